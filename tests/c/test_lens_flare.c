/* Ghosts: where they are, the light they hold, and which sources have them. */
#include "harness.h"

#include "sensor/stages.h"
#include "sensors.h"

enum { W = 121, H = 81 };

static pl_sensor flared(double scale, double radius_rad) {
  pl_sensor sensor = sensor_plain();
  sensor.flare = (pl_flare){
      .count = 1, .ghosts = {{scale, radius_rad, {1e-3, 2e-3, 0.0}}}, .baffle_rad = {0.2, 0.4}};
  return sensor;
}

/* Energy and centroid of what a stage added in red. */
static void moments(const sensor_shot *shot, size_t source, double *sum, double middle[2]) {
  *sum = middle[0] = middle[1] = 0.0;
  for (size_t i = 0; i < shot->pixels; i++) {
    const double light = i == source ? 0.0 : (double)shot->frame.bands[i].x;
    *sum += light;
    middle[0] += light * (double)(i % W);
    middle[1] += light * (double)(i / W);
  }
  middle[0] /= *sum;
  middle[1] /= *sum;
}

/* The stated part of the source's light, about the place that the scale gives; even within the
 * disc: light over its area, pi r^2. */
static void ghosts_hold_their_light(void **state) {
  (void)state;
  const double radii[] = {0.0002, 0.003, 0.0077, 0.02};
  const double scales[] = {-0.8, -0.31, 0.25, 0.9};
  for (int k = 0; k < 16; k++) {
    const double radius = radii[k % 4], scale = scales[k / 4], r = fmax(0.5, 1000.0 * tan(radius));
    const pl_sensor sensor = flared(scale, radius);
    assert_int_equal(pl_sensor_check(&sensor), PL_OK);
    sensor_shot shot;
    sensor_shot_init(&shot, &sensor, W, H);
    const size_t source = 40 * W + 97, opposite = 52 * W + 33; /* the axis is at (60, 40) */
    const size_t at = k % 2 ? source : opposite;
    const float light = 1e6f;
    shot.frame.bands[at].x = light;
    assert_int_equal(pl_stage_lens_flare(&shot.frame, 1), PL_OK);
    double sum, middle[2];
    /* its own pixel may lie in the disc: counted without what was there */
    shot.frame.bands[at].x -= light;
    moments(&shot, shot.pixels, &sum, middle);
    const double x = 60.0 + scale * ((double)(at % W) - 60.0),
                 y = 40.0 + scale * ((double)(at / W) - 40.0);
    assert_true(fabs(sum / (1e-3 * 1e6) - 1.0) <
                4e-3); /* 1e6 + 0.1 in floats; cos^4 of 2 degrees */
    assert_true(hypot(middle[0] - x, middle[1] - y) < (r < 1.0 ? 0.71 : 0.05)); /* of pixels */
    const double most = 1e3 / (3.14159265358979 * r * r);
    for (size_t i = 0; i < shot.pixels; i++) {
      const double d = hypot((double)(i % W) - x, (double)(i / W) - y);
      const double got = (double)shot.frame.bands[i].x;
      assert_true(got <= most * 1.001 + 0.07);
      assert_true(d < r + 1.5 || got == 0.0);
      assert_true(d > r - 1.5 || i == at || fabs(got / most - 1.0) < 4e-3);
    }
    sensor_shot_clear(&shot);
  }
}

/* Clipped by the image's border: the part of the disc that is inside keeps its brightness. */
static void ghosts_may_be_cut_off(void **state) {
  (void)state;
  const pl_sensor sensor = flared(-1.0, 0.02);
  sensor_shot shot;
  sensor_shot_init(&shot, &sensor, W, H);
  shot.frame.sun = (pl_flare_sun){true, {120.0 + 0.5, 40.0}, 4.0, 1e6}; /* ghost about x = -0.5 */
  assert_int_equal(pl_stage_lens_flare(&shot.frame, 1), PL_OK);
  double sum, middle[2];
  moments(&shot, shot.pixels, &sum, middle);
  assert_true(fabs(sum / 500.0 - 1.0) < 1e-5);
  sensor_shot_clear(&shot);
}

/* Below white, under the sun's disc, and light that is none, make no ghosts; infinite light makes
 * finite ones. */
static void only_what_is_over_bright(void **state) {
  (void)state;
  const pl_sensor sensor = flared(-1.0, 0.002);
  const float white =
      (float)(pl_sensor_white_electrons(&sensor) / pl_sensor_response_white(&sensor));
  const float lights[] = {0.99f * white, NAN, -3.0f, 1.01f * white, INFINITY, 1.01f * white};
  for (int k = 0; k < 6; k++) {
    sensor_shot shot;
    sensor_shot_init(&shot, &sensor, W, H);
    const size_t source = 20 * W + 30, ghost = 60 * W + 90;
    shot.frame.bands[source].x = lights[k];
    if (k == 5)
      shot.frame.sun = (pl_flare_sun){true, {31.0, 20.0}, 2.0, 0.0};
    assert_int_equal(pl_stage_lens_flare(&shot.frame, 1), PL_OK);
    const float got = shot.frame.bands[ghost].x;
    assert_int_equal(got > 0.0f, k == 3 || k == 4);
    assert_true(isfinite(got));
    sensor_shot_clear(&shot);
  }
}

static void baffles_keep_the_sun_out(void **state) {
  (void)state;
  const pl_flare flare = flared(1.0, 0.01).flare;
  assert_true(pl_flare_baffle(&flare, 0.0) == 1.0 && pl_flare_baffle(&flare, 0.2) == 1.0);
  assert_true(fabs(pl_flare_baffle(&flare, 0.25) - 0.75) < 1e-12);
  assert_true(pl_flare_baffle(&flare, 0.4) == 0.0 && pl_flare_baffle(&flare, 3.0) == 0.0);
  pl_sensor bad = flared(1.0, 0.01);
  bad.flare.baffle_rad[1] = 0.1;
  assert_int_equal(pl_sensor_check(&bad), PL_E_RANGE);
  bad = flared(2.1, 0.01);
  assert_int_equal(pl_sensor_check(&bad), PL_E_RANGE);
  bad = flared(1.0, (double)NAN);
  assert_int_equal(pl_sensor_check(&bad), PL_E_RANGE);
}

/* Many sources, any threads: the same bits. */
static void threads_do_not_matter(void **state) {
  (void)state;
  pl_sensor sensor = flared(-0.7, 0.01);
  sensor.flare.count = 2;
  sensor.flare.ghosts[1] = (pl_ghost){1.3, 0.03, {1e-2, 1e-3, 1e-3}};
  sensor_shot shots[2];
  for (int k = 0; k < 2; k++) {
    sensor_shot_init(&shots[k], &sensor, W, H);
    sensor_shot_fill(&shots[k], 100.0f * sensor_radiance(&sensor, 30000.0));
    shots[k].frame.threads = 1 + 2 * k;
    assert_int_equal(pl_stage_lens_flare(&shots[k].frame, 1), PL_OK);
  }
  assert_memory_equal(shots[0].frame.bands, shots[1].frame.bands, W * H * sizeof(pl_vec3f));
  sensor_shot_clear(&shots[0]);
  sensor_shot_clear(&shots[1]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      serial_unit_test(ghosts_hold_their_light),  serial_unit_test(ghosts_may_be_cut_off),
      serial_unit_test(only_what_is_over_bright), serial_unit_test(baffles_keep_the_sun_out),
      cmocka_unit_test(threads_do_not_matter),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
