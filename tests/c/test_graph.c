/* Graphs: every node against its closed form, folding, what is evaluated, errors, surfaces. */
#include "graphs.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "shade/node_rows.h"

static void expect(const float *v, double x, double y, double z) {
  assert_true(fabs((double)v[0] - x) < 1e-5 * (1.0 + fabs(x)));
  assert_true(fabs((double)v[1] - y) < 1e-5 * (1.0 + fabs(y)));
  assert_true(fabs((double)v[2] - z) < 1e-5 * (1.0 + fabs(z)));
}

/* --- nodes ------------------------------------------------------------------------------------ */

static float math_of(const char *function, float a, float b, float c) {
  test_graph g = {0};
  pl_value v;
  const pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, 0.0f);
  const size_t node = graph_add(&g, "math");
  graph_choose(&g, node, "function", function);
  graph_set(&g, node, "a", a, a, a);
  graph_set(&g, node, "b", b, b, b);
  graph_set(&g, node, "c", c, c, c);
  graph_value_at(g, node, 0, &p, v);
  assert_true(v[0] == v[1] && v[1] == v[2] && v[3] == 0.0f);
  return v[0];
}

static void test_math_is_what_it_says(void **state) {
  (void)state;
  static const struct {
    const char *function;
    float a, b, c, result;
  } rows[] = {
      {"add", 2.0f, 3.0f, 9.0f, 5.0f},
      {"subtract", 2.0f, 3.0f, 9.0f, -1.0f},
      {"multiply", 2.0f, 3.0f, 9.0f, 6.0f},
      {"divide", 3.0f, 2.0f, 9.0f, 1.5f},
      {"divide", 3.0f, 0.0f, 9.0f, 0.0f},
      {"multiply_add", 2.0f, 3.0f, 9.0f, 15.0f},
      {"power", 2.0f, 10.0f, 0.0f, 1024.0f},
      {"power", -2.0f, 0.5f, 0.0f, 0.0f},
      {"power", 1e30f, 10.0f, 0.0f, 0.0f},
      {"sqrt", 2.25f, 0.0f, 0.0f, 1.5f},
      {"sqrt", -1.0f, 0.0f, 0.0f, 0.0f},
      {"exp", 0.0f, 0.0f, 0.0f, 1.0f},
      {"log", 1.0f, 0.0f, 0.0f, 0.0f},
      {"log", 0.0f, 0.0f, 0.0f, 0.0f},
      {"absolute", -2.0f, 0.0f, 0.0f, 2.0f},
      {"minimum", 2.0f, 3.0f, 0.0f, 2.0f},
      {"maximum", 2.0f, 3.0f, 0.0f, 3.0f},
      {"less_than", 2.0f, 3.0f, 0.0f, 1.0f},
      {"less_than", 3.0f, 3.0f, 0.0f, 0.0f},
      {"greater_than", 4.0f, 3.0f, 0.0f, 1.0f},
      {"sign", -4.0f, 0.0f, 0.0f, -1.0f},
      {"sign", 0.0f, 0.0f, 0.0f, 0.0f},
      {"floor", -1.5f, 0.0f, 0.0f, -2.0f},
      {"fraction", -1.25f, 0.0f, 0.0f, 0.75f},
      {"modulo", -5.5f, 2.0f, 0.0f, -1.5f},
      {"modulo", 5.5f, 0.0f, 0.0f, 0.0f},
      {"wrap", 7.5f, 1.0f, 3.0f, 1.5f},
      {"wrap", -0.5f, 1.0f, 3.0f, 1.5f},
      {"wrap", 7.5f, 2.0f, 2.0f, 2.0f},
      {"sine", 0.5f * PL_PI_F, 0.0f, 0.0f, 1.0f},
      {"cosine", 0.0f, 0.0f, 0.0f, 1.0f},
      {"atan2", 1.0f, 0.0f, 0.0f, 0.5f * PL_PI_F},
      {"smoothstep", 0.25f, 0.0f, 1.0f, 0.15625f}, /* 3 t^2 - 2 t^3 */
      {"smoothstep", 5.0f, 0.0f, 1.0f, 1.0f},
      {"smoothstep", 1.0f, 1.0f, 1.0f, 1.0f},
  };
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    const float x = math_of(rows[i].function, rows[i].a, rows[i].b, rows[i].c);
    if (!(fabsf(x - rows[i].result) < 1e-5f))
      fail_msg("%s(%g, %g, %g) = %g", rows[i].function, (double)rows[i].a, (double)rows[i].b,
               (double)rows[i].c, (double)x);
  }
}

static void test_every_function_of_math_is_tested_for_finite_results(void **state) {
  (void)state;
  static const float odd[] = {0.0f, -0.0f, 1.0f, -1.0f, 1e-38f, 3e38f, -3e38f};
  const pl_constant_row *row = &pl_node_kind_find("math")->constants[0];
  for (size_t f = 0; row->choices[f] != NULL; f++)
    for (size_t i = 0; i < 7; i++)
      for (size_t k = 0; k < 7; k++)
        assert_true(isfinite(math_of(row->choices[f], odd[i], odd[k], odd[(i + k) % 7])));
}

static void vector_math_of(const char *function, const float a[3], const float b[3], float factor,
                           pl_value out) {
  test_graph g = {0};
  const pl_graph_point p = graph_point(a[0], a[1], a[2], 0.25f);
  const size_t where = graph_add(&g, "coordinates"), node = graph_add(&g, "vector_math");
  graph_choose(&g, node, "function", function);
  graph_link(&g, node, "a", where, 0);
  graph_set(&g, node, "b", b[0], b[1], b[2]);
  graph_set(&g, node, "factor", factor, factor, factor);
  graph_value_at(g, node, 0, &p, out);
}

static void test_vector_math_is_what_it_says(void **state) {
  (void)state;
  const float a[3] = {1.0f, 2.0f, -2.0f}, b[3] = {3.0f, -1.0f, 4.0f};
  pl_value v;
  vector_math_of("add", a, b, 2.0f, v);
  expect(v, 4.0, 1.0, 2.0);
  assert_true(v[3] == 0.25f);
  vector_math_of("subtract", a, b, 2.0f, v);
  expect(v, -2.0, 3.0, -6.0);
  vector_math_of("multiply", a, b, 2.0f, v);
  expect(v, 3.0, -2.0, -8.0);
  assert_true(v[3] == 1.0f); /* the footprint times the largest factor */
  vector_math_of("scale", a, b, -2.0f, v);
  expect(v, -2.0, -4.0, 4.0);
  assert_true(v[3] == 0.5f);
  vector_math_of("cross", a, b, 2.0f, v);
  expect(v, 6.0, -10.0, -7.0);
  vector_math_of("normalize", a, b, 2.0f, v);
  expect(v, 1.0 / 3.0, 2.0 / 3.0, -2.0 / 3.0);
  vector_math_of("absolute", a, b, 2.0f, v);
  expect(v, 1.0, 2.0, 2.0);
  vector_math_of("minimum", a, b, 2.0f, v);
  expect(v, 1.0, -1.0, -2.0);
  vector_math_of("maximum", a, b, 2.0f, v);
  expect(v, 3.0, 2.0, 4.0);
  vector_math_of("dot", a, b, 2.0f, v);
  expect(v, -7.0, -7.0, -7.0);
  vector_math_of("length", a, b, 2.0f, v);
  expect(v, 3.0, 3.0, 3.0);
  vector_math_of("distance", a, b, 2.0f, v);
  expect(v, 7.0, 7.0, 7.0);
  const float none[3] = {0.0f, 0.0f, 0.0f};
  vector_math_of("normalize", none, b, 2.0f, v);
  expect(v, 0.0, 0.0, 0.0);
}

static void test_mapping_scales_then_turns_then_moves(void **state) {
  (void)state;
  test_graph g = {0};
  pl_value v;
  const pl_graph_point p = graph_point(1.0f, 2.0f, 3.0f, 0.5f);
  const size_t where = graph_add(&g, "coordinates"), node = graph_add(&g, "mapping");
  graph_link(&g, node, "vector", where, 0);
  graph_set(&g, node, "scale", 2.0f, 1.0f, -4.0f);
  graph_set(&g, node, "rotation_deg", 0.0f, 0.0f, 90.0f);
  graph_set(&g, node, "location", 10.0f, 20.0f, 30.0f);
  graph_value_at(g, node, 0, &p, v);
  expect(v, 8.0, 22.0, 18.0); /* (2, 2, -12) turned about z to (-2, 2, -12) */
  assert_true(v[3] == 2.0f);
  graph_set(&g, node, "rotation_deg", 90.0f, 90.0f, 0.0f);
  graph_value_at(g, node, 0, &p, v);
  expect(v, 12.0, 32.0, 28.0); /* about x: (2, 12, 2), then about y: (2, 12, -2) */
}

static void test_mix_blends(void **state) {
  (void)state;
  static const struct {
    const char *blend;
    float factor, result;
  } rows[] = {{"mix", 0.25f, 0.45f},     {"mix", -1.0f, 0.4f}, {"mix", 2.0f, 0.6f},
              {"multiply", 1.0f, 0.24f}, {"add", 1.0f, 1.0f},  {"screen", 1.0f, 0.76f}};
  const pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, 0.0f);
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    test_graph g = {0};
    pl_value v;
    const size_t node = graph_add(&g, "mix");
    graph_choose(&g, node, "blend", rows[i].blend);
    graph_set(&g, node, "factor", rows[i].factor, rows[i].factor, rows[i].factor);
    graph_set(&g, node, "a", 0.4f, 0.4f, 0.4f);
    graph_set(&g, node, "b", 0.6f, 0.6f, 0.6f);
    graph_value_at(g, node, 0, &p, v);
    expect(v, (double)rows[i].result, (double)rows[i].result, (double)rows[i].result);
  }
}

static const float stops[] = {0.25f, 0.0f, 0.2f, 1.0f, 0.75f, 1.0f, 0.4f, 0.0f};

static void ramp_at(const char *interpolation, float x, pl_value out) {
  test_graph g = {0};
  const pl_graph_point p = graph_point(x, x, x, 0.0f);
  const size_t where = graph_add(&g, "coordinates"), node = graph_add(&g, "ramp");
  graph_link(&g, node, "value", where, 0);
  *graph_constant(&g, node, "stops") = (pl_constant){.numbers = stops, .count = 8};
  graph_choose(&g, node, "interpolation", interpolation);
  graph_value_at(g, node, 0, &p, out);
}

static void test_ramp_interpolates_and_holds(void **state) {
  (void)state;
  pl_value v;
  ramp_at("linear", 0.375f, v);
  expect(v, 0.25, 0.25, 0.75);
  ramp_at("ease", 0.375f, v);
  expect(v, 0.15625, 0.23125, 0.84375);
  ramp_at("step", 0.74f, v);
  expect(v, 0.0, 0.2, 1.0);
  ramp_at("linear", -5.0f, v);
  expect(v, 0.0, 0.2, 1.0);
  ramp_at("linear", 5.0f, v);
  expect(v, 1.0, 0.4, 0.0);
  ramp_at("linear", 0.75f, v);
  expect(v, 1.0, 0.4, 0.0);
}

static void test_scalars_of_colors_are_luminances_and_of_vectors_means(void **state) {
  (void)state;
  const pl_graph_point p = graph_point(1.0f, 2.0f, 6.0f, 0.0f);
  pl_value v;
  test_graph g = {0};
  const size_t where = graph_add(&g, "coordinates"), color = graph_add(&g, "color");
  const size_t number = graph_add(&g, "value");
  graph_link(&g, number, "value", where, 0);
  graph_value_at(g, number, 0, &p, v);
  expect(v, 3.0, 3.0, 3.0);
  graph_set(&g, color, "color", 1.0f, 0.0f, 0.0f);
  graph_link(&g, number, "value", color, 0);
  graph_value_at(g, number, 0, &p, v);
  expect(v, 0.2126, 0.2126, 0.2126);
}

/* --- compiling -------------------------------------------------------------------------------- */

static void test_constant_parts_are_folded_and_unused_ones_left_out(void **state) {
  (void)state;
  test_graph g = {0};
  pl_graph *graph;
  const size_t two = graph_add(&g, "value"), sum = graph_add(&g, "math");
  const size_t where = graph_add(&g, "coordinates"), scaled = graph_add(&g, "mapping");
  const size_t unused = graph_add(&g, "mapping"), surface = graph_add(&g, "principled");
  graph_set(&g, two, "value", 2.0f, 2.0f, 2.0f);
  graph_link(&g, sum, "a", two, 0);
  graph_set(&g, sum, "b", -1.8f, -1.8f, -1.8f);
  graph_link(&g, surface, "roughness", sum, 0);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  assert_int_equal(pl_graph_instruction_count(graph), 0);
  pl_model_summary summary = {.ggx_alpha_min = 1.0};
  pl_graph_summarise(graph, &summary);
  assert_false(summary.textured);
  assert_true(fabs(summary.ggx_alpha_min - 0.04) < 1e-6);
  pl_graph_destroy(graph);
  graph_link(&g, unused, "vector", where, 0);
  graph_link(&g, scaled, "vector", where, 0);
  graph_link(&g, scaled, "scale", sum, 0);
  graph_link(&g, surface, "base_color", scaled, 0);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  assert_int_equal(pl_graph_instruction_count(graph), 2);
  pl_graph_summarise(graph, &summary);
  assert_true(summary.textured);
  pl_graph_destroy(graph);
}

static void test_parameters_are_read_at_each_evaluation(void **state) {
  (void)state;
  test_graph g = {.parameters = 2};
  pl_graph *graph;
  pl_value out[PL_NODE_SOCKETS], params[2] = {{0.3f, 0.3f, 0.3f, 0.0f}, {0.1f, 0.2f, 0.4f, 0.0f}};
  const pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, 0.0f);
  const size_t number = graph_add(&g, "value"), surface = graph_add(&g, "principled");
  graph_drive(&g, number, "value", 0);
  graph_link(&g, surface, "roughness", number, 0);
  graph_drive(&g, surface, "base_color", 1);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  assert_int_equal(pl_graph_parameter_count(graph), 2);
  for (int i = 0; i < 2; i++, params[0][0] += 0.25f) {
    pl_surface s = {.n = {0.0f, 0.0f, 1.0f}, .t = {1.0f, 0.0f, 0.0f}, .b = {0.0f, 1.0f, 0.0f}};
    pl_graph_evaluate(graph, &p, params, out);
    assert_true(out[PL_SURFACE_SOCKETS + 1][0] == params[0][0]);
    pl_graph_surface(graph, &p, params, &s);
    assert_true(s.alpha == params[0][0] * params[0][0] && s.color.z == 0.4f);
  }
  pl_model_summary summary = {.ggx_alpha_min = 1.0};
  pl_graph_summarise(graph, &summary);
  assert_true(summary.ggx_alpha_min == 0.0); /* any roughness may come */
  pl_graph_destroy(graph);
}

static void test_cycles_are_printed(void **state) {
  (void)state;
  test_graph g = {0};
  pl_graph *graph;
  const size_t a = graph_add(&g, "math"), b = graph_add(&g, "math"), c = graph_add(&g, "math");
  graph_add(&g, "lambert");
  graph_link(&g, a, "a", b, 0);
  graph_link(&g, b, "b", c, 0);
  graph_link(&g, c, "a", b, 0);
  assert_int_equal(graph_make(&g, &graph), PL_E_RANGE);
  assert_string_equal(pl_error_text(), "nodes form a cycle: n1 -> n2 -> n1");
  assert_null(graph);
}

static void test_faults_name_node_and_input(void **state) {
  (void)state;
  pl_graph *graph;
  test_graph g = {0};
  const size_t ramp = graph_add(&g, "ramp"), surface = graph_add(&g, "principled");
  assert_int_equal(graph_make(&g, &graph), PL_E_RANGE);
  assert_string_equal(pl_error_text(), "n0.stops: a ramp needs at least one");
  *graph_constant(&g, ramp, "stops") = (pl_constant){.numbers = stops, .count = 8};
  graph_link(&g, surface, "roughness", ramp, 1);
  assert_int_equal(graph_make(&g, &graph), PL_E_RANGE);
  assert_string_equal(pl_error_text(), "n1.roughness: linked to an output that is not there");
  graph_set(&g, surface, "roughness", NAN, 0.0f, 0.0f);
  assert_int_equal(graph_make(&g, &graph), PL_E_RANGE);
  assert_string_equal(pl_error_text(), "n1.roughness: not a finite number");
  graph_drive(&g, surface, "roughness", 0);
  assert_int_equal(graph_make(&g, &graph), PL_E_RANGE);
  graph_set(&g, surface, "roughness", 1.0f, 1.0f, 1.0f);
  graph_constant(&g, ramp, "interpolation")->number = 3.0;
  assert_int_equal(graph_make(&g, &graph), PL_E_RANGE);
  g.surface = ramp;
  assert_int_equal(graph_make(&g, &graph), PL_E_RANGE);
}

static void test_graphs_that_are_too_large_are_refused(void **state) {
  (void)state;
  pl_graph *graph;
  static test_graph g;
  size_t last = graph_add(&g, "coordinates");
  for (int i = 0; i < 250; i++) {
    const size_t next = graph_add(&g, "vector_math"); /* two values each */
    graph_link(&g, next, "a", last, 0);
    last = next;
  }
  graph_link(&g, graph_add(&g, "lambert"), "base_color", last, 0);
  assert_int_equal(graph_make(&g, &graph), PL_E_RANGE);
  for (int i = 0; i < 10; i++)
    graph_add(&g, "value");
  assert_int_equal(graph_make(&g, &graph), PL_E_RANGE);
  static test_graph many = {.parameters = 65536};
  graph_add(&many, "lambert");
  assert_int_equal(graph_make(&many, &graph), PL_E_RANGE);
}

/* --- surfaces --------------------------------------------------------------------------------- */

static void test_surfaces_are_cut_off_at_their_limits(void **state) {
  (void)state;
  test_graph g = {0};
  pl_graph *graph;
  const pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, 0.0f);
  pl_surface s = {.t = p.t, .b = p.b, .n = p.n, .ng = p.ng, .emission = {1.0f, 1.0f, 1.0f}};
  const size_t surface = graph_add(&g, "principled");
  graph_set(&g, surface, "base_color", 2.0f, -1.0f, 0.5f);
  graph_set(&g, surface, "metallic", 3.0f, 3.0f, 3.0f);
  graph_set(&g, surface, "roughness", -3.0f, -3.0f, -3.0f);
  graph_set(&g, surface, "emission_color", 1.0f, 0.5f, -1.0f);
  graph_set(&g, surface, "emission_strength", 4.0f, 4.0f, 4.0f);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  pl_graph_surface(graph, &p, NULL, &s);
  assert_true(s.color.x == 1.0f && s.color.y == 0.0f && s.color.z == 0.5f);
  assert_true(s.metallic == 1.0f && s.alpha == 0.0f);
  assert_true(s.emission.x == 4.0f && s.emission.y == 2.0f && s.emission.z == 0.0f);
  assert_ptr_equal(s.reflectance, &pl_reflectance_metallic_roughness);
  pl_model_summary summary = {.ggx_alpha_min = 1.0};
  pl_graph_summarise(graph, &summary);
  assert_true(summary.emission_max == 4.0 && summary.ggx_alpha_min == 0.0);
  pl_graph_destroy(graph);
}

static void test_wrapping_keeps_what_is_not_given(void **state) {
  (void)state;
  test_graph g = {.wrap = true};
  pl_graph *graph;
  const pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, 0.0f);
  const pl_surface of_file = {.t = p.t,
                              .b = p.b,
                              .n = p.n,
                              .ng = p.ng,
                              .color = {0.1f, 0.2f, 0.3f},
                              .emission = {5.0f, 6.0f, 7.0f},
                              .alpha = 0.4f,
                              .metallic = 0.6f};
  pl_surface s = of_file;
  const size_t surface = graph_add(&g, "principled");
  graph_set(&g, surface, "roughness", 0.5f, 0.5f, 0.5f);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  assert_false(pl_graph_sets_emission(graph));
  pl_graph_surface(graph, &p, NULL, &s);
  assert_true(s.alpha == 0.25f && s.metallic == 0.6f && s.color.y == 0.2f && s.emission.z == 7.0f);
  pl_graph_destroy(graph);
}

static void test_normals_bend_the_frame_on_its_side(void **state) {
  (void)state;
  static const float normals[][3] = {
      {0.3f, -0.2f, 1.0f}, {1.0f, 0.0f, 0.0f}, {0.0f, 0.0f, -1.0f}, {0.0f, 0.0f, 0.0f}};
  for (size_t i = 0; i < 4; i++) {
    test_graph g = {0};
    pl_graph *graph;
    const pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, 0.0f);
    pl_surface s = {.t = p.t, .b = p.b, .n = p.n, .ng = p.ng};
    const size_t surface = graph_add(&g, "lambert");
    graph_set(&g, surface, "normal", normals[i][0], normals[i][1], normals[i][2]);
    assert_int_equal(graph_make(&g, &graph), PL_OK);
    pl_graph_surface(graph, &p, NULL, &s);
    assert_true(fabsf(pl_vec3f_norm(s.n) - 1.0f) < 1e-5f);
    assert_true(fabsf(pl_vec3f_norm(s.t) - 1.0f) < 1e-5f);
    assert_true(fabsf(pl_vec3f_dot(s.n, s.t)) < 1e-5f && fabsf(pl_vec3f_dot(s.n, s.b)) < 1e-5f);
    assert_true(s.n.z > 0.04f);
    pl_graph_destroy(graph);
  }
}

/* --- memory ----------------------------------------------------------------------------------- */

typedef struct failing {
  size_t left;
} failing;

static void *fail_later(void *context, size_t size) {
  failing *f = context;
  return f->left-- == 0 ? NULL : malloc(size);
}

static void test_each_failing_allocation_is_reported(void **state) {
  (void)state;
  test_graph g = {0};
  pl_graph *graph = NULL;
  const size_t where = graph_add(&g, "coordinates"), scaled = graph_add(&g, "mapping");
  graph_link(&g, scaled, "vector", where, 0);
  graph_link(&g, graph_add(&g, "lambert"), "base_color", scaled, 0);
  pl_status status = PL_E_MEMORY;
  size_t n = 0;
  for (; n < 200 && status != PL_OK; n++) {
    failing f = {n};
    pl_memory_hook(fail_later, &f);
    status = graph_make(&g, &graph);
    pl_memory_hook(NULL, NULL);
    assert_true(status == PL_OK || status == PL_E_MEMORY);
  }
  assert_true(n > 5 && status == PL_OK);
  const uint64_t before = pl_memory_allocations();
  const pl_graph_point p = graph_point(1.0f, 2.0f, 3.0f, 0.0f);
  pl_value out[PL_NODE_SOCKETS];
  pl_graph_evaluate(graph, &p, NULL, out);
  assert_int_equal(pl_memory_allocations(), before);
  pl_graph_destroy(graph);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_math_is_what_it_says),
      cmocka_unit_test(test_every_function_of_math_is_tested_for_finite_results),
      cmocka_unit_test(test_vector_math_is_what_it_says),
      cmocka_unit_test(test_mapping_scales_then_turns_then_moves),
      cmocka_unit_test(test_mix_blends),
      cmocka_unit_test(test_ramp_interpolates_and_holds),
      cmocka_unit_test(test_scalars_of_colors_are_luminances_and_of_vectors_means),
      cmocka_unit_test(test_constant_parts_are_folded_and_unused_ones_left_out),
      cmocka_unit_test(test_parameters_are_read_at_each_evaluation),
      cmocka_unit_test(test_cycles_are_printed),
      cmocka_unit_test(test_faults_name_node_and_input),
      cmocka_unit_test(test_graphs_that_are_too_large_are_refused),
      cmocka_unit_test(test_surfaces_are_cut_off_at_their_limits),
      cmocka_unit_test(test_wrapping_keeps_what_is_not_given),
      cmocka_unit_test(test_normals_bend_the_frame_on_its_side),
      cmocka_unit_test(test_each_failing_allocation_is_reported),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
