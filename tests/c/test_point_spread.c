/* The point-spread function: energy within rings, energy kept, the same by both ways. */
#include "harness.h"

#include "sensor/psf.h"
#include "sensor/stages.h"
#include "sensors.h"

enum { REACH = 128, SIDE = 2 * REACH + 1 };

/* Airy's pattern: 83.7784869173 % within its first dark ring at x = 3.8317059702, 93.7625720104 %
 * within x = 10 (1 - J0^2 - J1^2). A pixel of a tenth of the ring's radius. */
static void airy_has_its_encircled_energy(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.psf.core = PL_PSF_AIRY;
  sensor.pixel_m = 1.2196698912665 * sensor.wavelength_m[1] * sensor.f_number / 10.0;
  assert_true(fabs(pl_psf_outside(&sensor, 1, 10.0) - (1.0 - 0.837784869173)) < 1e-9);
  const double far = 10.0 / 3.8317059702 * 10.0;
  assert_true(fabs(pl_psf_outside(&sensor, 1, far) - (1.0 - 0.937625720104)) < 1e-9);
  double *kernel = malloc(sizeof(double) * SIDE * SIDE);
  pl_psf_kernel(&sensor, 1, REACH, REACH, true, kernel);
  double ring = 0.0, sum = 0.0;
  for (int y = -REACH; y <= REACH; y++)
    for (int x = -REACH; x <= REACH; x++) {
      const double part = kernel[(y + REACH) * SIDE + x + REACH];
      sum += part;
      /* pixels that the ring cuts, by the part of 64^2 points inside */
      const double middle = hypot(x, y);
      int inside = middle < 9.0 ? 4096 : 0;
      for (int k = 0; k < 64 * 64 && fabs(middle - 10.0) <= 1.0; k++)
        inside += hypot(x + (k % 64 + 0.5) / 64 - 0.5, y + (k / 64 + 0.5) / 64.0 - 0.5) < 10.0;
      ring += part * inside / 4096.0;
    }
  print_message("Airy: %.5f in the first dark ring, sum %.9f\n", ring, sum);
  assert_true(fabs(ring - 0.8378) < 1e-3);
  assert_true(fabs(sum - 1.0) < 1e-12);
  free(kernel);
}

/* At f/0.7 and pixels of 30 um the pattern's dark ring is 0.5 um wide, far less than the points
 * that a pixel is sampled at are apart: still, all but 0.6 % of the energy (2 / (pi x) at x = pi /
 * 2 30 um / (550 nm 0.7)) is within half a pixel of the middle, and none of it is made up farther
 * out. */
static void a_core_smaller_than_a_pixel_stays_in_it(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.psf.core = PL_PSF_AIRY;
  sensor.f_number = 0.7;
  sensor.pixel_m = 30e-6;
  double kernel[15 * 15], sum = 0.0;
  pl_psf_kernel(&sensor, 1, 7, 7, true, kernel);
  for (int i = 0; i < 15 * 15; i++)
    sum += kernel[i];
  assert_true(fabs(sum - 1.0) < 1e-12);
  assert_true(kernel[7 * 15 + 7] > 0.994);
  assert_true(kernel[0] < 1e-5);
}

static void set_psf(pl_sensor *sensor, int kind) {
  static double kernel[42];
  for (int i = 0; i < 42; i++)
    kernel[i] = 2.0 * (i + 1) / (42.0 * 43.0);
  const pl_psf kinds[] = {
      {PL_PSF_GAUSS, .sigma_px = 0.7},
      {PL_PSF_GAUSS, .sigma_px = 0.7, .wings = 0.02, .wing_radius_px = 2.0, .wing_beta = 1.4},
      {PL_PSF_AIRY, .wings = 0.0},
      {PL_PSF_POINT, .wings = 0.5, .wing_radius_px = 1.0, .wing_beta = 3.0},
      {PL_PSF_MEASURED, .kernel = kernel, .kernel_width = 7, .kernel_height = 6}};
  sensor->psf = kinds[kind];
}

/* A point's flux stays to 1e-6: all of the kernel lies in the image. */
static void flux_is_kept(void **state) {
  (void)state;
  for (int kind = 0; kind < 4; kind++)
    for (int value = 1; value <= 2; value++) {
      pl_sensor sensor = sensor_plain();
      set_psf(&sensor, kind);
      sensor_shot shot;
      sensor_shot_init(&shot, &sensor, 129, 129); /* padded to 256: reaches 127 */
      const size_t middle = 64 * 129 + 64;
      shot.frame.bands[middle] = (pl_vec3f){1e6f, 3.0f, 2e3f};
      assert_int_equal(pl_stage_point_spread(&shot.frame, value), PL_OK);
      double sum[3] = {0};
      for (size_t i = 0; i < shot.pixels; i++) {
        sum[0] += shot.frame.bands[i].x;
        sum[1] += shot.frame.bands[i].y;
        sum[2] += shot.frame.bands[i].z;
      }
      /* of the wings a part leaves an image that the kernel exceeds */
      const double left = value == 2 ? pl_psf_outside(&sensor, 0, 64.0) : 0.0;
      assert_true(fabs(sum[0] / 1e6 - 1.0) < 1e-6 + left);
      assert_true(fabs(sum[1] / 3.0 - 1.0) < 1e-6 + left);
      assert_true(fabs(sum[2] / 2e3 - 1.0) < 1e-6 + left);
      assert_true(shot.frame.bands[middle].x < 1e6f);
      sensor_shot_clear(&shot);
    }
}

/* Where the function ends within the middle, both ways give the same image, borders too. */
static void both_ways_agree(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  set_psf(&sensor, 0);
  sensor_shot shots[2];
  for (int k = 0; k < 2; k++) {
    sensor_shot_init(&shots[k], &sensor, 37, 23);
    for (size_t i = 0; i < shots[k].pixels; i++)
      shots[k].frame.bands[i] = (pl_vec3f){(float)(i % 7), (float)(i % 11), i == 400 ? 1e4f : 0.0f};
    assert_int_equal(pl_stage_point_spread(&shots[k].frame, k + 1), PL_OK);
  }
  for (size_t i = 0; i < shots[0].pixels; i++) {
    const pl_vec3f a = shots[0].frame.bands[i], b = shots[1].frame.bands[i];
    assert_true(fabsf(a.x - b.x) < 1e-5f && fabsf(a.y - b.y) < 1e-5f && fabsf(a.z - b.z) < 1e-2f);
  }
  sensor_shot_clear(&shots[0]);
  sensor_shot_clear(&shots[1]);
}

/* What the middle leaves out is within what the row says of it. */
static void the_middle_keeps_its_bound(void **state) {
  (void)state;
  for (int kind = 0; kind < 4; kind++) {
    pl_sensor sensor = sensor_plain();
    set_psf(&sensor, kind);
    const double bound = pl_psf_outside(&sensor, 0, 6.5);
    sensor_shot shots[2];
    for (int k = 0; k < 2; k++) {
      sensor_shot_init(&shots[k], &sensor, 96, 64);
      for (size_t i = 0; i < shots[k].pixels; i++)
        shots[k].frame.bands[i].x = i % 96 < 40 ? 1.0f : 0.0f;
      assert_int_equal(pl_stage_point_spread(&shots[k].frame, k + 1), PL_OK);
    }
    double worst = 0.0;
    for (size_t i = 0; i < shots[0].pixels; i++)
      worst =
          fmax(worst, fabs((double)shots[0].frame.bands[i].x - (double)shots[1].frame.bands[i].x));
    assert_true(worst <= bound + 1e-6);
    sensor_shot_clear(&shots[0]);
    sensor_shot_clear(&shots[1]);
  }
}

/* Images smaller than the kernel, of one row, with light that is no number; any threads. */
static void any_image_is_spread(void **state) {
  (void)state;
  const int sizes[][2] = {{1, 1}, {1, 9}, {5, 1}, {3, 2}, {65, 33}};
  for (int kind = 0; kind < 5; kind++)
    for (int k = 0; k < 5; k++)
      for (int value = 1; value <= 2; value++) {
        pl_sensor sensor = sensor_plain();
        set_psf(&sensor, kind);
        sensor_shot shots[2];
        for (int j = 0; j < 2; j++) {
          sensor_shot_init(&shots[j], &sensor, sizes[k][0], sizes[k][1]);
          sensor_shot_fill(&shots[j], 3e38f);
          shots[j].frame.bands[0] = (pl_vec3f){NAN, -1.0f, INFINITY};
          shots[j].frame.threads = 1 + 2 * j;
          assert_int_equal(pl_stage_point_spread(&shots[j].frame, value), PL_OK);
        }
        for (size_t i = 0; i < shots[0].pixels; i++)
          assert_true(isfinite(shots[0].frame.bands[i].x + shots[0].frame.bands[i].z));
        assert_memory_equal(shots[0].frame.bands, shots[1].frame.bands,
                            shots[0].pixels * sizeof(pl_vec3f));
        sensor_shot_clear(&shots[0]);
        sensor_shot_clear(&shots[1]);
      }
}

/* An uneven kernel of any size, even sides too, larger than the image too: the sum that defines the
 * image of every point, by sums and by transforms as the cost has it. */
static void measured_kernels_are_convolved(void **state) {
  (void)state;
  const int sizes[][2] = {{1, 1}, {2, 3}, {4, 7}, {13, 12}, {33, 30}, {60, 21}, {101, 128}};
  enum { W = 41, H = 26 };
  for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
    const int kw = sizes[k][0], kh = sizes[k][1];
    double *kernel = malloc(sizeof(double) * (size_t)kw * (size_t)kh), sum = 0.0;
    for (int i = 0; i < kw * kh; i++)
      sum += kernel[i] = 1.0 + i * 7 % 23 + (i % kw < kw / 3 ? 40.0 : 0.0);
    for (int i = 0; i < kw * kh; i++)
      kernel[i] /= sum;
    pl_sensor sensor = sensor_plain();
    sensor.psf =
        (pl_psf){PL_PSF_MEASURED, .kernel = kernel, .kernel_width = kw, .kernel_height = kh};
    assert_int_equal(pl_sensor_check(&sensor), PL_OK);
    sensor_shot shot;
    sensor_shot_init(&shot, &sensor, W, H);
    double light[W * H], worst = 0.0;
    for (int i = 0; i < W * H; i++) {
      light[i] = i * 31 % 57;
      shot.frame.bands[i] = (pl_vec3f){(float)light[i], 0.0f, 2.0f * (float)light[i]};
    }
    assert_int_equal(pl_stage_point_spread(&shot.frame, 2), PL_OK);
    for (int y = 0; y < H; y++)
      for (int x = 0; x < W; x++) {
        double expected = 0.0;
        for (int v = 0; v < H; v++)
          for (int u = 0; u < W; u++) {
            const int a = x - u + kw / 2, b = y - v + kh / 2;
            if (a >= 0 && b >= 0 && a < kw && b < kh)
              expected += light[v * W + u] * kernel[b * kw + a];
          }
        const pl_vec3f got = shot.frame.bands[y * W + x];
        worst = fmax(worst, fabs((double)got.x - expected));
        worst = fmax(worst, fabs(0.5 * (double)got.z - expected));
      }
    print_message("kernel %d x %d: worst error %.2g\n", kw, kh, worst);
    assert_true(worst < 57.0 * 2e-7);
    sensor_shot_clear(&shot);
    free(kernel);
  }
}

/* What its middle leaves out is counted; with wings all light is still there. */
static void measured_kernels_have_wings_and_bounds(void **state) {
  (void)state;
  double kernel[21] = {[0] = 0.25, [10] = 0.5, [13] = 0.25};
  pl_sensor sensor = sensor_plain();
  sensor.psf = (pl_psf){PL_PSF_MEASURED, .kernel = kernel, .kernel_width = 21, .kernel_height = 1};
  assert_true(fabs(pl_psf_outside(&sensor, 0, 6.5) - 0.25) < 1e-15);
  for (int value = 1; value <= 2; value++) {
    sensor.psf.wings = value == 2 ? 0.1 : 0.0;
    sensor.psf.wing_radius_px = 1.0;
    sensor.psf.wing_beta = 4.0;
    sensor_shot shot;
    sensor_shot_init(&shot, &sensor, 65, 65);
    shot.frame.bands[32 * 65 + 32].y = 1.0f;
    assert_int_equal(pl_stage_point_spread(&shot.frame, value), PL_OK);
    double sum = 0.0;
    for (size_t i = 0; i < shot.pixels; i++)
      sum += shot.frame.bands[i].y;
    assert_true(fabs(sum - 1.0) < 1e-6);
    const float *middle = &shot.frame.bands[32 * 65 + 32].y;
    if (value == 1) { /* what is out of reach stays */
      assert_true(fabsf(*middle - 0.75f) < 1e-6f);
      assert_true(fabsf(middle[9] - 0.25f) < 1e-6f);
    } else {
      assert_true(middle[-30] > 0.2249f && middle[-30] < 0.2251f);
    }
    sensor_shot_clear(&shot);
  }
  kernel[0] = 0.3; /* the sum is not 1 */
  assert_int_equal(pl_sensor_check(&sensor), PL_E_RANGE);
  kernel[0] = -0.25;
  assert_int_equal(pl_sensor_check(&sensor), PL_E_RANGE);
  sensor.psf.kernel = NULL;
  assert_int_equal(pl_sensor_check(&sensor), PL_E_RANGE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      serial_unit_test(airy_has_its_encircled_energy),
      serial_unit_test(a_core_smaller_than_a_pixel_stays_in_it),
      serial_unit_test(flux_is_kept),
      serial_unit_test(both_ways_agree),
      serial_unit_test(the_middle_keeps_its_bound),
      serial_unit_test(measured_kernels_are_convolved),
      serial_unit_test(measured_kernels_have_wings_and_bounds),
      cmocka_unit_test(any_image_is_spread),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
