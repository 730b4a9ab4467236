/* Shapes of bodies: winding and normals, and meshes that stand for ellipsoids. */
#include "harness.h"

#include "frames.h"
#include "geom/inside.h"
#include "geom/shape.h"
#include "scene/snapshot.h"

/* A ball of `rings` rings of latitude, closed, wound outwards; to be destroyed. */
static pl_model *ball_create(int rings, double radius) {
  const int columns = 2 * rings;
  const size_t vertices = 2 + (size_t)((rings - 1) * columns);
  const size_t triangles = 2 * (size_t)((rings - 1) * columns);
  float *p = calloc(3 * vertices, sizeof *p);
  uint32_t *f = calloc(3 * triangles, sizeof *f);
  size_t t = 0;
  pl_model *model = NULL;
  assert_true(p != NULL && f != NULL);
  for (size_t v = 0; v < vertices; v++) {
    const int at = (int)v - 1, last = v == vertices - 1;
    const double lat = v == 0 ? 0.0 : last ? PL_PI : PL_PI * (1 + at / columns) / rings;
    const double lon = 2.0 * PL_PI * (at % columns) / columns;
    p[3 * v] = (float)(radius * sin(lat) * cos(lon));
    p[3 * v + 1] = (float)(radius * sin(lat) * sin(lon));
    p[3 * v + 2] = (float)(radius * cos(lat));
  }
  for (int ring = 0; ring < rings; ring++)
    for (int k = 0; k < columns; k++) {
      const uint32_t next = (uint32_t)((k + 1) % columns), below = 1 + (uint32_t)(ring * columns);
      const uint32_t above = below - (uint32_t)columns, south = (uint32_t)vertices - 1;
      const uint32_t a = ring == 0 ? 0 : above + (uint32_t)k, b = ring == 0 ? 0 : above + next;
      const uint32_t c = ring == rings - 1 ? south : below + (uint32_t)k;
      const uint32_t d = ring == rings - 1 ? south : below + next;
      const uint32_t quad[2][3] = {{a, c, d}, {a, d, b}};
      for (int half = 0; half < 2; half++)
        if (!(half == 0 && ring == rings - 1) && !(half == 1 && ring == 0))
          memcpy(f + 3 * t++, quad[half], sizeof quad[half]);
    }
  assert_int_equal(t, triangles);
  assert_int_equal(pl_shape_create("ball", p, vertices, f, triangles, &model), PL_OK);
  free(p);
  free(f);
  return model;
}

/* The solid angles of a closed surface add up to 4 pi inside and to nothing outside; in a face to
 * the half of it. A facet is within r pi^2 / (2 n^2) of the sphere. */
static void test_winding(void **state) {
  (void)state;
  test_random random = {.seed = 71};
  pl_model *ball = ball_create(24, 2.0);
  print_message("seed 71\n");
  for (int i = 0; i < 300; i++) {
    const double r = random_range(&random, 0.0, 4.0);
    const double turns = pl_shape_winding(ball, pl_vec3_scale(random_direction(&random), r));
    if (r < 1.97 || r > 2.0)
      assert_true(fabs(turns - (r < 2.0 ? 1.0 : 0.0)) < 1e-9);
  }
  pl_model_destroy(ball);
  pl_model *cube = cube_create(1.0);
  assert_true(fabs(pl_shape_winding(cube, (pl_vec3){0.3, -0.2, 0.0})) > 0.999);
  assert_true(fabs(fabs(pl_shape_winding(cube, (pl_vec3){0.3, -0.2, 1.0})) - 0.5) < 1e-9);
  assert_true(fabs(pl_shape_winding(cube, (pl_vec3){0.3, -0.2, 1e9})) < 1e-9);
  pl_model_destroy(cube);
}

/* A ball with hills of two fifths of its radius, maybe turned inside out, and maybe with the same
 * ball again, shifted into it; to be destroyed. */
static pl_model *hills_create(test_random *random, int rings, bool inverted, bool twice) {
  pl_model *ball = ball_create(rings, 1.0), *out = NULL;
  const size_t n = ball->vertex_count, faces = 3 * ball->triangle_count, times = twice ? 2 : 1;
  float *p = malloc(3 * n * times * sizeof *p);
  uint32_t *f = malloc(faces * times * sizeof *f);
  const double k[3] = {random_range(random, 1, 6), random_range(random, 1, 6),
                       random_range(random, 1, 6)};
  assert_true(p != NULL && f != NULL);
  for (size_t v = 0; v < n * times; v++) {
    const float *q = ball->positions + 3 * (v % n);
    const double hill = 1.0 + 0.4 * sin(k[0] * q[0]) * sin(k[1] * q[1] + k[2] * q[2]);
    for (size_t i = 0; i < 3; i++)
      p[3 * v + i] = (float)(hill * q[i]) + (v < n ? 0.0f : 0.5f);
  }
  for (size_t i = 0; i < faces * times; i++) {
    const size_t corner = i % 3 == 0 || !inverted ? i : i - i % 3 + 3 - i % 3;
    f[i] = ball->indices[corner % faces] + (uint32_t)(i < faces ? 0 : n);
  }
  const pl_status made = pl_shape_create("hills", p, n * times, f, faces / 3 * times, &out);
  assert_int_equal(made, PL_OK);
  pl_model_destroy(ball);
  free(p);
  free(f);
  return out;
}

/* Compares with the sum of all solid angles at random points, and at some above, below and beside
 * corners, where rays along the axes meet edges. Near the surface rounding may put both on
 * different sides of one half. */
static void compare_inside(const pl_model *model, test_random *random, size_t *inside) {
  pl_cover cover;
  assert_int_equal(pl_cover_init(model, &cover), PL_OK);
  for (int i = 0; i < 60; i++) {
    pl_vec3 point = pl_vec3_scale(random_direction(random), random_range(random, 0.0, 1.5));
    if (i % 3 == 0) {
      const float *v = model->positions + 3 * ((size_t)i * 7 % model->vertex_count);
      point = pl_vec3_add(pl_vec3_scale((pl_vec3){v[0], v[1], v[2]}, model->unit), model->origin);
      point.x *= i % 2 == 0 ? 0.5 : 1.0;
      point.z += i % 2 == 0 ? 0.0 : random_range(random, -1.0, 1.0);
    }
    const double winding = fabs(pl_shape_winding(model, point));
    if (fabs(winding - 0.5) > 1e-9) {
      assert_int_equal(pl_cover_inside(&cover, point).inside, winding >= 0.5);
      *inside += winding >= 0.5;
    }
  }
  pl_cover_clear(&cover);
}

static void test_inside(void **state) {
  (void)state;
  test_random random = {.seed = 1717};
  size_t inside = 0;
  print_message("seed 1717\n");
  for (int i = 0; i < 40; i++) {
    pl_model *hills = hills_create(&random, 4 + i, i % 2 == 1, i % 4 > 1);
    compare_inside(hills, &random, &inside);
    pl_model_destroy(hills);
  }
  pl_model *cube = cube_create(1.0);
  compare_inside(cube, &random, &inside);
  pl_model_destroy(cube);
  assert_true(inside > 600 && inside < 1900);
}

/* A hundred times the triangles, ten times as many in the boxes along a ray at most. In a corner no
 * ray decides, and all triangles do. */
static void test_inside_looks_at_few(void **state) {
  (void)state;
  size_t seen[2];
  for (int i = 0; i < 2; i++) {
    pl_model *ball = ball_create(i == 0 ? 16 : 160, 2.0);
    pl_cover cover;
    assert_int_equal(pl_cover_init(ball, &cover), PL_OK);
    const pl_inside found = pl_cover_inside(&cover, (pl_vec3){0.3, 0.4, 0.5});
    const pl_inside corner = pl_cover_inside(&cover, (pl_vec3){0.0, 0.0, 2.0});
    assert_true(found.inside && found.triangles > 0);
    assert_true(corner.triangles > ball->triangle_count);
    print_message("%zu of %zu triangles\n", found.triangles, ball->triangle_count);
    seen[i] = found.triangles;
    pl_cover_clear(&cover);
    pl_model_destroy(ball);
  }
  assert_true(seen[1] <= 10 * seen[0]);
}

/* A corner of a cube sees its faces alike, however they are cut in two. */
static void test_normals_do_not_depend_on_the_cut(void **state) {
  (void)state;
  float p[24];
  pl_model *model = NULL;
  for (int v = 0; v < 8; v++)
    for (int k = 0; k < 3; k++)
      p[3 * v + k] = (v >> k) & 1 ? 1.0f : -1.0f;
  const uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  uint32_t f[36];
  for (int i = 0; i < 6; i++) {
    const uint32_t *q = quads[i];
    const uint32_t cuts[2][6] = {{q[0], q[1], q[2], q[0], q[2], q[3]},
                                 {q[0], q[1], q[3], q[1], q[2], q[3]}};
    memcpy(f + 6 * i, cuts[i % 2], sizeof cuts[0]);
  }
  assert_int_equal(pl_shape_create("cube", p, 8, f, 12, &model), PL_OK);
  for (int i = 0; i < 24; i++)
    assert_true(fabsf(model->normals[i] - p[i] / sqrtf(3.0f)) < 1e-6f);
  assert_true(model->bounds_min[0] == -1.0f && model->bounds_max[2] == 1.0f);
  pl_model_destroy(model);
}

static void test_refuses(void **state) {
  (void)state;
  const float good[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, bad[9] = {0, 0, 0, 1, 0, 0, NAN, 1, 0};
  const uint32_t f[3] = {0, 1, 2}, far[3] = {0, 1, 3};
  pl_model *model = NULL;
  assert_int_equal(pl_shape_create("rock", good, 3, f, 0, &model), PL_E_RANGE);
  assert_int_equal(pl_shape_create("rock", good, 3, far, 1, &model), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "rock"));
  assert_int_equal(pl_shape_create("rock", bad, 3, f, 1, &model), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "vertex 2"));
  assert_null(model);
}

typedef struct failing {
  int left;
} failing;

static void *fail_after(void *context, size_t size) {
  failing *f = context;
  return f->left-- > 0 ? malloc(size) : NULL;
}

static void add_shape(stage *s, const pl_model *shape, pl_vec3 position, double radius_m,
                      float albedo, pl_status expected) {
  const size_t index = s->scene.body_count;
  const int32_t id = stage_next_id(s);
  const pl_body body = {.name = (char *)(uintptr_t) "rock",
                        .shape = shape,
                        .reflectance = &pl_reflectance_lambert,
                        .instance_id = id,
                        .part_id = id,
                        .class_ids = {(uint16_t)(100 + id), (uint16_t)(200 + id)}};
  assert_int_equal(pl_scene_add_body(&s->scene, &body), expected);
  s->bodies[index] = (pl_body_state){.motion = still(position, PL_QUAT_IDENTITY),
                                     .radii_m = {radius_m, radius_m, radius_m},
                                     .albedo = {albedo, albedo, albedo}};
}

/* Each allocation fails once: the error is told, nothing leaks (sanitizers) and the scene stays as
 * it was. */
static void test_memory(void **state) {
  (void)state;
  const float p[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const uint32_t f[3] = {0, 1, 2};
  pl_model *ball = ball_create(4, 1.0);
  bool whole = false;
  for (int n = 0; !whole; n++) {
    failing hook = {.left = n};
    pl_model *model = NULL;
    pl_memory_hook(fail_after, &hook);
    const pl_status status = pl_shape_create("rock", p, 3, f, 1, &model);
    pl_memory_hook(NULL, NULL);
    whole = status == PL_OK;
    assert_true(whole || (status == PL_E_MEMORY && model == NULL));
    pl_model_destroy(model);
  }
  whole = false;
  for (int n = 0; !whole; n++) {
    failing hook = {.left = n};
    stage s;
    stage_init(&s, 8, 8, 8.0);
    const pl_body body = {
        .name = (char *)(uintptr_t) "rock", .shape = ball, .reflectance = &pl_reflectance_lambert};
    pl_memory_hook(fail_after, &hook);
    const pl_status status = pl_scene_add_body(&s.scene, &body);
    pl_memory_hook(NULL, NULL);
    whole = status == PL_OK;
    assert_true(whole || (status == PL_E_MEMORY && s.scene.body_count == 0));
    stage_clear(&s);
  }
  pl_model_destroy(ball);
}

/* Objects keep the places that they are given, before the shapes, in whatever order things come. */
static void test_objects_come_first(void **state) {
  (void)state;
  stage s;
  pl_snapshot shot;
  pl_arena arena;
  pl_model *ball = ball_create(8, 2.0), *cube = cube_create(0.5);
  stage_init(&s, 16, 16, 16.0);
  pl_arena_init(&arena);
  assert_int_equal(stage_add_object(&s, cube, (pl_vec3){0, 0, 5}, PL_QUAT_IDENTITY, 1.0), 0);
  add_shape(&s, ball, (pl_vec3){7, 0, 20}, 2.0, 0.5f, PL_OK);
  assert_int_equal(stage_add_object(&s, cube, (pl_vec3){0, 2, 6}, PL_QUAT_IDENTITY, 1.0), 1);
  stage_add_body(&s, (pl_vec3){0, 0, 50}, (pl_vec3){9, 9, 9}, 0.5f);
  assert_int_equal(s.scene.craft_count, 2);
  assert_int_equal(s.scene.object_count, 3);
  assert_int_equal(pl_placement_check(&s.scene, &s.placement), PL_OK);
  assert_int_equal(pl_snapshot_build(&s.scene, &s.placement, &arena, &shot), PL_OK);
  assert_true(shot.objects[1].position.y == 2.0 && shot.objects[2].position.x == 7.0);
  assert_ptr_equal(shot.bodies[0].shape, &shot.objects[2]);
  assert_null(shot.bodies[1].shape);
  const pl_surface_kind kinds[3] = {PL_SURFACE_MESH, PL_SURFACE_MESH, PL_SURFACE_SHAPE};
  for (size_t i = 0; i < 3; i++) {
    assert_true(pl_surface_same(shot.objects[i].id, pl_surface_make(kinds[i], i)));
    assert_int_equal(pl_shot_slot(&shot, shot.objects[i].id), i);
    assert_ptr_equal(pl_shot_object_of(&shot, shot.objects[i].id), &shot.objects[i]);
    assert_true(pl_surface_is_mesh(shot.objects[i].id));
  }
  assert_int_equal(pl_shot_slot(&shot, pl_surface_of_body(1)), 4);
  assert_ptr_equal(pl_shot_body_of(&shot, pl_surface_of_body(1)), &shot.bodies[1]);
  assert_false(pl_surface_is_mesh(pl_surface_of_body(1)) || pl_surface_is_mesh(PL_NO_SURFACE));
  assert_true(shot.bodies[1].in_frame && !shot.bodies[0].in_frame && shot.objects[2].in_frame);
  pl_view view;
  assert_int_equal(pl_snapshot_view(&shot, &arena, &view), PL_OK);
  assert_true(!view.entities[2].is_body && view.entities[2].albedo_max == 0.5);
  assert_true(view.entities[3].albedo_max == 0.0 && view.entities[3].radius_m == 0.0);
  assert_true(view.entities[4].is_body);
  stage_clear(&s);
  pl_arena_clear(&arena);
  pl_model_destroy(cube);
  pl_model_destroy(ball);
}

/* The shape says what is inside, not the ellipsoid that it stands for. */
static void test_camera_inside(void **state) {
  (void)state;
  pl_model *ball = ball_create(16, 2.0);
  const double z[4] = {1.9, 2.1, 3.9, -1.9};
  for (int i = 0; i < 4; i++) {
    stage s;
    stage_init(&s, 16, 16, 16.0);
    add_shape(&s, ball, (pl_vec3){0, 0, z[i]}, 4.0, 0.5f, PL_OK);
    const bool inside = fabs(z[i]) < 2.0;
    assert_int_equal(pl_placement_check(&s.scene, &s.placement), inside ? PL_E_RANGE : PL_OK);
    if (inside)
      assert_non_null(strstr(pl_error_text(), "inside the shape of body 'rock'"));
    stage_clear(&s);
  }
  pl_model_destroy(ball);
}

enum { SIDE = 48 };

static void shoot(stage *s, film *f) {
  pl_renderer *renderer;
  pl_frame_request request = request_all(s, f);
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  render(renderer, &request);
  pl_renderer_destroy(renderer);
}

/* A fine ball, and a cube whose shadow falls on it, are as an ellipsoid and a cube: every label but
 * for the outline's pixels, and the light. */
static void test_as_the_ellipsoid(void **state) {
  (void)state;
  pl_model *ball = ball_create(160, 30.0), *cube = cube_create(4.0);
  stage s[2];
  film f[2];
  for (int k = 0; k < 2; k++) {
    stage_init(&s[k], SIDE, SIDE, 60.0);
    s[k].placement.sun.position_m = (pl_vec3){4e10, 2e10, -1.4e11};
    if (k == 0)
      stage_add_body(&s[k], (pl_vec3){0, 0, 90}, (pl_vec3){30, 30, 30}, 0.5f);
    else
      add_shape(&s[k], ball, (pl_vec3){0, 0, 90}, 30.0, 0.5f, PL_OK);
    stage_add_object(&s[k], cube, (pl_vec3){6, 4, 45}, PL_QUAT_IDENTITY, 1.0);
    film_init(&f[k], &s[k]);
    shoot(&s[k], &f[k]);
  }
  assert_memory_equal(&f[0].objects[0], &f[1].objects[0], sizeof f[0].objects[0]);
  assert_memory_equal(f[0].masks, f[1].masks, f[0].pixels);
  const int32_t *ids[2] = {film_channel(&f[0], "instance"), film_channel(&f[1], "instance")};
  const int32_t *parts[2] = {film_channel(&f[0], "part"), film_channel(&f[1], "part")};
  const uint16_t *classes[2] = {film_channel(&f[0], "semantic"), film_channel(&f[1], "semantic")};
  const float *range[2] = {film_channel(&f[0], "range"), film_channel(&f[1], "range")};
  const float *coords[2] = {film_channel(&f[0], "object_coords"),
                            film_channel(&f[1], "object_coords")};
  const float *normal[2] = {film_channel(&f[0], "normal"), film_channel(&f[1], "normal")};
  int other = 0, dark = 0;
  double sum[2] = {0, 0};
  for (size_t i = 0; i < f[0].pixels; i++) {
    for (int k = 0; k < 2; k++)
      sum[k] += (double)f[k].radiance[3 * i];
    if (ids[0][i] != ids[1][i]) {
      other++;
      continue;
    }
    assert_int_equal(parts[0][i], parts[1][i]);
    assert_int_equal(classes[0][2 * i], classes[1][2 * i]);
    assert_int_equal(classes[0][2 * i + 1], classes[1][2 * i + 1]);
    if (ids[0][i] != 1)
      continue;
    /* The facets' sagitta over the cosine; 2 degrees of arc at the outline. */
    const float off = range[0][i] - range[1][i];
    assert_true(fabsf(off) < 1.2f);
    for (size_t k = 0; k < 3; k++) {
      assert_true(fabsf(coords[0][3 * i + k] - coords[1][3 * i + k]) < 1.2f);
      assert_true(fabsf(normal[0][3 * i + k] - normal[1][3 * i + k]) < 0.04f);
    }
    dark += f[1].radiance[3 * i] < 40.0f && f[0].radiance[3 * i] < 40.0f;
  }
  assert_true(other < 8);
  assert_true(dark > 10); /* the cube's shadow is on both */
  assert_true(fabs(sum[1] / sum[0] - 1.0) < 5e-3);
  for (int k = 0; k < 2; k++) {
    film_clear(&f[k]);
    stage_clear(&s[k]);
  }
  pl_model_destroy(cube);
  pl_model_destroy(ball);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_winding),
      cmocka_unit_test(test_inside),
      cmocka_unit_test(test_inside_looks_at_few),
      cmocka_unit_test(test_normals_do_not_depend_on_the_cut),
      cmocka_unit_test(test_refuses),
      cmocka_unit_test(test_memory),
      cmocka_unit_test(test_objects_come_first),
      cmocka_unit_test(test_camera_inside),
      cmocka_unit_test(test_as_the_ellipsoid),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
