/* The sun's disc: irradiance, sampling, coverage. */
#include "harness.h"

#include "light/sun.h"
#include "math/sampling.h"
#include "random.h"

static const double AU = 149597870700.0, SUN_RADIUS_M = 695700e3;

static pl_shot_sun sun_at(pl_vec3 position) {
  return (pl_shot_sun){.position = position, .radius_m = SUN_RADIUS_M, .irradiance_au = 1361.0};
}

static void test_irradiance(void **state) {
  (void)state;
  /* Mercury's perihelion to Neptune. */
  for (double au = 0.3; au < 31.0; au *= 1.5) {
    const pl_shot_sun sun = sun_at((pl_vec3){0, au * AU, 0});
    const pl_sun_view view = pl_sun_view_at(&sun, (pl_vec3){0, 0, 0});
    const double sine = (double)view.sin_radius;
    assert_true(fabs((double)view.irradiance - 1361.0 / (au * au)) < 1e-6 * 1361.0 / (au * au));
    assert_true(fabs(sine * au * AU / SUN_RADIUS_M - 1.0) < 1e-6);
    /* E = pi sin^2(a) L for a uniform disc. */
    const double e = PL_PI * sine * sine * (double)view.radiance;
    assert_true(fabs(e / (double)view.irradiance - 1.0) < 1e-6);
    const double one_minus_cos = sine * sine / (1.0 + sqrt(1.0 - sine * sine));
    assert_true(fabs((double)view.one_minus_cos / one_minus_cos - 1.0) < 1e-6);
    assert_true(fabs((double)view.distance_m / (au * AU) - 1.0) < 1e-6);
  }
}

/* In [0, 1): 24 bits, which are not rounded. */
static float below_one(test_random *random) {
  return (float)random_below(random, 1 << 24) * 0x1p-24f;
}

/* The radiance does not depend on distance. */
static void test_radiance_is_constant(void **state) {
  (void)state;
  const pl_shot_sun sun = sun_at((pl_vec3){AU, 0, 0});
  const float near = pl_sun_view_at(&sun, (pl_vec3){0.5 * AU, 0, 0}).radiance;
  const float far = pl_sun_view_at(&sun, (pl_vec3){-20 * AU, 0, 0}).radiance;
  assert_true(fabsf(near / far - 1.0f) < 1e-5f);
}

static void test_samples_lie_in_the_disc(void **state) {
  (void)state;
  test_random random = {.seed = 31};
  int outside = 0, total = 0;
  for (int k = 0; k < 50; k++) {
    const pl_shot_sun sun =
        sun_at(pl_vec3_scale(random_direction(&random), random_scale(&random, 0.02, 35.0) * AU));
    const pl_sun_view view = pl_sun_view_at(&sun, (pl_vec3){0, 0, 0});
    const pl_vec3 center = pl_vec3_unit(sun.position);
    const double limit = (double)view.sin_radius;
    for (int i = 0; i < 2000; i++, total++) {
      const float u[2] = {below_one(&random), below_one(&random)};
      const pl_vec3f d = pl_sun_sample(&view, u);
      const double sine = pl_vec3_norm(pl_vec3_cross(center, pl_vec3f_to_double(d)));
      assert_true(fabsf(pl_vec3f_norm(d) - 1.0f) < 1e-6f);
      assert_true(sine <= limit + 2e-7); /* float directions */
      outside += !pl_sun_covers(&view, d);
    }
  }
  print_message("seed 31: %d of %d samples rounded off the disc\n", outside, total);
  assert_true(outside < total / 100);
}

/* One over the density is the disc's solid angle: the mean of f/pdf over samples. */
static void test_density(void **state) {
  (void)state;
  const pl_shot_sun sun = sun_at((pl_vec3){0, 0, AU});
  const pl_sun_view view = pl_sun_view_at(&sun, (pl_vec3){0, 0, 0});
  const double angle = asin(SUN_RADIUS_M / AU);
  const double solid = 2.0 * PL_PI * (1.0 - cos(angle));
  assert_true(fabs(1.0 / (double)pl_sun_pdf(&view) / solid - 1.0) < 1e-5);
}

/* Rays on a fine grid about the sun: the covered area is that of the disc, 0.00465 rad. The count
 * of lattice points in a circle is off by less than 2 pi radii (Gauss gave 2 sqrt(2) pi r). */
static void test_covers_by_area(void **state) {
  (void)state;
  const pl_shot_sun sun = sun_at((pl_vec3){0.6 * AU, -0.48 * AU, 0.64 * AU});
  const pl_sun_view view = pl_sun_view_at(&sun, (pl_vec3){0, 0, 0});
  const pl_basis basis = pl_basis_make(view.direction);
  const double angle = asin(SUN_RADIUS_M / pl_vec3_norm(sun.position)), radius = 400.0;
  const double step = tan(angle) / radius;
  double count = 0.0;
  for (int y = -420; y <= 420; y++)
    for (int x = -420; x <= 420; x++)
      count += pl_sun_covers(
          &view, pl_vec3f_unit(pl_basis_to_world(
                     &basis, pl_vec3f_make((float)(x * step), (float)(y * step), 1.0f))));
  assert_true(fabs(angle - 0.00465) < 1e-5);
  assert_true(fabs(count - PL_PI * radius * radius) < 2.0 * PL_PI * radius);
  assert_false(pl_sun_covers(&view, pl_vec3f_scale(view.direction, -1.0f)));
}

static void test_inside_the_sun(void **state) {
  (void)state;
  const pl_shot_sun sun = sun_at((pl_vec3){1e8, 0, 0});
  const pl_sun_view view = pl_sun_view_at(&sun, (pl_vec3){0, 0, 0});
  assert_true(view.sin_radius == 1.0f && view.one_minus_cos == 1.0f);
  assert_true(isfinite(view.radiance) && isfinite(pl_sun_pdf(&view)));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_irradiance),
      cmocka_unit_test(test_radiance_is_constant),
      cmocka_unit_test(test_samples_lie_in_the_disc),
      cmocka_unit_test(test_density),
      cmocka_unit_test(test_covers_by_area),
      cmocka_unit_test(test_inside_the_sun),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
