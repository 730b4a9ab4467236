/* Media in frames, by the example of clouds. */
#include "harness.h"

#include "airs.h"
#include "clouds.h"
#include "frames.h"
#include "render/medium.h"

enum { SIDE = 9 };

static void test_list_is_sorted(void **state) {
  (void)state;
  pl_medium_list list = {.count = 0};
  for (int i = 0; i < 40; i++)
    pl_medium_list_add(&list, &(pl_medium_crossing){.t = (double)(7 * i % 40)});
  assert_int_equal(list.count, PL_MEDIUM_CROSSINGS);
  for (size_t i = 0; i < list.count; i++)
    assert_true(list.items[i].t == (double)i);
}

static const double AU = 149597870700.0;

/* A body of 1000 km before the camera, `far` from its centre, and the sun in direction `sun`. */
static void build(stage *s, double far, pl_vec3 sun, float albedo) {
  stage_init(s, SIDE, SIDE, 400.0);
  s->placement.sun.position_m = pl_vec3_scale(pl_vec3_unit(sun), AU);
  stage_add_body(s, (pl_vec3){0, 0, far}, (pl_vec3){1e6, 1e6, 1e6}, albedo);
}

static void shoot(const stage *s, film *f, pl_plan_wish wish) {
  pl_renderer *renderer;
  pl_frame_request request = request_all(s, f);
  request.wish = wish;
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  render(renderer, &request);
  pl_renderer_destroy(renderer);
}

/* Straight down on an overcast: the clouds' own light, and the ground's through them twice. */
static void test_overcast_ground(void **state) {
  (void)state;
  stage s;
  film f;
  build(&s, 4e6, (pl_vec3){1.0, 0.0, -1.0}, 0.4f);
  film_init(&f, &s);
  s.bodies[0].clouds = overcast(1e4, 8.0f);
  const double bent = 2.0 * 1e3 / 1.01e6; /* of the layer */
  for (int color = 0; color < 2; color++) {
    s.bodies[0].clouds.color[0] = color ? 0.5f : 1.0f;
    shoot(&s, &f, (pl_plan_wish){.tolerance_dn = 0.0});
    const double mu = sqrt(0.5), up = (double)pl_cloud_reflected(8.0f, 1.0f);
    const double down = (double)pl_cloud_reflected(8.0f, (float)sqrt(0.5 + bent));
    const double cloud = (color ? 0.5 : 1.0) * down * mu / PL_PI;
    const double ground = (1.0 - up) * (1.0 - down) * 0.4 * mu / PL_PI;
    const float found = f.radiance[3 * (SIDE * SIDE / 2)];
    assert_near((double)found / (1361.0 * (cloud + ground)), 1.0, 2e-3);
    const int32_t *instance = film_channel(&f, "instance");
    assert_int_equal(instance[SIDE * SIDE / 2], 1); /* labels see through */
  }
  film_clear(&f);
  stage_clear(&s);
}

/* From the ground up to an overcast: what comes through diffusely. */
static void test_overcast_sky(void **state) {
  (void)state;
  stage s;
  film f;
  build(&s, 4e6, (pl_vec3){0.3, 0.0, 1.0}, 0.0f);
  film_init(&f, &s);
  s.bodies[0].clouds = overcast(1e4, 8.0f);
  s.bodies[0].motion = still((pl_vec3){0.0, 0.0, -1e6 - 10.0}, PL_QUAT_IDENTITY);
  shoot(&s, &f, (pl_plan_wish){.tolerance_dn = 0.0});
  const double mu = 1.0 / sqrt(1.09);
  const double down = (double)pl_cloud_reflected(8.0f, (float)mu);
  const double light = 1361.0 * mu / PL_PI * (1.0 - down - exp(-8.0 / mu));
  assert_near((double)f.radiance[3 * (SIDE * SIDE / 2)] / light, 1.0, 3e-3);
  film_clear(&f);
  stage_clear(&s);
}

/* In a body's shadow clouds are dark, and by night. */
static void test_dark(void **state) {
  (void)state;
  static const pl_vec3 suns[] = {{0.0, 0.0, 1.0}, {1e-4, 0.0, -1.0}};
  stage s;
  film f;
  for (int k = 0; k < 2; k++) {
    build(&s, 4e6, suns[k], 0.4f);
    if (k == 1) { /* behind the camera, between body and sun */
      stage_add_body(&s, (pl_vec3){0.0, 0.0, -5e6}, (pl_vec3){2e6, 2e6, 2e6}, 0.4f);
    }
    film_init(&f, &s);
    s.bodies[0].clouds = overcast(1e4, 8.0f);
    shoot(&s, &f, (pl_plan_wish){.tolerance_dn = 0.0});
    assert_true(f.radiance[3 * (SIDE * SIDE / 2)] < 1e-3f);
    film_clear(&f);
    stage_clear(&s);
  }
}

/* Air along a ray in pieces is the air along the ray: clouds that do nothing change nothing. */
static void test_nothing(void **state) {
  (void)state;
  test_random random = {.seed = 12};
  for (int round = 0; round < 4; round++) {
    stage s;
    film with, without;
    build(&s, 1.3e6, random_direction(&random), 0.4f);
    s.placement.camera.fx = s.placement.camera.fy = 6.0;
    const pl_air_settings settings = random_air(&random, 1e6, 0.1, 1.0);
    pl_air *air = air_create(&settings, 1e6);
    s.scene.bodies[0].air = air;
    film_init(&with, &s);
    film_init(&without, &s);
    const pl_plan_wish wish = {.tolerance_dn = 0.0, .force_on = one_effect("clouds")};
    shoot(&s, &without, wish);
    s.bodies[0].clouds = overcast(3e4, 0.0f);
    s.bodies[0].clouds.color[0] = s.bodies[0].clouds.color[1] = 0.0f;
    shoot(&s, &with, wish);
    for (size_t i = 0; i < 3 * with.pixels; i++)
      assert_near((double)with.radiance[i], (double)without.radiance[i],
                  1e-4 * (double)without.radiance[i] + 1e-6);
    film_clear(&with);
    film_clear(&without);
    stage_clear(&s);
    pl_air_destroy(air);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_list_is_sorted), cmocka_unit_test(test_overcast_ground),
      cmocka_unit_test(test_overcast_sky),   cmocka_unit_test(test_dark),
      cmocka_unit_test(test_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
