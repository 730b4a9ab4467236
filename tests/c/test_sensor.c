/* What follows from a sensor's numbers. */
#include "harness.h"

#include "sensor/metering.h"
#include "sensors.h"

/* Worked by hand: radiance 5.890006133944863 in a band (I/F 0.1 at 1 au, 500 to 600 nm), f/5.6, 5.5
 * um, 1 ms, quantum efficiency 0.5, transmission 0.9: pi L T / (4 N^2) = 0.13276147958683676 W/m^2,
 * times 5.5e-6^2 m^2, 1e-3 s, 0.5 and 550 nm / (h c) = 5559.726455065379 electrons. */
static void electrons_of_a_radiance(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.f_number = 5.6;
  sensor.transmission = 0.9;
  sensor.pixel_m = 5.5e-6;
  sensor.band_share[1] = 1.0;
  const double electrons = 5.890006133944863 * pl_sensor_response(&sensor, 1);
  assert_true(fabs(electrons / 5559.726455065379 - 1.0) < 1e-9);
}

/* By the sine condition E = pi L / (4 N^2); through a flat opening, the disc of angular radius
 * atan(1 / (2 N)) seen from the sensor: E = pi L sin^2 = pi L / (4 N^2 + 1), of which the sum over
 * rings of the disc, cos(a) 2 pi sin(a) da, is the definition. */
static void irradiance_on_the_axis(void **state) {
  (void)state;
  const double numbers[] = {0.5, 1.0, 1.4, 2.0, 8.0};
  for (size_t i = 0; i < 5; i++) {
    pl_sensor sensor = sensor_plain();
    sensor.f_number = numbers[i];
    const double aplanatic = pl_sensor_response(&sensor, 1);
    sensor.plane_pupil = true;
    const double plane = pl_sensor_response(&sensor, 1);
    const double edge = atan(0.5 / numbers[i]);
    double sum = 0.0;
    for (int k = 0; k < 4000; k++) {
      const double a = edge * (k + 0.5) / 4000.0;
      sum += cos(a) * 2.0 * sin(a) * edge / 4000.0;
    }
    assert_true(fabs(plane / aplanatic / (sum * 4.0 * numbers[i] * numbers[i]) - 1.0) < 1e-6);
  }
}

static void mosaics_are_named_by_their_first_four(void **state) {
  (void)state;
  static const char *const names[] = {"ggg", "rggb", "bggr", "grbg", "gbrg"};
  for (int mosaic = PL_MOSAIC_RGGB; mosaic < PL_MOSAIC_COUNT; mosaic++)
    for (int i = 0; i < 4; i++)
      for (int shift = 0; shift < 6; shift += 2)
        assert_int_equal("rgb"[pl_sensor_band((pl_mosaic)mosaic, i % 2 + shift, i / 2 + shift)],
                         names[mosaic][i]);
}

static void automatic_time_keeps_its_limits(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.auto_time = (pl_auto_time){.on = true, .min_s = 1e-4, .max_s = 2.0};
  pl_sensor_expose(&sensor, 3.0);
  const double time_s = sensor.exposure_s;
  assert_true(fabs(3.0 * pl_sensor_response_white(&sensor) / pl_sensor_white_electrons(&sensor) -
                   1.0) < 1e-12);
  const double radiances[] = {1e9, 1e-9, 0.0}, limits[] = {1e-4, 2.0, 2.0};
  for (int i = 0; i < 3; i++) {
    pl_sensor_expose(&sensor, radiances[i]);
    assert_true(sensor.exposure_s == limits[i]);
  }
  sensor.auto_time.step_s = time_s / 2.5; /* two whole steps fit */
  pl_sensor_expose(&sensor, 3.0);
  assert_true(fabs(sensor.exposure_s - 0.8 * time_s) < 1e-12 * time_s);
  sensor.auto_time.step_s = 0.0;
  sensor.auto_time.time_count = 3;
  const double times[] = {0.5 * time_s, 0.9 * time_s, 1.1 * time_s};
  memcpy(sensor.auto_time.times_s, times, sizeof times);
  pl_sensor_expose(&sensor, 3.0);
  assert_true(sensor.exposure_s == times[1]);
  pl_sensor_expose(&sensor, 300.0); /* all are too long */
  assert_true(sensor.exposure_s == times[0]);
}

/* The gain rises when the longest time no longer suffices, and no further than it has steps. Below
 * the full well, the digits are white: the time is as if nothing else had changed. */
static void gains_follow_the_longest_time(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.full_well = 1e6;
  sensor.auto_time = (pl_auto_time){
      .on = true, .min_s = 1e-9, .max_s = 1.0, .gain_count = 3, .gains = {1.0, 2.0, 8.0}};
  sensor.exposure_s = 1.0;
  const double white = pl_sensor_white_electrons(&sensor) / pl_sensor_response_white(&sensor);
  const double parts[] = {2.0, 1.01, 0.99, 0.51, 0.49, 0.126, 0.1};
  const double gains[] = {1.0, 1.0, 2.0, 2.0, 8.0, 8.0, 8.0};
  for (int i = 0; i < 7; i++) {
    sensor.gain = 10.0;
    pl_sensor_expose(&sensor, parts[i] * white);
    assert_true(fabs(sensor.gain * gains[i] - 10.0) < 1e-12);
    assert_true(fabs(sensor.exposure_s - fmin(1.0, 1.0 / parts[i] / gains[i])) < 1e-9);
  }
}

static void metering_looks_at_its_window(void **state) {
  (void)state;
  float scratch[100], image[100];
  for (int i = 0; i < 100; i++) /* left half 1 to 10 by rows, right half 100, the rest no light */
    image[i] = i % 10 < 5 ? (float)(1 + i / 10) : 100.0f;
  image[99] = NAN;
  pl_auto_time how = {.percentile = 100.0, .key = 0.5, .window = {0, 0, 0.5, 1}, .saturated = 1.0};
  assert_true(pl_sensor_meter(&how, image, 10, 10, scratch, 1.0) == 20.0);
  how.mean = true;
  assert_true(fabs(pl_sensor_meter(&how, image, 10, 10, scratch, 1.0) - 11.0) < 1e-12);
  const double all[4] = {0, 0, 1, 1}, dot[4] = {0.31, 0.31, 0.32, 0.32};
  memcpy(how.window, all, sizeof all);
  const double average = (0.5 * 5.5 + 0.49 * 100.0); /* of a hundred, one is no number */
  assert_true(fabs(pl_sensor_meter(&how, image, 10, 10, scratch, 1.0) - average / 0.5) < 1e-9);
  how.key = 1.0;
  how.saturated = 0.0; /* then none may be brighter than white */
  assert_true(pl_sensor_meter(&how, image, 10, 10, scratch, 1.0) == 100.0);
  how.saturated = 0.49; /* the hundreds may */
  assert_true(fabs(pl_sensor_meter(&how, image, 10, 10, scratch, 1.0) - average) < 1e-9);
  memcpy(how.window, dot, sizeof dot); /* between the middles of pixels: the one it lies in */
  assert_true(pl_sensor_meter(&how, image, 10, 10, scratch, 1.0) == 4.0);
  memset(image, 0, sizeof image);
  assert_true(pl_sensor_meter(&how, image, 10, 10, scratch, 7.0) == 7.0);
}

/* Rows of the mix are parts of a whole; planes and mixes exclude what they replace. */
static void wrong_filters_are_refused(void **state) {
  (void)state;
  pl_sensor_plane plane = {{0.1, 0.1, 0.1}, {5e-7, 5e-7, 5e-7}};
  pl_sensor mosaic = sensor_plain(), bare = sensor_plain();
  mosaic.mosaic = PL_MOSAIC_RGGB;
  mosaic.mixed = true;
  for (int band = 0; band < 3; band++)
    mosaic.mix[band][band] = 1.0;
  bare.planes = &plane;
  bare.plane_count = 1;
  assert_int_equal(pl_sensor_check(&mosaic), PL_OK);
  assert_int_equal(pl_sensor_check(&bare), PL_OK);
  mosaic.mix[1][2] = 0.5;
  assert_int_equal(pl_sensor_check(&mosaic), PL_E_RANGE);
  mosaic.mix[1][1] = 1.5;
  mosaic.mix[1][2] = -0.5;
  assert_int_equal(pl_sensor_check(&mosaic), PL_E_RANGE);
  mosaic = sensor_plain();
  mosaic.mosaic = PL_MOSAIC_RGGB;
  mosaic.planes = &plane;
  mosaic.plane_count = 1;
  assert_int_equal(pl_sensor_check(&mosaic), PL_E_ARGUMENT);
  bare.mixed = true;
  for (int band = 0; band < 3; band++)
    bare.mix[band][band] = 1.0;
  assert_int_equal(pl_sensor_check(&bare), PL_E_ARGUMENT);
  bare.mixed = false;
  plane.wavelength_m[2] = (double)NAN;
  assert_int_equal(pl_sensor_check(&bare), PL_E_RANGE);
}

static void wrong_numbers_are_refused(void **state) {
  (void)state;
  const pl_sensor good = sensor_plain();
  assert_int_equal(pl_sensor_check(&good), PL_OK);
  pl_sensor bad[] = {good, good, good, good, good, good, good, good};
  bad[0].f_number = 0.0;
  bad[1].bits = 17;
  bad[2].bits = 0;
  bad[3].full_well = (double)NAN;
  bad[4].quantum_efficiency[2] = 1.5;
  bad[5].black_level = 4095.0;
  bad[6].read_noise = INFINITY;
  bad[7].exposure_s = -1.0;
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
    assert_int_equal(pl_sensor_check(&bad[i]), PL_E_RANGE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(electrons_of_a_radiance),
      cmocka_unit_test(irradiance_on_the_axis),
      cmocka_unit_test(mosaics_are_named_by_their_first_four),
      cmocka_unit_test(automatic_time_keeps_its_limits),
      cmocka_unit_test(wrong_filters_are_refused),
      cmocka_unit_test(gains_follow_the_longest_time),
      cmocka_unit_test(metering_looks_at_its_window),
      cmocka_unit_test(wrong_numbers_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
