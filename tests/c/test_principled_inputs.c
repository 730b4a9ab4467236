/* The principled surface of graphs against the same layers of a glTF material, and at its edges. */
#include "graphs.h"

#include <math.h>

#include "models.h"
#include "random.h"
#include "shade/principled_inputs.h"

/* --- helpers ---------------------------------------------------------------------------------- */

typedef struct row {
  const char *name;
  float value[3];
} row;

static pl_graph *skin(const row *rows, size_t count, bool wrap) {
  test_graph g = {.wrap = wrap};
  pl_graph *graph;
  const size_t surface = graph_add(&g, "principled");
  for (size_t i = 0; i < count; i++)
    graph_set(&g, surface, rows[i].name, rows[i].value[0], rows[i].value[1], rows[i].value[2]);
  if (graph_make(&g, &graph) != PL_OK)
    fail_msg("%s", pl_error_text());
  return graph;
}

static pl_surface flat(void) {
  return (pl_surface){.t = {1.0f, 0.0f, 0.0f},
                      .b = {0.0f, 1.0f, 0.0f},
                      .n = {0.0f, 0.0f, 1.0f},
                      .ng = {0.0f, 0.0f, 1.0f}};
}

static pl_surface surface_of(const row *rows, size_t count) {
  pl_graph *graph = skin(rows, count, false);
  const pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, 0.0f);
  pl_surface s = flat();
  pl_graph_surface(graph, &p, NULL, &s);
  pl_graph_destroy(graph);
  return s;
}

static pl_model_summary summary_of(const row *rows, size_t count) {
  pl_graph *graph = skin(rows, count, false);
  pl_model_summary summary = {.ggx_alpha_min = 1.0};
  pl_graph_summarise(graph, &summary);
  pl_graph_destroy(graph);
  return summary;
}

static void same_vector(pl_vec3f a, pl_vec3f b, float tolerance) {
  assert_true(fabsf(a.x - b.x) <= tolerance && fabsf(a.y - b.y) <= tolerance &&
              fabsf(a.z - b.z) <= tolerance);
}

#define S(x)                                                                                       \
  { (x), (x), (x) }
#define COUNT(rows) (rows), sizeof(rows) / sizeof((rows)[0])

/* --- tests ------------------------------------------------------------------------------------ */

/* pl_material_layers_surface is tested against the extensions' texts. */
static void test_layers_are_those_of_a_gltf_material(void **state) {
  (void)state;
  const row rows[] = {{"base_color", {0.3f, 0.5f, 0.7f}},
                      {"metallic", S(0.25f)},
                      {"roughness", S(0.4f)},
                      {"ior", S(1.8f)},
                      {"specular", S(0.7f)},
                      {"specular_tint", {1.0f, 0.5f, 0.25f}},
                      {"anisotropy", S(0.6f)},
                      {"anisotropy_rotation_deg", S(30.0f)},
                      {"coat", S(0.8f)},
                      {"coat_roughness", S(0.2f)},
                      {"transmission", S(0.3f)}};
  pl_model *model = square_create(1.0);
  pl_material *m = &model->materials[0];
  const float color[3] = {0.3f, 0.5f, 0.7f}, tint[3] = {1.0f, 0.5f, 0.25f};
  memcpy(m->base_color, color, sizeof color);
  m->metallic = 0.25f;
  m->roughness = 0.4f;
  m->layered = true;
  m->layers = PL_MATERIAL_LAYERS_PLAIN;
  m->layers.ior = 1.8f;
  m->layers.specular = 0.7f;
  memcpy(m->layers.specular_color, tint, sizeof tint);
  m->layers.anisotropy = 0.6f;
  m->layers.anisotropy_rotation_rad = PL_PI_F / 6.0f;
  m->layers.coat = 0.8f;
  m->layers.coat_roughness = 0.2f;
  m->layers.transmission = 0.3f;
  const pl_surface a = surface_of(COUNT(rows));
  const pl_triangle_point point = {.w = {1.0f, 0.0f, 0.0f}};
  pl_surface b = flat();
  pl_material_surface(model, &point, PL_DETAIL_FULL, &b);
  assert_ptr_equal(a.reflectance, &pl_reflectance_principled);
  assert_ptr_equal(b.reflectance, &pl_reflectance_principled);
  same_vector(a.t, b.t, 1e-6f);
  same_vector(a.b, b.b, 1e-6f);
  same_vector(a.color, b.color, 0.0f);
  same_vector(a.lobes.f0, b.lobes.f0, 0.0f);
  assert_true(a.alpha == b.alpha && a.metallic == b.metallic && a.lobes.f90 == b.lobes.f90);
  assert_true(a.lobes.anisotropy == b.lobes.anisotropy && a.lobes.coat == b.lobes.coat);
  assert_true(a.lobes.coat_alpha == b.lobes.coat_alpha);
  assert_true(a.lobes.transmission == b.lobes.transmission);
  const pl_model_summary of_graph = summary_of(COUNT(rows)), of_model = pl_model_summarise(model);
  assert_true(of_graph.coat_max == of_model.coat_max);
  assert_true(of_graph.transmission_max == of_model.transmission_max);
  assert_true(of_graph.ggx_alpha_min == of_model.ggx_alpha_min);
  pl_model_destroy(model);
}

/* Values that make no layer leave the cheaper row, whether they are given or not. */
static void test_without_layers_it_is_metallic_roughness(void **state) {
  (void)state;
  const row rows[] = {{"ior", S(1.5f)},
                      {"specular", S(1.0f)},
                      {"specular_tint", S(1.0f)},
                      {"anisotropy", S(0)},
                      {"coat", S(0)},
                      {"transmission", S(0)},
                      {"roughness", S(0.3f)},
                      {"coat_roughness", S(0.9f)}};
  assert_ptr_equal(surface_of(COUNT(rows)).reflectance, &pl_reflectance_metallic_roughness);
  assert_ptr_equal(surface_of(NULL, 0).reflectance, &pl_reflectance_metallic_roughness);
  const pl_model_summary summary = summary_of(COUNT(rows));
  assert_true(summary.coat_max == 0.0 && summary.transmission_max == 0.0);
}

static void test_a_driven_layer_is_there_at_zero(void **state) {
  (void)state;
  test_graph g = {.parameters = 2};
  pl_graph *graph;
  const size_t surface = graph_add(&g, "principled");
  graph_drive(&g, surface, "coat", 0);
  graph_drive(&g, surface, "transmission", 1);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  const pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, 0.0f);
  pl_value params[2] = {{0.0f}, {0.25f, 0.25f, 0.25f, 0.0f}};
  pl_surface s = flat();
  pl_graph_surface(graph, &p, params, &s);
  assert_ptr_equal(s.reflectance, &pl_reflectance_principled);
  assert_true(s.lobes.coat == 0.0f && s.lobes.transmission == 0.25f);
  pl_model_summary summary = {.ggx_alpha_min = 1.0};
  pl_graph_summarise(graph, &summary);
  assert_true(summary.coat_max == 1.0 && summary.transmission_max == 1.0);
  pl_graph_destroy(graph);
}

static pl_surface wrapped(const row *rows, size_t count, const pl_surface *of_file) {
  pl_graph *graph = skin(rows, count, true);
  const pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, 0.0f);
  pl_surface s = *of_file;
  pl_graph_surface(graph, &p, NULL, &s);
  pl_graph_destroy(graph);
  return s;
}

static void test_wrapping_keeps_and_adds_layers(void **state) {
  (void)state;
  const row coat[] = {{"coat", S(0.5f)}}, no_coat[] = {{"coat", S(0.0f)}}, ior[] = {{"ior", S(2)}};
  pl_surface layered = flat(), plain = flat();
  plain.reflectance = &pl_reflectance_metallic_roughness;
  plain.lobes.f90 = 77.0f; /* what is not read need not be valid */
  layered.reflectance = &pl_reflectance_principled;
  layered.lobes = (pl_lobes){.f0 = {0.1f, 0.1f, 0.1f},
                             .f90 = 1.0f,
                             .anisotropy = 0.5f,
                             .coat = 0.75f,
                             .coat_alpha = 0.09f,
                             .transmission = 0.25f};
  pl_surface s = wrapped(NULL, 0, &layered);
  assert_ptr_equal(s.reflectance, &pl_reflectance_principled);
  assert_true(s.lobes.f0.x == 0.1f && s.lobes.coat == 0.75f && s.lobes.transmission == 0.25f);
  s = wrapped(COUNT(no_coat), &layered);
  assert_true(s.lobes.coat == 0.0f && s.lobes.coat_alpha == 0.09f && s.lobes.f0.x == 0.1f);
  s = wrapped(COUNT(ior), &layered);
  assert_true(fabsf(s.lobes.f0.x - 1.0f / 9.0f) < 1e-6f && s.lobes.coat == 0.75f);
  s = wrapped(COUNT(coat), &plain);
  assert_ptr_equal(s.reflectance, &pl_reflectance_principled);
  assert_true(s.lobes.coat == 0.5f && s.lobes.f90 == 1.0f && s.lobes.f0.x == 0.04f);
  s = wrapped(COUNT(no_coat), &plain);
  assert_ptr_equal(s.reflectance, &pl_reflectance_metallic_roughness);
}

/* Reflected light of a white sky, by drawing. */
static double albedo_of(const pl_surface *s, float cosine) {
  enum { DRAWS = 4000 };
  const pl_vec3f wo = {sqrtf(1.0f - cosine * cosine), 0.0f, cosine};
  double sum = 0.0;
  test_random random = {.seed = 12345};
  for (int i = 0; i < DRAWS; i++) {
    const float u[2] = {(float)random_unit(&random), (float)random_unit(&random)};
    pl_vec3f wi, weight;
    float pdf;
    if (s->reflectance->sample(s, wo, u, &wi, &weight, &pdf))
      sum += (double)pl_vec3f_max(weight);
  }
  return sum / DRAWS;
}

/* Index 1 and black: nothing comes back. A black metal mirrors at the horizon alone (Schlick: (1 -
 * cos)^5 = 0.03 at 60 degrees). A whole coat over anything, and any roughness: never more than all.
 * The means of 4000 draws are good to 0.02. */
static void test_edges(void **state) {
  (void)state;
  static const float roughness[] = {0.0f, 0.5f, 1.0f}, cosine[] = {1.0f, 0.5f, 0.02f};
  const row nothing[] = {{"base_color", S(0)}, {"ior", S(1)}};
  pl_surface s = surface_of(COUNT(nothing));
  assert_true(albedo_of(&s, 0.02f) == 0.0 && s.lobes.f90 == 0.0f);
  for (size_t r = 0; r < 3; r++)
    for (size_t metal = 0; metal < 2; metal++) {
      const float m = (float)metal;
      const row black[] = {{"base_color", S(0)},
                           {"metallic", S(1)},
                           {"roughness", S(roughness[r])},
                           {"anisotropy", S(m)}};
      const row coated[] = {{"base_color", S(1)},
                            {"metallic", S(m)},
                            {"roughness", S(roughness[r])},
                            {"coat", S(1)},
                            {"coat_roughness", S(roughness[2 - r])},
                            {"anisotropy", S(1)},
                            {"transmission", S(1)}};
      const pl_surface dark = surface_of(COUNT(black)), bright = surface_of(COUNT(coated));
      assert_true(albedo_of(&dark, 1.0f) < 0.05);
      for (size_t c = 0; c < 3; c++) {
        const double all = albedo_of(&bright, cosine[c]);
        if (!(all > 0.1 && all < 1.02))
          fail_msg("roughness %g, metal %g: %g comes back", (double)roughness[r], (double)m, all);
      }
    }
}

static void test_what_is_beyond_is_cut_off(void **state) {
  (void)state;
  const row high[] = {{"coat", S(7)},         {"coat_roughness", S(9)}, {"transmission", S(3)},
                      {"anisotropy", S(5)},   {"ior", S(3e38f)},        {"specular", S(4)},
                      {"specular_tint", S(9)}};
  const row low[] = {
      {"coat", S(-7)}, {"coat_roughness", S(-9)}, {"transmission", S(-3)}, {"anisotropy", S(-5)},
      {"ior", S(-2)},  {"specular", S(-4)},       {"specular_tint", S(-9)}};
  const pl_surface a = surface_of(COUNT(high)), b = surface_of(COUNT(low));
  assert_true(a.lobes.coat == 1.0f && a.lobes.coat_alpha == 1.0f && a.lobes.transmission == 1.0f);
  assert_true(a.lobes.anisotropy == 1.0f && a.lobes.f0.x == 1.0f && a.lobes.f90 == 1.0f);
  assert_true(b.lobes.coat == 0.0f && b.lobes.coat_alpha == 0.0f && b.lobes.transmission == 0.0f);
  assert_true(b.lobes.anisotropy == 0.0f && b.lobes.f0.x == 0.0f && b.lobes.f90 == 0.0f);
  const row infinite[] = {{"ior", S(0)}}; /* KHR_materials_ior */
  assert_true(surface_of(COUNT(infinite)).lobes.f0.x == 1.0f);
}

static void test_every_model_is_a_node(void **state) {
  (void)state;
  for (size_t i = 0; i < pl_reflectance_count; i++) {
    const pl_reflectance *reflectance = pl_reflectances[i];
    const pl_node_kind *kind = pl_node_kind_find(reflectance->name);
    assert_non_null(kind);
    assert_ptr_equal(kind->reflectance, reflectance);
    assert_true(pl_node_input_count(kind) <= PL_NODE_SOCKETS);
    assert_true((reflectance->set != NULL) == (reflectance->input_count > 0));
    for (size_t k = 0; k < pl_node_input_count(kind); k++)
      for (size_t n = 0; n < k; n++)
        assert_true(strcmp(pl_node_input(kind, k)->name, pl_node_input(kind, n)->name) != 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_layers_are_those_of_a_gltf_material),
      cmocka_unit_test(test_without_layers_it_is_metallic_roughness),
      cmocka_unit_test(test_a_driven_layer_is_there_at_zero),
      cmocka_unit_test(test_wrapping_keeps_and_adds_layers),
      cmocka_unit_test(test_edges),
      cmocka_unit_test(test_what_is_beyond_is_cut_off),
      cmocka_unit_test(test_every_model_is_a_node),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
