/* Stages that move, add or take charge: their sums and shapes. */
#include "harness.h"

#include "sensor/stages.h"
#include "sensors.h"

enum { W = 64, H = 48 };

static double total(const sensor_shot *shot) {
  double sum = 0.0;
  for (size_t i = 0; i < shot->pixels; i++)
    sum += shot->frame.electrons[i];
  return sum;
}

static void run(sensor_shot *shot, pl_status (*stage)(pl_sensor_frame *, int)) {
  assert_int_equal(stage(&shot->frame, 1), PL_OK);
}

/* A source of 11 wells in the middle fills five pixels above and five below; all charge stays. */
static void blooming_keeps_charge(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.full_well = 1000.0;
  for (int drained = 0; drained < 2; drained++) {
    sensor.drain = drained ? 0.6 : 0.0;
    sensor_shot shot;
    sensor_shot_init(&shot, &sensor, W, H);
    double *column = shot.frame.electrons + 7;
    column[20 * W] = 11000.0;
    column[22 * W] = 400.0; /* takes 600 only */
    run(&shot, pl_stage_blooming);
    run(&shot, pl_stage_full_well);
    assert_true(fabs(total(&shot) - (drained ? 5400.0 : 11400.0)) < 1e-6);
    if (!drained) {
      for (int y = 15; y <= 25; y++)
        assert_true(column[y * W] == 1000.0);
      assert_true(column[14 * W] == 0.0 && fabs(column[26 * W] - 400.0) < 1e-9);
    }
    assert_true(shot.frame.electrons[20 * W + 6] == 0.0);
    sensor_shot_clear(&shot);
  }
}

/* The sun in a pixel fills its column, loses the rest at the ends, and hangs nothing. */
static void the_sun_fills_its_column(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.drain = 0.0;
  sensor_shot shot;
  sensor_shot_init(&shot, &sensor, W, H);
  shot.frame.electrons[5] = 1e12;
  run(&shot, pl_stage_blooming);
  run(&shot, pl_stage_full_well);
  for (int y = 0; y < H; y++)
    assert_true(shot.frame.electrons[y * W + 5] == sensor.full_well);
  assert_true(total(&shot) == H * sensor.full_well);
  sensor_shot_clear(&shot);
}

static void smear_adds_the_columns_sum(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.shift_s = 1e-6; /* of an exposure of 1 ms */
  sensor_shot shot;
  sensor_shot_init(&shot, &sensor, W, H);
  shot.frame.electrons[3 * W + 9] = 5000.0;
  shot.frame.electrons[8 * W + 9] = 2000.0;
  run(&shot, pl_stage_smear);
  for (int y = 0; y < H; y++)
    assert_true(fabs(shot.frame.electrons[y * W + 9] - 7.0 -
                     (y == 3   ? 5000.0
                      : y == 8 ? 2000.0
                               : 0.0)) < 1e-9);
  assert_true(shot.frame.electrons[3 * W + 8] == 0.0);
  sensor.exposure_s = 0.0; /* no time: nothing, not infinity */
  run(&shot, pl_stage_smear);
  assert_true(isfinite(total(&shot)));
  sensor_shot_clear(&shot);
}

/* cos^4 of the angle: 1/4 at 45 degrees, 1 on the axis. */
static void vignetting_is_cos4(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.shading.power = 4.0;
  sensor_shot shot;
  sensor_shot_init(&shot, &sensor, 101, 3);
  shot.frame.focal_px[0] = shot.frame.focal_px[1] = 50.0;
  sensor_shot_fill(&shot, 8.0f);
  run(&shot, pl_stage_vignetting);
  assert_true(fabsf(shot.frame.bands[101 + 50].x - 8.0f) < 1e-6f);
  assert_true(fabsf(shot.frame.bands[101].y - 2.0f) < 1e-6f);
  assert_true(fabsf(shot.frame.bands[101 + 100].z - 2.0f) < 1e-6f);
  sensor_shot_clear(&shot);
}

/* A table and a flat field multiply; between their points they are linear, beyond them they hold.
 */
static void vignetting_by_table_and_flat_field(void **state) {
  (void)state;
  const float flat[2] = {0.5f, 1.5f};
  pl_sensor sensor = sensor_plain();
  sensor.shading = (pl_shading){.count = 2, .angle_rad = {0.2, 0.4}, .factor = {1.0, 0.5}};
  assert_int_equal(pl_shading_set_flat(&sensor.shading, flat, 2, 1), PL_OK);
  const struct {
    double angle, place, factor;
  } cases[] = {{0.0, 0.5, 1.0},  {0.1, 0.5, 1.0}, {0.3, 0.5, 0.75}, {0.4, 0.5, 0.5},
               {1.2, 0.5, 0.5},  {0.0, 0.0, 0.5}, {0.0, 0.25, 0.5}, {0.0, 0.375, 0.75},
               {0.0, 0.75, 1.5}, {0.0, 1.0, 1.5}, {0.3, 1.0, 1.125}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    const double place[2] = {cases[i].place, 0.3};
    const double tangent[2] = {0.6 * tan(cases[i].angle), -0.8 * tan(cases[i].angle)};
    const double factor = pl_shading_at(&sensor.shading, tangent, place);
    assert_true(fabs(factor - cases[i].factor) < 1e-12);
  }
  double low, high;
  pl_shading_range(&sensor.shading, 9.0, &low, &high);
  assert_true(low == 0.25 && high == 1.5);
  assert_int_equal(pl_sensor_check(&sensor), PL_OK);
  sensor.shading.angle_rad[1] = 0.2;
  assert_int_equal(pl_sensor_check(&sensor), PL_E_RANGE);
  const float bad[] = {1.0f, NAN, 1.0f, -0.1f, 1.0f, INFINITY};
  for (int i = 0; i < 3; i++)
    assert_int_equal(pl_shading_set_flat(&sensor.shading, bad + 2 * i, 2, 1), PL_E_RANGE);
}

/* The stated parts of the pixels, within 5 standard errors; the same ones in every frame. */
static void defects_are_as_many_as_stated(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.dead_pixels = 0.01;
  sensor.hot_pixels = 0.02;
  sensor.hot_current = 1e6;
  double first[2] = {0};
  for (int frame = 0; frame < 2; frame++) {
    sensor_shot shot;
    sensor_shot_init(&shot, &sensor, 256, 256);
    shot.frame.index = (uint64_t)frame;
    double dead = 0.0, hot = 0.0;
    for (size_t i = 0; i < shot.pixels; i++)
      shot.frame.electrons[i] = 100.0;
    run(&shot, pl_stage_defects);
    for (size_t i = 0; i < shot.pixels; i++) {
      dead += shot.frame.electrons[i] == 0.0;
      hot += shot.frame.electrons[i] >= 600.0 && shot.frame.electrons[i] <= 1600.0;
    }
    assert_true(fabs(dead - 655.36) < 5.0 * sqrt(655.36));
    assert_true(fabs(hot - 1310.72) < 5.0 * sqrt(1310.72));
    first[frame] = total(&shot);
    sensor_shot_clear(&shot);
  }
  assert_true(first[0] == first[1]);
}

/* Mean charge: rays times charge a metre times depth times the mean of 1/cos over density cos,
 * which is 2; less what grazing tracks lose over the borders. */
static void rays_leave_their_charge(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.ray_depth_m = 2e-6;
  sensor.ray_electrons_per_m = 8e7;
  const double rays = 20000.0, area = 5e-6 * 5e-6 * 512 * 512;
  sensor.ray_flux = rays / area / sensor.exposure_s;
  sensor_shot shot;
  sensor_shot_init(&shot, &sensor, 512, 512);
  run(&shot, pl_stage_cosmic_rays);
  /* a track's charge has the variance (2e-6 * 8e7)^2 * (mean of 1/cos^2 - 4), up to tan = 50:
     mean of 1/cos^2 = 1 + ln(2501), 4.8: 5 standard errors of 20000 are 5.5 % of the mean, with the
     count's */
  assert_true(fabs(total(&shot) / (rays * 160.0 * 2.0) - 1.0) < 0.07);
  const double once = total(&shot);
  memset(shot.frame.electrons, 0, shot.pixels * sizeof(double));
  run(&shot, pl_stage_cosmic_rays);
  assert_true(total(&shot) == once);
  shot.frame.index++;
  memset(shot.frame.electrons, 0, shot.pixels * sizeof(double));
  run(&shot, pl_stage_cosmic_rays);
  assert_true(total(&shot) != once);
  sensor_shot_clear(&shot);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(blooming_keeps_charge),
      cmocka_unit_test(the_sun_fills_its_column),
      cmocka_unit_test(smear_adds_the_columns_sum),
      cmocka_unit_test(vignetting_is_cos4),
      cmocka_unit_test(vignetting_by_table_and_flat_field),
      cmocka_unit_test(defects_are_as_many_as_stated),
      cmocka_unit_test(rays_leave_their_charge),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
