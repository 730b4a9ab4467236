/* Pixels of one instance against rays: in none that is not mixed does a ray see another instance
 * than the one through the centre. */
#include "annotate/mixed_pixels.h"

#include "render/geometry.h"
#include "scenes.h"
#include "trace/tracer.h"

enum { WIDTH = 80, HEIGHT = 56, TRIES = 12 };

/* From the centre: as far as pl_image_sample_offset goes. */
static const double FARTHEST = 0.542;

/* Pixels: mixed ones, those of them in which rays differ, and those that see anything. */
typedef struct sums {
  int mixed, differ, hit, all;
} sums;

static int32_t seen_at(const pl_snapshot *shot, const pl_tracer *tracer, double u, double v) {
  const pl_vec3 direction = pl_snapshot_ray(shot, u, v);
  const pl_ray ray = {.t_max = INFINITY, .direction = direction, .skip_body = PL_NO_BODY};
  pl_hit hit;
  pl_geometry_label label;
  if (!(pl_vec3_dot(direction, direction) > 0.0))
    return 0;
  pl_tracer_closest(tracer, &ray, &hit, 1, false, true);
  if (pl_surface_is_none(hit.surface_id))
    return 0;
  pl_geometry_of(hit.surface_id)->label(shot, hit.surface_id, &label);
  return label.instance_id;
}

static void check_pixel(const pl_snapshot *shot, const pl_tracer *tracer, test_random *random,
                        int x, int y, bool mixed, sums *sums) {
  const int32_t centre = seen_at(shot, tracer, x, y);
  bool differs = false;
  for (int i = 0; i < TRIES && !differs; i++)
    differs = seen_at(shot, tracer, x + random_range(random, -FARTHEST, FARTHEST),
                      y + random_range(random, -FARTHEST, FARTHEST)) != centre;
  if (differs && !mixed)
    fail_msg("rays of pixel (%d, %d) see several instances, and it is not mixed", x, y);
  sums->mixed += mixed;
  sums->differ += differs;
  sums->hit += centre > 0;
  sums->all++;
}

static void check_shot(const stage *stage, test_random *random, sums *sums) {
  pl_arena arena;
  pl_snapshot shot;
  pl_accelerators *kept;
  const pl_tracer *tracer;
  pl_coverage coverage = {0};
  pl_arena_init(&arena);
  assert_int_equal(pl_accelerators_create(&kept), PL_OK);
  assert_int_equal(pl_snapshot_build(&stage->scene, &stage->placement, &arena, &shot), PL_OK);
  assert_int_equal(pl_geometry_tracer(kept, &shot, &arena, &tracer), PL_OK);
  assert_int_equal(pl_coverage_update(&coverage, &shot, 0, HEIGHT, 17, 1), PL_OK);
  for (int y0 = 0; y0 < HEIGHT; y0 += PL_TILE_SIDE)
    for (int x0 = 0; x0 < WIDTH; x0 += PL_TILE_SIDE) {
      const pl_tile tile = {x0, y0, WIDTH - x0 < PL_TILE_SIDE ? WIDTH - x0 : PL_TILE_SIDE,
                            HEIGHT - y0 < PL_TILE_SIDE ? HEIGHT - y0 : PL_TILE_SIDE};
      bool mixed[PL_TILE_PIXELS];
      pl_mixed_pixels_find(&shot, &coverage, tile, mixed);
      for (int y = 0; y < tile.height; y++)
        for (int x = 0; x < tile.width; x++)
          check_pixel(&shot, tracer, random, x0 + x, y0 + y, mixed[y * PL_TILE_SIDE + x], sums);
    }
  pl_coverage_clear(&coverage);
  pl_accelerators_destroy(kept);
  pl_arena_clear(&arena);
}

/* Slivers as long as `size`, of which rays through centres meet few. */
static pl_model *slivers_create(test_random *random, size_t count, double size) {
  pl_model *model = model_create(3 * count, count);
  for (uint32_t i = 0; i < 3 * count; i += 3) {
    const pl_vec3 from = random_direction(random), along = random_direction(random);
    const pl_vec3 aside = random_direction(random), up = {0, 0, 1};
    model_set_vertex(model, i, from, up);
    model_set_vertex(model, i + 1, pl_vec3_madd(from, size, along), up);
    model_set_vertex(model, i + 2, pl_vec3_madd(from, random_scale(random, 1e-5, 1e-2), aside), up);
    for (uint32_t k = i; k < i + 3; k++)
      model->indices[k] = k;
  }
  pl_model_measure(model);
  return model;
}

/* Ellipsoids of all sizes and distances, before and behind each other, some of them of less than a
 * pixel, some that fill the picture and more. */
static void add_bodies(stage *stage, test_random *random, int count) {
  for (int i = 0; i < count; i++) {
    const double off = random_scale(random, 2.0, 1e4), part = random_scale(random, 1e-3, 0.9);
    const pl_vec3 toward = pl_vec3_unit(
        (pl_vec3){random_range(random, -0.6, 0.6), random_range(random, -0.5, 0.5), 1.0});
    const pl_vec3 radii = {part * off, part * off * random_range(random, 0.3, 1.0),
                           part * off * random_range(random, 0.3, 1.0)};
    stage_add_body(stage, pl_vec3_scale(toward, off), radii, 0.5f);
  }
}

static const double BROWN[8] = {-0.28, 0.09, 1e-3, -8e-4, -0.012, 0.01, -0.002, 1e-4};
static const double EYE[4] = {-0.02, 0.004, -0.001, 1e-4};

/* `lens`: of pl_lens_models; -1: none. */
static sums check_worlds(int worlds, int bodies, bool slivers, int lens, uint64_t seed) {
  test_random random = {.seed = seed};
  sums sums = {0};
  for (int i = 0; i < worlds; i++) {
    stage stage;
    pl_model *model = slivers_create(&random, 12, 1.0);
    stage_init(&stage, WIDTH, HEIGHT, random_range(&random, 50.0, 120.0));
    if (lens >= 0)
      assert_int_equal(pl_lens_init(&pl_lens_models[lens], lens == 0 ? BROWN : EYE,
                                    &stage.placement.camera.lens),
                       PL_OK);
    if (slivers)
      stage_add_object(&stage, model, (pl_vec3){0.5, 0.0, random_range(&random, 3.0, 20.0)},
                       random_rotation(&random), 1.0);
    add_bodies(&stage, &random, bodies);
    check_shot(&stage, &random, &sums);
    stage_clear(&stage);
    pl_model_destroy(model);
  }
  print_message("%d of %d pixels mixed, rays differ in %d, %d see anything\n", sums.mixed, sums.all,
                sums.differ, sums.hit);
  assert_true(sums.differ > 0 && sums.mixed < sums.all);
  return sums;
}

/* Few pixels more than those that a limb crosses. */
static void test_limbs(void **state) {
  (void)state;
  const sums one = check_worlds(24, 1, false, -1, 1);
  assert_true(one.mixed < 2.5 * one.differ);
  assert_true(one.hit > one.all / 20);
  check_worlds(24, 3, false, -1, 2);
}

/* A small ellipsoid before a large one: what lies far behind another is hidden. */
static void test_one_before_another(void **state) {
  (void)state;
  test_random random = {.seed = 8};
  sums sums = {0};
  for (int i = 0; i < 12; i++) {
    stage stage;
    stage_init(&stage, WIDTH, HEIGHT, 60.0);
    for (int k = 0; k < 2; k++) {
      const double away = k == 0 ? 10.0 : 1000.0, part = k == 0 ? 0.2 : 0.5;
      stage_add_body(&stage,
                     (pl_vec3){away * random_range(&random, -0.4, 0.4),
                               away * random_range(&random, -0.3, 0.3), away},
                     (pl_vec3){part * away, 0.8 * part * away, part * away}, 0.5f);
    }
    check_shot(&stage, &random, &sums);
    stage_clear(&stage);
  }
  assert_true(sums.differ > 0 && sums.mixed < 2.5 * sums.differ);
}

static void test_slivers(void **state) {
  (void)state;
  const sums sums = check_worlds(16, 2, true, -1, 3);
  assert_true(sums.mixed < sums.all / 2);
}

static void test_lenses(void **state) {
  (void)state;
  check_worlds(8, 2, true, 0, 4);
  check_worlds(8, 2, true, 1, 5);
  check_worlds(8, 2, true, 2, 6);
}

/* More ellipsoids than are looked at one by one: nothing is missed. */
static void test_many_bodies(void **state) {
  (void)state;
  check_worlds(6, 14, false, -1, 6);
}

/* The camera 1 mm above an ellipsoid as large as the Earth, and as far as a star from a small one.
 */
static void test_extremes(void **state) {
  (void)state;
  test_random random = {.seed = 7};
  sums sums = {0};
  for (int i = 0; i < 8; i++) {
    stage stage;
    const double radius_m = 6378137.0;
    stage_init(&stage, WIDTH, HEIGHT, i < 4 ? 40.0 : 40.0 * 0.05 * 4e11 / radius_m);
    const pl_vec3 place = i < 4 ? (pl_vec3){0.0, radius_m + 1e-3, 0.0} : (pl_vec3){0.0, 1e6, 2e10};
    stage_add_body(&stage, place, (pl_vec3){radius_m, radius_m, radius_m * (i % 2 ? 1.0 : 0.9966)},
                   0.5f);
    check_shot(&stage, &random, &sums);
    stage_clear(&stage);
  }
  assert_true(sums.differ > 0 && sums.hit > 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      serial_unit_test(test_limbs),    serial_unit_test(test_slivers),
      serial_unit_test(test_lenses),   serial_unit_test(test_many_bodies),
      serial_unit_test(test_extremes), serial_unit_test(test_one_before_another),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
