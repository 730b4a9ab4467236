/* Limb darkening against the tabulated values of Neckel (2005), and what its effect row says. */
#include "harness.h"

#include "light/limb.h"
#include "random.h"

static const double AU = 149597870700.0;

static pl_sun_view sun(void) {
  const pl_shot_sun sun = {.position = {0, 0, AU}, .radius_m = 695700e3, .irradiance_au = 1361.0};
  return pl_sun_view_at(&sun, (pl_vec3){0, 0, 0});
}

static double ratio_at(const pl_limb *limb, double mu) {
  const pl_sun_view view = sun();
  const double sine = (double)view.sin_radius * sqrt(1.0 - mu * mu);
  const pl_vec3f d = {(float)sine, 0.0f, (float)sqrt(1.0 - sine * sine)};
  return (double)pl_limb_ratio(limb, &view, d).y;
}

/* Mean over centre, and intensity over that of the centre at mu = 0.5 and 0.1: evaluated apart from
 * this code from the published coefficients. */
static void test_values(void **state) {
  (void)state;
  const double rows[4][4] = {{0.44, 0.75433592, 0.6340735, 0.2684769},
                             {0.55, 0.8047566, 0.7106433, 0.3893373},
                             {0.68, 0.83877224, 0.7619659, 0.4763116},
                             {1.0, 0.88189939, 0.826792, 0.5905525}};
  for (int i = 0; i < 4; i++) {
    const pl_limb limb = pl_limb_make((const double[3]){0.5, rows[i][0], 0.9});
    const double center = ratio_at(&limb, 1.0);
    assert_true(fabs(1.0 / center - rows[i][1]) < 1e-6);
    assert_true(fabs(ratio_at(&limb, 0.5) / center - rows[i][2]) < 1e-5);
    assert_true(fabs(ratio_at(&limb, 0.1) / center - rows[i][3]) < 1e-4); /* float directions */
  }
}

/* The irradiance stays; a chord and half the disc differ from an even one by what the row says. */
static void test_moments(void **state) {
  (void)state;
  enum { RINGS = 2000, CHORDS = 400 };
  for (double um = 0.4226; um < 1.1; um += 0.05) {
    const pl_limb limb = pl_limb_make((const double[3]){um, um, um});
    static double across[CHORDS];
    double sum = 0.0, moment = 0.0, fraction = 0.0, even = 0.0, worst = 0.0;
    for (int i = 0; i < RINGS; i++) {
      const double r = (i + 0.5) / RINGS, light = ratio_at(&limb, sqrt(1.0 - r * r));
      sum += 2.0 * r * light / RINGS;
      moment += 2.0 / PL_PI * r * r * light / RINGS; /* of half: the mean of |cos| is 2/pi */
    }
    for (int i = 0; i < CHORDS; i++) {
      const double x = (i + 0.5) * 2.0 / CHORDS - 1.0, half = sqrt(1.0 - x * x);
      across[i] = 0.0;
      for (int k = 0; k < CHORDS; k++) {
        const double y = half * ((k + 0.5) * 2.0 / CHORDS - 1.0);
        across[i] += ratio_at(&limb, sqrt(fmax(0.0, 1.0 - x * x - y * y))) * half / CHORDS;
      }
      fraction += across[i] * 4.0 / (CHORDS * PL_PI);
      even += half * 4.0 / (CHORDS * PL_PI);
      worst = fmax(worst, fabs(fraction - even));
    }
    assert_true(fabs(sum - 1.0) < 1e-4);
    assert_true(2.0 / (3.0 * PL_PI) - moment < 0.0178 && moment < 2.0 / (3.0 * PL_PI));
    assert_true(worst < 0.0283);
  }
}

/* Between which numbers the disc's radiance over its mean lies, which bounds the row where lobes
 * are narrow. */
static void test_extremes(void **state) {
  (void)state;
  double least = 1.0, most = 1.0;
  for (double um = 0.40; um < 1.15; um += 0.005) {
    const pl_limb limb = pl_limb_make((const double[3]){um, um, um});
    for (int i = 0; i <= 200; i++) {
      const double ratio = ratio_at(&limb, i / 200.0);
      least = fmin(least, ratio);
      most = fmax(most, ratio);
    }
  }
  assert_true(1.0 - least < 0.834 && 1.0 - least > 0.82);
  assert_true(1.0 - 1.0 / most < 0.834);
}

/* Draws are as dense as the second band is bright: of random ones the part inside each ring is the
 * part of the light, within four standard errors. */
static void test_draws(void **state) {
  (void)state;
  enum { DRAWS = 160000, RINGS = 50 };
  test_random random = {.seed = 17};
  const pl_sun_view view = sun();
  for (double um = 0.4226; um < 1.1; um += 0.3) {
    const pl_limb limb = pl_limb_make((const double[3]){0.5, um, 0.5});
    double drawn[RINGS + 1] = {0.0}, light = 0.0, inside = 0.0;
    for (int i = 0; i < DRAWS; i++) {
      const float u[2] = {(float)random_unit(&random), (float)random_unit(&random)};
      pl_vec3f ratio;
      const pl_vec3f d = pl_limb_sample(&limb, &view, u, &ratio);
      const pl_vec3f there = pl_limb_ratio(&limb, &view, d);
      assert_true(fabsf(ratio.x - there.x) + fabsf(ratio.z - there.z) < 2e-3f); /* float rays */
      const double across = (double)pl_vec3f_norm(pl_vec3f_cross(view.direction, d));
      const double r = across / (double)view.sin_radius;
      assert_true(r <= 1.0 + 1e-4);
      drawn[(int)(r * RINGS)] += 1.0 / DRAWS;
    }
    for (int ring = 0; ring < RINGS; ring++) {
      for (int k = 0; k < 100; k++) {
        const double x = (ring + (k + 0.5) / 100.0) / RINGS;
        light += 0.02 * x * ratio_at(&limb, sqrt(1.0 - x * x)) / RINGS;
      }
      inside += drawn[ring];
      assert_true(fabs(light - inside) < 5e-3);
    }
  }
}

static void test_wavelengths_are_cut_off(void **state) {
  (void)state;
  const pl_limb cut = pl_limb_make((const double[3]){0.1, 5.0, 0.4226});
  const pl_limb ends = pl_limb_make((const double[3]){0.4226, 1.1, 0.4226});
  assert_memory_equal(&cut, &ends, sizeof cut);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_values),
      cmocka_unit_test(test_moments),
      cmocka_unit_test(test_extremes),
      cmocka_unit_test(test_draws),
      cmocka_unit_test(test_wavelengths_are_cut_off),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
