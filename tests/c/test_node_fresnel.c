/* Fresnel and layer weights against the equations, at their edges, and with bent normals. */
#include "graphs.h"

#include <math.h>

#include "random.h"

/* Seen at `cosine` from the normal z; `normal` is linked if not NULL. */
static float weight_of(const char *kind, const char *input, float x, float cosine,
                       const float *normal, size_t output) {
  test_graph g = {0};
  pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, 0.0f);
  pl_value v;
  const size_t node = graph_add(&g, kind);
  p.view = pl_vec3f_make(sqrtf(pl_maxf(0.0f, 1.0f - cosine * cosine)), 0.0f, cosine);
  graph_set(&g, node, input, x, x, x);
  if (normal != NULL)
    graph_set(&g, node, "normal", normal[0], normal[1], normal[2]);
  graph_value_at(g, node, output, &p, v);
  return v[0];
}

/* The mean of both polarisations by Snell's law and the amplitudes (Born and Wolf, 1.5.2). */
static double reflected(double n, double cosine) {
  const double sine = sqrt(1.0 - cosine * cosine) / n;
  if (sine >= 1.0)
    return 1.0;
  const double inside = sqrt(1.0 - sine * sine);
  const double s = (cosine - n * inside) / (cosine + n * inside);
  const double p = (n * cosine - inside) / (n * cosine + inside);
  return 0.5 * (s * s + p * p);
}

static void test_fresnel_is_that_of_the_equations(void **state) {
  (void)state;
  test_random random = {.seed = 2};
  for (int i = 0; i < 500; i++) {
    const double n = random_scale(&random, 0.4, 5.0), cosine = random_unit(&random);
    const double expected = reflected((double)(float)n, (double)(float)cosine);
    const float found = weight_of("fresnel", "ior", (float)n, (float)cosine, NULL, 0);
    if (!(fabs((double)found - expected) <
          2e-4)) /* near the critical angle the slope is infinite */
      fail_msg("n %g, cosine %g: %g, not %g", n, cosine, (double)found, expected);
  }
  assert_true(fabsf(weight_of("fresnel", "ior", 1.5f, 1.0f, NULL, 0) - 0.04f) < 1e-6f);
  /* At Brewster's angle, tan = n, one polarisation alone: ((n^2 - 1) / (n^2 + 1))^2 / 2. */
  const float brewster = 1.0f / sqrtf(1.0f + 2.25f);
  assert_true(fabsf(weight_of("fresnel", "ior", 1.5f, brewster, NULL, 0) - 0.0739645f) < 1e-6f);
}

static void test_edges(void **state) {
  (void)state;
  static const float odd[] = {0.0f, 1.0f, -1.0f, -3.0f, 1e-30f, 1e30f, 3e38f, 1.0f + 1e-7f};
  static const float cosine[] = {0.0f, 1e-7f, 0.5f, 1.0f, -0.5f};
  for (size_t i = 0; i < 8; i++)
    for (size_t k = 0; k < 5; k++) {
      const float f = weight_of("fresnel", "ior", odd[i], cosine[k], NULL, 0);
      const float a = weight_of("layer_weight", "blend", odd[i], cosine[k], NULL, 0);
      const float b = weight_of("layer_weight", "blend", odd[i], cosine[k], NULL, 1);
      assert_true(f >= 0.0f && f <= 1.0f && a >= 0.0f && a <= 1.0f && b >= 0.0f && b <= 1.0f);
    }
  assert_true(weight_of("fresnel", "ior", 1.0f, 0.0f, NULL, 0) == 0.0f);
  assert_true(weight_of("fresnel", "ior", 1.5f, 0.0f, NULL, 0) == 1.0f);
  assert_true(weight_of("fresnel", "ior", 0.0f, 1.0f, NULL, 0) == 1.0f);
}

static void test_layer_weights(void **state) {
  (void)state;
  /* facing: 1 - cos^(2 blend) below 1/2, 1 - cos^(1 / (2 - 2 blend)) above. */
  static const float rows[][3] = {{0.5f, 0.6f, 0.4f}, {0.25f, 0.25f, 0.5f}, {0.75f, 0.5f, 0.75f},
                                  {0.0f, 0.3f, 0.0f}, {0.5f, 1.0f, 0.0f},   {0.5f, 0.0f, 1.0f},
                                  {1.0f, 0.9f, 1.0f}};
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
    assert_true(fabsf(weight_of("layer_weight", "blend", rows[i][0], rows[i][1], NULL, 1) -
                      rows[i][2]) < 1e-5f);
  for (float blend = 0.0f; blend < 0.95f; blend += 0.1f)
    assert_true(fabsf(weight_of("layer_weight", "blend", blend, 0.4f, NULL, 0) -
                      weight_of("fresnel", "ior", 1.0f / (1.0f - blend), 0.4f, NULL, 0)) < 1e-6f);
}

/* A bent normal counts, of any length, on whichever side the viewer is. */
static void test_normals_are_heeded(void **state) {
  (void)state;
  const float tilted[3] = {3.0f, 0.0f, 4.0f}, none[3] = {0.0f, 0.0f, 0.0f};
  const float away[3] = {-1.0f, 0.0f, 0.1f};
  const float seen = 0.6f * 0.8f + 0.8f * 0.6f; /* view (0.8, 0, 0.6) */
  assert_true(fabsf(weight_of("layer_weight", "blend", 0.5f, 0.6f, tilted, 1) - (1.0f - seen)) <
              1e-6f);
  assert_true(fabsf(weight_of("layer_weight", "blend", 0.5f, 0.6f, none, 1) - 0.4f) < 1e-6f);
  assert_true(fabsf(weight_of("layer_weight", "blend", 0.5f, -0.6f, none, 1) - 0.4f) < 1e-6f);
  assert_true(weight_of("layer_weight", "blend", 0.5f, 0.6f, away, 1) == 1.0f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_fresnel_is_that_of_the_equations),
      cmocka_unit_test(test_edges),
      cmocka_unit_test(test_layer_weights),
      cmocka_unit_test(test_normals_are_heeded),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
