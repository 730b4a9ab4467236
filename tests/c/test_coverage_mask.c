/* The mask of pixels that a mesh may show in against rays: none that leaves by another pixel meets
 * a mesh. The tracer, which meets them, has its own test against brute force. */
#include "render/coverage_mask.h"

#include "jointed.h"
#include "scenes.h"
#include "render/geometry.h"
#include "scene/image_sample.h"
#include "trace/tracer.h"

enum { WIDTH = 96, HEIGHT = 64, PIXELS = WIDTH * HEIGHT, TRIES = 12 };

/* Random worlds of `all`. */
#define WORLDS(all) PL_DRAWS(all, (all) / 4 + 1)

/* From the centre: as far as pl_image_sample_offset goes. */
static const double FARTHEST = 0.542;

typedef struct world {
  stage stage;
  pl_arena arena;
  pl_snapshot shot;
  pl_accelerators *kept;
  const pl_tracer *tracer;
  pl_coverage coverage;
} world;

static void world_init(world *w, double focal_px) {
  *w = (world){0};
  stage_init(&w->stage, WIDTH, HEIGHT, focal_px);
  pl_arena_init(&w->arena);
  assert_int_equal(pl_accelerators_create(&w->kept), PL_OK);
}

static void world_set(world *w, int rays) {
  pl_arena_reset(&w->arena);
  assert_int_equal(pl_snapshot_build(&w->stage.scene, &w->stage.placement, &w->arena, &w->shot),
                   PL_OK);
  assert_int_equal(pl_geometry_tracer(w->kept, &w->shot, &w->arena, &w->tracer), PL_OK);
  assert_int_equal(pl_coverage_update(&w->coverage, &w->shot, 0, HEIGHT, rays, 1), PL_OK);
}

static void world_clear(world *w) {
  pl_coverage_clear(&w->coverage);
  pl_accelerators_destroy(w->kept);
  pl_arena_clear(&w->arena);
  stage_clear(&w->stage);
}

/* Triangles about places of the cube of half side 1, of sides from `small` to `large`; many are
 * slivers. */
static pl_model *debris_create(test_random *random, size_t triangles, double small, double large) {
  pl_model *model = model_create(3 * triangles, triangles);
  for (size_t t = 0; t < triangles; t++) {
    const pl_vec3 corner = {random_range(random, -1, 1), random_range(random, -1, 1),
                            random_range(random, -1, 1)};
    const double a = random_scale(random, small, large), b = random_scale(random, small, large);
    const uint32_t first = (uint32_t)(3 * t);
    const pl_vec3 along = random_direction(random), up = {0, 0, 1};
    model_set_vertex(model, first, corner, up);
    model_set_vertex(model, first + 1, pl_vec3_madd(corner, a, along), up);
    model_set_vertex(model, first + 2, pl_vec3_madd(corner, b, random_direction(random)), up);
    for (uint32_t k = 0; k < 3; k++)
      model->indices[first + k] = first + k;
  }
  pl_model_measure(model);
  return model;
}

static bool meets(const world *w, test_random *random, int x, int y) {
  const double offset[2] = {random_range(random, -FARTHEST, FARTHEST),
                            random_range(random, -FARTHEST, FARTHEST)};
  pl_beam beam;
  pl_hit hit;
  pl_image_sample_ray(&w->shot, (uint32_t)random_below(random, 64), offset, x, y,
                      (uint32_t)random_below(random, 1 << 30), &beam.origin, &beam.direction);
  if (pl_vec3_norm(beam.direction) == 0.0)
    return false;
  const pl_ray ray = {.origin = beam.origin,
                      .t_max = INFINITY,
                      .direction = beam.direction,
                      .skip_body = PL_EVERY_ELLIPSOID};
  pl_tracer_closest(w->tracer, &ray, &hit, 1, false, true);
  return !pl_surface_is_none(hit.surface_id);
}

/* Pixels: marked ones, and those of them that some of the rays hit in. */
typedef struct sums {
  int marked, hit, all;
} sums;

static void check_world(world *w, test_random *random, sums *sums) {
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++) {
      bool hit = false;
      for (int i = 0; i < TRIES && !hit; i++)
        hit = meets(w, random, x, y);
      const bool marked = pl_coverage_pixel(&w->coverage, x, y);
      if (hit && !marked)
        fail_msg("a mesh shows in pixel (%d, %d), which is not marked", x, y);
      sums->marked += marked;
      sums->hit += hit;
      sums->all++;
    }
}

/* Changes of the camera, and how far from it the mesh is, in its half sides. */
typedef void change_fn(pl_camera *camera, test_random *random);

static void keep(pl_camera *camera, test_random *random) {
  (void)camera;
  (void)random;
}

static void skew(pl_camera *camera, test_random *random) {
  camera->fy *= random_range(random, 0.5, 1.0);
  camera->skew = random_range(random, -20.0, 20.0);
  camera->cx += random_range(random, -100.0, 100.0);
}

static const double BROWN[8] = {-0.28, 0.09, 1e-3, -8e-4, -0.012, 0.01, -0.002, 1e-4};
static const double EYE[4] = {-0.02, 0.004, -0.001, 1e-4};

static void bend(pl_camera *camera, test_random *random) {
  const int model = random_below(random, 3);
  assert_int_equal(pl_lens_init(&pl_lens_models[model], model == 0 ? BROWN : EYE, &camera->lens),
                   PL_OK);
}

static void open_wide(pl_camera *camera, test_random *random) {
  camera->aperture_m = random_range(random, 0.01, 0.5);
  camera->focus_per_m = random_range(random, 0.0, 0.5);
}

/* `rays`: that a pixel gets; 0: in turn from one, for which boxes are enough, to four. */
static sums check_debris(change_fn *change, int rays, double near, double far, size_t triangles,
                         double small, double large, int worlds, uint64_t seed) {
  test_random random = {.seed = seed};
  sums sums = {0};
  for (int i = 0; i < worlds; i++) {
    world w;
    pl_model *model = debris_create(&random, triangles, small, large);
    world_init(&w, random_range(&random, 60.0, 120.0));
    change(&w.stage.placement.camera, &random);
    const double off = random_range(&random, near, far);
    const pl_vec3 place = {random_range(&random, -0.3, 0.3) * off,
                           random_range(&random, -0.3, 0.3) * off, off};
    const double scale = random_range(&random, 0.7, 1.0);
    stage_add_object(&w.stage, model, place, random_rotation(&random), scale);
    world_set(&w, rays > 0 ? rays : 1 + i % 4);
    check_world(&w, &random, &sums);
    world_clear(&w);
    pl_model_destroy(model);
  }
  print_message("%d of %d pixels marked, %d hit\n", sums.marked, sums.all, sums.hit);
  assert_true(sums.hit > 0 && sums.marked < sums.all);
  return sums;
}

/* Triangles of many pixels, near ones too; marks are few more than pixels that are hit. */
static void test_large(void **state) {
  (void)state;
  const sums sums = check_debris(keep, 5, 3.0, 8.0, 30, 0.05, 2.0, WORLDS(24), 1);
  assert_true(sums.marked < 1.35 * sums.hit);
}

/* Triangles of less than a pixel, in more and in fewer boxes than there are pixels. */
static void test_small(void **state) {
  (void)state;
  check_debris(keep, 0, 3.0, 30.0, 1000, 1e-4, 0.05, WORLDS(12), 2);
  check_debris(keep, 0, 3.0, 30.0, 40000, 1e-4, 0.02, PL_DRAWS(3, 1), 3);
}

static void test_slivers(void **state) {
  (void)state;
  check_debris(keep, 0, 2.5, 6.0, 40, 1e-5, 3.0, WORLDS(24), 4);
}

/* The camera is among the triangles. */
static void test_around_the_camera(void **state) {
  (void)state;
  check_debris(keep, 0, 0.0, 1.5, 60, 0.001, 0.3, WORLDS(24), 5);
}

static void test_cameras(void **state) {
  (void)state;
  check_debris(skew, 0, 2.5, 8.0, 60, 0.001, 1.0, WORLDS(16), 6);
  check_debris(bend, 0, 1.0, 8.0, 200, 0.001, 0.5, WORLDS(16), 7);
  check_debris(open_wide, 0, 2.5, 12.0, 200, 0.001, 0.5, WORLDS(16), 8);
}

/* From so far that a pixel is but few roundings of single precision wide. Not of slivers, beyond
 * whose tips rays then find what is not there. */
static void test_far_away(void **state) {
  (void)state;
  test_random random = {.seed = 9};
  sums sums = {0};
  for (int i = 0; i < WORLDS(12); i++) {
    world w;
    const double off = random_scale(&random, 1e3, 1e6);
    pl_model *model = cube_create(0.6);
    world_init(&w, 30.0 * off);
    stage_add_object(&w.stage, model, (pl_vec3){random_range(&random, -1, 1), 0, off},
                     random_rotation(&random), 1.0);
    world_set(&w, 5);
    check_world(&w, &random, &sums);
    world_clear(&w);
    pl_model_destroy(model);
  }
  assert_true(sums.hit > 0);
}

static pl_affine random_motion(test_random *random) {
  pl_affine out = {pl_mat3_from_quat(random_rotation(random)),
                   {random_range(random, -2, 2), random_range(random, -2, 2), 0}};
  for (int i = 0; i < 3; i++)
    out.m.row[i] = pl_vec3_scale(out.m.row[i], random_range(random, 0.3, 1.5));
  if (random_below(random, 2) == 0)
    out.m.row[0] = pl_vec3_scale(out.m.row[0], -1.0);
  return out;
}

/* Pieces that move, are stretched and mirrored. */
static void test_pieces(void **state) {
  (void)state;
  static const cube_node nodes[3] = {{-1, {{0, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}}, false},
                                     {0, {{2.5, 0, 0}, {1, 0, 0, 0}, {1, 0.5, 0.1}}, false},
                                     {1, {{2.5, 0.5, 0}, {1, 0, 0, 0}, {1, 1, -0.5}}, false}};
  static const int moving[2] = {1, 2};
  test_random random = {.seed = 10};
  sums sums = {0};
  pl_model *model = jointed_create(nodes, 3, 1);
  for (int i = 0; i < WORLDS(16); i++) {
    world w;
    const pl_affine motions[2] = {random_motion(&random), random_motion(&random)};
    world_init(&w, 90.0);
    stage_add_object(&w.stage, model, (pl_vec3){0, 0, 25}, random_rotation(&random), 1.0);
    assert_int_equal(pl_scene_articulate(&w.stage.scene, 0, moving, 2), PL_OK);
    w.stage.objects[0].movers = motions;
    world_set(&w, 5);
    check_world(&w, &random, &sums);
    world_clear(&w);
  }
  pl_model_destroy(model);
  print_message("%d of %d pixels marked, %d hit\n", sums.marked, sums.all, sums.hit);
  assert_true(sums.hit > 0 && sums.marked < 1.5 * sums.hit);
}

/* The marks of all rows, as one thread makes them, and of `threads` that make some rows alone. */
static void check_rows(world *w, int row0, int row1, int threads) {
  unsigned char alone[PIXELS];
  for (int i = 0; i < PIXELS; i++)
    alone[i] = pl_coverage_pixel(&w->coverage, i % WIDTH, i / WIDTH);
  memset((void *)w->coverage.pixels, 2, PIXELS); /* of another frame */
  assert_int_equal(pl_coverage_update(&w->coverage, &w->shot, row0, row1, 5, threads), PL_OK);
  const unsigned char *pixels = (const unsigned char *)w->coverage.pixels;
  for (int i = 0; i < PIXELS; i++)
    if (i / WIDTH < row0 || i / WIDTH >= row1)
      assert_int_equal(pixels[i], 2);
    else if (row1 - row0 == HEIGHT)
      assert_int_equal(pixels[i], alone[i]);
}

/* Several threads mark the same pixels. */
static void test_threads(void **state) {
  (void)state;
  change_fn *const cameras[] = {keep, bend, open_wide};
  test_random random = {.seed = 11};
  pl_model *model = debris_create(&random, 20000, 0.001, 0.1);
  for (int k = 0; k < 3; k++) {
    world w;
    world_init(&w, 90.0);
    cameras[k](&w.stage.placement.camera, &random);
    for (int i = 0; i < 3; i++)
      stage_add_object(&w.stage, model, (pl_vec3){i - 1, 0, 4}, random_rotation(&random), 0.7);
    for (int threads = 2; threads <= 5; threads++) {
      world_set(&w, 5);
      check_rows(&w, 0, HEIGHT, threads);
    }
    world_clear(&w);
  }
  pl_model_destroy(model);
}

/* Bands of rows: a ray that meets a mesh leaves by a marked pixel, and others are left alone. */
static void test_rows(void **state) {
  (void)state;
  test_random random = {.seed = 12};
  int hits = 0;
  pl_model *model = debris_create(&random, 300, 0.01, 0.5);
  world w;
  world_init(&w, 90.0);
  stage_add_object(&w.stage, model, (pl_vec3){0, 0, 4}, random_rotation(&random), 1.0);
  world_set(&w, 5);
  for (int row0 = 0, row1; row0 < HEIGHT; row0 = row1) {
    row1 = row0 + 1 + random_below(&random, HEIGHT / 4);
    row1 = row1 < HEIGHT ? row1 : HEIGHT;
    check_rows(&w, row0, row1, 1 + random_below(&random, 3));
    for (int i = 0; i < WIDTH * (row1 - row0); i++) {
      const int x = i % WIDTH, y = row0 + i / WIDTH;
      const bool hit = meets(&w, &random, x, y);
      assert_true(!hit || pl_coverage_pixel(&w.coverage, x, y));
      hits += hit;
    }
  }
  assert_true(hits > 100);
  world_clear(&w);
  pl_model_destroy(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      serial_unit_test(test_large),   serial_unit_test(test_small),
      serial_unit_test(test_slivers), serial_unit_test(test_around_the_camera),
      serial_unit_test(test_cameras), serial_unit_test(test_far_away),
      serial_unit_test(test_pieces),  cmocka_unit_test(test_threads),
      cmocka_unit_test(test_rows),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
