/* Cellular texture against a search of all cells within four, its means, and its filter. Random
 * points are drawn from fixed seeds; bounds on statistics lie at five standard errors or more. */
#include "harness.h"
#include "cellular_points.h"
#include "math/lattice.h"
#include "textures.h"

/* The sites are those of the code under test, from the hashes of their cells; the search is not. */
enum { FAR = 4, CELLS = 2 * FAR + 1, SITES = CELLS * CELLS * CELLS };

static pl_vec3 site_of(const int64_t cell[3], float randomness, uint32_t seed) {
  uint32_t hash = pl_sampler_mix(seed);
  for (int axis = 2; axis >= 0; axis--)
    hash = pl_lattice_hash(hash, (uint32_t)cell[axis]);
  double at[3];
  for (uint32_t axis = 0; axis < 3; axis++) {
    const uint32_t bits = axis ? pl_lattice_hash(hash, axis) : hash;
    at[axis] = (double)cell[axis] + 0.5 + (double)randomness * ((bits >> 8) * 0x1p-24 - 0.5);
  }
  return pl_vec3_make(at[0], at[1], at[2]);
}

static int sites_around(pl_vec3 p, float randomness, uint32_t seed, pl_vec3 sites[SITES]) {
  const double x[3] = {floor(p.x), floor(p.y), floor(p.z)};
  for (int k = 0; k < SITES; k++) {
    const int64_t cell[3] = {(int64_t)x[0] + k % CELLS - FAR,
                             (int64_t)x[1] + k / CELLS % CELLS - FAR,
                             (int64_t)x[2] + k / CELLS / CELLS - FAR};
    sites[k] = pl_vec3_sub(site_of(cell, randomness, seed), p);
  }
  return SITES;
}

static void check_against_all(pl_vec3 p, float randomness, uint32_t seed) {
  static pl_vec3 sites[SITES];
  const int count = sites_around(p, randomness, seed, sites);
  int nearest = 0;
  double second = INFINITY, edge = INFINITY, sum = 0.0;
  for (int k = 1; k < count; k++)
    if (pl_vec3_norm(sites[k]) < pl_vec3_norm(sites[nearest]))
      nearest = k;
  const double first = pl_vec3_norm(sites[nearest]), s = 0.6 / 8.0;
  for (int k = 0; k < count; k++) {
    const double d = pl_vec3_norm(sites[k]);
    sum += exp((first - d) / s);
    if (k == nearest)
      continue;
    const pl_vec3 across = pl_vec3_sub(sites[k], sites[nearest]);
    second = fmin(second, d);
    edge = fmin(edge, (d * d - first * first) / (2.0 * pl_vec3_norm(across)));
  }
  const cellular found = cellular_find(p, randomness, seed);
  assert_true(fabs((double)found.first - first) < 1e-6);
  assert_true(fabs((double)found.second - second) < 1e-6);
  assert_true(fabs((double)cellular_edge(p, randomness, seed, NULL) - edge) < 2e-6);
  const double smooth = (double)cellular_smooth(p, randomness, 0.6f, seed);
  assert_true(fabs(smooth - (first - s * log(sum))) < 1e-4);
  if (second - first > 1e-5)
    assert_true(pl_vec3_norm(pl_vec3_sub(pl_vec3f_to_double(found.to_site), sites[nearest])) <
                1e-6);
}

static void test_search_is_exact(void **state) {
  (void)state;
  test_random random = {31, 0};
  static const float randomness[] = {1.0f, 0.7f, 0.2f, 0.0f};
  for (int i = 0; i < PL_DRAWS(12000, 1500); i++)
    check_against_all(random_point(&random, i % 3 ? 100.0 : 1e7), randomness[i & 3], (uint32_t)i);
}

/* Where sites are far the search must leave the cells next to the point: the worst of many points.
 */
static void test_far_sites(void **state) {
  (void)state;
  test_random random = {32, 0};
  int beyond = 0;
  for (int i = 0; i < PL_DRAWS(300000, 30000); i++) {
    const pl_vec3 p = random_point(&random, 1e4);
    if (cellular_find(p, 1.0f, 3).second > 1.0f) {
      check_against_all(p, 1.0f, 3);
      beyond++;
    }
  }
  assert_true(beyond > PL_DRAWS(1000, 100));
}

static void test_continuity(void **state) {
  (void)state;
  test_random random = {33, 0};
  for (int i = 0; i < PL_DRAWS(30000, 3000); i++) {
    pl_vec3 below = random_point(&random, 5.0), above = below;
    above.y = (double)random_below(&random, 9) - 4.0;
    below.y = nextafter(above.y, -INFINITY);
    const cellular a = cellular_find(below, 1.0f, 1), b = cellular_find(above, 1.0f, 1);
    assert_true(fabsf(a.first - b.first) < 1e-6f && fabsf(a.second - b.second) < 1e-6f);
    assert_true(fabsf(cellular_edge(below, 1.0f, 1, NULL) - cellular_edge(above, 1.0f, 1, NULL)) <
                3e-6f);
    assert_true(fabsf(cellular_smooth(below, 1.0f, 1.0f, 1) -
                      cellular_smooth(above, 1.0f, 1.0f, 1)) < 1e-4f);
  }
}

/* The stated means hold; -to_site/first is the gradient; ids and colours are uniform. */
static void test_means(void **state) {
  (void)state;
  static const float randomness[] = {0.0f, 0.4f, 1.0f};
  const int points = 150000;
  for (size_t k = 0; k < 3; k++) {
    const float r = randomness[k];
    test_random random = {34 + k, 0};
    moments first = {0}, second = {0}, edge = {0}, smooth = {0}, red = {0};
    for (int i = 0; i < points; i++) {
      const pl_vec3 p = random_point(&random, 1e4);
      const cellular c = cellular_find(p, r, (uint32_t)i);
      moments_add(&first, (double)c.first);
      moments_add(&second, (double)c.second);
      moments_add(&edge, (double)cellular_edge(p, r, (uint32_t)i, NULL));
      moments_add(&smooth, (double)cellular_smooth(p, r, 0.5f, (uint32_t)i));
      moments_add(&red, (double)pl_cellular_color(c.id).x);
    }
    const double error = 5.0 * sqrt(moments_variance(&first) / points);
    assert_true(fabs(moments_mean(&first) - (double)pl_cellular_mean_first(r)) < 5e-4 + error);
    assert_true(fabs(moments_mean(&second) - (double)pl_cellular_mean_second(r)) < 5e-4 + error);
    assert_true(fabs(moments_mean(&edge) - (double)pl_cellular_mean_edge(r)) < 5e-4 + error);
    assert_true(fabs(moments_mean(&smooth) - (double)pl_cellular_mean_smooth(r, 0.5f)) <
                2e-3 + error);
    assert_true(fabs(moments_mean(&red) - 0.5) < 5.0 / sqrt(12.0 * points));
    assert_true(fabs(12.0 * moments_variance(&red) - 1.0) < 0.02);
  }
  /* Randomness 0: the mean distance of a unit cube from its middle, and from its faces six pyramids
   * of height 1/2: a quarter of that. */
  const double cube = sqrt(3.0) / 8.0 + log(2.0 + sqrt(3.0)) / 4.0 - PL_PI / 48.0;
  assert_true(fabs((double)pl_cellular_mean_first(0.0f) - cube) < 1e-4);
  assert_true(fabs((double)pl_cellular_mean_edge(0.0f) - 0.125) < 1e-6);
}

/* Rotation statistics: the direction to the nearest site has the moments of a sphere. */
static void test_isotropy(void **state) {
  (void)state;
  test_random random = {37, 0};
  const int points = 200000;
  double moment[3] = {0}, mean[3] = {0}, mixed = 0.0;
  for (int i = 0; i < points; i++) {
    const cellular c = cellular_find(random_point(&random, 1e4), 1.0f, 5);
    const double v[3] = {(double)c.to_site.x, (double)c.to_site.y, (double)c.to_site.z};
    const double d2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    for (int a = 0; a < 3; a++) {
      moment[a] += v[a] * v[a] / d2 / points;
      mean[a] += v[a] / sqrt(d2) / points;
    }
    mixed += v[0] * v[1] / d2 / points;
  }
  for (int a = 0; a < 3; a++) /* standard errors 0.3/sqrt(N) and 0.58/sqrt(N) */
    assert_true(fabs(moment[a] - 1.0 / 3.0) < 0.005 && fabs(mean[a]) < 0.0065);
  assert_true(fabs(mixed) < 0.003);
}

/* The faded first distance against the mean over discs, in standard deviations. */
static void test_filter(void **state) {
  (void)state;
  static const struct {
    double width, first, edge;
  } cases[] = {{0.1, 0.03, 0.07},
               {0.4, 0.16, 0.28},
               {1.0, 0.36, 0.40},
               {2.0, 0.40, 0.30},
               {6.0, 0.20, 0.12}};
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    test_random random = {38, 0};
    moments error = {0}, edge_error = {0}, first = {0}, edge = {0};
    const float m = pl_cellular_mean_first(1.0f), n = pl_cellular_mean_edge(1.0f);
    const float width = (float)cases[k].width;
    for (int i = 0; i < 400; i++) {
      const pl_vec3 p = random_point(&random, 1e3);
      const pl_quat axes = random_rotation(&random);
      double mean = 0.0, edge_mean = 0.0;
      for (int j = 0; j < 128; j++) {
        const pl_vec3 q = disc_point(p, axes, cases[k].width, j, 128);
        mean += (double)cellular_find(q, 1.0f, 4).first / 128.0;
        edge_mean += (double)cellular_edge(q, 1.0f, 4, NULL) / 128.0;
      }
      const float f = cellular_find(p, 1.0f, 4).first, e = cellular_edge(p, 1.0f, 4, NULL);
      moments_add(&first, (double)f);
      moments_add(&edge, (double)e);
      moments_add(&error, (double)(m + pl_cellular_fade(width) * (f - m)) - mean);
      moments_add(&edge_error, (double)(n + pl_cellular_edge_fade(width) * (e - n)) - edge_mean);
    }
    const double rms = sqrt(error.square / error.count / moments_variance(&first));
    const double edge_rms = sqrt(edge_error.square / edge_error.count / moments_variance(&edge));
    assert_true(rms < cases[k].first && edge_rms < cases[k].edge);
  }
  assert_true(pl_cellular_fade(0.0f) == 1.0f && pl_cellular_fade(INFINITY) == 0.0f);
  assert_true(pl_cellular_fade(NAN) == 0.0f);
  assert_true(pl_cellular_edge_fade(0.0f) == 1.0f && pl_cellular_edge_fade(1.5001f) == 0.0f);
}

static void test_odd_input(void **state) {
  (void)state;
  const pl_vec3 nowhere = {NAN, INFINITY, -1e300};
  const cellular c = cellular_find(nowhere, NAN, 1);
  assert_true(isfinite(c.first) && isfinite(c.second));
  assert_true(isfinite(cellular_edge(nowhere, INFINITY, 1, NULL)));
  assert_true(isfinite(cellular_smooth(nowhere, -1.0f, NAN, 1)));
  const pl_vec3 p = {1e7 + 0.3, -1e7 - 0.7, 0.2};
  assert_true(cellular_smooth(p, 1.0f, 0.0f, 1) == cellular_find(p, 1.0f, 1).first);
  assert_true(cellular_find(p, 2.0f, 1).first == cellular_find(p, 1.0f, 1).first);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_search_is_exact), cmocka_unit_test(test_far_sites),
      cmocka_unit_test(test_continuity),      converging_unit_test(test_means),
      converging_unit_test(test_isotropy),    converging_unit_test(test_filter),
      cmocka_unit_test(test_odd_input),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
