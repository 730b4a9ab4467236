/* The sunlit part of a body, as directions to draw from: against rays that meet the body. */
#include "harness.h"

#include <stdio.h>

#include "airs.h"
#include "geom/ellipsoid.h"
#include "light/lune.h"
#include "math/sampler.h"
#include "math/sampling.h"
#include "random.h"

/* A body as a snapshot has it. */
typedef struct world {
  pl_body_state state;
  pl_body own;
  pl_shot_body body;
  pl_vec3 sun, point;
} world;

static void world_init(world *w, pl_vec3 radii, pl_quat turn, pl_vec3 center, pl_vec3 point,
                       pl_vec3 sun) {
  *w = (world){.state = {.radii_m = radii}, .sun = sun, .point = point};
  pl_mat3 rotation = pl_mat3_from_quat(turn), to_unit = pl_mat3_transpose(rotation);
  const double r[3] = {radii.x, radii.y, radii.z};
  for (int k = 0; k < 3; k++)
    to_unit.row[k] = pl_vec3_scale(to_unit.row[k], 1.0 / r[k]);
  w->body = (pl_shot_body){.state = &w->state,
                           .body = &w->own,
                           .rotation = rotation,
                           .center = center,
                           .to_unit = to_unit,
                           .camera_unit = pl_mat3_mul_vec(to_unit, pl_vec3_scale(center, -1.0)),
                           .radius_m = fmax(radii.x, fmax(radii.y, radii.z))};
}

/* Cosine of the sun's height where a ray meets the body; NAN where it does not. */
static double height(const world *w, pl_vec3f direction) {
  const pl_vec3 v = pl_mat3_mul_vec(w->body.to_unit, pl_vec3f_to_double(direction));
  const pl_vec3 at = pl_vec3_add(w->body.camera_unit, pl_mat3_mul_vec(w->body.to_unit, w->point));
  double t;
  if (!pl_unit_sphere_intersect(at, v, 0.0, &t))
    return NAN;
  const pl_vec3 local = pl_mat3_mul_vec_t(
      w->body.rotation,
      pl_vec3_sub(pl_vec3_madd(w->point, t, pl_vec3f_to_double(direction)), w->body.center));
  const pl_vec3 n = pl_mat3_mul_vec(w->body.rotation, pl_ellipsoid_normal(w->state.radii_m, local));
  return pl_vec3_dot(n, pl_vec3_unit(w->sun));
}

static void random_world(test_random *random, world *w) {
  const double size = random_scale(random, 1.0, 1e7);
  const pl_vec3 radii = {size * random_range(random, 0.5, 1.0),
                         size * random_range(random, 0.5, 1.0),
                         size * random_range(random, 0.5, 1.0)};
  const double gap = size * (1.0 + random_scale(random, 1e-3, 1e2));
  const pl_vec3 center = pl_vec3_scale(random_direction(random), gap);
  world_init(w, radii, random_rotation(random), center,
             pl_vec3_scale(random_direction(random), 1e-4 * size), random_direction(random));
}

/* What is drawn is lit, with the density that is said; what is lit has a density, and what is not
 * has none. Near outlines rounding decides. */
static void test_draws_are_what_is_lit(void **state) {
  (void)state;
  enum { WORLDS = 400, DRAWS = 64 };
  test_random random = {.seed = 11};
  print_message("seed %d\n", (int)random.seed);
  int lit = 0, dark = 0, worlds = 0;
  for (int i = 0; i < WORLDS; i++) {
    world w;
    pl_lune lune;
    random_world(&random, &w);
    const bool any = pl_lune_make(&w.body, w.sun, w.point, &lune);
    worlds += any;
    for (int k = 0; k < DRAWS; k++) {
      float u[2], pdf;
      pl_vec3f direction;
      pl_sample_2d((uint32_t)k, (uint32_t)i, 0, u);
      if (any && pl_lune_sample(&lune, u, &direction, &pdf)) {
        const double h = height(&w, direction);
        assert_true(isnan(h) || h > -1e-3);
        const float again = pl_lune_pdf(&lune, direction);
        if (h > 1e-2)
          assert_true(fabsf(again - pdf) < 2e-3f * pdf);
      }
      /* Any direction near the body's. */
      const pl_vec3 to = pl_vec3_sub(w.body.center, w.point);
      direction = pl_vec3_to_float(pl_vec3_unit(pl_vec3_madd(
          to, 1.1 * w.body.radius_m * random_unit(&random), random_direction(&random))));
      const double h = height(&w, direction);
      if (h > 1e-3)
        lit += any && pl_lune_pdf(&lune, direction) > 0.0f ? 1 : 1000000;
      else if (h < -1e-3)
        dark += any && pl_lune_pdf(&lune, direction) > 0.0f ? 1000000 : 1;
    }
  }
  print_message("%d worlds with light, %d directions lit, %d dark\n", worlds, lit, dark);
  assert_true(worlds > WORLDS / 2 && lit > 3000 && lit < 1000000);
  assert_true(dark > 3000 && dark < 1000000);
}

/* Solid angle by the mean of one over the density, sr. */
static double solid_angle(const pl_lune *lune) {
  enum { DRAWS = 1 << 14 };
  double sum = 0.0;
  for (uint32_t i = 0; i < DRAWS; i++) {
    float u[2], pdf;
    pl_vec3f direction;
    pl_sample_2d(i, 5, 0, u);
    if (pl_lune_sample(lune, u, &direction, &pdf))
      sum += 1.0 / (double)pdf / DRAWS;
  }
  return sum;
}

/* Far from a sphere the lit part of its disc is (1 + cos(phase))/2 (e.g. Meeus, Astronomical
 * Algorithms, ch. 48); near it and full it is the whole cap, 2 pi (1 - cos(limb)). */
static void test_solid_angles(void **state) {
  (void)state;
  const pl_vec3 unit = {1.0, 1.0, 1.0}, here = {0, 0, 0};
  world w;
  pl_lune lune;
  for (int degrees = 0; degrees < 180; degrees += 15) {
    const double phase = degrees * PL_PI / 180.0;
    world_init(&w, unit, PL_QUAT_IDENTITY, (pl_vec3){0, 0, 1e4}, here,
               (pl_vec3){sin(phase), 0, -cos(phase)});
    assert_true(pl_lune_make(&w.body, w.sun, here, &lune));
    const double exact = PL_PI * 1e-8 * 0.5 * (1.0 + cos(phase));
    assert_true(fabs(solid_angle(&lune) / exact - 1.0) < 2e-3);
  }
  for (double height_m = 1e-6; height_m < 1e3; height_m *= 10.0) {
    const double d = 1.0 + height_m;
    world_init(&w, unit, PL_QUAT_IDENTITY, (pl_vec3){0, 0, d}, here, (pl_vec3){0, 0, -1});
    assert_true(pl_lune_make(&w.body, w.sun, here, &lune));
    const double cosine = sqrt((d - 1.0) * (d + 1.0)) / d;
    assert_true(fabs(solid_angle(&lune) / (2.0 * PL_PI * (1.0 - cosine)) - 1.0) < 2e-3);
  }
}

/* Air shines beyond the limb: a body with air is drawn to as one as large as both, but from within
 * the air as the ground alone. */
static void test_air_is_part_of_it(void **state) {
  (void)state;
  const pl_vec3 ground = {6e6, 6e6, 6e6}, both = {6.6e6, 6.6e6, 6.6e6}, here = {0, 0, 0};
  test_random random = {.seed = 13};
  pl_air_settings settings = random_air(&random, ground.x, 0.1, 1.0);
  settings.top_m = 6e5;
  pl_air *air = air_create(&settings, ground.x);
  for (int i = 0; i < 2; i++) {
    const pl_vec3 center = {0, 0, i == 0 ? 7e6 : 6.5e6}, sun = {0.6, 0.1, -0.7};
    world w, other;
    pl_lune lune, expected;
    world_init(&w, ground, PL_QUAT_IDENTITY, center, here, sun);
    world_init(&other, i == 0 ? both : ground, PL_QUAT_IDENTITY, center, here, sun);
    w.own.air = air;
    assert_true(pl_lune_make(&w.body, sun, here, &lune));
    assert_true(pl_lune_make(&other.body, sun, here, &expected));
    assert_true(fabs(solid_angle(&lune) / solid_angle(&expected) - 1.0) < 1e-5);
  }
  pl_air_destroy(air);
}

/* Of worlds at random against counting the lit among directions that are even over a cone. */
static void test_random_solid_angles(void **state) {
  (void)state;
  enum { WORLDS = 40, COUNTED = 1 << 14 };
  test_random random = {.seed = 12};
  print_message("seed %d\n", (int)random.seed);
  for (int i = 0; i < WORLDS; i++) {
    world w;
    pl_lune lune;
    random_world(&random, &w);
    if (!pl_lune_make(&w.body, w.sun, w.point, &lune))
      continue;
    const pl_vec3 to = pl_vec3_sub(w.body.center, w.point);
    const double sine = fmin(w.body.radius_m / pl_vec3_norm(to), 1.0);
    const float wide = (float)(1.0 - sqrt(1.0 - sine * sine));
    const pl_basis basis = pl_basis_make(pl_vec3_to_float(pl_vec3_unit(to)));
    int lit = 0;
    for (uint32_t k = 0; k < COUNTED; k++) {
      float u[2];
      pl_sample_2d(k, 7, (uint32_t)i, u);
      lit += height(&w, pl_basis_to_world(&basis, pl_sample_cone(u[0], u[1], wide))) > 0.0;
    }
    const double counted = (double)lit / COUNTED, cone = 2.0 * PL_PI * (double)wide;
    const double found = solid_angle(&lune) / cone;
    if (!(fabs(found - counted) < 0.003 + 0.01 * counted))
      fail_msg("world %d: %g of the cone, counted %g", i, found, counted);
  }
}

/* New from far and from near, at the surface, and inside: nothing to draw. */
static void test_nothing_lit(void **state) {
  (void)state;
  const pl_vec3 unit = {1.0, 1.0, 1.0}, here = {0, 0, 0};
  world w;
  pl_lune lune;
  world_init(&w, unit, PL_QUAT_IDENTITY, (pl_vec3){0, 0, 100}, here, (pl_vec3){0, 0, 1});
  assert_false(pl_lune_make(&w.body, w.sun, here, &lune));
  world_init(&w, unit, PL_QUAT_IDENTITY, (pl_vec3){0, 0, 1.01}, here, (pl_vec3){0.5, 0, 1});
  assert_false(pl_lune_make(&w.body, w.sun, here, &lune));
  world_init(&w, unit, PL_QUAT_IDENTITY, (pl_vec3){0, 0, 1}, here, (pl_vec3){0, 0, -1});
  assert_false(pl_lune_make(&w.body, w.sun, here, &lune));
  world_init(&w, unit, PL_QUAT_IDENTITY, (pl_vec3){0, 0, 0.5}, here, (pl_vec3){0, 0, -1});
  assert_false(pl_lune_make(&w.body, w.sun, here, &lune));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_draws_are_what_is_lit), cmocka_unit_test(test_solid_angles),
      cmocka_unit_test(test_air_is_part_of_it),     cmocka_unit_test(test_random_solid_angles),
      cmocka_unit_test(test_nothing_lit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
