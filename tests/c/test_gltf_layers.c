/* Layers of glTF materials, by the texts of their KHR_materials_* specifications. */
#include "harness.h"

#include "gltf_files.h"

#define WITH(extensions)                                                                           \
  ASSET "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"                                   \
        "\"materials\":[{\"extensions\":{" extensions "}}],"                                       \
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,"             \
        "\"material\":0}]}]," SQUARE_DATA "}"

static void test_all_factors(void **state) {
  (void)state;
  pl_model *model = load_text(WITH(
      "\"KHR_materials_clearcoat\":{\"clearcoatFactor\":0.5,\"clearcoatRoughnessFactor\":0.25},"
      "\"KHR_materials_transmission\":{\"transmissionFactor\":0.75},"
      "\"KHR_materials_ior\":{\"ior\":1.25},"
      "\"KHR_materials_specular\":{\"specularFactor\":0.5,"
      "\"specularColorFactor\":[1,0.5,0]},"
      "\"KHR_materials_anisotropy\":{\"anisotropyStrength\":0.5,\"anisotropyRotation\":1}"));
  const pl_material *m = &model->materials[0];
  assert_true(m->layered && m->layers.coat == 0.5f && m->layers.coat_roughness == 0.25f);
  assert_true(m->layers.transmission == 0.75f && m->layers.ior == 1.25f);
  assert_true(m->layers.specular == 0.5f && m->layers.specular_color[1] == 0.5f);
  assert_true(m->layers.anisotropy == 0.5f && m->layers.anisotropy_rotation_rad == 1.0f);
  assert_int_equal(m->layers.coat_map.texture, -1);
  assert_string_equal(model->warnings, "");
  pl_model_destroy(model);
}

/* Without extensions, or with one that is off, a material is a plain one. */
static void test_plain(void **state) {
  (void)state;
  pl_model *model = load_text(WITH("\"KHR_materials_clearcoat\":{}"));
  assert_false(model->materials[0].layered);
  pl_model_destroy(model);
  model = load_text(WITH("\"KHR_materials_ior\":{}"));
  assert_true(model->materials[0].layered && model->materials[0].layers.ior == 1.5f);
  pl_model_destroy(model);
}

/* The reader carries these extensions out, so files may require them, and nothing is remarked on.
 */
static void test_required(void **state) {
  (void)state;
#define NAMES                                                                                      \
  "[\"KHR_materials_clearcoat\",\"KHR_materials_transmission\",\"KHR_materials_ior\","             \
  "\"KHR_materials_specular\",\"KHR_materials_anisotropy\"]"
  pl_model *model = load_text(ASSET "\"extensionsUsed\":" NAMES ",\"extensionsRequired\":" NAMES
                                    "," SQUARE_DATA "," SQUARE_MESH ",\"nodes\":[{\"mesh\":0}]}");
  assert_string_equal(model->warnings, "");
  pl_model_destroy(model);
}

static void test_maps_warn(void **state) {
  (void)state;
  pl_model *model = load_text(WITH("\"KHR_materials_clearcoat\":{\"clearcoatFactor\":1,"
                                   "\"clearcoatTexture\":{\"index\":0}}"));
  assert_non_null(strstr(model->warnings, "clearcoatTexture is left out"));
  pl_model_destroy(model);
}

static void test_bad_numbers(void **state) {
  (void)state;
  static const char *const bad[] = {
      WITH("\"KHR_materials_clearcoat\":{\"clearcoatFactor\":1.5}"),
      WITH("\"KHR_materials_transmission\":{\"transmissionFactor\":\"much\"}"),
      WITH("\"KHR_materials_ior\":{\"ior\":0.5}"),
      WITH("\"KHR_materials_ior\":{\"ior\":-1}"),
      WITH("\"KHR_materials_specular\":{\"specularColorFactor\":[1,1]}"),
      WITH("\"KHR_materials_anisotropy\":{\"anisotropyStrength\":-0.1}"),
  };
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    pl_model *model;
    write_square();
    assert_int_equal(pl_gltf_load(write_text("model.gltf", bad[i]), &model), PL_E_FORMAT);
  }
}

#define in_own_folder(test) cmocka_unit_test_setup_teardown(test, folder_create, folder_remove)

int main(void) {
  const struct CMUnitTest tests[] = {
      in_own_folder(test_all_factors), in_own_folder(test_plain),
      in_own_folder(test_required),    in_own_folder(test_maps_warn),
      in_own_folder(test_bad_numbers),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
