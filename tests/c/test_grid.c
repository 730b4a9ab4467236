/* Grids over a body: interpolation, the seam, the edges, means and errors. */
#include "harness.h"

#include <math.h>

#include "geom/grid.h"
#include "math/vec.h"
#include "random.h"

static const double DEGREE = PL_PI / 180.0;

/* Two channels: longitude of the cell's centre as a cosine, latitude. From 70 S to 70 N. */
enum { WIDTH = 36, HEIGHT = 14 };
static pl_grid *make(void) {
  static float values[HEIGHT][WIDTH][2];
  const pl_grid_frame frame = {WIDTH, HEIGHT, 2, 0.0, 70.0 * DEGREE, -70.0 * DEGREE};
  pl_grid *grid;
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++) {
      values[y][x][0] = (float)cos((10.0 * x + 5.0) * DEGREE);
      values[y][x][1] = (float)(65.0 - 10.0 * y);
    }
  assert_int_equal(pl_grid_create(&frame, &values[0][0][0], &grid), PL_OK);
  return grid;
}

static void test_cell_centres_and_between(void **state) {
  (void)state;
  pl_grid *grid = make();
  float out[2];
  for (int y = 0; y < HEIGHT; y++)
    for (int x = -WIDTH; x < WIDTH; x++) {
      pl_grid_sample(grid, (10.0 * x + 5.0) * DEGREE, (65.0 - 10.0 * y) * DEGREE, 0.0, out);
      assert_true(fabs((double)out[0] - cos((10.0 * x + 5.0) * DEGREE)) < 1e-6);
      assert_true(fabs((double)out[1] - (65.0 - 10.0 * y)) < 1e-4);
    }
  pl_grid_sample(grid, 0.0, 12.0 * DEGREE, 0.0, out); /* the seam: between 355 and 5 degrees */
  assert_true(fabs((double)out[0] - cos(5.0 * DEGREE)) < 1e-6);
  assert_true(fabs((double)out[1] - 12.0) < 1e-4);
  pl_grid_destroy(grid);
}

static void test_beyond_the_edges(void **state) {
  (void)state;
  pl_grid *grid = make();
  float out[2];
  pl_grid_sample(grid, 1.0, 70.001 * DEGREE, 0.0, out);
  assert_true(fabs((double)out[1] - 65.0) < 1e-3);
  pl_grid_sample(grid, 1.0, -70.001 * DEGREE, 0.0, out);
  assert_true(fabs((double)out[1] + 65.0) < 1e-3);
  /* At the pole, 20 degrees on, four cells and four are one. */
  float other[2];
  pl_grid_sample(grid, 0.0, 0.5 * PL_PI, 0.0, out);
  pl_grid_sample(grid, 20.0 * DEGREE, 0.5 * PL_PI, 0.0, other);
  assert_true(fabsf(out[0] - other[0]) < 0.2f && out[1] > 40.0f && out[1] < 60.0f);
  pl_grid_destroy(grid);
}

/* The halved levels keep the mean; a footprint as wide as the world sees it; between levels the
 * value goes over without a step. */
static void test_footprints(void **state) {
  (void)state;
  pl_grid *grid = make();
  float out[2], last[2];
  pl_grid_sample(grid, 2.0, 0.3, 100.0, out);
  assert_true(fabs((double)out[0]) < 1e-6 && fabs((double)out[1]) < 1e-5);
  assert_true(out[0] == pl_grid_mean(grid)[0]);
  pl_grid_sample(grid, 2.0, 0.3, 0.0, last);
  for (double size = 0.0; size < 8.0; size += 1e-3) {
    pl_grid_sample(grid, 2.0, 0.3, size, out);
    assert_true(fabsf(out[0] - last[0]) < 0.02f && fabsf(out[1] - last[1]) < 0.5f);
    last[0] = out[0];
    last[1] = out[1];
  }
  pl_grid_destroy(grid);
}

/* Odd sides share cells between coarse ones: the mean stays. */
static void test_odd_sizes(void **state) {
  (void)state;
  test_random random = {.seed = 81};
  float values[7 * 5];
  double mean = 0.0;
  for (int i = 0; i < 35; i++) {
    values[i] = (float)random_unit(&random);
    mean += (double)values[i] / 35.0;
  }
  const pl_grid_frame frame = {7, 5, 1, -PL_PI, 1.0, -1.0};
  pl_grid *grid;
  assert_int_equal(pl_grid_create(&frame, values, &grid), PL_OK);
  assert_true(fabs((double)pl_grid_mean(grid)[0] - mean) < 1e-6);
  assert_true(pl_grid_cell(grid, 3, 2)[0] == values[2 * 7 + 3]);
  pl_grid_destroy(grid);
}

static void test_errors(void **state) {
  (void)state;
  const float good[2] = {1.0f, 2.0f}, bad[2] = {1.0f, NAN};
  pl_grid *grid;
  const pl_grid_frame frames[] = {{0, 1, 1, 0.0, 1.0, 0.0},
                                  {1, 1, 33, 0.0, 1.0, 0.0},
                                  {2, 1, 1, 0.0, 0.0, 1.0},
                                  {2, 1, 1, NAN, 1.0, 0.0}};
  for (size_t i = 0; i < sizeof frames / sizeof frames[0]; i++) {
    assert_int_equal(pl_grid_create(&frames[i], good, &grid), PL_E_RANGE);
    assert_null(grid);
  }
  const pl_grid_frame frame = {2, 1, 1, 0.0, 1.0, 0.0};
  assert_int_equal(pl_grid_create(&frame, bad, &grid), PL_E_RANGE);
  pl_grid_destroy(NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_cell_centres_and_between),
      cmocka_unit_test(test_beyond_the_edges),
      cmocka_unit_test(test_footprints),
      cmocka_unit_test(test_odd_sizes),
      cmocka_unit_test(test_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
