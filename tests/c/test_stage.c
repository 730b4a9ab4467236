/* The sensor's stages from radiance to digital numbers: photon transfer, and what breaks sensors.
 */
#include "harness.h"

#include "sensor/stages.h"
#include "sensors.h"

enum { SIDE = PL_DRAWS(512, 128) };

/* Allowed differences grow with the scatter of fewer pixels. */
static const double LOOSER = 512.0 / SIDE;

static void develop(sensor_shot *shot, const pl_plan *plan) {
  assert_int_equal(pl_sensor_run(&shot->frame, plan), PL_OK);
}

/* EMVA 1288: var(DN) = K mean(DN) + K^2 sigma^2 + 1/12, K in digital numbers an electron. A line
 * fitted through levels of 3e5 pixels each; a variance of so many is good to 0.27 %. */
static void photon_transfer_has_the_stated_slope_and_intercept(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.gain = 2.0;
  sensor.bits = 16;
  sensor.read_noise = 20.0;
  const pl_plan plan = sensor_plan(1, "fixed_pattern");
  double sw = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (int level = 0; level <= 12; level++) {
    sensor_shot shot;
    sensor_shot_init(&shot, &sensor, SIDE, SIDE);
    shot.frame.index = (uint64_t)level;
    sensor_shot_fill(&shot, sensor_radiance(&sensor, 100.0 * level * level));
    develop(&shot, &plan);
    double mean, variance;
    sensor_moments(&shot, &mean, &variance);
    const double x = mean - sensor.black_level, w = 1.0 / (variance * variance);
    sw += w, sx += w * x, sy += w * variance, sxx += w * x * x, sxy += w * x * variance;
    sensor_shot_clear(&shot);
  }
  const double slope = (sw * sxy - sx * sy) / (sw * sxx - sx * sx);
  const double intercept = (sy - slope * sx) / sw;
  const double noise = sqrt((intercept - 1.0 / 12.0)) * sensor.gain;
  print_message("slope %.6g of 0.5, read noise %.6g of 20 electrons\n", slope, noise);
  assert_true(fabs(slope * sensor.gain - 1.0) < 0.01 * LOOSER);
  assert_true(fabs(noise / sensor.read_noise - 1.0) < 0.02 * LOOSER);
}

static void the_full_well_and_the_last_bit_saturate(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  const double light[] = {1e5, 1e12, 3e38};
  for (int k = 0; k < 6; k++) {
    sensor.full_well = k % 2 == 0 ? 30000.0 : 1e6;
    sensor_shot shot;
    sensor_shot_init(&shot, &sensor, 8, 8);
    sensor_shot_fill(&shot, k / 2 < 2 ? sensor_radiance(&sensor, light[k / 2]) : 3e38f);
    const pl_plan plan = sensor_plan(1, NULL);
    develop(&shot, &plan);
    /* 30000 / 10 + 100, or all bits of 12 */
    for (size_t i = 0; i < shot.pixels; i++) {
      assert_int_equal(shot.frame.raw[i], k % 2 == 0 ? 3100 : 4095);
      assert_int_equal(shot.frame.rgb[3 * i + 1], 255);
    }
    sensor_shot_clear(&shot);
  }
}

/* No light, no time, and light that is no number: black level and noise alone. */
static void nothing_gives_the_black_level(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  const float lights[] = {0.0f, 1.0f, NAN, -1.0f};
  for (int k = 0; k < 4; k++) {
    sensor.exposure_s = k == 1 ? 0.0 : 1e-3;
    sensor.dark_current = 0.0;
    sensor_shot shot;
    sensor_shot_init(&shot, &sensor, 16, 16);
    sensor_shot_fill(&shot, lights[k]);
    const pl_plan plan = sensor_plan(1, NULL);
    develop(&shot, &plan);
    for (size_t i = 0; i < shot.pixels; i++)
      assert_int_equal(shot.frame.raw[i], 100);
    for (size_t i = 0; i < 3 * shot.pixels; i++)
      assert_int_equal(shot.frame.rgb[i], 0);
    sensor_shot_clear(&shot);
  }
}

/* Read noise around a black level is seen whole; with a black level of 0 its lower half is cut. */
static void read_noise_stands_around_the_black_level(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.read_noise = 50.0;
  double mean, variance;
  for (int k = 0; k < 2; k++) {
    sensor.black_level = k == 0 ? 100.0 : 0.0;
    sensor_shot shot;
    sensor_shot_init(&shot, &sensor, SIDE, SIDE);
    const pl_plan plan = sensor_plan(1, NULL);
    develop(&shot, &plan);
    sensor_moments(&shot, &mean, &variance);
    sensor_shot_clear(&shot);
    /* sigma 5 DN: 100, or the mean of its positive half, 5/sqrt(2 pi) */
    assert_true(fabs(mean - (k == 0 ? 100.0 : 1.99471)) < 0.05 * LOOSER);
  }
}

/* Dark current: the mean is stated, its deviation between pixels too, and both stay with the unit.
 * In 1e6 s everything is full. */
static void dark_current_gathers(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.dark_current = 1e6;
  sensor.dark_nonuniform = 0.2;
  sensor.exposure_s = 0.01;
  for (int k = 0; k < 2; k++) {
    sensor_shot shot;
    double mean, variance;
    sensor_shot_init(&shot, &sensor, SIDE, SIDE);
    const pl_plan plan = sensor_plan(1, "shot_noise");
    develop(&shot, &plan);
    sensor_moments(&shot, &mean, &variance);
    if (k == 0) {
      /* 1e6 * 0.01 / 10 = 1000 DN; 5 standard errors of 200 DN / SIDE each */
      assert_true(fabs(mean - 1100.0) < 2.0 * LOOSER);
      assert_true(fabs(sqrt(variance) - 200.0) < 2.5 * LOOSER);
    } else {
      assert_true(mean == 3100.0 && variance == 0.0);
    }
    sensor_shot_clear(&shot);
    sensor.exposure_s = 1e6;
  }
}

/* The pattern is the unit's: the same in all frames and seeds, another in another unit. */
static void fixed_pattern_is_fixed(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.prnu = 0.05;
  sensor.column_noise = 30.0;
  sensor.dark_current = 1e5;
  sensor.dark_nonuniform = 0.5;
  uint16_t first[64];
  for (int k = 0; k < 3; k++) {
    sensor.serial = k == 2 ? 5 : 4;
    sensor_shot shot;
    sensor_shot_init(&shot, &sensor, 8, 8);
    shot.frame.index = (uint64_t)k;
    shot.frame.seed = (uint64_t)k + 20;
    sensor_shot_fill(&shot, sensor_radiance(&sensor, 10000.0));
    const pl_plan plan = sensor_plan(1, "shot_noise");
    develop(&shot, &plan);
    if (k == 0)
      memcpy(first, shot.frame.raw, sizeof first);
    assert_int_equal(memcmp(first, shot.frame.raw, sizeof first) == 0, k < 2);
    sensor_shot_clear(&shot);
  }
}

/* Offsets of rows and columns: the same along each, new in each frame, of the stated deviation. */
static void rows_and_columns_flicker(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.row_noise = 200.0;
  sensor.column_flicker = 100.0;
  sensor.black_level = 1000.0;
  sensor_shot shots[2];
  const pl_plan plan = sensor_plan(1, NULL);
  for (int k = 0; k < 2; k++) {
    sensor_shot_init(&shots[k], &sensor, SIDE, SIDE);
    shots[k].frame.index = (uint64_t)k;
    develop(&shots[k], &plan);
  }
  double rows = 0.0, columns = 0.0, same = 0.0;
  for (int i = 1; i < SIDE; i++) { /* differences to the first: twice the variance */
    const double row = shots[0].frame.electrons[i * SIDE] - shots[0].frame.electrons[0];
    const double column = shots[0].frame.electrons[i] - shots[0].frame.electrons[0];
    const double corner = shots[0].frame.electrons[i * SIDE + i] - shots[0].frame.electrons[0];
    assert_true(fabs(row + column - corner) < 1e-9);
    same += shots[0].frame.electrons[i * SIDE] == shots[1].frame.electrons[i * SIDE];
  }
  for (int i = 0; i + 1 < SIDE; i++) {
    const double *e = shots[0].frame.electrons;
    rows += pow(e[(i + 1) * SIDE] - e[i * SIDE], 2.0) / 2.0 / (SIDE - 1);
    columns += pow(e[i + 1] - e[i], 2.0) / 2.0 / (SIDE - 1);
  }
  assert_true(same == 0.0);
  /* of SIDE - 1 dependent differences: 5.4 % of the variance as standard error of 511 */
  assert_true(fabs(rows / 40000.0 - 1.0) < 0.3 * sqrt(LOOSER));
  assert_true(fabs(columns / 10000.0 - 1.0) < 0.3 * sqrt(LOOSER));
  sensor_shot_clear(&shots[0]);
  sensor_shot_clear(&shots[1]);
}

/* With a reset sampled after 1 % of the exposure: 1 % is missing, from a full well on more, and at
 * a hundred times the well all. */
static void the_sun_is_black(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.reset_s = 0.01 * sensor.exposure_s;
  const double charges[] = {0.0, 1000.0, 30000.0, 1.5e6, 3e6, 1e12};
  const double left[] = {0.0, 990.0, 29700.0, 15000.0, 0.0, 0.0};
  for (int k = 0; k < 6; k++) {
    sensor_shot shot;
    sensor_shot_init(&shot, &sensor, 2, 2);
    for (size_t i = 0; i < shot.pixels; i++)
      shot.frame.electrons[i] = charges[k];
    assert_int_equal(pl_stage_black_sun(&shot.frame, 1), PL_OK);
    assert_true(fabs(shot.frame.electrons[3] - left[k]) < 1e-9 * 3e4);
    sensor_shot_clear(&shot);
  }
}

static uint64_t raw_difference(int threads) {
  pl_sensor sensor = sensor_plain();
  sensor.mosaic = PL_MOSAIC_GRBG;
  sensor.prnu = 0.05;
  sensor.read_noise = 30.0;
  sensor.dark_current = 1e5;
  sensor_shot shots[2];
  const pl_plan plan = sensor_plan(1, NULL);
  for (int k = 0; k < 2; k++) {
    sensor_shot_init(&shots[k], &sensor, 67, 41);
    for (size_t i = 0; i < shots[k].pixels; i++)
      shots[k].frame.bands[i] = (pl_vec3f){(float)(i % 97), (float)(i % 31), (float)(i % 13)};
    shots[k].frame.threads = k == 0 ? 1 : threads;
    develop(&shots[k], &plan);
  }
  uint64_t different = 0;
  for (size_t i = 0; i < shots[0].pixels; i++)
    different += shots[0].frame.raw[i] != shots[1].frame.raw[i];
  for (size_t i = 0; i < 3 * shots[0].pixels; i++)
    different += shots[0].frame.rgb[i] != shots[1].frame.rgb[i];
  sensor_shot_clear(&shots[0]);
  sensor_shot_clear(&shots[1]);
  return different;
}

static void threads_do_not_matter(void **state) {
  (void)state;
  for (int threads = 2; threads < 5; threads++)
    assert_int_equal(raw_difference(threads), 0);
}

/* A grey field under every mosaic: a grey picture, edges too, whatever the bands' responses. */
static void demosaicing_keeps_grey_grey(void **state) {
  (void)state;
  for (int mosaic = 0; mosaic < PL_MOSAIC_COUNT; mosaic++) {
    pl_sensor sensor = sensor_plain();
    sensor.mosaic = (pl_mosaic)mosaic;
    sensor.quantum_efficiency[2] = 0.3;
    sensor.bits = 16;
    sensor.gain = 1.0;
    sensor_shot shot;
    sensor_shot_init(&shot, &sensor, 9, 7);
    sensor_shot_fill(&shot, sensor_radiance(&sensor, 0.2140411 * 30000.0));
    const pl_plan plan = sensor_plan(0, NULL);
    develop(&shot, &plan);
    for (size_t i = 0; i < 3 * shot.pixels; i++) /* IEC 61966-2-1: 0.2140411 is 127.5 of 255 */
      assert_true(abs(shot.frame.rgb[i] - 127) <= 1);
    sensor_shot_clear(&shot);
  }
}

/* One row or column has pixels of two bands only; the third is black and nothing is read outside.
 */
static void images_of_one_row_develop(void **state) {
  (void)state;
  const int sizes[][2] = {{1, 1}, {1, 5}, {5, 1}, {2, 2}};
  for (int k = 0; k < 4; k++) {
    pl_sensor sensor = sensor_plain();
    sensor.mosaic = PL_MOSAIC_RGGB;
    sensor_shot shot;
    sensor_shot_init(&shot, &sensor, sizes[k][0], sizes[k][1]);
    sensor_shot_fill(&shot, sensor_radiance(&sensor, 10000.0));
    const pl_plan plan = sensor_plan(1, NULL);
    develop(&shot, &plan);
    assert_true(shot.frame.rgb[0] > 100);
    assert_int_equal(shot.frame.rgb[2] > 100, sizes[k][0] > 1 && sizes[k][1] > 1);
    sensor_shot_clear(&shot);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      serial_unit_test(photon_transfer_has_the_stated_slope_and_intercept),
      serial_unit_test(the_full_well_and_the_last_bit_saturate),
      serial_unit_test(nothing_gives_the_black_level),
      serial_unit_test(read_noise_stands_around_the_black_level),
      serial_unit_test(dark_current_gathers),
      serial_unit_test(fixed_pattern_is_fixed),
      serial_unit_test(rows_and_columns_flicker),
      serial_unit_test(the_sun_is_black),
      cmocka_unit_test(threads_do_not_matter),
      serial_unit_test(demosaicing_keeps_grey_grey),
      serial_unit_test(images_of_one_row_develop),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
