#include "terrain/plane_fit.h"

#include "math/rotation.h"

/* Cells over the baseline. */
#define CELL_OF_BASELINE (1.0 / 8.0)
/* Directions that are evaluated at once. */
enum { BATCH = 2048 };
/* Extent of an array in baselines from which discs are evaluated one by one: together they would
 * find mostly craters between them. */
#define ALONE_FROM 64.0

/* Equal areas, turned by the golden angle from point to point (Vogel 1979). */
static void spread(pl_disc *disc) {
  const double turn = PL_PI * (3.0 - sqrt(5.0));
  double mean_x = 0.0, mean_y = 0.0;
  for (int k = 0; k < disc->count; k++) {
    const double r = 0.5 * sqrt((k + 0.5) / disc->count);
    disc->x[k] = r * cos(k * turn);
    disc->y[k] = r * sin(k * turn);
    mean_x += disc->x[k] / disc->count;
    mean_y += disc->y[k] / disc->count;
  }
  for (int k = 0; k < disc->count; k++) {
    disc->x[k] -= mean_x;
    disc->y[k] -= mean_y;
  }
}

pl_status pl_disc_init(int points, pl_disc *out) {
  if (points < PL_DISC_LEAST || points > PL_DISC_MOST)
    return pl_fail(PL_E_RANGE, "a plane through %d points; must be %d to %d", points, PL_DISC_LEAST,
                   PL_DISC_MOST);
  out->count = points;
  spread(out);
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (int k = 0; k < points; k++) {
    xx += out->x[k] * out->x[k];
    xy += out->x[k] * out->y[k];
    yy += out->y[k] * out->y[k];
  }
  const double det = xx * yy - xy * xy;
  for (int k = 0; k < points; k++) {
    out->of_x[k] = (yy * out->x[k] - xy * out->y[k]) / det;
    out->of_y[k] = (xx * out->y[k] - xy * out->x[k]) / det;
  }
  return PL_OK;
}

/* Sets the directions of the points of a disc about `up`, `stride` apart. `angle`: of the baseline.
 */
static void aim(const pl_disc *disc, pl_vec3 up, double angle, pl_vec3 *directions, size_t stride) {
  pl_vec3 east, north;
  pl_ground_axes(up, &east, &north);
  for (int k = 0; k < disc->count; k++) {
    const pl_vec3 across = pl_vec3_madd(up, angle * disc->x[k], east);
    directions[(size_t)k * stride] = pl_vec3_unit(pl_vec3_madd(across, angle * disc->y[k], north));
  }
}

/* `heights_m`: `stride` apart. `datum_m`: distance of the ellipsoid, where the baseline was laid
 * out. */
static pl_plane_fit fit(const pl_disc *disc, const double *heights_m, size_t stride,
                        double baseline_m, double datum_m) {
  double mean = 0.0, gx = 0.0, gy = 0.0, sum = 0.0;
  for (int k = 0; k < disc->count; k++)
    mean += heights_m[(size_t)k * stride] / disc->count;
  for (int k = 0; k < disc->count; k++) {
    gx += disc->of_x[k] * (heights_m[(size_t)k * stride] - mean);
    gy += disc->of_y[k] * (heights_m[(size_t)k * stride] - mean);
  }
  for (int k = 0; k < disc->count; k++) {
    const double plane = mean + gx * disc->x[k] + gy * disc->y[k];
    const double rest = heights_m[(size_t)k * stride] - plane;
    sum += rest * rest;
  }
  /* Distances along the ground grow with its own height. */
  const double run_m = baseline_m * (1.0 + mean / datum_m);
  return (pl_plane_fit){atan(hypot(gx, gy) / run_m), sqrt(sum / disc->count)};
}

/* Distance of the ends of an array in baselines. */
static double extent(const pl_vec3 *directions, size_t count, double angle) {
  return pl_vec3_norm(pl_vec3_sub(directions[count - 1], directions[0])) / angle;
}

static pl_status fit_batch(const pl_terrain *terrain, const pl_disc *disc, int level,
                           const pl_vec3 *directions, size_t count, double baseline_m,
                           pl_plane_fit *out) {
  pl_vec3 around[BATCH];
  double heights_m[BATCH], datum_m[BATCH / PL_DISC_LEAST];
  const size_t points = (size_t)disc->count;
  /* Neighbours among the heights share the search for craters; no bit depends on it. */
  const bool by_point = extent(directions, count, baseline_m / pl_terrain_radius_m(terrain)) < 1.0;
  const size_t stride = by_point ? count : 1, step = by_point ? 1 : points;
  for (size_t k = 0; k < count; k++) {
    datum_m[k] = pl_terrain_datum_m(terrain, directions[k]);
    aim(disc, directions[k], baseline_m / datum_m[k], around + k * step, stride);
  }
  PL_TRY(pl_terrain_heights(terrain, around, count * points, level, heights_m));
  for (size_t k = 0; k < count; k++)
    out[k] = fit(disc, heights_m + k * step, stride, baseline_m, datum_m[k]);
  return PL_OK;
}

pl_status pl_plane_fits(const pl_terrain *terrain, const pl_disc *disc, const pl_vec3 *directions,
                        size_t count, double baseline_m, pl_plane_fit *out) {
  const int level = pl_terrain_level_of(terrain, CELL_OF_BASELINE * baseline_m);
  const double angle = baseline_m / pl_terrain_radius_m(terrain);
  size_t most = BATCH / (size_t)disc->count;
  if (count > 1 && extent(directions, count, angle) > ALONE_FROM)
    most = 1;
  for (size_t done = 0; done < count; done += most) {
    const size_t some = count - done < most ? count - done : most;
    PL_TRY(fit_batch(terrain, disc, level, directions + done, some, baseline_m, out + done));
  }
  return PL_OK;
}
