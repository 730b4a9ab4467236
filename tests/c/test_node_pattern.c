/* Nodes of procedural patterns against the functions they stand on, their means, and bump. */
#include "graphs.h"

#include "cellular_points.h"
#include "math/fractal.h"
#include "math/pattern.h"
#include "random.h"

static const char *const patterns[] = {"noise",       "musgrave", "voronoi", "wave",
                                       "white_noise", "checker",  "brick",   "panel"};
enum { PATTERNS = sizeof patterns / sizeof patterns[0] };

/* A pattern of the object's coordinates. */
static size_t add_pattern(test_graph *g, const char *kind, float scale) {
  const size_t where = graph_add(g, "coordinates"), node = graph_add(g, kind);
  graph_link(g, node, "vector", where, 0);
  graph_set(g, node, "scale", scale, scale, scale);
  return node;
}

static float number_at(const test_graph *g, size_t node, size_t output, float x, float y, float z,
                       float radius) {
  const pl_graph_point p = graph_point(x, y, z, radius);
  pl_value v;
  graph_value_at(*g, node, output, &p, v);
  return v[0];
}

/* Coordinates are scaled, a radius becomes the diameter or the side of the square of its area. */
static void test_values_are_those_of_the_functions(void **state) {
  (void)state;
  test_graph g = {0};
  const pl_vec3 p = {3.0, -1.5, 0.75}; /* twice the point below: exact */
  const float x = 1.5f, y = -0.75f, z = 0.375f, radius = 0.05f;
  const float width = 4.0f * radius, side = 2.0f * sqrtf(PL_PI_F) * radius;
  const size_t noise = add_pattern(&g, "noise", 2.0f);
  graph_constant(&g, noise, "seed")->number = 4e9;
  const pl_fractal shape = {
      .octaves = 4.0f, .roughness = 0.5f, .lacunarity = 2.0f, .seed = 4000000000u};
  const float fbm = pl_fractal_rows[PL_FRACTAL_FBM].evaluate(&shape, p, width);
  assert_true(fabsf(number_at(&g, noise, 0, x, y, z, radius) - 0.5f - 0.5f * fbm) < 1e-6f);
  const size_t voronoi = add_pattern(&g, "voronoi", 2.0f);
  const cellular cell = cellular_find(p, 1.0f, 0);
  assert_true(number_at(&g, voronoi, 0, x, y, z, 0.0f) == cell.first);
  assert_true(fabsf(number_at(&g, voronoi, 1, x, y, z, 0.0f) - pl_cellular_color(cell.id).x) <
              1e-6f);
  graph_choose(&g, voronoi, "feature", "second");
  assert_true(fabsf(number_at(&g, voronoi, 0, x, y, z, 0.0f) - cell.second) < 1e-6f);
  graph_choose(&g, voronoi, "feature", "edge");
  assert_true(fabsf(number_at(&g, voronoi, 0, x, y, z, 0.0f) - cellular_edge(p, 1.0f, 0, NULL)) <
              1e-6f);
  graph_choose(&g, voronoi, "feature", "smooth");
  assert_true(fabsf(number_at(&g, voronoi, 0, x, y, z, 0.0f) - cellular_smooth(p, 1.0f, 0.5f, 0)) <
              1e-6f);
  const size_t white = add_pattern(&g, "white_noise", 2.0f);
  assert_true(number_at(&g, white, 0, x, y, z, radius) == pl_white_noise(p, side, 0));
  const size_t checker = add_pattern(&g, "checker", 2.0f);
  assert_true(number_at(&g, checker, 1, x, y, z, radius) == pl_checker(p, side));
  assert_true(fabsf(number_at(&g, checker, 0, x, y, z, radius) -
                    (0.2f + 0.6f * pl_checker(p, side))) < 1e-6f);
  const size_t wave = add_pattern(&g, "wave", 2.0f);
  graph_set(&g, wave, "phase", 0.2f, 0.2f, 0.2f);
  assert_true(fabsf(number_at(&g, wave, 0, x, y, z, radius) -
                    pl_wave(PL_WAVE_SINE, p.x + 0.2, side)) < 1e-5f);
  graph_choose(&g, wave, "path", "rings_z");
  graph_choose(&g, wave, "profile", "triangle");
  assert_true(fabsf(number_at(&g, wave, 0, x, y, z, radius) -
                    pl_wave(PL_WAVE_TRIANGLE, hypot(p.x, p.y) + 0.2, side)) < 1e-5f);
}

static void test_fractals_keep_the_order_of_their_table(void **state) {
  (void)state;
  const char *const *names = pl_node_kind_find("musgrave")->constants[0].choices;
  for (int kind = 0; kind < PL_FRACTAL_KINDS; kind++) {
    assert_string_equal(names[kind], pl_fractal_rows[kind].name);
    test_graph g = {0};
    const size_t node = add_pattern(&g, "musgrave", 1.0f);
    graph_choose(&g, node, "fractal", names[kind]);
    const pl_fractal shape = {
        .octaves = 4.0f, .roughness = 0.5f, .lacunarity = 2.0f, .offset = 1.0f, .gain = 2.0f};
    const pl_vec3 p = {0.25, 0.5, -3.125};
    assert_true(number_at(&g, node, 0, 0.25f, 0.5f, -3.125f, 0.0f) ==
                pl_fractal_rows[kind].evaluate(&shape, p, 0.0f));
  }
  assert_null(names[PL_FRACTAL_KINDS]);
}

/* With an infinite footprint every output is one number everywhere: the mean over many points. */
static void test_infinite_footprints_give_means(void **state) {
  (void)state;
  for (size_t k = 0; k < PATTERNS; k++) {
    test_graph g = {0};
    const size_t node = add_pattern(&g, patterns[k], 1.0f);
    for (size_t out = 0; out < g.nodes[node].kind->output_count; out++) {
      test_random random = {51, 0};
      const float far = number_at(&g, node, out, 0.1f, 7.0f, 3.0f, INFINITY);
      const int points = 4000;
      double sum = 0.0, square = 0.0;
      for (int i = 0; i < points; i++) {
        const float x = (float)random_range(&random, -50.0, 50.0);
        const float y = (float)random_range(&random, -50.0, 50.0);
        const float z = (float)random_range(&random, -50.0, 50.0);
        const double v = (double)number_at(&g, node, out, x, y, z, 0.0f);
        sum += v / points;
        square += v * v / points;
        if (i < 20)
          assert_true(number_at(&g, node, out, x, y, z, INFINITY) == far);
      }
      const double error = sqrt(fmax(0.0, square - sum * sum) / points);
      if (!(fabs(sum - (double)far) < 5.0 * error + 1e-3))
        fail_msg("%s: output %d, mean %g, far %g", patterns[k], (int)out, sum, (double)far);
    }
  }
}

/* A plane that recedes over 4 octaves, its pixels larger than a cell, square and side by side: the
 * mean over 24 x 24 of them stays within 0.0025 of the far value, half a percent of a mean of 1/2
 * (a wave cut off at the rim of the image leaves up to 0.5/(pi 85) = 0.0019). */
static void test_receding_patterns_stay_at_their_mean(void **state) {
  (void)state;
  for (size_t k = 0; k < PATTERNS; k++) {
    test_graph g = {0};
    const size_t node = add_pattern(&g, patterns[k], 1.0f);
    const double far = (double)number_at(&g, node, 0, 0.0f, 0.0f, 0.0f, INFINITY);
    for (float radius = 2.0f; radius <= 32.0f; radius *= 1.6f) {
      const float side = sqrtf(PL_PI_F) * radius;
      double sum = 0.0;
      for (int i = 0; i < 576; i++)
        sum += (double)number_at(&g, node, 0, side * (float)(i % 24) + 0.3f,
                                 side * (float)(i / 24) + 0.4f, 0.5f, radius) /
               576.0;
      if (!(fabs(sum - far) < 0.0025))
        fail_msg("%s: radius %g, mean %g, far %g", patterns[k], (double)radius, sum, far);
    }
  }
}

/* No input makes an output that is not a number; a scale of 0 is one point. */
static void test_odd_inputs(void **state) {
  (void)state;
  static const float odd[] = {0.0f, -1.0f, 1.0f, 0.3f, 1e-30f, 1e7f, -3.0f, 20.0f};
  test_random random = {52, 0};
  for (int i = 0; i < 4000; i++) {
    test_graph g = {0};
    const size_t node = add_pattern(&g, patterns[i % PATTERNS], 1.0f);
    const pl_node_kind *kind = g.nodes[node].kind;
    for (size_t k = 1; k < kind->input_count; k++) {
      const float x = odd[random_below(&random, 8)];
      graph_set(&g, node, kind->inputs[k].name, x, x, x);
    }
    for (size_t k = 0; k < kind->constant_count; k++)
      if (kind->constants[k].choices != NULL)
        g.constants[node][k].number = random_below(&random, 3);
    const float radius = i % 3 ? odd[random_below(&random, 8)] : INFINITY;
    for (size_t out = 0; out < kind->output_count; out++)
      assert_true(isfinite(number_at(&g, node, out, 0.2f, -3.0f, 1e7f, fabsf(radius))));
  }
}

static void normal_at(const test_graph *g, size_t node, const pl_graph_point *p, double out[3]) {
  pl_value v;
  graph_value_at(*g, node, 0, p, v);
  for (int i = 0; i < 3; i++)
    out[i] = (double)v[i];
}

/* A plane's slopes come back exactly; a noise's are those of its analytic gradient. */
static void test_bump(void **state) {
  (void)state;
  test_graph g = {0};
  const size_t where = graph_add(&g, "coordinates"), bump = graph_add(&g, "bump");
  graph_link(&g, bump, "height", where, 0); /* as a scalar: the mean of x, y, z */
  graph_set(&g, bump, "distance_m", 0.6f, 0.6f, 0.6f);
  graph_set(&g, bump, "strength", 0.5f, 0.5f, 0.5f);
  const pl_graph_point p = graph_point(0.3f, -0.2f, 0.1f, 0.01f);
  double n[3];
  normal_at(&g, bump, &p, n);
  assert_true(fabs(n[0] / n[2] + 0.1) < 1e-4 && fabs(n[1] / n[2] + 0.1) < 1e-4);
  assert_true(fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1.0) < 1e-5);
  const size_t noise = add_pattern(&g, "noise", 3.0f);
  graph_link(&g, bump, "height", noise, 0);
  graph_set(&g, bump, "distance_m", 0.1f, 0.1f, 0.1f);
  graph_set(&g, bump, "strength", 1.0f, 1.0f, 1.0f);
  const pl_fractal shape = {.octaves = 4.0f, .roughness = 0.5f, .lacunarity = 2.0f};
  test_random random = {53, 0};
  for (int i = 0; i < 300; i++) {
    const float x = (float)random_range(&random, -2.0, 2.0);
    const float y = (float)random_range(&random, -2.0, 2.0);
    const pl_graph_point at = graph_point(x, y, 0.3f, 1e-3f);
    const pl_vec3 cells = {3.0 * (double)x, 3.0 * (double)y, 3.0 * (double)0.3f};
    const pl_fractal_value f = pl_fractal_gradient(&shape, cells, 6e-3f);
    normal_at(&g, bump, &at, n); /* height = 1/2 + f/2: slopes of 3/2 grad f times 0.1 */
    assert_true(fabs(n[0] / n[2] + 0.15 * (double)f.gradient.x) < 2e-3);
    assert_true(fabs(n[1] / n[2] + 0.15 * (double)f.gradient.y) < 2e-3);
  }
  const pl_graph_point far = graph_point(0.3f, -0.2f, 0.1f, INFINITY);
  normal_at(&g, bump, &far, n);
  assert_true(n[0] == 0.0 && n[1] == 0.0 && n[2] == 1.0);
}

/* A panel of two triangles in the plane of y and (sin a, 0, cos a), somewhere in the model. */
static void test_coordinates_in_planes(void **state) {
  (void)state;
  const float a = 0.35f, u[4] = {0.0f, 2.0f, 2.0f, 0.0f}, v[4] = {0.0f, 0.0f, 3.0f, 3.0f};
  float positions[12];
  for (int i = 0; i < 4; i++) {
    positions[3 * i] = 5.0f + sinf(a) * v[i];
    positions[3 * i + 1] = u[i] - 1.0f;
    positions[3 * i + 2] = 2.0f + cosf(a) * v[i];
  }
  uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
  pl_model model = {.positions = positions, .indices = indices};
  test_graph g = {0};
  const size_t where = graph_add(&g, "coordinates");
  const char *const spaces[] = {"face", "box"};
  for (int k = 0; k < 2; k++) {
    graph_choose(&g, where, "space", spaces[k]);
    pl_value at[2][3];
    for (uint32_t triangle = 0; triangle < 2; triangle++)
      for (int i = 0; i < 3; i++) { /* the first corner is that of both */
        pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, 0.01f);
        p.model = &model;
        p.triangle.triangle = triangle;
        p.triangle.w[i] = 1.0f;
        p.object = pl_graph_point_object(&p);
        graph_value_at(g, where, 0, &p, at[triangle][i]);
        assert_true(at[triangle][i][2] == 0.0f && at[triangle][i][3] == 0.01f);
      }
    const double along = hypot((double)(at[1][2][0] - at[0][0][0]), /* the side of 3 */
                               (double)(at[1][2][1] - at[0][0][1]));
    assert_true(fabs(along - (k == 0 ? 3.0 : 3.0 * cos((double)a))) < 1e-5);
    for (int i = 0; i < 2; i++) {
      assert_true(fabsf(at[0][0][i] - at[1][0][i]) < 1e-5f);
      assert_true(fabsf(at[0][2][i] - at[1][1][i]) < 1e-5f);
    }
    assert_true(fabsf(at[0][1][0] - at[0][0][0] - 2.0f) < 1e-5f); /* the first axis is y */
  }
  graph_choose(&g, where, "space", "face"); /* without a model: the plane of x and y */
  const pl_graph_point p = graph_point(0.1f, 0.2f, 0.3f, 0.01f);
  pl_value at;
  graph_value_at(g, where, 0, &p, at);
  assert_true(at[0] == 0.1f && at[1] == 0.2f && at[2] == 0.0f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_values_are_those_of_the_functions),
      cmocka_unit_test(test_fractals_keep_the_order_of_their_table),
      converging_unit_test(test_infinite_footprints_give_means),
      converging_unit_test(test_receding_patterns_stay_at_their_mean),
      cmocka_unit_test(test_odd_inputs),
      cmocka_unit_test(test_bump),
      cmocka_unit_test(test_coordinates_in_planes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
