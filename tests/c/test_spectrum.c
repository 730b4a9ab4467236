/* Bands of sunlight against integrals in closed form. */
#include "harness.h"

#include <math.h>

#include "light/spectrum.h"
#include "sensor/bands.h"

static const double FLAT[2][2] = {{0.2, 3.0}, {1.2, 3.0}};
static const pl_curve EVEN = {FLAT, 2}; /* an even sun: 0.01 of its light in every 0.01 um */

static double sum(const double parts[3]) { return parts[0] + parts[1] + parts[2]; }

static void shares_are_white_together(void **state) {
  (void)state;
  double first[3], weights[3];
  pl_reflectance_weights(0.38, first);
  for (int i = 0; i <= 4000; i++) {
    pl_reflectance_weights(0.2 + 0.00025 * i, weights);
    assert_true(fabs(sum(weights) - 1.0) < 1e-12);
    for (int c = 0; c < 3; c++) {
      assert_true(weights[c] >= 0.0 && weights[c] <= 1.0);
      assert_true(i > 720 || fabs(weights[c] - first[c]) < 1e-12);
    }
  }
  assert_true(weights[0] > 0.99);
}

/* A box holds its width of an even sun, and that is its mean wavelength's; half a box of response
 * 0.5 with half of 1 likewise. Beyond the table of reflectances, parts are shares. */
static void boxes_are_exact(void **state) {
  (void)state;
  const double box[2][2] = {{0.4137, 1.0}, {0.7921, 1.0}}, far[2][2] = {{0.8, 1.0}, {1.1, 1.0}};
  const double half[2][2] = {{0.3, 0.5}, {0.9, 0.5}};
  const pl_curve curves[2] = {{box, 2}, {half, 2}}, beyond = {far, 2};
  pl_band_light light;
  double weights[3];
  assert_int_equal(pl_band_gather(&EVEN, curves, 1, 0.01, &light), PL_OK);
  assert_true(fabs(sum(light.part) - 0.3784) < 1e-12);
  assert_true(fabs(light.mean_um - 0.6029) < 1e-12);
  assert_true(fabs(sum(light.moment_um) - 0.3784 * 0.6029) < 1e-12);
  assert_int_equal(pl_band_gather(&EVEN, curves, 2, 0.01, &light), PL_OK);
  assert_true(fabs(sum(light.part) - 0.1892) < 1e-12);
  assert_int_equal(pl_band_gather(&EVEN, &beyond, 1, 1.0, &light), PL_OK);
  pl_reflectance_weights(1.0, weights);
  for (int c = 0; c < 3; c++)
    assert_true(fabs(light.part[c] - 0.3 * weights[c]) < 1e-12);
}

/* A triangle on a sun that rises: sums of cubics; int t (1 - t) dt from 0 to 1 is 1/6. */
static void products_of_slopes_are_exact(void **state) {
  (void)state;
  const double rising[2][2] = {{0.5, 0.0}, {1.5, 1.0}}, falling[2][2] = {{0.5, 1.0}, {1.5, 0.0}};
  const pl_curve sun = {rising, 2}, response = {falling, 2};
  pl_band_light light;
  for (double step_um = 0.001; step_um < 3.0; step_um *= 4.0) {
    assert_int_equal(pl_band_gather(&sun, &response, 1, step_um, &light), PL_OK);
    assert_true(fabs(sum(light.part) - 2.0 / 6.0) < 1e-12); /* of a light of 1/2 */
    assert_true(fabs(light.mean_um - 1.0) < 1e-12);
  }
}

/* All light is in all wavelengths; half of a black body's photons' energy is above 4107 um K / T
 * (median of Planck's law), here of what the blanketed part below 0.4 um leaves. */
static void the_default_sun_is_whole(void **state) {
  (void)state;
  const double all[2][2] = {{0.01, 1.0}, {1000.0, 1.0}}, red[2][2] = {{0.70209, 1.0}, {1e3, 1.0}};
  const double blue[2][2] = {{0.01, 1.0}, {0.4, 1.0}};
  const pl_curve every = {all, 2}, above = {red, 2}, below = {blue, 2};
  pl_band_light light, long_half, dimmed;
  assert_int_equal(pl_band_gather(NULL, &every, 1, 0.02, &light), PL_OK);
  assert_true(fabs(sum(light.part) - 1.0) < 1e-9);
  assert_int_equal(pl_band_gather(NULL, &above, 1, 0.02, &long_half), PL_OK);
  assert_int_equal(pl_band_gather(NULL, &below, 1, 0.02, &dimmed), PL_OK);
  const double whole = 1.0 + sum(dimmed.part) * 0.3 / 0.7; /* were it not blanketed */
  assert_true(fabs(sum(long_half.part) / whole - 0.5) < 1e-4);
}

static void what_is_no_band_is_refused(void **state) {
  (void)state;
  const double nan_um[2][2] = {{0.4, 1.0}, {(double)NAN, 1.0}}, twice[2][2] = {{0.4, 1}, {0.4, 1}};
  const double back[2][2] = {{0.5, 1.0}, {0.4, 1.0}},
               infinite[2][2] = {{0.4, 1.0}, {0.5, INFINITY}};
  const double outside[2][2] = {{0.1, 1.0}, {0.5, 1.0}}, fine[2][2] = {{0.4, 1.0}, {0.5, 1.0}};
  const double dark[2][2] = {{0.1, 0.0}, {9.0, 0.0}}, negative[2][2] = {{0.1, 2.0}, {9.0, -1.0}};
  const pl_curve bad[] = {{nan_um, 2},   {twice, 2},   {back, 2},
                          {infinite, 2}, {outside, 2}, {fine, 1}};
  const pl_curve good = {fine, 2}, suns[] = {{dark, 2}, {negative, 2}, {FLAT, 1}};
  pl_band_light light;
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
    assert_int_equal(pl_band_gather(&EVEN, &bad[i], 1, 0.01, &light), PL_E_RANGE);
  for (size_t i = 0; i < sizeof suns / sizeof suns[0]; i++)
    assert_int_equal(pl_band_gather(&suns[i], &good, 1, 0.01, &light), PL_E_RANGE);
  assert_int_equal(pl_band_gather(&EVEN, &good, 0, 0.01, &light), PL_E_ARGUMENT);
  assert_int_equal(pl_band_gather(&EVEN, &good, 1, 0.0, &light), PL_E_ARGUMENT);
  assert_int_equal(pl_band_gather(&EVEN, &good, 1, 1e-300, &light), PL_E_ARGUMENT);
  assert_int_equal(pl_band_gather(&EVEN, &good, 1, 0.01, &light), PL_OK);
}

/* Curves that do not meet gather nothing. */
static void apart_is_dark(void **state) {
  (void)state;
  const double low[2][2] = {{0.4, 1.0}, {0.5, 1.0}}, high[2][2] = {{0.6, 1.0}, {0.7, 1.0}};
  const pl_curve curves[2] = {{low, 2}, {high, 2}};
  pl_band_light light;
  assert_int_equal(pl_band_gather(NULL, curves, 2, 0.01, &light), PL_OK);
  assert_true(sum(light.part) == 0.0 && light.mean_um == 0.0);
}

static void a_matrix_on_each_pixel(void **state) {
  (void)state;
  const float parts[2][3] = {{0.5f, 0.25f, 0.125f}, {0.0f, 1.0f, 0.0f}};
  const pl_vec3f light[2] = {{1.0f, 2.0f, 4.0f}, {8.0f, 0.0f, 0.0f}};
  float out[4];
  pl_bands_write(parts, 2, light, 2, out);
  assert_true(out[0] == 1.5f && out[1] == 2.0f && out[2] == 4.0f && out[3] == 0.0f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(shares_are_white_together),    cmocka_unit_test(boxes_are_exact),
      cmocka_unit_test(products_of_slopes_are_exact), cmocka_unit_test(the_default_sun_is_whole),
      cmocka_unit_test(what_is_no_band_is_refused),   cmocka_unit_test(apart_is_dark),
      cmocka_unit_test(a_matrix_on_each_pixel),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
