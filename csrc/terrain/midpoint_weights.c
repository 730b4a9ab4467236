/* Weights and variances of midpoint displacement. */
#include "terrain/midpoint_weights.h"

#include <math.h>

enum { AROUND = PL_MIDPOINT_AROUND, UNKNOWN = AROUND + 1 };

/* At H = 1 the field is a plane, for which any weights of a linear estimate do. */
#define HURST_MOST 0.98

/* Four by four nodes: of the lattice about the middle of a cell; of the lattice of both, which is
 * turned by 45 degrees and finer by sqrt(2), about a middle of a side. */
void pl_midpoint_offset(pl_midpoint_step step, int k, int *x, int *y) {
  const int a = 2 * (k % 4) - 3, b = 2 * (k / 4) - 3;
  *x = step == PL_MIDPOINT_DIAMOND ? a : (a + b) / 2;
  *y = step == PL_MIDPOINT_DIAMOND ? b : (b - a) / 2;
}

/* Solves in place, by elimination with the greatest pivot of each column. */
static void solve(double matrix[UNKNOWN][UNKNOWN], double right[UNKNOWN]) {
  for (int k = 0; k < UNKNOWN; k++) {
    int best = k;
    for (int row = k + 1; row < UNKNOWN; row++)
      best = fabs(matrix[row][k]) > fabs(matrix[best][k]) ? row : best;
    for (int column = k; column < UNKNOWN; column++) {
      const double kept = matrix[k][column];
      matrix[k][column] = matrix[best][column];
      matrix[best][column] = kept;
    }
    const double kept = right[k];
    right[k] = right[best];
    right[best] = kept;
    for (int row = k + 1; row < UNKNOWN; row++) {
      const double factor = matrix[row][k] / matrix[k][k];
      for (int column = k; column < UNKNOWN; column++)
        matrix[row][column] -= factor * matrix[k][column];
      right[row] -= factor * right[k];
    }
  }
  for (int k = UNKNOWN - 1; k >= 0; k--) {
    for (int column = k + 1; column < UNKNOWN; column++)
      right[k] -= matrix[k][column] * right[column];
    right[k] /= matrix[k][k];
  }
}

/* Places of the neighbours about the node, in cells along y. */
typedef struct places {
  double x[AROUND], y[AROUND];
} places;

static double structure(double x, double y, double hurst) {
  const double square = x * x + y * y;
  return square > 0.0 ? pow(square, hurst) : 0.0;
}

/* Kriging: half of S among the neighbours, and weights that sum to 1. */
static void weigh(const places *at, double hurst, double weights[UNKNOWN]) {
  double matrix[UNKNOWN][UNKNOWN];
  for (int k = 0; k < AROUND; k++) {
    for (int n = 0; n < AROUND; n++)
      matrix[k][n] = 0.5 * structure(at->x[k] - at->x[n], at->y[k] - at->y[n], hurst);
    matrix[k][AROUND] = matrix[AROUND][k] = 1.0;
    weights[k] = 0.5 * structure(at->x[k], at->y[k], hurst);
  }
  matrix[AROUND][AROUND] = 0.0;
  weights[AROUND] = 1.0;
  solve(matrix, weights);
}

/* Of what is left, for any weights that sum to 1: sum_k w_k S_k - 1/2 sum_kn w_k w_n S_kn. */
static double left(const places *at, double hurst, const double *weights) {
  double sum = 0.0;
  for (int k = 0; k < AROUND; k++) {
    sum += weights[k] * structure(at->x[k], at->y[k], hurst);
    for (int n = 0; n < AROUND; n++)
      sum -= 0.5 * weights[k] * weights[n] *
             structure(at->x[k] - at->x[n], at->y[k] - at->y[n], hurst);
  }
  return fmax(sum, 0.0);
}

pl_midpoint pl_midpoint_make(double hurst, double ratio, pl_midpoint_step step) {
  places at;
  double weights[UNKNOWN];
  pl_midpoint out;
  for (int k = 0; k < AROUND; k++) {
    int x, y;
    pl_midpoint_offset(step, k, &x, &y);
    at.x[k] = 0.5 * ratio * x;
    at.y[k] = 0.5 * y;
  }
  weigh(&at, fmin(hurst, HURST_MOST), weights);
  for (int k = 0; k < AROUND; k++)
    out.weights[k] = weights[k];
  out.variance = left(&at, hurst, weights);
  return out;
}
