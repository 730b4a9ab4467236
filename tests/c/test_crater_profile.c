/* Dimensions of fresh craters, diffusion against a reference solution, and degraded profiles. */
#include "harness.h"

#include <math.h>
#include <string.h>

#include "terrain/crater_profile.h"
#include "terrain/radial_diffusion.h"

#define NEAR(value, expected, tolerance)                                                           \
  do {                                                                                             \
    const double near_value_ = (value), near_expected_ = (expected);                               \
    if (!(fabs(near_value_ - near_expected_) <= (tolerance)))                                      \
      fail_msg("%s = %.9g, expected %.9g", #value, near_value_, near_expected_);                   \
  } while (0)

/* Pike (1977): depth 0.196 D^1.010 and rim 0.036 D^1.014 of simple craters, 1.044 D^0.301 and
 * 0.236 D^0.399 of complex ones, all in km. A diameter in m in place of km would be off by 7 %. */
static void test_fresh_dimensions(void **state) {
  (void)state;
  pl_crater_dimensions fresh = pl_crater_fresh(1000.0);
  NEAR(fresh.depth_m, 196.0, 1e-9);
  NEAR(fresh.rim_m, 36.0, 1e-9);
  NEAR(fresh.ejecta_m, 0.14 * pow(500.0, 0.74), 1e-9);
  assert_true(fresh.peak_m == 0.0);
  fresh = pl_crater_fresh(5000.0);
  NEAR(fresh.depth_m, 196.0 * pow(5.0, 1.010), 1e-9);
  fresh = pl_crater_fresh(30e3);
  NEAR(fresh.depth_m, 1044.0 * pow(30.0, 0.301), 1e-9);
  NEAR(fresh.rim_m, 236.0 * pow(30.0, 0.399), 1e-9);
  NEAR(fresh.peak_m, 32.0 * pow(30.0, 0.9), 1e-9);
  NEAR(fresh.floor, 0.187 * pow(30.0, 0.249), 1e-9);
  /* Stopar et al. (2017): d/D of 0.13 between 40 and 100 m, 0.15 up to 200 m, 0.17 up to 400 m. */
  NEAR(pl_crater_fresh(70.0).depth_m / 70.0, 0.13, 0.01);
  NEAR(pl_crater_fresh(150.0).depth_m / 150.0, 0.15, 0.01);
  NEAR(pl_crater_fresh(300.0).depth_m / 300.0, 0.17, 0.01);
  /* Rims in m: 0.0327 D^1.014, less where depths are less than 0.1829 D^1.010. Ejecta of small
   * craters by the law for large ones would be higher than the whole rim. */
  for (double d = 0.01; d < 26.0; d *= 1.5) {
    fresh = pl_crater_fresh(d);
    const double fraction = fresh.depth_m / (0.1829 * pow(d, 1.010));
    NEAR(fresh.rim_m, fraction * 0.0327 * pow(d, 1.014), 0.002 * fresh.rim_m);
    NEAR(fresh.ejecta_m, 0.5 * fresh.rim_m, 1e-12);
  }
}

/* What is thrown out comes from inside: the net volume is between 0 and minus a third of the
 * bowl's, so that no crater diffuses to a mound. */
static void test_volumes(void **state) {
  for (double d = 0.01; d < 10e3; d *= 2.0) {
    const pl_crater_dimensions fresh = pl_crater_fresh(d);
    float profile[PL_CRATER_KNOTS];
    pl_crater_profile(*state, &fresh, 0.0, profile);
    double volume = 0.0, bowl = 0.0;
    for (double x = 0.0005; x < 3.0; x += 0.001) {
      const double ring = x * pl_crater_profile_height(profile, x);
      volume += ring;
      bowl += fmin(ring, 0.0);
    }
    assert_true(bowl < 0.0 && volume < 0.0 && volume > 0.333 * bowl);
  }
}

static void test_dimensions_are_continuous(void **state) {
  (void)state;
  pl_crater_dimensions before = pl_crater_fresh(0.01);
  for (double d = 0.01; d < 400e3; d *= 1.001) {
    const pl_crater_dimensions fresh = pl_crater_fresh(d);
    if (!(fresh.depth_m >= 0.9995 * before.depth_m && fresh.depth_m < 1.005 * before.depth_m))
      fail_msg("depth %g of a crater of %g m, after %g", fresh.depth_m, d, before.depth_m);
    assert_true(fresh.rim_m >= before.rim_m && fresh.rim_m < 1.005 * before.rim_m);
    assert_true(fresh.ejecta_m <= 0.5 * fresh.rim_m * (1.0 + 1e-12));
    assert_true(fresh.rim_m < 0.5 * fresh.depth_m);
    assert_true(fresh.peak_m < 0.501 * fresh.depth_m);
    before = fresh;
  }
}

/* 5.5 m^2 per Myr at 1 km and the exponent 0.9: tau 0.077 in 3.5 Ga; no step at any size. */
static void test_tau(void **state) {
  (void)state;
  NEAR(pl_crater_tau(1000.0, 3.5, 5.5, 0.9), 0.077, 1e-12);
  NEAR(pl_crater_tau(100.0, 1.0, 5.5, 0.9), 1000.0 * 5.5 * pow(0.1, 0.9) / 2500.0, 1e-12);
  NEAR(pl_crater_tau(125.01, 1.0, 5.5, 0.9) / pl_crater_tau(124.99, 1.0, 5.5, 0.9), 1.0, 1e-3);
}

/* Heights over D of a crater of Fassett and Thomson (2014) at 0, 0.2, 0.4, 0.6, 0.8, 0.9, 1, 1.1,
 * 1.2, 1.5 and 2 R: an axisymmetric solution on finite volumes whose digits two grids agree on. */
enum { TIMES = 4, RADII = 11, RINGS = 512 };
static const double taus[TIMES] = {0.01, 0.05, 0.1, 0.3};
static const double radii[RADII] = {0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0, 1.1, 1.2, 1.5, 2.0};
static const double heights[TIMES][RADII] = {
    {-0.17341, -0.15924, -0.11868, -0.06596, -0.01346, 0.00675, 0.01806, 0.01997, 0.01598, 0.00236,
     0.0},
    {-0.12398, -0.11419, -0.08792, -0.05348, -0.02168, -0.00967, -0.00104, 0.00423, 0.00664,
     0.00461, 0.00029},
    {-0.08528, -0.07963, -0.06445, -0.04428, -0.02460, -0.01636, -0.00963, -0.00451, -0.00094,
     0.00279, 0.00089},
    {-0.03294, -0.03186, -0.02880, -0.02430, -0.01908, -0.01643, -0.01387, -0.01145, -0.00925,
     -0.00414, -0.00035}};

/* Height over D at x of the fresh simple crater of Fassett and Thomson (2014): the profile whose
 * diffusion they published. */
static double fassett_thomson(double x) {
  if (x <= 0.98)
    return fmax(-0.181, -0.228809953 + x * (0.227533882 + x * (0.083116795 - x * 0.039499407)));
  if (x <= 1.5)
    return 0.188253307 + x * (-0.187050452 + x * (0.018447460 + x * 0.015056470));
  return 0.0;
}

static void test_diffusion(void **state) {
  (void)state;
  const double width = 8.0 / RINGS;
  static double z[RINGS], scratch[3 * RINGS];
  double volume = 0.0;
  for (int i = 0; i < RINGS; i++) {
    z[i] = 0.0;
    for (int k = 0; k < 8; k++)
      z[i] += fassett_thomson((i + (k + 0.5) / 8.0) * width) / 8.0;
    volume += 2.0 * 3.14159265358979 * (i + 0.5) * width * width * z[i];
  }
  NEAR(volume, -0.10851, 2e-4);
  double before = 0.0;
  for (int time = 0; time < TIMES; time++) {
    pl_radial_diffuse(z, 1, RINGS, width, taus[time] - before, 100, time == 0, scratch);
    before = taus[time];
    for (int k = 0; k < RADII; k++) {
      const double at = fmax(radii[k] / width - 0.5, 0.0);
      const int i = (int)at;
      NEAR(z[i] + (at - i) * (z[i + 1] - z[i]), heights[time][k], 2.5e-4);
    }
    double now = 0.0;
    for (int i = 0; i < RINGS; i++)
      now += 2.0 * 3.14159265358979 * (i + 0.5) * width * width * z[i];
    NEAR(now, volume, 1e-12);
  }
}

/* A step 1e6 times that which explicit steps allow stays bounded, without a checkerboard. */
static void test_long_steps_are_stable(void **state) {
  (void)state;
  double z[64], scratch[3 * 64];
  for (int i = 0; i < 64; i++)
    z[i] = i < 8 ? -1.0 : 0.0;
  pl_radial_diffuse(z, 1, 64, 0.125, 4000.0, 4, 1, scratch);
  for (int i = 1; i < 64; i++)
    assert_true(z[i] >= z[i - 1] - 1e-12 && z[i] <= 0.0 && z[i] >= -1.0);
}

static const pl_crater_shapes *shapes_of(void **state) { return *state; }

static void test_fresh_profile(void **state) {
  const double diameters[] = {0.05, 10.0, 300.0, 1000.0, 5000.0, 40e3, 200e3};
  for (int i = 0; i < 7; i++) {
    const pl_crater_dimensions fresh = pl_crater_fresh(diameters[i]);
    float profile[PL_CRATER_KNOTS];
    pl_crater_profile(shapes_of(state), &fresh, 0.0, profile);
    const double floor = fresh.rim_m - fresh.depth_m;
    NEAR(pl_crater_profile_height(profile, 1.0), fresh.rim_m, 1e-6 * fresh.rim_m);
    NEAR(pl_crater_profile_height(profile, 0.0), floor + fresh.peak_m, 1e-5 * fresh.depth_m);
    if (fresh.floor > 0.35)
      NEAR(pl_crater_profile_height(profile, 0.33), floor, 0.01 * fresh.depth_m);
    /* Ejecta: a power of the distance, below the rim, none at the reach. */
    const double y = 1.0 + 1.0 / 1.05;
    const double ejecta =
        (fresh.rim_m - fresh.ejecta_m) * pow(y, -4.2) + fresh.ejecta_m * pow(y, -3.0);
    NEAR(pl_crater_profile_height(profile, 2.0), ejecta, 0.01 * ejecta);
    assert_true(pl_crater_profile_height(profile, PL_CRATER_REACH) == 0.0);
    assert_true(pl_crater_profile_height(profile, 1e9) == 0.0);
    NEAR(pl_crater_profile_height(profile, 2.999999), 0.0, 1e-6 * fresh.rim_m);
    for (double x = 1.05; x < 3.0; x += 0.01)
      assert_true(pl_crater_profile_height(profile, x) <=
                  pl_crater_profile_height(profile, x - 0.01) + 1e-6 * fresh.rim_m);
  }
}

/* Fraction of the depth from rim to centre that is left: 0.975, 0.889, 0.602, 0.405, 0.152 and
 * 0.043 for the profile of Fassett and Thomson. Ours has another flank and a sharper crest. */
static void test_degraded_depth(void **state) {
  const double tau[6] = {1e-3, 0.01, 0.05, 0.1, 0.3, 1.0};
  const double left[6] = {0.975, 0.889, 0.602, 0.405, 0.152, 0.043};
  const pl_crater_dimensions fresh = {
      .depth_m = 0.21772, .rim_m = 0.03672, .ejecta_m = 0.0139, .floor = 0.2};
  for (int k = 0; k < 6; k++) {
    float profile[PL_CRATER_KNOTS];
    pl_crater_profile(shapes_of(state), &fresh, tau[k], profile);
    float top = -1.0f;
    for (int i = 1; i < PL_CRATER_KNOTS; i++)
      top = fmaxf(top, profile[i]);
    NEAR(((double)top - pl_crater_profile_height(profile, 0.0)) / fresh.depth_m, left[k],
         0.01 + 0.06 * left[k]);
  }
}

/* Neither time nor size makes a crater jump. */
static void test_profiles_are_continuous(void **state) {
  const pl_crater_dimensions fresh = pl_crater_fresh(1000.0);
  float before[PL_CRATER_KNOTS], now[PL_CRATER_KNOTS];
  pl_crater_profile(shapes_of(state), &fresh, 0.0, before);
  for (double tau = 1e-5; tau < 4.0; tau *= 1.05) {
    pl_crater_profile(shapes_of(state), &fresh, tau, now);
    for (int k = 0; k < PL_CRATER_KNOTS; k++)
      assert_true(fabsf(now[k] - before[k]) < 4.0f);
    memcpy(before, now, sizeof now);
  }
  for (double x = 0.0; x < 3.1; x += 1e-3)
    assert_true(fabs(pl_crater_profile_height(now, x + 1e-6) - pl_crater_profile_height(now, x)) <
                1e-3);
}

static int create(void **state) {
  pl_crater_shapes *shapes;
  const pl_status status = pl_crater_shapes_create(&shapes);
  *state = shapes;
  return status != PL_OK;
}
static int destroy(void **state) {
  pl_crater_shapes_destroy(*state);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_fresh_dimensions),
      cmocka_unit_test(test_dimensions_are_continuous),
      cmocka_unit_test(test_volumes),
      cmocka_unit_test(test_tau),
      cmocka_unit_test(test_diffusion),
      cmocka_unit_test(test_long_steps_are_stable),
      cmocka_unit_test(test_fresh_profile),
      cmocka_unit_test(test_degraded_depth),
      cmocka_unit_test(test_profiles_are_continuous),
  };
  return cmocka_run_group_tests(tests, create, destroy);
}
