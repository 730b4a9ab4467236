/* Areas of a body by rasters of bytes (terrain/area_map.h), against cells found by hand. */
#include "harness.h"

#include <math.h>

#include "random.h"
#include "terrain/area_map.h"

enum { W = 12, H = 6 };

static pl_raster *globe(const uint8_t *cells) {
  pl_raster *out = NULL;
  const pl_raster_frame frame = {.samples = cells,
                                 .type = PL_RASTER_UINT8,
                                 .width = W,
                                 .height = H,
                                 .scale = 1.0,
                                 .projection = {.kind = PL_PROJECTION_CYLINDRICAL},
                                 .x0 = PL_PI / W,
                                 .y0 = PL_PI / 2.0 - PL_PI / (2.0 * H),
                                 .dx = 2.0 * PL_PI / W,
                                 .dy = -PL_PI / H};
  assert_int_equal(pl_raster_create(&frame, &out), PL_OK);
  return out;
}

static pl_vec3 towards(double lon, double lat) {
  return (pl_vec3){cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)};
}

/* The cell that holds a place, with no use of the raster's own code. */
static uint8_t by_hand(const uint8_t *cells, double lon, double lat) {
  int column = (int)floor((lon < 0.0 ? lon + 2.0 * PL_PI : lon) / (2.0 * PL_PI) * W);
  int row = (int)floor((PL_PI / 2.0 - lat) / PL_PI * H);
  column = column < 0 ? 0 : column >= W ? W - 1 : column;
  row = row < 0 ? 0 : row >= H ? H - 1 : row;
  return cells[row * W + column];
}

static void every_place_has_the_number_of_its_cell(void **state) {
  uint8_t cells[W * H];
  test_random random = {.seed = 7};
  (void)state;
  for (int i = 0; i < W * H; i++)
    cells[i] = (uint8_t)(random_unit(&random) * 5.0);
  pl_raster *raster = globe(cells);
  const pl_area_map map = {.rasters = {raster}, .count = 1};
  assert_int_equal(pl_area_map_check(&map, 4), PL_OK);
  for (int i = 0; i < 20000; i++) {
    const double lon = 2.0 * PL_PI * (random_unit(&random) - 0.5);
    /* a third of the places within 3 degrees of a pole */
    const double wide = i % 3 == 0 ? 0.05 : PL_PI / 2.0;
    const double from = (i % 2 == 0 ? 1.0 : -1.0) * (PL_PI / 2.0 - random_unit(&random) * wide);
    const double x = (lon + PL_PI) / (2.0 * PL_PI) * W, y = (PL_PI / 2.0 - from) / PL_PI * H;
    if (fabs(x - rint(x)) < 1e-6 || fabs(y - rint(y)) < 1e-6)
      continue; /* on the edge of a cell */
    const double length = exp(20.0 * (random_unit(&random) - 0.5));
    assert_int_equal(pl_area_map_at(&map, pl_vec3_scale(towards(lon, from), length)),
                     by_hand(cells, lon, from));
  }
  pl_raster_destroy(raster);
}

static void the_uppermost_that_says_something_counts(void **state) {
  uint8_t low[W * H], high[W * H];
  (void)state;
  for (int i = 0; i < W * H; i++) {
    low[i] = (uint8_t)(i % 3);
    high[i] = (uint8_t)(i % 2 == 0 ? 0 : 3);
  }
  pl_raster *rasters[] = {globe(low), globe(high)};
  const pl_area_map map = {.rasters = {rasters[0], rasters[1]}, .count = 2};
  for (int row = 0; row < H; row++)
    for (int column = 0; column < W; column++) {
      const int i = row * W + column;
      const pl_vec3 at =
          towards(2.0 * PL_PI * (column + 0.5) / W, PL_PI / 2.0 - PL_PI * (row + 0.5) / H);
      assert_int_equal(pl_area_map_at(&map, at), high[i] != 0 ? high[i] : low[i]);
    }
  assert_int_equal(pl_area_map_at(&(pl_area_map){.count = 0}, towards(0.0, 0.0)), 0);
  pl_raster_destroy(rasters[0]);
  pl_raster_destroy(rasters[1]);
}

static void what_is_no_map_of_areas_is_refused(void **state) {
  uint8_t cells[W * H] = {0};
  (void)state;
  cells[17] = 3;
  pl_raster *raster = globe(cells);
  const pl_area_map map = {.rasters = {raster}, .count = 1};
  assert_int_equal(pl_area_map_check(&map, 3), PL_OK);
  assert_int_equal(pl_area_map_check(&map, 2), PL_E_RANGE);
  pl_raster_frame frame = *pl_raster_frame_of(raster);
  frame.offset = 0.5;
  pl_raster *shifted = NULL;
  assert_int_equal(pl_raster_create(&frame, &shifted), PL_OK);
  assert_int_equal(pl_area_map_check(&(pl_area_map){.rasters = {shifted}, .count = 1}, 9),
                   PL_E_RANGE);
  pl_raster_destroy(raster);
  pl_raster_destroy(shifted);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_place_has_the_number_of_its_cell),
      cmocka_unit_test(the_uppermost_that_says_something_counts),
      cmocka_unit_test(what_is_no_map_of_areas_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
