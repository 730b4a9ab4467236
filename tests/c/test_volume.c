/* Light in bounded volumes: slabs in closed form, spheres against a sum over many steps that knows
 * nothing of the code under test, densities of graphs whose columns have closed forms, and rays
 * that begin, end or pass where shapes do. */
#include "graphs.h"

#include <math.h>

#include "base/memory.h"
#include "random.h"
#include "render/volume.h"
#include "scenes.h"

enum { STEPS = 64 };

/* A volume at the origin of the root, where the camera is, on a body far away. */
typedef struct scene {
  stage s;
  pl_volume volumes[3];
  pl_arena arena;
  pl_snapshot shot;
} scene;

static pl_volume volume_of(const pl_bound *bound, double x, double y, double z, float extinction) {
  return (pl_volume){.name = "mist",
                     .bound = bound,
                     .size = {x, y, z},
                     .local = {{-1e7, 0, 0}, PL_QUAT_IDENTITY},
                     .extinction = {extinction, extinction, extinction},
                     .albedo = {1.0f, 1.0f, 1.0f}};
}

static const pl_volume_view *build(scene *c, size_t count, int steps) {
  const pl_volume_view *view;
  stage_init(&c->s, 32, 32, 32.0);
  stage_add_body(&c->s, (pl_vec3){1e7, 0, 0}, (pl_vec3){10, 10, 10}, 0.3f);
  c->s.placement.volumes = c->volumes;
  c->s.placement.volume_count = count;
  assert_int_equal(pl_placement_check(&c->s.scene, &c->s.placement), PL_OK);
  pl_arena_init(&c->arena);
  assert_int_equal(pl_snapshot_build(&c->s.scene, &c->s.placement, &c->arena, &c->shot), PL_OK);
  assert_int_equal(pl_volume_view_build(&c->shot, steps, &c->arena, &view), PL_OK);
  return view;
}

static void finish(scene *c) {
  pl_arena_clear(&c->arena);
  stage_clear(&c->s);
}

/* A sun of irradiance 2, wherever. */
static pl_vec3f even_sun(const void *context, pl_vec3 point, const pl_sun_view *sun) {
  (void)context, (void)point, (void)sun;
  return (pl_vec3f){2.0f, 2.0f, 2.0f};
}

static pl_volume_ray ray_of(pl_vec3 origin, pl_vec3 direction) {
  return (pl_volume_ray){.origin = origin,
                         .direction = pl_vec3_unit(direction),
                         .t_max = INFINITY,
                         .camera = true,
                         .sun = even_sun};
}

static void near(double found, double expected, double relative) {
  if (!(fabs(found - expected) <= relative * fabs(expected)))
    fail_msg("%.8g, not %.8g within %g", found, expected, relative);
}

static double henyey(double g, double cosine) {
  return (1.0 - g * g) / (4.0 * PL_PI * pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
}

/* A wide slab with the sun behind the viewer: of the light that comes back from a depth z,
 * exp(-2 s z) is left. Beer and Lambert; the integral is (1 - exp(-2 s h)) / 2 of albedo, phase
 * function and irradiance. */
static void test_slab(void **state) {
  (void)state;
  static const float depths[] = {0.01f, 0.5f, 3.0f, 200.0f};
  for (int i = 0; i < 4; i++) {
    scene c;
    pl_volume_stretch out[PL_VOLUMES_MAX];
    c.volumes[0] = volume_of(&pl_bound_box, 1e6, 1e6, 4.0, depths[i] / 4.0f);
    c.volumes[0].albedo[1] = 0.25f;
    c.volumes[0].g = 0.4f;
    const pl_volume_view *view = build(&c, 1, STEPS);
    const pl_volume_ray ray = ray_of((pl_vec3){0, 0, -50}, (pl_vec3){0, 0, 1});
    assert_int_equal(pl_volume_cross(view, &ray, out), 1);
    const double light = 2.0 * henyey(0.4, -1.0) * -0.5 * expm1(-2.0 * (double)depths[i]);
    if (depths[i] < 100.0f)
      near((double)out[0].transmittance.x, exp(-(double)depths[i]), 1e-5);
    near((double)out[0].radiance.x, light, 1e-3);
    near((double)out[0].radiance.y, 0.25 * light, 1e-3);
    near(out[0].start, 48.0, 1e-9);
    near(out[0].end, 52.0, 1e-9);
    finish(&c);
  }
}

/* Sum over 20000 steps through a sphere of radius 1 about the origin: chord by chord, with the
 * sphere's own equation. The sun is in the direction (0, 0, -1). */
static double brute(pl_vec3 o, pl_vec3 d, double extinction, double g) {
  enum { MANY = 20000 };
  const double b = pl_vec3_dot(o, d), h = sqrt(b * b - pl_vec3_dot(o, o) + 1.0);
  double sum = 0.0;
  for (int i = 0; i < MANY; i++) {
    const double t = 2.0 * h * (i + 0.5) / MANY;
    const pl_vec3 p = pl_vec3_madd(o, -b - h + t, d);
    const double to_sun = p.z + sqrt(fmax(0.0, p.z * p.z - pl_vec3_dot(p, p) + 1.0));
    sum += exp(-extinction * (t + to_sun));
  }
  return 2.0 * henyey(g, -d.z) * extinction * sum * 2.0 * h / MANY;
}

static void test_sphere(void **state) {
  (void)state;
  static const float depths[] = {0.1f, 2.0f, 20.0f};
  double worst = 0.0;
  for (int i = 0; i < 3; i++) {
    scene c;
    test_random random = {.seed = 5};
    c.volumes[0] = volume_of(&pl_bound_ellipsoid, 1.0, 1.0, 1.0, depths[i]);
    c.volumes[0].g = -0.3f;
    const pl_volume_view *view = build(&c, 1, STEPS);
    for (int k = 0; k < 40; k++) {
      pl_volume_stretch out[PL_VOLUMES_MAX];
      const pl_vec3 d =
          pl_vec3_unit((pl_vec3){random_range(&random, -1, 1), random_range(&random, -1, 1),
                                 random_range(&random, -1, 1)});
      const pl_vec3 side = pl_vec3_unit(pl_vec3_cross(d, (pl_vec3){0.3, 0.5, 0.8}));
      const pl_vec3 o = pl_vec3_madd(pl_vec3_scale(d, -9.0), random_range(&random, 0, 0.95), side);
      const pl_volume_ray ray = ray_of(o, d);
      assert_int_equal(pl_volume_cross(view, &ray, out), 1);
      const double exact = brute(o, d, (double)depths[i], -0.3);
      /* Against the most that comes from any such ray: of what is dark the error is not seen. */
      const double most = 2.0 * henyey(0.3, 1.0) * fmin(1.0, (double)depths[i]);
      worst = fmax(worst, fabs((double)out[0].radiance.x - exact) / most);
    }
    finish(&c);
  }
  assert_true(worst < 1e-3);
}

/* No more is scattered than is taken out of the light: albedo 1, every depth, phase and place. */
static void test_energy(void **state) {
  (void)state;
  test_random random = {.seed = 7};
  for (int i = 0; i < 60; i++) {
    scene c;
    pl_volume_stretch out[PL_VOLUMES_MAX];
    c.volumes[0] =
        volume_of(pl_bounds[i % 3], 2.0, 3.0, 1.0, (float)random_scale(&random, 1e-3, 1e3));
    c.volumes[0].g = (float)random_range(&random, -0.9, 0.9);
    const pl_volume_view *view = build(&c, 1, 1 + i % 9);
    for (int k = 0; k < 50; k++) {
      const pl_volume_ray ray =
          ray_of((pl_vec3){random_range(&random, -4, 4), random_range(&random, -4, 4), -6},
                 (pl_vec3){random_range(&random, -0.3, 0.3), random_range(&random, -0.3, 0.3), 1});
      if (pl_volume_cross(view, &ray, out) == 0)
        continue;
      const double most =
          2.0 * pl_volume_phase_max(&c.volumes[0]) * (1.0 - (double)out[0].transmittance.x);
      assert_true((double)out[0].radiance.x >= 0.0);
      assert_true((double)out[0].radiance.x <= most * (1.0 + 1e-5) + 1e-9);
    }
    finish(&c);
  }
}

/* Emission without extinction is its length; with it, it saturates at emission over extinction. */
static void test_emission(void **state) {
  (void)state;
  scene c;
  pl_volume_stretch out[PL_VOLUMES_MAX];
  c.volumes[0] = volume_of(&pl_bound_box, 10, 10, 3, 0.0f);
  c.volumes[0].emission[0] = 0.5f;
  c.volumes[0].emission[2] = 2.0f;
  c.volumes[0].extinction[2] = 40.0f;
  c.volumes[0].albedo[2] = 0.0f;
  const pl_volume_view *view = build(&c, 1, 8);
  const pl_volume_ray ray = ray_of((pl_vec3){0, 0, -9}, (pl_vec3){0, 0, 1});
  assert_int_equal(pl_volume_cross(view, &ray, out), 1);
  near((double)out[0].radiance.x, 1.5, 1e-5);
  near((double)out[0].transmittance.x, 1.0, 1e-6);
  assert_true(out[0].radiance.y == 0.0f);
  near((double)out[0].radiance.z, 0.05, 1e-4);
  finish(&c);
}

/* Rays that begin inside, end inside, point away, or have no direction. */
static void test_ends(void **state) {
  (void)state;
  scene c;
  pl_volume_stretch out[PL_VOLUMES_MAX];
  c.volumes[0] = volume_of(&pl_bound_ellipsoid, 2, 2, 2, 0.5f);
  const pl_volume_view *view = build(&c, 1, 16);
  pl_volume_ray ray = ray_of((pl_vec3){0, 0, 0}, (pl_vec3){1, 1, 0});
  assert_int_equal(pl_volume_cross(view, &ray, out), 1);
  near((double)out[0].transmittance.x, exp(-1.0), 1e-5);
  ray.t_max = 0.4;
  assert_int_equal(pl_volume_cross(view, &ray, out), 1);
  near((double)out[0].transmittance.x, exp(-0.2), 1e-5);
  near(out[0].end, 0.4, 1e-12);
  ray = ray_of((pl_vec3){0, 0, -5}, (pl_vec3){0, 0, 1});
  ray.t_max = 2.9;
  assert_int_equal(pl_volume_cross(view, &ray, out), 0);
  ray = ray_of((pl_vec3){0, 0, -5}, (pl_vec3){0, 0, -1});
  assert_int_equal(pl_volume_cross(view, &ray, out), 0);
  ray = ray_of((pl_vec3){0, 0, 0}, (pl_vec3){0, 0, 1});
  ray.direction = (pl_vec3){0, 0, 0};
  assert_int_equal(pl_volume_cross(view, &ray, out), 0);
  finish(&c);
}

/* Two halves are the whole, apart or one in the other; those with a gap are two stretches. */
static void test_several(void **state) {
  (void)state;
  scene one, two;
  pl_volume_stretch whole[PL_VOLUMES_MAX], out[PL_VOLUMES_MAX];
  one.volumes[0] = volume_of(&pl_bound_box, 1e6, 1e6, 4.0, 0.4f);
  const pl_volume_view *view = build(&one, 1, STEPS);
  const pl_volume_ray ray = ray_of((pl_vec3){0, 0, -9}, (pl_vec3){0.2, 0, 1});
  assert_int_equal(pl_volume_cross(view, &ray, whole), 1);
  finish(&one);
  for (int kind = 0; kind < 2; kind++) {
    two.volumes[0] = two.volumes[1] = kind == 0 ? volume_of(&pl_bound_box, 1e6, 1e6, 2.0, 0.4f)
                                                : volume_of(&pl_bound_box, 1e6, 1e6, 4.0, 0.2f);
    two.volumes[0].local.t.z += kind == 0 ? 1.0 : 0.0;
    two.volumes[1].local.t.z -= kind == 0 ? 1.0 : 0.0;
    view = build(&two, 2, STEPS);
    assert_int_equal(pl_volume_cross(view, &ray, out), 1);
    near((double)out[0].transmittance.x, (double)whole[0].transmittance.x, 1e-5);
    near((double)out[0].radiance.x, (double)whole[0].radiance.x, 1e-3);
    finish(&two);
  }
  two.volumes[0].local.t.z += 10.0;
  view = build(&two, 2, STEPS);
  assert_int_equal(pl_volume_cross(view, &ray, out), 2);
  assert_true(out[0].end < out[1].start);
  /* The far one has the shadow of the near one on it. */
  near((double)(out[1].radiance.x / out[0].radiance.x), exp(-0.8), 0.02);
  finish(&two);
}

/* --- densities of graphs ---------------------------------------------------------------------- */

/* alpha = (0.5 + k z) of the volume's own axes. */
static pl_graph *linear_create(float k) {
  test_graph g = {0};
  pl_graph *graph;
  const size_t where = graph_add(&g, "coordinates"), along = graph_add(&g, "vector_math");
  const size_t sum = graph_add(&g, "math"), surface = graph_add(&g, "lambert");
  graph_choose(&g, along, "function", "dot");
  graph_link(&g, along, "a", where, 0);
  graph_set(&g, along, "b", 0.0f, 0.0f, k);
  graph_choose(&g, sum, "function", "add");
  graph_link(&g, sum, "a", along, 1);
  graph_set(&g, sum, "b", 0.5f, 0.5f, 0.5f);
  graph_set(&g, surface, "base_color", 1.0f, 0.5f, 0.0f);
  graph_link(&g, surface, "alpha", sum, 0);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  return graph;
}

/* alpha = c / r^2 */
static pl_graph *square_law_create(float c) {
  test_graph g = {0};
  pl_graph *graph;
  const size_t where = graph_add(&g, "coordinates"), square = graph_add(&g, "vector_math");
  const size_t part = graph_add(&g, "math"), surface = graph_add(&g, "lambert");
  graph_choose(&g, square, "function", "dot");
  graph_link(&g, square, "a", where, 0);
  graph_link(&g, square, "b", where, 0);
  graph_choose(&g, part, "function", "divide");
  graph_set(&g, part, "a", c, c, c);
  graph_link(&g, part, "b", square, 1);
  graph_link(&g, surface, "alpha", part, 0);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  return graph;
}

/* The sun is towards -z: the column from z is 0.5 (z + 1) + k (z^2 - 1) / 2 over a slab of 2 m; and
 * the density along a ray is linear, so that the middle of a step is its mean. */
static void test_linear_density(void **state) {
  (void)state;
  scene c;
  pl_volume_stretch out[PL_VOLUMES_MAX];
  pl_graph *graph = linear_create(0.4f);
  c.volumes[0] = volume_of(&pl_bound_box, 8, 8, 2, 1.5f);
  c.volumes[0].graph = graph;
  const pl_volume_view *view = build(&c, 1, STEPS);
  for (int i = -9; i <= 9; i++) {
    const double z = 0.1 * i, column = 0.5 * (z + 1.0) + 0.2 * (z * z - 1.0);
    near((double)pl_volume_toward_sun(view, (pl_vec3){0.3, -1.1, z}).y, exp(-1.5 * column), 1e-3);
  }
  near((double)pl_volume_toward_sun(view, (pl_vec3){0.3, -1.1, 7.0}).x, exp(-1.5), 1e-4);
  assert_true(pl_volume_toward_sun(view, (pl_vec3){0.3, -1.1, -1.5}).x == 1.0f);
  assert_true(pl_volume_toward_sun(view, (pl_vec3){4.5, 0, 0}).x == 1.0f);
  const pl_volume_ray ray = ray_of((pl_vec3){0.1, 0.2, -9}, (pl_vec3){0, 0, 1});
  assert_int_equal(pl_volume_cross(view, &ray, out), 1);
  near((double)out[0].transmittance.x, exp(-1.5), 1e-4);
  /* As in the slab: of depth u, exp(-2 u) comes back. */
  near((double)out[0].radiance.x, 2.0 / (4.0 * PL_PI) * 0.5 * (1.0 - exp(-3.0)), 2e-3);
  near((double)out[0].radiance.y, 0.5 * (double)out[0].radiance.x, 1e-5);
  assert_true(out[0].radiance.z == 0.0f);
  finish(&c);
  pl_graph_destroy(graph);
}

/* Along a line that passes at p, c/r^2 has a column of c/p times the angle that the line spans:
 * with a core, steps are even in that angle, and few of them are enough. */
static void test_square_law(void **state) {
  (void)state;
  pl_graph *graph = square_law_create(1.0f);
  for (int i = 0; i < 3; i++) {
    scene c;
    pl_volume_stretch out[PL_VOLUMES_MAX];
    const double pass = i == 0 ? 2.0 : i == 1 ? 20.0 : 900.0;
    c.volumes[0] = volume_of(&pl_bound_ellipsoid, 1000, 1000, 1000, 0.5f);
    c.volumes[0].graph = graph;
    c.volumes[0].core_m = 0.01;
    const pl_volume_view *view = build(&c, 1, 16);
    const pl_volume_ray ray = ray_of((pl_vec3){pass, 0, -5000}, (pl_vec3){0, 0, 1});
    assert_int_equal(pl_volume_cross(view, &ray, out), 1);
    near(-log((double)out[0].transmittance.x), 0.5 * 2.0 * acos(pass / 1000.0) / pass, 2e-3);
    finish(&c);
  }
  /* Towards the sun, from (p, 0, z) on: the table's lines lie closer there, too. */
  scene c;
  c.volumes[0] = volume_of(&pl_bound_ellipsoid, 1000, 1000, 1000, 0.5f);
  c.volumes[0].graph = graph;
  c.volumes[0].core_m = 3.0;
  const pl_volume_view *view = build(&c, 1, STEPS);
  for (int i = 0; i < 8; i++) {
    const double p = i < 4 ? 2.5 : 30.0, z = i % 4 == 0 ? -20.0 : 15.0 * (i % 4 - 1);
    const double edge = sqrt(1e6 - p * p);
    const double column = (atan(edge / p) + atan(z / p)) / p;
    const pl_vec3f transmittance = pl_volume_toward_sun(view, (pl_vec3){p * 0.6, p * 0.8, z});
    near(-log((double)transmittance.x), 0.5 * column, 0.03);
  }
  finish(&c);
  pl_graph_destroy(graph);
}

/* More steps, less error, in both ways of marching. */
static void test_steps(void **state) {
  (void)state;
  for (int kind = 0; kind < 2; kind++) {
    pl_graph *graph = linear_create(0.3f);
    double last = INFINITY, value[4];
    for (int i = 0; i < 4; i++) {
      scene c;
      pl_volume_stretch out[PL_VOLUMES_MAX];
      c.volumes[0] = volume_of(&pl_bound_ellipsoid, 1, 1, 1, 3.0f);
      c.volumes[0].graph = kind == 0 ? NULL : graph;
      const pl_volume_view *view = build(&c, 1, i == 3 ? 64 : 4 << i);
      const pl_volume_ray ray = ray_of((pl_vec3){-9, 0.2, 0.3}, (pl_vec3){1, 0, -0.01});
      assert_int_equal(pl_volume_cross(view, &ray, out), 1);
      value[i] = (double)out[0].radiance.x;
      finish(&c);
    }
    for (int i = 0; i < 3; i++) {
      assert_true(fabs(value[i] - value[3]) < last);
      last = fabs(value[i] - value[3]);
    }
    assert_true(last < 0.03 * value[3]);
    pl_graph_destroy(graph);
  }
}

/* Turning and moving everything changes nothing; a volume follows the body that it is on. */
static void test_moves_with_its_parent(void **state) {
  (void)state;
  scene c;
  const pl_quat turn = pl_quat_axis_angle(pl_vec3_unit((pl_vec3){1, 2, 3}), 0.8);
  c.volumes[0] = volume_of(&pl_bound_cone, 0.5, 2, 4, 0.5f);
  c.volumes[0].local = (pl_pose){{0, 0, 30}, pl_quat_axis_angle((pl_vec3){0, 1, 0}, 0.3)};
  build(&c, 1, 4);
  c.s.bodies[0].motion = still((pl_vec3){50, 60, 70}, turn);
  assert_int_equal(pl_snapshot_build(&c.s.scene, &c.s.placement, &c.arena, &c.shot), PL_OK);
  const pl_vec3 tip = pl_vec3_add((pl_vec3){50, 60, 70}, pl_quat_rotate(turn, (pl_vec3){0, 0, 30}));
  assert_true(pl_vec3_norm(pl_vec3_sub(c.shot.volumes[0].origin, tip)) < 1e-12 * 100);
  const pl_vec3 axis = pl_quat_rotate(turn, (pl_vec3){sin(0.3), 0, cos(0.3)});
  const pl_vec3 found = pl_mat3_mul_vec(c.shot.volumes[0].rotation, (pl_vec3){0, 0, 1});
  assert_true(pl_vec3_norm(pl_vec3_sub(found, axis)) < 1e-12);
  finish(&c);
}

static void test_refusals(void **state) {
  (void)state;
  scene c;
  const pl_volume good = volume_of(&pl_bound_box, 1, 1, 1, 1.0f);
  c.volumes[0] = good;
  build(&c, 1, 4);
  pl_volume *v = &c.volumes[0];
  const struct {
    const char *says;
    pl_volume bad;
  } rows[] = {
      {"entity 7", {.parent = 7}},
      {"size", {.size = {1, 0, 1}}},
      {"size", {.size = {1, NAN, 1}}},
      {"pose", {.local = {{0, 0, 0}, {2, 0, 0, 0}}}},
      {"extinction", {.extinction = {-1, 0, 0}}},
      {"albedo", {.albedo = {0, 1.5f, 0}}},
      {"emission", {.emission = {0, 0, INFINITY}}},
      {"g must", {.g = 0.999f}},
      {"core_m", {.core_m = -1}},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    *v = good;
    if (rows[i].bad.parent != 0)
      v->parent = rows[i].bad.parent;
    if (rows[i].bad.size[0] != 0.0)
      memcpy(v->size, rows[i].bad.size, sizeof v->size);
    if (rows[i].bad.local.q.w != 0.0)
      v->local = rows[i].bad.local;
    v->extinction[0] += 2.0f * rows[i].bad.extinction[0];
    v->albedo[1] += rows[i].bad.albedo[1];
    v->emission[2] += rows[i].bad.emission[2];
    v->g = rows[i].bad.g;
    v->core_m = rows[i].bad.core_m;
    assert_int_equal(pl_placement_check(&c.s.scene, &c.s.placement), PL_E_RANGE);
    if (strstr(pl_error_text(), rows[i].says) == NULL)
      fail_msg("%zu: %s", i, pl_error_text());
  }
  c.s.placement.volume_count = PL_VOLUMES_MAX + 1;
  assert_int_equal(pl_placement_check(&c.s.scene, &c.s.placement), PL_E_RANGE);
  finish(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_slab),           cmocka_unit_test(test_sphere),
      cmocka_unit_test(test_energy),         cmocka_unit_test(test_emission),
      cmocka_unit_test(test_ends),           cmocka_unit_test(test_several),
      cmocka_unit_test(test_linear_density), cmocka_unit_test(test_square_law),
      cmocka_unit_test(test_steps),          cmocka_unit_test(test_moves_with_its_parent),
      cmocka_unit_test(test_refusals),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
