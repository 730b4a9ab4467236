/* Layers of glTF materials, by the texts of their KHR_materials_* specifications. */
#include "harness.h"

#include <math.h>

#include "gltf_files.h"
#include "io/png_write.h"
#include "shade/material_surface.h"
#include "shade/reflectance.h"

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

/* A tenth of green passes 2 units, all of red and, by 1e-6, none of blue. */
static void test_volume(void **state) {
  (void)state;
  pl_model *model =
      load_text(WITH("\"KHR_materials_transmission\":{\"transmissionFactor\":1},"
                     "\"KHR_materials_volume\":{\"thicknessFactor\":0.5,\"attenuationDistance\":2,"
                     "\"attenuationColor\":[1,0.1,0]}"));
  const pl_material_layers *l = &model->materials[0].layers;
  assert_true(l->solid && l->extinction[0] == 0.0f);
  assert_true(model->materials[0].double_sided); /* or rays inside would not meet it */
  assert_true(fabsf(l->extinction[1] - 1.1512925f) < 1e-6f);
  assert_true(fabsf(l->extinction[2] - 6.9077553f) < 1e-5f);
  assert_string_equal(model->warnings, "");
  pl_model_destroy(model);
  model = load_text(WITH("\"KHR_materials_transmission\":{\"transmissionFactor\":1},"
                         "\"KHR_materials_volume\":{}"));
  assert_false(model->materials[0].layers.solid);
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

/* A mapped square with one texture, of which every texel is (51, 102, 153)/255. */
#define MAPPED(extensions, attributes)                                                             \
  ASSET "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"                                   \
        "\"images\":[{\"uri\":\"t.png\"}],\"textures\":[{\"source\":0}],"                          \
        "\"materials\":[{\"extensions\":{" extensions "}}],"                                       \
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0" attributes "},"             \
        "\"indices\":1,\"material\":0}]}]," SQUARE_DATA "}"
#define MAP(name) "\"" name "\":{\"index\":0}"
#define UVS ",\"TEXCOORD_0\":2"

static pl_model *load_mapped(const char *text) {
  const unsigned char texel[3] = {51, 102, 153};
  assert_int_equal(pl_png_write(in_folder("t.png"), texel, 1, 1, 3, 8, 6), PL_OK);
  return load_text(text);
}

/* The surface in the middle of triangle 0. */
static pl_surface surface_of(const pl_model *model) {
  const float third = 1.0f / 3.0f;
  const pl_triangle_point point = {.w = {third, third, third}};
  pl_surface s = {.t = {1.0f, 0.0f, 0.0f}, .b = {0.0f, 1.0f, 0.0f}, .n = {0.0f, 0.0f, 1.0f}};
  pl_material_surface(model, &point, PL_DETAIL_FULL, &s);
  return s;
}

static bool near(float a, double b) { return fabs((double)a - b) < 1e-5; }

/* Each map times its factor, in the channel that its specification names. */
static void test_all_maps(void **state) {
  (void)state;
  pl_model *model = load_mapped(MAPPED(
      "\"KHR_materials_clearcoat\":{\"clearcoatFactor\":0.5,\"clearcoatRoughnessFactor\":0."
      "5," MAP("clearcoatTexture") "," MAP(
          "clearcoatRoughnessTexture") ","
                                       "\"clearcoatNormalTexture\":{\"index\":0,\"scale\":"
                                       "0.5}},"
                                       "\"KHR_materials_transmission\":{"
                                       "\"transmissionFactor\":0.5," MAP(
                                           "transmissionTexture") "},"
                                                                  "\"KHR_materials_ior\":{"
                                                                  "\"ior\":3},"
                                                                  "\"KHR_materials_"
                                                                  "specular\":{"
                                                                  "\"specularFactor\":0.5,"
                                                                  "\"specularColorFactor\":"
                                                                  "[1,0.5,1]," MAP(
                                                                      "specula"
                                                                      "rTextur"
                                                                      "e") "," MAP("specularColorTe"
                                                                                   "xtur"
                                                                                   "e") "},"
                                                                                        "\"KHR_"
                                                                                        "materials_"
                                                                                        "anisotropy"
                                                                                        "\":{"
                                                                                        "\"anisotro"
                                                                                        "pyStr"
                                                                                        "ength\":0."
                                                                                        "5," MAP(
                                                                                            "anisot"
                                                                                            "ropyT"
                                                                                            "extur"
                                                                                            "e") "}",
      UVS));
  assert_string_equal(model->warnings, "");
  const pl_surface s = surface_of(model);
  assert_ptr_equal(s.reflectance, &pl_reflectance_principled);
  assert_true(near(s.lobes.coat, 0.5 * 0.2) && near(s.lobes.coat_alpha, 0.04));
  assert_true(near(s.lobes.transmission, 0.5 * 0.2) && near(s.lobes.anisotropy, 0.5 * 0.6));
  /* F0 of index 3 is 0.25; alpha of a picture without any is 1; IEC 61966-2-1 for the tint. */
  const double red = pow((0.2 + 0.055) / 1.055, 2.4), green = pow((0.4 + 0.055) / 1.055, 2.4);
  assert_true(near(s.lobes.f0.x, 0.5 * 0.25 * red) && near(s.lobes.f0.y, 0.25 * 0.25 * green));
  /* The coat's normal: twice the picture less 1, scaled across; the base is not bent. */
  const double x = -0.6 * 0.5, y = -0.2 * 0.5, z = 0.2, n = sqrt(x * x + y * y + z * z);
  assert_true(near(s.n.z, 1.0) && near(s.lobes.coat_normal.x, x / n));
  assert_true(near(s.lobes.coat_normal.y, y / n) && near(s.lobes.coat_normal.z, z / n));
  /* The direction of the highlights is (-0.6, -0.2) from the tangent. */
  assert_true(near(s.t.x, -0.6 / sqrt(0.4)) && near(s.t.y, -0.2 / sqrt(0.4)));
  pl_model_destroy(model);
}

/* Over a base with a normal map a coat without one is flat. */
static void test_coat_over_bumps_is_flat(void **state) {
  (void)state;
  pl_model *model = load_mapped(MAPPED("\"KHR_materials_clearcoat\":{\"clearcoatFactor\":1}},"
                                       "\"normalTexture\":{\"index\":0},\"extras\":{",
                                       UVS));
  const pl_surface s = surface_of(model);
  assert_true(s.n.z < 0.5f && near(s.lobes.coat_normal.z, 1.0));
  pl_model_destroy(model);
}

/* Maps of layers that are off are not even decoded. */
static void test_maps_of_nothing(void **state) {
  (void)state;
  pl_model *model = load_mapped(MAPPED(
      "\"KHR_materials_ior\":{},\"KHR_materials_clearcoat\":{" MAP("clearcoatTexture") "}", UVS));
  assert_int_equal(model->texture_count, 0);
  assert_null(model->tangents);
  pl_model_destroy(model);
}

static void test_bad_maps(void **state) {
  (void)state;
  refuse_text(MAPPED("\"KHR_materials_clearcoat\":{\"clearcoatTexture\":{\"index\":7}}", UVS),
              PL_E_FORMAT, "clearcoatTexture.index: 7, but the file has 1 textures");
  refuse_text(MAPPED("\"KHR_materials_anisotropy\":{\"anisotropyTexture\":[]}", UVS), PL_E_FORMAT,
              "anisotropyTexture: must be an object");
}

#define TURNED "\"KHR_materials_anisotropy\":{\"anisotropyStrength\":1}"

/* Without any map anisotropy has a tangent: along growing u, or, without texture coordinates, any
 * across the normal. */
static void test_anisotropy_has_tangents(void **state) {
  (void)state;
  for (int mapped = 0; mapped < 2; mapped++) {
    pl_model *model = load_mapped(mapped ? MAPPED(TURNED, UVS) : MAPPED(TURNED, ""));
    assert_string_equal(model->warnings, "");
    assert_true((model->tangents != NULL) == (mapped == 1));
    for (size_t v = 0; mapped && v < model->vertex_count; v++)
      assert_true(near(model->tangents[4 * v], 1.0) && near(model->tangents[4 * v + 3], 1.0));
    pl_model_destroy(model);
  }
}

/* A file's own tangents need no texture coordinates; those of no length are any unit vector across
 * the normal. The first corner's tangent is (0, 2, 0), the others' are nothing. */
static void test_tangents_of_no_length(void **state) {
  (void)state;
  float numbers[12 + 12 + 16] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0,
                                 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 2, 0, 1};
  unsigned char bytes[sizeof numbers + 8] = {0};
  memcpy(bytes, numbers, sizeof numbers);
  memcpy(bytes + sizeof numbers, SQUARE_INDICES, 8);
  write_file("own.bin", bytes, sizeof bytes);
  pl_model *model = load_text(
      ASSET "\"buffers\":[{\"byteLength\":168,\"uri\":\"own.bin\"}],\"bufferViews\":[{\"buffer\":0,"
            "\"byteLength\":168}],\"accessors\":["
            "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
            "{\"bufferView\":0,\"byteOffset\":48,\"componentType\":5126,\"count\":4,"
            "\"type\":\"VEC3\"},{\"bufferView\":0,\"byteOffset\":96,\"componentType\":5126,"
            "\"count\":4,\"type\":\"VEC4\"},{\"bufferView\":0,\"byteOffset\":160,"
            "\"componentType\":5121,\"count\":6,\"type\":\"SCALAR\"}],"
            "\"nodes\":[{\"mesh\":0}],\"materials\":[{\"extensions\":{" TURNED "}}],"
            "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,"
            "\"TANGENT\":2},\"indices\":3,\"material\":0}]}]}");
  assert_non_null(model->tangents);
  for (size_t v = 0; v < model->vertex_count; v++) {
    const float *t = model->tangents + 4 * v, *n = model->normals + 3 * v;
    assert_true(near(t[0] * t[0] + t[1] * t[1] + t[2] * t[2], 1.0));
    assert_true(near(t[0] * n[0] + t[1] * n[1] + t[2] * n[2], 0.0));
    if (v == 0) /* y up in the file is z up */
      assert_true(near(t[2], 1.0));
  }
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
      WITH("\"KHR_materials_volume\":{\"attenuationDistance\":0}"),
      WITH("\"KHR_materials_volume\":{\"attenuationColor\":[1,1]}"),
  };
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    pl_model *model;
    write_square();
    assert_int_equal(pl_gltf_load(write_text("model.gltf", bad[i]), NULL, &model), PL_E_FORMAT);
  }
}

#define in_own_folder(test) cmocka_unit_test_setup_teardown(test, folder_create, folder_remove)

int main(void) {
  const struct CMUnitTest tests[] = {
      in_own_folder(test_all_factors),
      in_own_folder(test_volume),
      in_own_folder(test_plain),
      in_own_folder(test_required),
      in_own_folder(test_all_maps),
      in_own_folder(test_coat_over_bumps_is_flat),
      in_own_folder(test_maps_of_nothing),
      in_own_folder(test_bad_maps),
      in_own_folder(test_anisotropy_has_tangents),
      in_own_folder(test_tangents_of_no_length),
      in_own_folder(test_bad_numbers),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
