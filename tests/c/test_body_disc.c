/* The disc of a body as directions to draw from: against rays that meet the body, and cones. */
#include "harness.h"

#include <stdio.h>

#include "airs.h"
#include "geom/ellipsoid.h"
#include "light/body_disc.h"
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

/* Whether a ray meets the body. */
static bool meets(const world *w, pl_vec3f direction) {
  const pl_vec3 v = pl_mat3_mul_vec(w->body.to_unit, pl_vec3f_to_double(direction));
  const pl_vec3 at = pl_vec3_add(w->body.camera_unit, pl_mat3_mul_vec(w->body.to_unit, w->point));
  double t;
  return pl_unit_sphere_intersect(at, v, 0.0, &t);
}

/* Light that differs by orders of magnitude, and is nowhere in a part of the cells. */
static void random_table(test_random *random, const pl_body_disc *disc, pl_disc_table *out) {
  float light[PL_DISC_TURNS][PL_DISC_RINGS];
  for (int k = 0; k < PL_DISC_TURNS; k++)
    for (int j = 0; j < PL_DISC_RINGS; j++)
      light[k][j] = random_unit(random) < 0.5 ? 0.0f : (float)random_scale(random, 1e-3, 1e3);
  light[0][0] = 1.0f;
  pl_disc_rings(disc, out);
  pl_disc_table_fill(light, out);
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

static void random_disc(test_random *random, world *w, pl_body_disc *disc, pl_disc_table *table) {
  random_world(random, w);
  assert_true(pl_body_disc_make(&w->body, w->sun, w->point, disc));
  random_table(random, disc, table);
}

/* What is drawn is on the body, with the density that is said again for the direction; what is
 * beside it has none. Near outlines and between cells rounding decides. */
static void test_draws_are_on_the_disc(void **state) {
  (void)state;
  enum { WORLDS = 400, DRAWS = 64 };
  test_random random = {.seed = 11};
  print_message("seed %d\n", (int)random.seed);
  int off = 0, beside = 0, again = 0;
  for (int i = 0; i < WORLDS; i++) {
    world w;
    pl_body_disc disc;
    pl_disc_table table;
    random_disc(&random, &w, &disc, &table);
    for (int k = 0; k < DRAWS; k++) {
      float u[2], pdf;
      pl_sample_2d((uint32_t)k, (uint32_t)i, 0, u);
      const pl_vec3f drawn = pl_disc_sample(&disc, &table, u, &pdf);
      assert_true(pdf > 0.0f && isfinite(pdf));
      off += !meets(&w, drawn);
      again += fabsf(pl_disc_pdf(&disc, &table, drawn) - pdf) > 2e-3f * pdf;
      /* Any direction near the body's. */
      const pl_vec3 to = pl_vec3_sub(w.body.center, w.point);
      const pl_vec3f any = pl_vec3_to_float(pl_vec3_unit(pl_vec3_madd(
          to, 1.2 * w.body.radius_m * random_unit(&random), random_direction(&random))));
      const bool has = pl_disc_pdf(&disc, &table, any) > 0.0f;
      off += has != meets(&w, any);
      beside += !has;
    }
  }
  print_message("%d off, %d said otherwise again, %d beside\n", off, again, beside);
  assert_true(off < WORLDS * DRAWS / 2000 && again < WORLDS * DRAWS / 200 && beside > 300);
}

/* The density is 1 over all directions: by directions that are even over a cone about the body. And
 * the mean of one over it is the disc's solid angle, as by counting. */
static void test_density_is_one_in_all(void **state) {
  (void)state;
  enum { WORLDS = 40, COUNTED = 1 << 14 };
  test_random random = {.seed = 12};
  print_message("seed %d\n", (int)random.seed);
  for (int i = 0; i < WORLDS; i++) {
    world w;
    pl_body_disc disc;
    pl_disc_table table;
    random_disc(&random, &w, &disc, &table);
    const pl_vec3 to = pl_vec3_sub(w.body.center, w.point);
    const double sine = fmin(w.body.radius_m / pl_vec3_norm(to), 1.0);
    const float wide = (float)(1.0 - sqrt(1.0 - sine * sine));
    const pl_basis basis = pl_basis_make(pl_vec3_to_float(pl_vec3_unit(to)));
    double density = 0.0, square = 0.0, met = 0.0, angle = 0.0;
    for (uint32_t k = 0; k < COUNTED; k++) {
      float u[2], pdf;
      pl_sample_2d(k, 7, (uint32_t)i, u);
      const pl_vec3f v = pl_basis_to_world(&basis, pl_sample_cone(u[0], u[1], wide));
      const double here = 2.0 * PL_PI * (double)wide * (double)pl_disc_pdf(&disc, &table, v);
      density += here / COUNTED;
      square += here * here / COUNTED;
      met += (double)meets(&w, v) / COUNTED;
      pl_disc_sample(&disc, &table, u, &pdf);
      angle += 1.0 / (double)pdf / COUNTED;
    }
    const double error = 4.0 * sqrt(fmax(square - density * density, 0.0) / COUNTED) + 0.005;
    if (!(fabs(density - 1.0) < error))
      fail_msg("world %d: density %g in all, within %g", i, density, error);
    if (!(fabs(angle / (2.0 * PL_PI * (double)wide) - met) < 0.005 + 0.02 * met))
      fail_msg("world %d: %g of the cone, counted %g", i, angle / (2.0 * PL_PI * (double)wide),
               met);
  }
}

/* A table of even light draws evenly, and one of a half draws a twentieth or so beside it. */
static void test_draws_follow_the_light(void **state) {
  (void)state;
  enum { DRAWS = 1 << 12 };
  const pl_vec3 unit = {1.0, 1.0, 1.0}, here = {0, 0, 0};
  world w;
  pl_body_disc disc;
  pl_disc_table table;
  float light[PL_DISC_TURNS][PL_DISC_RINGS] = {{0.0f}};
  world_init(&w, unit, PL_QUAT_IDENTITY, (pl_vec3){0, 0, 3}, here, (pl_vec3){1, 0, 0});
  assert_true(pl_body_disc_make(&w.body, w.sun, here, &disc));
  pl_disc_rings(&disc, &table);
  for (int k = 0; k < PL_DISC_TURNS; k++)
    for (int j = 0; j < PL_DISC_RINGS; j++)
      light[k][j] = k < PL_DISC_TURNS / 4 || k >= 3 * PL_DISC_TURNS / 4 ? 5.0f : 0.0f;
  pl_disc_table_fill(light, &table);
  int sunward = 0;
  for (uint32_t i = 0; i < DRAWS; i++) {
    float u[2], pdf;
    pl_sample_2d(i, 5, 0, u);
    sunward += pl_disc_sample(&disc, &table, u, &pdf).x > 0.0f;
  }
  print_message("%g towards the sun\n", (double)sunward / DRAWS);
  assert_true(sunward > 0.9 * DRAWS && sunward < DRAWS);
}

/* Air shines beyond the limb: the disc of a body with air is as large as both, but from within the
 * air as the ground alone. */
static void test_air_is_part_of_it(void **state) {
  (void)state;
  const pl_vec3 ground = {6e6, 6e6, 6e6}, here = {0, 0, 0}, sun = {0.6, 0.1, -0.7};
  test_random random = {.seed = 13};
  pl_air_settings settings = random_air(&random, ground.x, 0.1, 1.0);
  settings.top_m = 6e5;
  pl_air *air = air_create(&settings, ground.x);
  for (int i = 0; i < 2; i++) {
    const double away = i == 0 ? 7e6 : 6.5e6, rim = i == 0 ? 6.6e6 : 6e6;
    world w;
    pl_body_disc disc;
    world_init(&w, ground, PL_QUAT_IDENTITY, (pl_vec3){0, 0, away}, here, sun);
    w.own.air = air;
    assert_true(pl_body_disc_make(&w.body, sun, here, &disc));
    assert_true(fabs(disc.most - (1.0 - sqrt(1.0 - rim * rim / (away * away)))) < 1e-9);
    const double limb = 1.0 - sqrt(1.0 - ground.x * ground.x / (away * away));
    assert_true(fabs(disc.ground * disc.most - limb) < 1e-9);
  }
  pl_air_destroy(air);
}

/* At the surface and inside there is no disc; a hair above it there is. */
static void test_no_disc(void **state) {
  (void)state;
  const pl_vec3 unit = {1.0, 1.0, 1.0}, here = {0, 0, 0}, sun = {0, 0, -1};
  world w;
  pl_body_disc disc;
  world_init(&w, unit, PL_QUAT_IDENTITY, (pl_vec3){0, 0, 1}, here, sun);
  assert_false(pl_body_disc_make(&w.body, w.sun, here, &disc));
  world_init(&w, unit, PL_QUAT_IDENTITY, (pl_vec3){0, 0, 0.5}, here, sun);
  assert_false(pl_body_disc_make(&w.body, w.sun, here, &disc));
  world_init(&w, unit, PL_QUAT_IDENTITY, (pl_vec3){0, 0, 1.0 + 1e-7}, here, sun);
  assert_true(pl_body_disc_make(&w.body, w.sun, here, &disc));
  assert_true(disc.most > 0.99 && disc.most < 1.0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_draws_are_on_the_disc),
      cmocka_unit_test(test_density_is_one_in_all),
      cmocka_unit_test(test_draws_follow_the_light),
      cmocka_unit_test(test_air_is_part_of_it),
      cmocka_unit_test(test_no_disc),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
