/* Bounds of the light that meshes send, and of what points of bodies reflect of it. */
#include "harness.h"

#include "random.h"
#include "scene/senders.h"
#include "scene/sent_light.h"
#include "shade/reflectance.h"
#include "shade/water.h"

/* One triangle of area 1/2 in the plane z = 0 whose shading normals all lean by an angle. */
static pl_sent_light leaning(double roughness, double lean_rad) {
  static float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  static uint32_t indices[] = {0, 1, 2}, part = 0;
  static pl_part parts = {.material = 0};
  float normals[9];
  for (int k = 0; k < 3; k++) {
    normals[3 * k] = (float)sin(lean_rad);
    normals[3 * k + 1] = 0.0f;
    normals[3 * k + 2] = (float)cos(lean_rad);
  }
  pl_material material = {.metallic = 1.0f,
                          .roughness = (float)roughness,
                          .metallic_roughness_map = PL_NO_TEXTURE,
                          .normal_map = PL_NO_TEXTURE,
                          .base_color_map = PL_NO_TEXTURE,
                          .emissive_map = PL_NO_TEXTURE};
  const pl_model model = {.vertex_count = 3,
                          .triangle_count = 1,
                          .positions = positions,
                          .normals = normals,
                          .indices = indices,
                          .triangle_part = &part,
                          .part_count = 1,
                          .parts = &parts,
                          .material_count = 1,
                          .materials = &material};
  const pl_model_summary summary = pl_model_summarise(&model);
  return pl_sent_light_of(&model, &summary, NULL);
}

static pl_vec3f above(test_random *random) {
  const pl_vec3 d = random_direction(random);
  return (pl_vec3f){(float)d.x, (float)d.y, (float)fabs(d.z) + 1e-4f};
}

/* Light from any direction to any other, near the mirror's more often. */
static double sent(test_random *random, double alpha, double lean_rad) {
  const pl_surface metal = {.reflectance = &pl_reflectance_metallic_roughness,
                            .color = {1.0f, 1.0f, 1.0f},
                            .n = {0.0f, 0.0f, 1.0f},
                            .metallic = 1.0f,
                            .alpha = (float)alpha};
  const pl_vec3f wo = pl_vec3f_unit(above(random));
  const float width = (float)alpha;
  pl_vec3f wi = {-wo.x + width * (float)random_range(random, -1, 1),
                 -wo.y + width * (float)random_range(random, -1, 1), wo.z};
  wi = pl_vec3f_unit(wi);
  const double value = (double)metal.reflectance->evaluate(&metal, wo, wi).x;
  const double shown = (double)wo.z * cos(lean_rad) + (double)wo.x * sin(lean_rad);
  return PL_PI * value * fabs(shown);
}

static void test_facets_send_no_more(void **state) {
  (void)state;
  test_random random = {.seed = 91};
  double nearest = 0.0;
  for (int i = 0; i < PL_DRAWS(200000, 20000); i++) {
    const double roughness = random_range(&random, 0.15, 1.0), lean = random_range(&random, 0, 1);
    const double lean_rad = i % 2 ? 0.0 : lean;
    const pl_sent_light bound = leaning(roughness, lean_rad);
    const double most = bound.area_gain + bound.mirrors * PL_SENT_MIRROR;
    const double found = 0.5 * sent(&random, roughness * roughness, lean_rad);
    assert_true(found <= most);
    nearest = fmax(nearest, found / most);
  }
  print_message("seed 91: at most %.2f of the bound\n", nearest);
  assert_true(nearest > 0.5);
}

/* A mirror as smooth as possible counts by its area. */
static void test_mirrors_are_counted_by_area(void **state) {
  (void)state;
  const pl_sent_light bound = leaning(0.0, 0.0);
  assert_true(fabs(bound.mirrors - 0.5) < 1e-6 && !(bound.area_gain > 0.0));
}

/* What water reflects of a small ball, against its reflectance towards the ball's centre. */
static void test_points_reflect_no_more(void **state) {
  (void)state;
  test_random random = {.seed = 92};
  const double far = 1000.0, radius = 5.0;
  int dark = 0;
  for (int i = 0; i < PL_DRAWS(100000, 10000); i++) {
    const double alpha = random_range(&random, 0.05, 0.8);
    const pl_vec3f wo = pl_vec3f_unit(above(&random)), wi = pl_vec3f_unit(above(&random));
    const pl_surface sea = {.reflectance = &pl_reflectance_water,
                            .n = {0.0f, 0.0f, 1.0f},
                            .alpha = (float)alpha,
                            .water = 1.0f};
    pl_sender ball = {.center = pl_vec3_scale(pl_vec3f_to_double(wi), far),
                      .radius_m = radius,
                      .intensity = radius * radius};
    const double solid = radius * radius / (far * far);
    const double found = PL_PI * (double)sea.reflectance->evaluate(&sea, wo, wi).x * solid;
    const pl_senders all = {.items = &ball, .count = 1, .albedo = 1.0, .least = found};
    const pl_senders less = {.items = &ball, .count = 1, .albedo = 1.0, .least = 30.0 * solid};
    const pl_senders_point point = {.normal = sea.n, .viewer = wo, .alpha = alpha};
    assert_true(!(found > 0.0) || pl_senders_light(&all, &point));
    dark += !pl_senders_light(&less, &point);
  }
  print_message("seed 92: %d points that do not mirror the ball are told apart\n", dark);
  assert_true(dark > PL_DRAWS(100000, 10000) / 2);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_facets_send_no_more),
      cmocka_unit_test(test_mirrors_are_counted_by_area),
      cmocka_unit_test(test_points_reflect_no_more),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
