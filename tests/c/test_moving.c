/* Frames that are the mean of instants. */
#include "harness.h"

#include "plan/effects.h"
#include "frames.h"
#include "sensors.h"

enum { SIDE = 64, STARS = 12 };
static const double FOCAL_PX = 100.0, LIGHT = 2e-3;

/* A body near the image's left edge that moves by `px` pixels during the exposure. */
static void add_mover(stage *s, double px) {
  const double far = 1e8;
  const size_t i =
      stage_add_body(s, (pl_vec3){-0.28 * far, 0.0, far}, (pl_vec3){2e6, 2e6, 2e6}, 0.5f);
  s->bodies[i].motion.close.t.y += px * far / FOCAL_PX;
}

static double energy_near(const film *f, const pl_camera *camera, int x, int y) {
  double energy = 0.0;
  for (int v = y - 2; v <= y + 2; v++)
    for (int u = x - 2; u <= x + 2; u++)
      energy += (double)f->radiance[3 * (v * SIDE + u) + 1] * pl_pixel_solid_angle(camera, u, v);
  return energy;
}

/* Stars that stand still have the light of a still frame, in whatever row, with few instants and a
 * shutter that rolls. */
static void test_stars_keep_their_light(void **state) {
  (void)state;
  for (int k = 0; k < 6; k++) {
    stage s;
    film f;
    pl_star stars[STARS];
    pl_star_catalogue *catalogue;
    pl_renderer *renderer;
    stage_init(&s, SIDE, SIDE, FOCAL_PX);
    add_mover(&s, 1.0 + k);
    for (int i = 0; i < STARS; i++)
      stars[i] = (pl_star){.direction = {0.1, (5 * i + 3 - 0.5 * (SIDE - 1)) / FOCAL_PX, 1.0},
                           .light = {0.5f * (float)LIGHT, (float)LIGHT, 0.25f * (float)LIGHT}};
    assert_int_equal(pl_star_catalogue_create(stars, STARS, &catalogue), PL_OK);
    const pl_sky sky = {.stars = catalogue};
    s.placement.shutter = (pl_shutter){.exposure_s = 1.0, .line_s = 0.013 * k};
    film_init(&f, &s);
    pl_frame_request request = request_all(&s, &f);
    request.sky = &sky;
    request.wish.force_on = one_effect("stars");
    assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
    const pl_frame_result result = render(renderer, &request);
    assert_true(pl_plan_value(&result.plan, &pl_effect_motion_blur) > 1);
    for (int i = 0; i < STARS; i++) {
      const double seen = energy_near(&f, &s.placement.camera, 41, 5 * i + 3);
      assert_true(fabs(seen / LIGHT - 1.0) < 1e-5);
    }
    pl_renderer_destroy(renderer);
    pl_star_catalogue_destroy(catalogue);
    film_clear(&f);
    stage_clear(&s);
  }
}

/* Most that the ghost of a sun beside the image adds to a pixel of the sensor, digital numbers;
 * with a body that is before the sun in the middle of the exposure, and nowhere near in the end. */
static int ghost_of_sun(bool hidden) {
  static uint16_t raw[2][SIDE * SIDE];
  int most = 0;
  for (int off = 0; off < 2; off++) {
    stage s;
    film f;
    pl_renderer *renderer;
    stage_init(&s, SIDE, SIDE, FOCAL_PX);
    add_mover(&s, 4.0);
    s.placement.sun.position_m = (pl_vec3){0.5 * 1.5e11, 0.0, 1.5e11};
    if (hidden) {
      const size_t i =
          stage_add_body(&s, (pl_vec3){0.5e8, 0.0, 1e8}, (pl_vec3){2e6, 2e6, 2e6}, 0.0f);
      s.bodies[i].motion.open.t.y = -2e7;
      s.bodies[i].motion.close.t.y = 2e7;
    }
    s.placement.shutter = (pl_shutter){.exposure_s = 1.0};
    pl_sensor sensor = sensor_plain();
    sensor.flare = (pl_flare){1, {{-0.5, 0.05, {1e-5, 1e-5, 1e-5}}}, {1.0, 1.2}};
    film_init(&f, &s);
    pl_frame_request request = request_all(&s, &f);
    request.sensor = &sensor;
    request.raw = raw[off];
    request.wish = (pl_plan_wish){.tolerance_dn = 0.5,
                                  .force_on = off ? no_effects() : one_effect("lens_flare"),
                                  .force_off = off ? one_effect("lens_flare") : no_effects()};
    assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
    const pl_frame_result result = render(renderer, &request);
    assert_true(pl_plan_value(&result.plan, &pl_effect_motion_blur) > 1);
    pl_renderer_destroy(renderer);
    film_clear(&f);
    stage_clear(&s);
  }
  for (int i = 0; i < SIDE * SIDE; i++)
    most = raw[0][i] - raw[1][i] > most ? raw[0][i] - raw[1][i] : most;
  return most;
}

/* What the sensor sees of the sun is that of the middle. */
static void test_sun_of_the_middle(void **state) {
  (void)state;
  const int free_sun = ghost_of_sun(false), hidden_sun = ghost_of_sun(true);
  assert_true(free_sun > 20);
  assert_int_equal(hidden_sun, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_stars_keep_their_light),
      cmocka_unit_test(test_sun_of_the_middle),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
