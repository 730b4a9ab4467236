/* Slopes that a mesh leaves out: those of the detail and their variance, beside tiles. */
#include "grounds.h"

#include <stdlib.h>

#include "detail_sum.h"
#include "random.h"
#include "terrain/cube.h"
#include "terrain/height_field.h"
#include "terrain/sub_cell.h"

static const double MOON_M = 1737400.0;

/* Detail of a Hurst exponent of 0.8 below 500 m, and craters if asked. */
typedef struct ground {
  pl_terrain *terrain;
  pl_crater_field *craters;
  pl_fractal_detail detail;
} ground;

static ground make_shared(double strength, bool craters, double roughness_baseline_m) {
  ground out = {0};
  pl_terrain_frame frame = {.radii_m = {MOON_M, MOON_M, MOON_M},
                            .detail = {.on = strength > 0.0,
                                       .seed = 7,
                                       .baseline_m = 10.0,
                                       .deviation_m = 1.0,
                                       .range_count = 1,
                                       .ranges = {{0.0, 0.8}},
                                       .strength = strength,
                                       .longest_m = 500.0,
                                       .finest_m = 0.5},
                            .roughness_baseline_m = roughness_baseline_m};
  if (craters) {
    pl_crater_frame given = pl_crater_frame_default(MOON_M);
    given.min_m = 2.0;
    given.max_m = 500.0;
    assert_int_equal(pl_crater_field_create(&given, &out.craters), PL_OK);
    frame.craters = out.craters;
  }
  assert_int_equal(pl_terrain_create(&frame, &out.terrain), PL_OK);
  pl_fractal_detail_init(&frame.detail, MOON_M, &out.detail);
  return out;
}

static ground make(double strength, bool craters) { return make_shared(strength, craters, 0.0); }

static void drop(ground *ground) {
  pl_terrain_destroy(ground->terrain);
  pl_crater_field_destroy(ground->craters);
}

static pl_vec3 direction(test_random *random) {
  return pl_vec3_unit(
      (pl_vec3){random_unit(random) - 0.5, random_unit(random) - 0.5, random_unit(random) - 0.5});
}

/* The closed form is the mean square of the gradient, octave by octave. */
static void test_variance_of_octaves(void **state) {
  (void)state;
  ground ground = make(1.0, false);
  test_random random = {.seed = 1};
  for (int octave = ground.detail.last - 2; octave <= ground.detail.last; octave++) {
    enum { COUNT = 4000 };
    double sum = 0.0;
    for (int k = 0; k < COUNT; k++) {
      const pl_vec3 d = direction(&random);
      const pl_vec3 along = pl_vec3_unit(pl_vec3_cross(d, direction(&random)));
      const double slope =
          pl_vec3_dot(pl_fractal_detail_octave_gradient(&ground.detail, d, octave), along) / MOON_M;
      sum += slope * slope / COUNT;
    }
    const double stated = pl_fractal_detail_slope_variance(&ground.detail, octave, MOON_M);
    assert_true(fabs(sum / stated - 1.0) < 0.12);
  }
  drop(&ground);
}

/* Sums over places on tiles of a level. */
typedef struct sums {
  double mesh, shown, error, shown_error, truth, left, whole, added;
} sums;

static pl_vec3 slope_of(pl_vec3 normal, pl_vec3 up) {
  const double height = pl_vec3_dot(normal, up);
  return pl_vec3_scale(pl_vec3_madd(normal, -height, up), -1.0 / height);
}

static double square(pl_vec3 v) { return 0.5 * pl_vec3_dot(v, v); }

static void measure(const ground *ground, pl_ground_tile *tile, int count, double footprint_m,
                    test_random *random, sums *out) {
  const pl_height_field field = {.terrain = ground->terrain,
                                 .tiles = (const pl_ground_tile *const[]){tile},
                                 .count = 1,
                                 .origin = tile->origin};
  for (int k = 0; k < count; k++) {
    const float u = (float)(0.05 + 0.9 * random_unit(random));
    const float v = (float)(0.05 + 0.9 * random_unit(random));
    const pl_vec3 up = pl_vec3_unit(pl_height_field_point(&field, 0, u, v));
    const pl_vec3 mesh = slope_of(pl_height_field_normal(&field, 0, u, v), up);
    const pl_vec3 truth =
        pl_vec3_scale(detail_gradient(&ground->detail, up, 0, ground->detail.last), 1.0 / MOON_M);
    const pl_sub_cell left = pl_terrain_sub_cell(
        ground->terrain, up, pl_ground_tile_lattice(tile->id), footprint_m, true);
    const pl_vec3 shown = pl_vec3_add(mesh, left.slope);
    assert_true(fabs(pl_vec3_dot(left.slope, up)) < 1e-12);
    assert_true(left.variance >= -1e-9 && left.whole >= left.variance);
    out->mesh += square(mesh) / count;
    out->shown += square(shown) / count;
    out->truth += square(truth) / count;
    out->error += square(pl_vec3_sub(mesh, truth)) / count;
    out->shown_error += square(pl_vec3_sub(shown, truth)) / count;
    out->left += left.variance / count;
    out->whole += left.whole / count;
    out->added += square(left.slope) / count;
  }
}

static sums measure_level(const ground *ground, int level, double footprint_m, int tiles) {
  sums out = {0};
  pl_ground_tile *tile = malloc(sizeof *tile);
  test_random random = {.seed = 11 + (uint64_t)level};
  for (int k = 0; k < tiles; k++) {
    const uint32_t side = 1u << level, from = side / 2 - side / 8; /* where cells are square */
    const pl_ground_tile_id id = {.face = (uint8_t)(k % 6),
                                  .level = (uint8_t)level,
                                  .i = from + (uint32_t)random_below(&random, (int)(side / 4)),
                                  .j = from + (uint32_t)random_below(&random, (int)(side / 4))};
    sums one = {0};
    assert_int_equal(pl_ground_tile_make(ground->terrain, id, tile), PL_OK);
    measure(ground, tile, 150, footprint_m, &random, &one);
    const double *from_sum = (const double *)&one;
    for (size_t n = 0; n < sizeof one / sizeof(double); n++)
      ((double *)&out)[n] += from_sum[n] / tiles;
  }
  free(tile);
  return out;
}

/* What is shown and what is left add up to the ground's slopes at any cell and footprint; what is
 * added makes slopes better, the more the finer the footprint. */
static void test_shares(void **state) {
  (void)state;
  ground ground = make(0.3, false);
  for (int level = 12; level <= 14; level++) {
    const double cell_m = pl_cube_cell_m(level + PL_GROUND_TILE_SHIFT, MOON_M);
    double before = INFINITY;
    for (int n = 0; n < 4; n++) {
      const double footprint_m = cell_m * exp2(1.0 - 1.5 * n);
      const sums got = measure_level(&ground, level, footprint_m, PL_DRAWS(60, 20));
      assert_true(fabs((got.shown + got.left) / got.truth - 1.0) < PL_DRAWS(0.04, 0.1));
      assert_true(fabs(got.added / fmax(got.whole - got.left, 1e-9) - 1.0) < PL_DRAWS(0.15, 0.4) ||
                  got.whole - got.left < 1e-6);
      assert_true(got.shown_error <= got.error * PL_DRAWS(1.001, 1.1) &&
                  got.shown_error < before * PL_DRAWS(1.0, 1.1));
      before = got.shown_error;
      if (n == 3 && level == 14) /* the finest octave is shown, too */
        assert_true(got.shown_error < 0.15 * got.error);
    }
  }
  drop(&ground);
}

/* Cells of any width and the variance that they leave out add up to the same. */
static void test_craters(void **state) {
  (void)state;
  ground ground = make(0.0, true);
  double least = INFINITY, most = 0.0;
  for (int level = 11; level <= 15; level += 2) {
    const sums got = measure_level(&ground, level, 1.0, PL_DRAWS(250, 60));
    const double sum = got.mesh + got.left;
    assert_true(got.mesh > 0.1 * sum && got.left > 0.05 * sum);
    assert_true(got.left == got.whole && got.added == 0.0); /* none is a normal */
    least = fmin(least, sum);
    most = fmax(most, sum);
  }
  assert_true(most < PL_DRAWS(1.3, 1.8) * least);
  drop(&ground);
}

/* Of a flat body nothing is left, and no level or footprint is beyond the tables. */
static void test_ends(void **state) {
  (void)state;
  ground flat = make(0.0, false), rough = make(1.0, false);
  const pl_vec3 up = {0.6, 0.0, 0.8};
  for (int level = 0; level < PL_CUBE_LEVELS; level++) {
    const pl_sub_cell none = pl_terrain_sub_cell(flat.terrain, up, level, 1e-3, true);
    assert_true(none.variance == 0.0 && none.whole == 0.0 && pl_vec3_norm(none.slope) == 0.0);
    for (int n = -8; n <= 8; n += 4) {
      const pl_sub_cell some = pl_terrain_sub_cell(rough.terrain, up, level, pow(10.0, n), true);
      assert_true(some.variance >= -1e-9 && isfinite(some.whole) && pl_vec3_finite(some.slope));
    }
  }
  const double all = pl_terrain_slope_variance(rough.terrain, 1e9);
  assert_true(all > 0.0 && pl_terrain_slope_variance(rough.terrain, 1e-9) == 0.0);
  double before = all;
  for (double cell_m = 1e4; cell_m > 0.01; cell_m *= 0.7) {
    const double left = pl_terrain_slope_variance(rough.terrain, cell_m);
    assert_true(left <= before);
    before = left;
  }
  drop(&flat);
  drop(&rough);
}

static double roughness_left(const pl_terrain *terrain, double roughness_rad) {
  return pl_roughness_without(roughness_rad, pl_terrain_shared_variance(terrain));
}

/* Hapke's roughness and that of the ground below the baseline add up to the stated one. */
static void test_roughness_is_shared(void **state) {
  (void)state;
  const double stated = 23.7 * PL_PI / 180.0, tangent = tan(stated);
  for (double baseline_m = 1.0; baseline_m < 1e5; baseline_m *= 10.0) {
    ground ground = make_shared(0.3, true, baseline_m);
    const double left = tan(roughness_left(ground.terrain, stated));
    const double own = pl_terrain_slope_variance(ground.terrain, baseline_m);
    assert_true(own > 0.0 && left < tangent);
    assert_true(fabs(left * left + 2.0 / PL_PI * own - tangent * tangent) < 1e-12);
    drop(&ground);
  }
  ground none = make_shared(0.3, true, 0.0), steep = make_shared(5.0, false, 100.0);
  assert_true(fabs(roughness_left(none.terrain, stated) - stated) < 1e-12);
  assert_true(roughness_left(steep.terrain, stated) == 0.0);
  assert_true(roughness_left(steep.terrain, 0.0) == 0.0);
  drop(&none);
  drop(&steep);
  pl_terrain *terrain;
  const pl_terrain_frame wrong = {.radii_m = {1.0, 1.0, 1.0}, .roughness_baseline_m = -1.0};
  assert_int_equal(pl_terrain_create(&wrong, &terrain), PL_E_RANGE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_variance_of_octaves),
      cmocka_unit_test(test_shares),
      cmocka_unit_test(test_craters),
      cmocka_unit_test(test_ends),
      cmocka_unit_test(test_roughness_is_shared),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
