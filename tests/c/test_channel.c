/* Every label channel on vertices whose labels are known. */
#include "harness.h"

#include <stdio.h>

#include "annotate/channel.h"
#include "frame/frame.h"
#include "scenes.h"

typedef struct fixture {
  stage stage;
  pl_model *model;
  pl_arena arena;
  pl_snapshot shot;
} fixture;

/* A cube and a body before a camera of any place and attitude. */
static void fixture_init(fixture *f, test_random *random) {
  f->model = cube_create(0.5);
  stage_init(&f->stage, 8, 6, 10.0);
  const pl_vec3 camera = pl_vec3_scale(random_direction(random), 7e8);
  const pl_quat attitude = random_rotation(random);
  f->stage.placement.camera.motion = still(camera, attitude);
  stage_add_object(&f->stage, f->model,
                   pl_vec3_add(camera, pl_quat_rotate(attitude, (pl_vec3){1, 2, 30})),
                   random_rotation(random), 3.0);
  stage_add_body(&f->stage, pl_vec3_add(camera, pl_quat_rotate(attitude, (pl_vec3){0, 0, 1e7})),
                 (pl_vec3){6e6, 6e6, 5e6}, 0.5f);
  f->stage.bodies[0].motion.open.q = f->stage.bodies[0].motion.close.q = random_rotation(random);
  pl_arena_init(&f->arena);
  assert_int_equal(pl_snapshot_build(&f->stage.scene, &f->stage.placement, &f->arena, &f->shot),
                   PL_OK);
}
static void fixture_clear(fixture *f) {
  pl_arena_clear(&f->arena);
  stage_clear(&f->stage);
  pl_model_destroy(f->model);
}

/* One pixel of one channel; `vertex` NULL: it hits nothing. */
static void write_one(const fixture *f, size_t channel, const pl_point *vertex, void *out) {
  const pl_point none = {.surface_id = PL_NO_SURFACE};
  void *images[PL_FRAME_CHANNELS_MAX] = {NULL};
  images[channel] = out;
  pl_channels_write(&f->shot, vertex != NULL ? vertex : &none, 1, 0, images);
}
static void write_pixel(const fixture *f, const char *name, const pl_point *vertex, void *out) {
  for (size_t i = 0; i < pl_channel_count; i++)
    if (strcmp(pl_channels[i].name, name) == 0) {
      write_one(f, i, vertex, out);
      return;
    }
  fail_msg("no channel '%s'", name);
}
static float value_of(const fixture *f, const char *name, const pl_point *vertex) {
  float out;
  write_pixel(f, name, vertex, &out);
  return out;
}

/* A vertex of an object or body at a point given in its own frame, metres. */
static pl_point vertex_at(const fixture *f, uint32_t entity, pl_vec3 local, pl_vec3 *root) {
  const pl_pose pose =
      entity == 0 ? f->stage.objects[0].motion.open : f->stage.bodies[entity - 1].motion.open;
  *root = pose_apply(pose, local);
  const pl_vec3 p = pl_vec3_sub(*root, f->stage.placement.camera.motion.open.t);
  pl_point vertex = {.position = p, .t = pl_vec3_norm(p), .triangle = 3};
  vertex.surface_id = entity == 0 ? f->shot.objects[0].id : pl_surface_of_body(entity - 1);
  vertex.n = pl_vec3_to_float(pl_vec3_unit(pl_vec3_scale(p, -1.0)));
  vertex.facet = pl_vec3_to_float(pl_vec3_unit((pl_vec3){-p.y, p.x, -p.z}));
  return vertex;
}

static void assert_close(double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance))
    fail_msg("%.9g, expected %.9g +- %.2g", value, expected, tolerance);
}

static void test_geometry(void **state) {
  (void)state;
  test_random random = {.seed = 61};
  print_message("seed 61\n");
  for (int i = 0; i < 50; i++) {
    fixture f;
    fixture_init(&f, &random);
    for (uint32_t entity = 0; entity < 2; entity++) {
      const double size = entity == 0 ? 1.5 : 5e6;
      const pl_vec3 local = pl_vec3_scale(random_direction(&random), size);
      pl_vec3 root;
      const pl_point vertex = vertex_at(&f, entity, local, &root);
      const pl_pose camera = f.stage.placement.camera.motion.open;
      const pl_vec3 p =
          pl_quat_rotate_inverse(camera.q, pl_vec3_sub(root, camera.t)); /* OpenCV axes */
      const double range = pl_vec3_norm(p);
      assert_close((double)value_of(&f, "depth", &vertex), p.z, 1e-6 * range);
      assert_close((double)value_of(&f, "range", &vertex), range, 1e-6 * range);
      double position[3];
      write_pixel(&f, "position", &vertex, position);
      assert_close(position[0], root.x, 1e-6);
      assert_close(position[1], root.y, 1e-6);
      assert_close(position[2], root.z, 1e-6);
      float coords[3], normal[3];
      write_pixel(&f, "object_coords", &vertex, coords);
      assert_close((double)coords[0], local.x, 1e-6 * size);
      assert_close((double)coords[1], local.y, 1e-6 * size);
      assert_close((double)coords[2], local.z, 1e-6 * size);
      write_pixel(&f, "normal", &vertex, normal); /* towards the camera */
      assert_close((double)normal[0], -p.x / range, 1e-6);
      assert_close((double)normal[1], -p.y / range, 1e-6);
      assert_close((double)normal[2], -p.z / range, 1e-6);
      const pl_vec3 facet = pl_quat_rotate_inverse(
          camera.q, pl_vec3f_to_double(vertex.facet)); /* another than the shading normal */
      write_pixel(&f, "geometric_normal", &vertex, normal);
      assert_close((double)normal[0], facet.x, 1e-6);
      assert_close((double)normal[1], facet.y, 1e-6);
      assert_close((double)normal[2], facet.z, 1e-6);
    }
    fixture_clear(&f);
  }
}

static void test_angles(void **state) {
  (void)state;
  test_random random = {.seed = 62};
  fixture f;
  fixture_init(&f, &random);
  pl_vec3 root;
  pl_point vertex = vertex_at(&f, 0, (pl_vec3){0, 0, 1.5}, &root);
  const pl_vec3 viewer = pl_vec3_unit(pl_vec3_scale(vertex.position, -1.0));
  const pl_vec3 sun = pl_vec3_unit(pl_vec3_sub(f.stage.placement.sun.position_m, root));
  for (int i = 0; i < 100; i++) {
    const pl_vec3 n = random_direction(&random);
    vertex.n = pl_vec3_to_float(n);
    assert_close((double)value_of(&f, "incidence", &vertex), acos(pl_vec3_dot(n, sun)), 1e-5);
    assert_close((double)value_of(&f, "emission", &vertex), acos(pl_vec3_dot(n, viewer)), 1e-5);
    assert_close((double)value_of(&f, "phase", &vertex), acos(pl_vec3_dot(viewer, sun)), 1e-5);
  }
  fixture_clear(&f);
}

static void test_ids(void **state) {
  (void)state;
  test_random random = {.seed = 63};
  fixture f;
  fixture_init(&f, &random);
  for (uint32_t entity = 0; entity < 2; entity++) {
    pl_vec3 root;
    const pl_point vertex = vertex_at(&f, entity, (pl_vec3){1, 0, 0}, &root);
    int32_t part, instance;
    uint16_t classes[2];
    write_pixel(&f, "part", &vertex, &part);
    write_pixel(&f, "instance", &vertex, &instance);
    write_pixel(&f, "semantic", &vertex, classes);
    assert_int_equal(part, entity + 1);
    assert_int_equal(instance, entity + 1);
    assert_int_equal(classes[0], 101 + entity);
    assert_int_equal(classes[1], 201 + entity);
  }
  fixture_clear(&f);
}

static void test_background(void **state) {
  (void)state;
  test_random random = {.seed = 64};
  fixture f;
  fixture_init(&f, &random);
  int32_t id = 9;
  uint16_t classes[2] = {9, 9};
  float normal[3] = {9, 9, 9};
  double position[3];
  write_pixel(&f, "part", NULL, &id);
  assert_int_equal(id, 0);
  id = 9;
  write_pixel(&f, "instance", NULL, &id);
  assert_int_equal(id, 0);
  write_pixel(&f, "semantic", NULL, classes);
  assert_true(classes[0] == 0 && classes[1] == 0);
  write_pixel(&f, "normal", NULL, normal);
  assert_true(normal[0] == 0 && normal[1] == 0 && normal[2] == 0);
  write_pixel(&f, "position", NULL, position);
  assert_true(isnan(position[0]) && isnan(position[2]));
  assert_true(value_of(&f, "depth", NULL) == 0.0f && value_of(&f, "range", NULL) == 0.0f);
  assert_true(isnan(value_of(&f, "incidence", NULL)) && isnan(value_of(&f, "emission", NULL)) &&
              isnan(value_of(&f, "phase", NULL)));
  fixture_clear(&f);
}

enum { WIDTH = 80, FROM = 5, COUNT = 71, BYTES_MAX = 24 };

/* Vertices on object and body, and pixels that hit nothing, in runs of 1 to 40. */
static void fill_row(const fixture *f, test_random *random, pl_point *points) {
  size_t x = 0;
  for (size_t run = 1; x < COUNT; run = run == 1 ? 40 : run / 2 + 1) {
    const uint32_t entity = (uint32_t)(random_unit(random) * 3.0);
    for (size_t i = 0; i < run && x < COUNT; i++, x++) {
      pl_vec3 root;
      const pl_vec3 local = pl_vec3_scale(random_direction(random), entity == 0 ? 1.0 : 5e6);
      points[x] = vertex_at(f, entity < 2 ? entity : 0, local, &root);
      points[x].triangle = (uint32_t)x % 12;
      points[x].n = pl_vec3_to_float(random_direction(random));
      if (entity == 2)
        points[x].surface_id = PL_NO_SURFACE;
    }
  }
}

/* A row is what its pixels are one by one, to the last bit, and no pixel beside it changes. */
static void test_rows_are_their_pixels(void **state) {
  (void)state;
  test_random random = {.seed = 65};
  print_message("seed 65\n");
  fixture f;
  fixture_init(&f, &random);
  for (size_t c = 0; c < 8 * pl_channel_count; c++) {
    const size_t channel = c % pl_channel_count;
    const size_t bytes =
        pl_channel_elements(&pl_channels[channel], 2) * pl_channels[channel].element;
    pl_point points[COUNT];
    unsigned char image[WIDTH * BYTES_MAX], pixel[BYTES_MAX];
    void *images[PL_FRAME_CHANNELS_MAX] = {NULL};
    assert_true(bytes <= BYTES_MAX);
    fill_row(&f, &random, points);
    memset(image, 0xa5, sizeof image);
    images[channel] = image;
    pl_channels_write(&f.shot, points, COUNT, FROM, images);
    for (size_t x = 0; x < WIDTH; x++) {
      memset(pixel, 0xa5, sizeof pixel);
      if (x >= FROM && x < FROM + COUNT)
        write_one(&f, channel, &points[x - FROM], pixel);
      assert_memory_equal(image + x * bytes, pixel, bytes);
    }
  }
  fixture_clear(&f);
}

/* Pixels that hit nothing, as tiles that are empty write them. */
static void test_blanks(void **state) {
  (void)state;
  test_random random = {.seed = 66};
  fixture f;
  fixture_init(&f, &random);
  for (size_t c = 0; c < pl_channel_count; c++) {
    const size_t bytes = pl_channel_elements(&pl_channels[c], 2) * pl_channels[c].element;
    unsigned char image[WIDTH * BYTES_MAX], pixel[BYTES_MAX];
    void *images[PL_FRAME_CHANNELS_MAX] = {NULL};
    memset(image, 0xa5, sizeof image);
    images[c] = image;
    pl_channels_blank(&f.shot, COUNT, FROM, images);
    for (size_t x = 0; x < WIDTH; x++) {
      memset(pixel, 0xa5, sizeof pixel);
      if (x >= FROM && x < FROM + COUNT)
        write_one(&f, c, NULL, pixel);
      assert_memory_equal(image + x * bytes, pixel, bytes);
    }
  }
  fixture_clear(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_geometry),
      cmocka_unit_test(test_angles),
      cmocka_unit_test(test_ids),
      cmocka_unit_test(test_background),
      cmocka_unit_test(test_rows_are_their_pixels),
      cmocka_unit_test(test_blanks),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
