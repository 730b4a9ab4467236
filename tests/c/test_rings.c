/* Rings: one scattering in an even layer by quadrature, means of many intervals by their sum, parts
 * of cones by their single lines. */
#include "harness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "math/quadrature.h"
#include "random.h"
#include "rings/rings.h"

enum { MANY = 300 };

static pl_rings *make(const pl_rings_settings *settings) {
  pl_rings *rings;
  if (pl_rings_create(settings, &rings) != PL_OK)
    fail_msg("%s", pl_error_text());
  return rings;
}

static pl_rings *even_rings(double depth, double albedo, double exponent) {
  const double edges[2] = {1e8, 2e8}, albedos[3] = {albedo, 0.5 * albedo, 0.0};
  return make(&(pl_rings_settings){
      .count = 1, .edges_m = edges, .depth = &depth, .albedo = albedos, .exponent = exponent});
}

static double edges[MANY + 1], depths[MANY], albedos[3 * MANY];

/* Gaps, and depths of 1e-4 to 30. */
static pl_rings_settings random_rings(test_random *random) {
  edges[0] = random_scale(random, 0.1, 1e8);
  for (int i = 0; i < MANY; i++) {
    edges[i + 1] = edges[i] + edges[0] * random_range(random, 1e-4, 1e-2);
    depths[i] = random_unit(random) < 0.1 ? 0.0 : random_scale(random, 1e-4, 30.0);
    for (int k = 0; k < 3; k++)
      albedos[3 * i + k] = random_unit(random);
  }
  return (pl_rings_settings){.count = MANY,
                             .edges_m = edges,
                             .depth = depths,
                             .albedo = albedos,
                             .exponent = 2.0,
                             .dust_share = 0.3,
                             .dust_g = 0.7};
}

/* The phase function over the sphere; and that of Saturn's A ring, of mean 1, which Dones, Cuzzi
 * and Showalter (1993) give as 0.153 turn^3.092. */
static void test_phase(void **state) {
  (void)state;
  const pl_gauss rule = pl_gauss_make(64);
  const double exponents[] = {0.0, 1.0, 3.092, 12.0}, gs[] = {0.0, 0.6, -0.4, 0.8};
  const double edge[2] = {1.0, 2.0}, depth = 1.0, albedo[3] = {1.0, 1.0, 1.0};
  for (int i = 0; i < 16; i++) {
    pl_rings *rings = make(&(pl_rings_settings){.count = 1,
                                                .edges_m = edge,
                                                .depth = &depth,
                                                .albedo = albedo,
                                                .exponent = exponents[i % 4],
                                                .dust_share = 0.4,
                                                .dust_g = gs[i / 4]});
    double sum = 0.0, most = 0.0;
    for (int k = 0; k < 64; k++) {
      const double angle = 0.5 * PL_PI * (1.0 + rule.node[k]);
      const double value = pl_rings_phase(rings, cos(angle));
      sum += 0.5 * PL_PI * rule.weight[k] * 2.0 * PL_PI * sin(angle) * value;
      most = fmax(most, value);
    }
    assert_true(fabs(sum - 1.0) < 1e-6);
    assert_true(most <= pl_rings_light_bounds_of(rings).scattered * (1.0 + 1e-12));
    pl_rings_destroy(rings);
  }
  pl_rings *saturn = even_rings(1.0, 0.5, 3.092);
  for (int i = 0; i < 5; i++)
    assert_true(fabs(4.0 * PL_PI * pl_rings_phase(saturn, cos(0.5 + 0.5 * i)) /
                         (0.153 * pow(0.5 + 0.5 * i, 3.092)) -
                     1.0) < 3e-3);
  pl_rings_destroy(saturn);
}

/* Light that is scattered at a depth t reached exp(-t/mu0) and comes out by exp(-way/mu). */
static double slab(double depth, double mu, double sun_sine) {
  const double mu0 = fabs(sun_sine);
  const pl_gauss rule = pl_gauss_make(64);
  double sum = 0.0;
  for (int part = 0; part < 200; part++)
    for (int k = 0; k < 64; k++) {
      const double t = depth * (part + 0.5 + 0.5 * rule.node[k]) / 200.0;
      const double out = sun_sine > 0.0 ? t : depth - t;
      sum += 0.5 * depth / 200.0 * rule.weight[k] * exp(-t / mu0 - out / mu) / mu;
    }
  return sum;
}

static void test_even_layer(void **state) {
  (void)state;
  test_random random = {.seed = 5};
  for (int i = 0; i < 60; i++) {
    const double depth = random_scale(&random, 1e-3, 10.0);
    const double mu = random_scale(&random, 0.02, 1.0);
    double sine = random_scale(&random, 0.02, 1.0) * (i % 2 == 0 ? 1.0 : -1.0);
    if (i % 6 == 1)
      sine = -mu * (1.0 + (i % 4 == 1 ? 3e-4 : 0.0)); /* where the closed form is 0/0 */
    pl_rings *rings = even_rings(depth, 0.8, 0.0);
    const pl_rings_piece piece = {
        .fraction = 1.0, .low_m = 1.4e8, .high_m = 1.41e8, .sine = mu, .side = 1.0};
    const pl_rings_sun sun = {{sqrt(1.0 - sine * sine), 0.0, sine}, 1e-6};
    const pl_rings_light light = pl_rings_scatter(rings, &piece, (pl_vec3){0, 1, 0}, &sun);
    const double expected = 0.8 / (4.0 * PL_PI) * slab(depth, mu, sine);
    assert_true(fabs(light.scattered[0] - expected) < 1e-5 * expected + 1e-12);
    assert_true(fabs(light.scattered[1] - 0.5 * expected) < 1e-5 * expected + 1e-12);
    assert_true(light.scattered[2] == 0.0);
    assert_true(fabs(light.transmittance - exp(-depth / mu)) < 1e-12);
    pl_rings_destroy(rings);
  }
}

/* A sun that stands in the plane lights both sides; as it rises its strips become one sun. */
static void test_sun_in_the_plane(void **state) {
  (void)state;
  const double radius = 5e-4;
  pl_rings *rings = even_rings(5.0, 0.8, 0.0);
  const pl_rings_piece piece = {
      .fraction = 1.0, .low_m = 1.4e8, .high_m = 1.4e8, .sine = 0.3, .side = 1.0};
  double before = 0.0;
  for (int i = -60; i <= 60; i++) {
    const double sine = i * radius / 10.0, steps = 20000.0;
    const pl_rings_sun sun = {{sqrt(1.0 - sine * sine), 0.0, sine}, radius};
    const double found =
        pl_rings_scatter(rings, &piece, (pl_vec3){0, 1, 0}, &sun).scattered[0] * 4.0 * PL_PI / 0.8;
    /* Over the disc's strips; of a depth of 5 next to nothing comes through at this angle. */
    double expected = 0.0;
    for (int k = 0; k < (int)steps; k++) {
      const double y = -1.0 + (k + 0.5) * 2.0 / steps, height = sine + y * radius;
      expected +=
          height > 0.0 ? 4.0 / PL_PI * sqrt(1.0 - y * y) / steps * height / (0.3 + height) : 0.0;
    }
    assert_true(fabs(found - expected) < 0.02 * expected + 1e-2 * radius / 0.3);
    assert_true(found >= before - 1e-9);
    before = found;
  }
  pl_rings_destroy(rings);
}

/* Both sides together send on no more than they take. */
static void test_energy(void **state) {
  (void)state;
  const pl_gauss rule = pl_gauss_make(64);
  for (int i = 0; i < 24; i++) {
    const double depth = 0.05 * pow(2.0, i % 8), mu0 = 0.1 + 0.4 * (i / 8);
    pl_rings *rings = even_rings(depth, 1.0, 0.0);
    double sum = 0.0;
    for (int k = 0; k < 128; k++) {
      const double mu = 0.5 + 0.5 * rule.node[k / 2];
      const pl_rings_piece piece = {
          .fraction = 1.0, .low_m = 1.4e8, .high_m = 1.4e8, .sine = mu, .side = k % 2 ? 1.0 : -1.0};
      const pl_rings_sun sun = {{sqrt(1.0 - mu0 * mu0), 0.0, mu0}, 1e-6};
      sum += 0.5 * rule.weight[k / 2] * 2.0 * PL_PI * mu *
             pl_rings_scatter(rings, &piece, (pl_vec3){0, 1, 0}, &sun).scattered[0];
    }
    const double taken = mu0 * -expm1(-depth / mu0);
    assert_true(sum < taken);
    assert_true(sum > 0.1 * taken); /* the rest is scattered again */
    pl_rings_destroy(rings);
  }
}

static void test_averages(void **state) {
  (void)state;
  test_random random = {.seed = 8};
  double worst = 0.0;
  for (int round = 0; round < 400; round++) {
    const pl_rings_settings settings = random_rings(&random);
    pl_rings *rings = make(&settings);
    const double span = edges[MANY] - edges[0];
    const double low = edges[0] + span * random_range(&random, -0.1, 1.0);
    const double high = low + span * random_scale(&random, 1e-4, 1.2);
    const double c = random_scale(&random, 1.0, 1e6);
    double opacity = 0.0, lit = 0.0;
    for (int i = 0; i < MANY; i++) {
      const double width = fmax(0.0, fmin(high, edges[i + 1]) - fmax(low, edges[i]));
      opacity += width * -expm1(-depths[i] * c) / (high - low);
      lit += width * -expm1(-depths[i] * c) * albedos[3 * i + 1] / (high - low);
    }
    const pl_rings_mean found = pl_rings_average(rings, low, high, c);
    worst = fmax(worst, fmax(fabs(found.opacity - opacity), fabs(found.lit[1] - lit)));
    pl_rings_destroy(rings);
  }
  print_message("means off by %.2g\n", worst);
  assert_true(worst < 2e-4);
}

/* The opacity of one line of a cone. */
static double line_opacity(const pl_rings *rings, const pl_rings_ray *ray, double q) {
  const pl_vec3 d = ray->direction, o = ray->origin;
  const double across = hypot(d.x, d.y);
  const pl_vec3 n = {-d.z * d.x / across, -d.z * d.y / across, across};
  const pl_vec3 from = pl_vec3_madd(o, q * ray->width_m, n);
  const pl_vec3 along = pl_vec3_madd(d, q * ray->spread, n);
  const double t = -from.z / along.z;
  const pl_vec3 p = pl_vec3_madd(from, t, along);
  if (!(t > 0.0 && t < ray->end_m))
    return 0.0;
  const double r = hypot(p.x, p.y), norm = pl_vec3_norm(along);
  return pl_rings_average(rings, r, r, norm / fabs(along.z)).opacity;
}

/* Cones against a thousand of their lines: far and near, steep and within the plane. */
static void test_cones(void **state) {
  (void)state;
  enum { LINES = 2000, ROUNDS = 400 };
  test_random random = {.seed = 21};
  double worst = 0.0, mean = 0.0;
  int met = 0, several = 0;
  for (int round = 0; round < ROUNDS; round++) {
    pl_rings *rings = even_rings(random_scale(&random, 0.01, 5.0), 0.5, 1.0);
    const double height = 2e8 * random_scale(&random, 1e-7, 10.0) * (round % 2 ? 1.0 : -1.0);
    const double turn = random_range(&random, 0.0, 6.28), far = random_range(&random, 0.0, 3e9);
    pl_rings_ray ray = {.origin = {far * cos(turn), far * sin(turn), height}, .end_m = INFINITY};
    const double to = random_range(&random, 0.0, 6.28), at = random_range(&random, 0.5e8, 2.1e8);
    const pl_vec3 aim = {at * cos(to), at * sin(to), 0.0};
    ray.direction = pl_vec3_unit(pl_vec3_sub(aim, ray.origin));
    ray.spread = random_scale(&random, 1e-7, 1e-2);
    ray.width_m = round % 3 == 0 ? random_scale(&random, 1.0, 1e6) : 0.0;
    if (round % 5 == 0)
      ray.end_m = pl_vec3_norm(pl_vec3_sub(aim, ray.origin));
    double expected = 0.0;
    for (int i = 0; i < LINES; i++)
      expected += line_opacity(rings, &ray, (i + 0.5) / LINES - 0.5) / LINES;
    pl_rings_piece pieces[PL_RINGS_PIECES];
    const size_t count = pl_rings_cut(rings, &ray, pieces);
    double fraction = 0.0;
    for (size_t i = 0; i < count; i++) {
      fraction += pieces[i].fraction;
      assert_true(i == 0 || pieces[i].t >= pieces[i - 1].t * (1.0 - 1e-9));
      assert_true(pieces[i].t <= ray.end_m * (1.0 + 1e-2));
    }
    assert_true(fraction <= 1.0 + 1e-9);
    const double off = fabs(1.0 - pl_rings_passed(rings, &ray) - expected);
    worst = fmax(worst, off);
    mean += off / ROUNDS;
    met += count > 0;
    several += count > 1;
    pl_rings_destroy(rings);
  }
  print_message("cones off by %.2g at most, %.2g in the mean\n", worst, mean);
  assert_true(met > 200 && several > 20);
  assert_true(mean < 5e-3 && worst < 0.15);
}

/* Rays within the plane, along the normal, from the rings themselves, of no width, from the axis.
 */
static void test_special_rays(void **state) {
  (void)state;
  pl_rings *rings = even_rings(1.0, 0.5, 1.0);
  static const pl_vec3 origins[] = {{0, 0, 0},        {1.5e8, 0, 0}, {0, 0, 1e9},
                                    {1.5e8, 0, 1e-9}, {5e8, 0, 0},   {5e8, 0, 1e-9},
                                    {1.5e8, 0, 1},    {2e8, 0, -1},  {0, 1e8, -1e-30}};
  static const pl_vec3 directions[] = {{0, 0, 1},         {0, 0, -1},    {1, 0, 0},
                                       {-1, 0, 0},        {0, -1, 0},    {-1, 0, -1e-18},
                                       {-0.6, -0.8, 0.0}, {0.6, 0, -0.8}};
  for (size_t i = 0; i < sizeof origins / sizeof *origins; i++)
    for (size_t k = 0; k < sizeof directions / sizeof *directions; k++)
      for (int wide = 0; wide < 3; wide++) {
        const pl_rings_ray ray = {.origin = origins[i],
                                  .direction = directions[k],
                                  .width_m = wide == 2 ? 10.0 : 0.0,
                                  .spread = wide == 0 ? 0.0 : 1e-3,
                                  .end_m = INFINITY};
        pl_rings_piece pieces[PL_RINGS_PIECES];
        const size_t count = pl_rings_cut(rings, &ray, pieces);
        const double transmittance = pl_rings_passed(rings, &ray);
        assert_true(transmittance >= 0.0 && transmittance <= 1.0);
        for (size_t n = 0; n < count; n++) {
          const pl_rings_sun sun = {{1.0, 0.0, 0.0}, 0.005};
          const pl_rings_light light = pl_rings_scatter(rings, &pieces[n], ray.direction, &sun);
          assert_true(isfinite(light.scattered[0]) && light.scattered[0] >= 0.0);
          assert_true(light.transmittance >= 0.0 && light.transmittance <= 1.0);
        }
        if (origins[i].z == 0.0 && wide == 0)
          assert_true(transmittance == 1.0);
      }
  /* Straight down on the middle of the rings. */
  const pl_rings_ray down = {.origin = {1.5e8, 0, 1e6}, .direction = {0, 0, -1}, .end_m = INFINITY};
  assert_true(fabs(pl_rings_passed(rings, &down) - exp(-1.0)) < 1e-9);
  pl_rings_destroy(rings);
}

static void expect(pl_rings_settings settings, const char *text) {
  pl_rings *rings = NULL;
  assert_int_equal(pl_rings_create(&settings, &rings), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), text));
}

static void test_bad_settings(void **state) {
  (void)state;
  test_random random = {.seed = 2};
  const pl_rings_settings good = random_rings(&random);
  pl_rings_settings bad = good;
  bad.count = 0;
  expect(bad, "intervals");
  bad = good;
  bad.dust_g = 1.0;
  expect(bad, "dust g");
  bad = good;
  bad.exponent = NAN;
  expect(bad, "exponent");
  depths[7] = -1.0;
  expect(good, "optical depth");
  depths[7] = 1.0;
  albedos[7] = 1.5;
  expect(good, "albedo");
  albedos[7] = 1.0;
  edges[8] = edges[7];
  expect(good, "must rise");
}

static int left;

static void *fail_later(void *context, size_t size) {
  (void)context;
  return left-- > 0 ? malloc(size) : NULL;
}

static void test_memory(void **state) {
  (void)state;
  test_random random = {.seed = 2};
  const pl_rings_settings settings = random_rings(&random);
  for (int allowed = 0; allowed < 6; allowed++) {
    pl_rings *rings = NULL;
    left = allowed;
    pl_memory_hook(fail_later, NULL);
    const pl_status status = pl_rings_create(&settings, &rings);
    pl_memory_hook(NULL, NULL);
    assert_int_equal(status, allowed < 5 ? PL_E_MEMORY : PL_OK);
    if (status == PL_OK)
      pl_rings_destroy(rings);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_phase),
      cmocka_unit_test(test_even_layer),
      cmocka_unit_test(test_sun_in_the_plane),
      cmocka_unit_test(test_energy),
      cmocka_unit_test(test_averages),
      cmocka_unit_test(test_cones),
      cmocka_unit_test(test_special_rays),
      cmocka_unit_test(test_bad_settings),
      cmocka_unit_test(test_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
