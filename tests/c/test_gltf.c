/* Reading glTF: geometry, nodes, accessors, attributes, materials. What is refused is in
 * test_gltf_hostile.c. Axes: the file is y-up, the model z-up: (x, y, z) -> (x, -z, y). */
#include "io/gltf.h"

#include <math.h>

#include "gltf_files.h"
#include "io/png_write.h"

static void axes_and_flat_normals(void **state) {
  (void)state;
  pl_model *model = load_nodes("{\"mesh\":0,\"name\":\"panel\"}");
  assert_int_equal(model->triangle_count, 2);
  assert_int_equal(model->vertex_count, 6); /* flat: no vertex is shared */
  vector_near(corner(model, 0, 0), 0, 0, 0);
  vector_near(corner(model, 0, 1), 1, 0, 0);
  vector_near(corner(model, 0, 2), 1, 0, 1);
  for (size_t v = 0; v < 6; v++)
    vector_near(model->normals + 3 * v, 0, -1, 0); /* +z of the file */
  normals_agree(model);
  vector_near(model->bounds_min, 0, 0, 0);
  vector_near(model->bounds_max, 1, 0, 1);
  assert_string_equal(model->parts[0].name, "panel");
  assert_string_equal(model->materials[0].name, "default");
  assert_string_equal(model->warnings, "");
  assert_null(model->uvs[0]);
  assert_null(model->tangents);
  assert_null(model->colors);
  pl_model_destroy(model);
}

/* The same rotation by quaternion, by matrix and through a parent. */
static void nodes_place_meshes(void **state) {
  (void)state;
  const char *const nodes[] = {
      "{\"mesh\":0,\"translation\":[10,20,30],\"rotation\":[0,0,0.70710678118,0.70710678118],"
      "\"scale\":[2,3,4]}",
      "{\"mesh\":0,\"matrix\":[0,2,0,0,-3,0,0,0,0,0,4,0,10,20,30,1]}",
      "{\"children\":[1],\"translation\":[10,20,30]},{\"mesh\":0,\"scale\":[2,3,4],"
      "\"rotation\":[0,0,0.70710678118,0.70710678118]}",
      "{\"mesh\":0,\"scale\":[2,3,4],\"rotation\":[0,0,0.70710678118,0.70710678118]},"
      "{\"children\":[0],\"translation\":[10,20,30]}"};
  for (int k = 0; k < 4; k++) {
    pl_model *model = load_nodes(nodes[k]);
    /* file (1, 1, 0) -> scaled (2, 3, 0) -> turned by 90 degrees (-3, 2, 0) -> (7, 22, 30) */
    vector_near(corner(model, 0, 2), 7, -30, 22);
    vector_near(model->normals, 0, -1, 0);
    normals_agree(model);
    pl_model_destroy(model);
  }
}

static void mirrored_nodes_keep_their_outside(void **state) {
  (void)state;
  pl_model *model = load_nodes("{\"mesh\":0,\"scale\":[-1,1,1]}");
  vector_near(model->normals, 0, -1, 0); /* still the file's +z side */
  normals_agree(model);
  pl_model_destroy(model);
  model = load_nodes("{\"mesh\":0,\"scale\":[1,1,-1]}");
  vector_near(model->normals, 0, 1, 0);
  normals_agree(model);
  pl_model_destroy(model);
}

/* With normals in the file, under a mirror and an uneven scale. */
static void given_normals_turn_with_the_mesh(void **state) {
  (void)state;
  const float slope = 0.70710678f;
  /* a triangle in the plane x + y = 0 with normals (1, 1, 0) / sqrt 2 */
  const float data[18] = {0,     0,     0, 0,     0,     -1, 1,     -1,    0,
                          slope, slope, 0, slope, slope, 0,  slope, slope, 0};
  write_file("n.bin", data, sizeof data);
  pl_model *model = load_text(
      ASSET
      "\"buffers\":[{\"byteLength\":72,\"uri\":\"n.bin\"}],"
      "\"bufferViews\":[{\"buffer\":0,\"byteLength\":72}],"
      "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
      "{\"bufferView\":0,\"byteOffset\":36,\"componentType\":5126,\"count\":3,"
      "\"type\":\"VEC3\"}],"
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1}}]}],"
      "\"nodes\":[{\"mesh\":0,\"scale\":[2,1,1]},{\"mesh\":0,\"scale\":[-2,1,1]}]}");
  assert_int_equal(model->triangle_count, 2);
  /* the plane becomes x / 2 + y = 0: normal (1, 2, 0) / sqrt 5; mirrored (-1, 2, 0) / sqrt 5 */
  const double r = sqrt(5);
  vector_near(model->normals, 1 / r, 0, 2 / r);
  vector_near(model->normals + 9, -1 / r, 0, 2 / r);
  double first[3], second[3];
  face_normal(model, 0, first);
  face_normal(model, 1, second);
  assert_true(first[0] * second[0] < 0 && first[2] * second[2] > 0);
  pl_model_destroy(model);
}

static void list_strip_and_fan_are_the_same(void **state) {
  (void)state;
  const unsigned char orders[3][6] = {{0, 1, 2, 0, 2, 3}, {0, 1, 3, 2}, {0, 1, 2, 3}};
  const int modes[3] = {4, 5, 6}, counts[3] = {6, 4, 4};
  for (int k = 0; k < 3; k++) {
    write_file("order.bin", orders[k], 6);
    char text[2048];
    snprintf(
        text, sizeof text,
        ASSET
        "\"buffers\":[{\"byteLength\":48,\"uri\":\"square.bin\"},"
        "{\"byteLength\":6,\"uri\":\"order.bin\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":1,\"byteLength\":6}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":"
        "\"VEC3\"},{\"bufferView\":1,\"componentType\":5121,\"count\":%d,\"type\":\"SCALAR\"}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,"
        "\"mode\":%d}]}],\"nodes\":[{\"mesh\":0}]}",
        counts[k], modes[k]);
    pl_model *model = load_text(text);
    assert_int_equal(model->triangle_count, 2);
    double area = 0;
    for (size_t t = 0; t < 2; t++) {
      double n[3];
      face_normal(model, t, n);
      assert_true(n[1] < 0); /* every triangle faces the same side */
      area -= n[1] / 2;
    }
    assert_true(fabs(area - 1) < 1e-6);
    pl_model_destroy(model);
  }
}

/* One square, its positions behind every kind of accessor. */
static void accessors_of_every_kind_are_read(void **state) {
  (void)state;
  float strided[4 * 5];
  for (int v = 0; v < 4; v++) {
    memcpy(strided + 5 * v, SQUARE + 3 * v, 12);
    strided[5 * v + 3] = strided[5 * v + 4] = 99;
  }
  write_file("strided.bin", strided, sizeof strided);
  const struct {
    int type;
    size_t size;
  } kinds[3] = {{5121, 1}, {5123, 2}, {5125, 4}};
  for (int k = 0; k < 3; k++) {
    unsigned char indices[24] = {0};
    for (size_t i = 0; i < 6; i++)
      indices[i * kinds[k].size] = SQUARE_INDICES[i]; /* little-endian */
    write_file("indices.bin", indices, 6 * kinds[k].size);
    char text[2048];
    snprintf(text, sizeof text,
             ASSET
             "\"buffers\":[{\"byteLength\":80,\"uri\":\"strided.bin\"},"
             "{\"byteLength\":%zu,\"uri\":\"indices.bin\"}],\"bufferViews\":["
             "{\"buffer\":0,\"byteLength\":80,\"byteStride\":20},"
             "{\"buffer\":1,\"byteLength\":%zu}],\"accessors\":["
             "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
             "{\"bufferView\":1,\"componentType\":%d,\"count\":6,\"type\":\"SCALAR\"}]," SQUARE_MESH
             ",\"nodes\":[{\"mesh\":0}]}",
             6 * kinds[k].size, 6 * kinds[k].size, kinds[k].type);
    pl_model *model = load_text(text);
    assert_int_equal(model->triangle_count, 2);
    vector_near(corner(model, 1, 2), 0, 0, 1);
    vector_near(model->bounds_max, 1, 0, 1);
    pl_model_destroy(model);
  }
}

/* Zeros with three of four elements replaced; the indices of the values are out of order, as some
 * exporters write them. */
static void sparse_accessors_are_read(void **state) {
  (void)state;
  unsigned char data[4 + 36];
  const unsigned char order[4] = {3, 1, 2, 0};
  const float values[9] = {0, 1, 0, 1, 0, 0, 1, 1, 0};
  memcpy(data, order, 4);
  memcpy(data + 4, values, 36);
  write_file("sparse.bin", data, sizeof data);
  pl_model *model = load_text(
      ASSET
      "\"buffers\":[{\"byteLength\":88,\"uri\":\"square.bin\"},"
      "{\"byteLength\":40,\"uri\":\"sparse.bin\"}],\"bufferViews\":["
      "{\"buffer\":1,\"byteLength\":3},{\"buffer\":1,\"byteOffset\":4,\"byteLength\":36},"
      "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":6}],\"accessors\":["
      "{\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"sparse\":{\"count\":3,"
      "\"indices\":{\"bufferView\":0,\"componentType\":5121},\"values\":{\"bufferView\":1}}},"
      "{\"bufferView\":2,\"componentType\":5121,\"count\":6,\"type\":\"SCALAR\"}]," SQUARE_MESH
      ",\"nodes\":[{\"mesh\":0}]}");
  assert_int_equal(model->triangle_count, 2);
  vector_near(corner(model, 0, 1), 1, 0, 0);
  vector_near(corner(model, 1, 1), 1, 0, 1);
  vector_near(corner(model, 1, 2), 0, 0, 1);
  pl_model_destroy(model);
}

static void normalised_integers_become_fractions(void **state) {
  (void)state;
  const unsigned char data[4 * 8] = {0,   51, 102, 255,  0xFF, 0xFF, 0,    0,    255,  0,   0,
                                     255, 0,  0,   0xFF, 0xFF, 0,    255,  0,    51,   0,   0,
                                     0,   0,  0,   0,    255,  0,    0xFF, 0xFF, 0xFF, 0xFF};
  write_file("colors.bin", data, sizeof data);
  pl_model *model = load_text(
      ASSET
      "\"buffers\":[{\"byteLength\":88,\"uri\":\"square.bin\"},"
      "{\"byteLength\":32,\"uri\":\"colors.bin\"}],\"bufferViews\":["
      "{\"buffer\":0,\"byteLength\":48},{\"buffer\":1,\"byteLength\":32,\"byteStride\":8}],"
      "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
      "{\"bufferView\":1,\"componentType\":5121,\"normalized\":true,\"count\":4,\"type\":\"VEC4\"},"
      "{\"bufferView\":1,\"byteOffset\":4,\"componentType\":5123,\"normalized\":true,\"count\":4,"
      "\"type\":\"VEC2\"}],\"meshes\":[{\"primitives\":[{\"mode\":6,\"attributes\":{\"POSITION\":0,"
      "\"COLOR_0\":1,\"TEXCOORD_0\":2,\"TEXCOORD_1\":2}}]}],\"nodes\":[{\"mesh\":0}]}");
  assert_non_null(model->colors);
  /* vertex of the square at (0, 0) of the file is the last corner of each fan triangle */
  const size_t v = model->indices[2];
  vector_near(model->colors + 4 * v, 0, 0.2, 0.4);
  assert_true(model->colors[4 * v + 3] == 1.0f);
  assert_true(model->uvs[0][2 * v] == 1.0f && model->uvs[0][2 * v + 1] == 0.0f);
  assert_memory_equal(model->uvs[0], model->uvs[1], 2 * model->vertex_count * sizeof(float));
  pl_model_destroy(model);
}

static void degenerate_triangles_are_counted(void **state) {
  (void)state;
  const float data[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 0, 0, NAN, 0, 0};
  const unsigned char order[12] = {0, 1, 2, 0, 1, 3, 0, 0, 1, 0, 1, 4};
  unsigned char bytes[72];
  memcpy(bytes, data, 60);
  memcpy(bytes + 60, order, 12);
  write_file("d.bin", bytes, sizeof bytes);
  pl_model *model = load_text(
      ASSET
      "\"buffers\":[{\"byteLength\":72,\"uri\":\"d.bin\"}],\"bufferViews\":["
      "{\"buffer\":0,\"byteLength\":60},{\"buffer\":0,\"byteOffset\":60,\"byteLength\":12}],"
      "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":5,\"type\":\"VEC3\"},"
      "{\"bufferView\":1,\"componentType\":5121,\"count\":12,\"type\":\"SCALAR\"}]," SQUARE_MESH
      ",\"nodes\":[{\"mesh\":0}]}");
  assert_int_equal(model->triangle_count, 1);
  assert_int_equal(model->vertex_count, 3);
  warned(model, "2 zero-area triangles");
  warned(model, "1 triangles with non-finite positions");
  vector_near(model->bounds_max, 1, 0, 1);
  pl_model_destroy(model);
}

static void bad_normals_are_repaired(void **state) {
  (void)state;
  const float normals[12] = {0, 0, 0, NAN, 0, 1, 0, 0, 2, 0, 0, 1};
  write_file("bad.bin", normals, sizeof normals);
  pl_model *model = load_text(
      ASSET "\"buffers\":[{\"byteLength\":88,\"uri\":\"square.bin\"},"
            "{\"byteLength\":48,\"uri\":\"bad.bin\"}],\"bufferViews\":["
            "{\"buffer\":0,\"byteLength\":48},{\"buffer\":1,\"byteLength\":48}],\"accessors\":["
            "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
            "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}],\"meshes\":["
            "{\"primitives\":[{\"mode\":6,\"attributes\":{\"POSITION\":0,\"NORMAL\":1}}]}],"
            "\"nodes\":[{\"mesh\":0}]}");
  assert_int_equal(model->vertex_count, 4);
  warned(model, "2 degenerate normals");
  for (size_t v = 0; v < 4; v++)
    vector_near(model->normals + 3 * v, 0, -1, 0);
  pl_model_destroy(model);
}

/* The scene named decides; without one the first; without scenes all roots. */
static void the_default_scene_is_read(void **state) {
  (void)state;
#define TWO_SCENES                                                                                 \
  ASSET SQUARE_DATA "," SQUARE_MESH ",\"nodes\":[{\"mesh\":0},{\"mesh\":0},{\"mesh\":0}],"         \
                    "\"scenes\":[{\"nodes\":[0]},{\"nodes\":[1,2]}]"
  const char *const texts[3] = {TWO_SCENES "}", TWO_SCENES ",\"scene\":1}",
                                ASSET SQUARE_DATA "," SQUARE_MESH
                                                  ",\"nodes\":[{\"mesh\":0},{},{\"mesh\":0},"
                                                  "{\"mesh\":0}]}"};
  for (size_t k = 0; k < 3; k++) {
    pl_model *model = load_text(texts[k]);
    assert_int_equal(model->part_count, k + 1);
    assert_int_equal(model->triangle_count, 2 * (k + 1));
    pl_model_destroy(model);
  }
}

static void what_cannot_be_rendered_is_named(void **state) {
  (void)state;
  pl_model *model = load_text(
      ASSET SQUARE_DATA
      ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1},"
      "{\"attributes\":{\"POSITION\":0},\"mode\":0},{\"attributes\":{\"POSITION\":0},\"mode\":3},"
      "{\"attributes\":{\"TEXCOORD_0\":2}}]}],\"nodes\":[{\"mesh\":0}],\"cameras\":[{}],"
      "\"animations\":[{}],\"skins\":[{}],\"extensionsUsed\":[\"VENDOR_entity\"]}");
  assert_int_equal(model->part_count, 1);
  warned(model, "1 primitives of points");
  warned(model, "1 primitives of lines");
  warned(model, "1 primitives without POSITION");
  warned(model, "cameras");
  warned(model, "animations");
  warned(model, "skins");
  warned(model, "VENDOR_entity");
  pl_model_destroy(model);
}

#define MATERIAL_FILE(material, attributes)                                                        \
  ASSET SQUARE_DATA ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0" attributes     \
                    "},\"indices\":1,\"material\":0}]}],\"nodes\":[{\"mesh\":0}],"                 \
                    "\"images\":[{\"uri\":\"t%2Bx.png\"}],\"samplers\":[{\"wrapS\":33071,"         \
                    "\"wrapT\":33648}],\"textures\":[{\"source\":0,\"sampler\":0}],"               \
                    "\"materials\":[" material "]}"

static void write_texture(void) {
  const unsigned char texels[4 * 3] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
  assert_int_equal(pl_png_write(in_folder("t+x.png"), texels, 2, 2, 3, 8, 6), PL_OK);
}

static pl_model *load_material(const char *text) {
  write_texture();
  return load_text(text);
}

static void materials_are_read(void **state) {
  (void)state;
  pl_model *model = load_material(MATERIAL_FILE(
      "{\"name\":\"foil\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.1,0.2,0.3,0.4],"
      "\"metallicFactor\":0.5,\"roughnessFactor\":0.6,\"baseColorTexture\":{\"index\":0},"
      "\"metallicRoughnessTexture\":{\"index\":0}},\"emissiveFactor\":[0.5,0.25,0],"
      "\"emissiveTexture\":{\"index\":0},\"alphaMode\":\"MASK\",\"alphaCutoff\":0.7,"
      "\"doubleSided\":true,\"extensions\":{\"KHR_materials_unlit\":{},"
      "\"KHR_materials_emissive_strength\":{\"emissiveStrength\":4}}}",
      ",\"TEXCOORD_0\":2"));
  const pl_material *m = &model->materials[0];
  assert_string_equal(m->name, "foil");
  vector_near(m->base_color, 0.1, 0.2, 0.3);
  vector_near(m->emissive, 2, 1, 0);
  assert_true(m->base_color[3] == 0.4f && m->metallic == 0.5f && m->roughness == 0.6f);
  assert_true(m->alpha_mode == PL_ALPHA_MASK && m->alpha_cutoff == 0.7f);
  assert_true(m->double_sided && !m->lambert);
  assert_non_null(strstr(model->warnings, "materials[0]: KHR_materials_unlit is not followed"));
  assert_int_equal(model->material_count, 1);
  /* one image in two roles: colours are decoded, factors are not */
  assert_int_equal(model->texture_count, 2);
  assert_int_equal(m->base_color_map.texture, m->emissive_map.texture);
  assert_int_not_equal(m->base_color_map.texture, m->metallic_roughness_map.texture);
  assert_int_equal(m->normal_map.texture, -1);
  float out[4];
  const float nothing[2] = {0, 0};
  const pl_texture *texture = model->textures[m->base_color_map.texture];
  pl_texture_sample(texture, -5, 0.25f, nothing, nothing, PL_FILTER_FINEST, out); /* clamped in u */
  vector_near(out, 1, 0, 0);
  pl_texture_sample(texture, 0.25f, 1.25f, nothing, nothing, PL_FILTER_FINEST,
                    out); /* mirrored in v */
  vector_near(out, 0, 0, 1);
  pl_model_destroy(model);
}

static void maps_without_coordinates_are_left_out(void **state) {
  (void)state;
  pl_model *model = load_material(
      MATERIAL_FILE("{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}},"
                    "\"normalTexture\":{\"index\":0}},{\"name\":\"unused\",\"emissiveTexture\":"
                    "{\"index\":0}}",
                    ""));
  assert_int_equal(model->texture_count, 0);
  assert_int_equal(model->materials[0].base_color_map.texture, -1);
  assert_int_equal(model->materials[0].normal_map.texture, -1);
  assert_int_equal(model->materials[1].emissive_map.texture, -1);
  assert_null(model->tangents);
  warned(model, "TEXCOORD_0");
  pl_model_destroy(model);
}

/* Khronos' TextureTransformTest: its arrow points to (0.778, 0.778) of the texture and, under these
 * transforms, to markers at (0.421, 1.016) and (0.43, 0.75) of the square. */
static void texture_transforms_follow_the_sample(void **state) {
  (void)state;
  const struct {
    const char *transform;
    double u, v, to_u, to_v, tolerance;
  } cases[] = {
      {"\"rotation\":0.39269908169872414", 0.42095, 1.01627, 0.77782, 0.77782, 1e-4},
      {"\"offset\":[-0.2,-0.1],\"rotation\":0.3,\"scale\":[1.5,1.5]", 0.43, 0.75, 0.75, 0.78, 0.01},
      {"\"offset\":[0.5,0],\"scale\":[2,3]", 0.1, 0.2, 0.7, 0.6, 1e-6},
  };
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    char text[4096];
    const char *const file =
        MATERIAL_FILE("{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,"
                      "\"texCoord\":7,\"extensions\":{\"KHR_texture_transform\":{"
                      "\"texCoord\":0,TRANSFORM}}}}}",
                      ",\"TEXCOORD_0\":2");
    const char *const at = strstr(file, "TRANSFORM");
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - file), file, cases[k].transform,
             at + strlen("TRANSFORM"));
    pl_model *model = load_material(text);
    const pl_texture_slot *slot = &model->materials[0].base_color_map;
    assert_int_equal(slot->uv_set, 0);
    double out[2];
    for (int r = 0; r < 2; r++)
      out[r] = (double)slot->transform.m[r][0] * cases[k].u +
               (double)slot->transform.m[r][1] * cases[k].v + (double)slot->transform.m[r][2];
    assert_true(fabs(out[0] - cases[k].to_u) < cases[k].tolerance);
    assert_true(fabs(out[1] - cases[k].to_v) < cases[k].tolerance);
    pl_model_destroy(model);
  }
}

/* An upright image on the square: u grows with x, so the tangent is +x, and the image's up, against
 * v, is cross(normal, tangent): w = 1. */
static void tangents_follow_the_texture(void **state) {
  (void)state;
  const char *const file =
      MATERIAL_FILE("{\"normalTexture\":{\"index\":0,\"scale\":0.5}}", ",\"TEXCOORD_0\":2");
  pl_model *model = load_material(file);
  assert_non_null(model->tangents);
  assert_true(model->materials[0].normal_scale == 0.5f);
  assert_int_equal(model->materials[0].normal_map.texture, 0);
  for (size_t v = 0; v < model->vertex_count; v++) {
    vector_near(model->tangents + 4 * v, 1, 0, 0);
    assert_true(model->tangents[4 * v + 3] == 1.0f);
  }
  pl_model_destroy(model);
}

/* Two triangles share an edge and its vertices; the second is a mirror image in uv. */
static void mirrored_texture_splits_vertices(void **state) {
  (void)state;
  /* positions, normals, uvs of (0,0) (1,0) (0,1) (-1,0), all facing +z of the file */
  const float data[12 + 12 + 8] = {0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 0, 0, 0, 0, 1, 0,
                                   0, 1, 0, 0, 1, 0, 0, 1, 0, 1,  1, 1, 0, 0, 1, 1};
  const unsigned char order[6] = {0, 1, 2, 0, 2, 3};
  unsigned char bytes[136] = {0};
  memcpy(bytes, data, 128);
  memcpy(bytes + 128, order, 6);
  write_file("mirror.bin", bytes, sizeof bytes);
  write_texture();
  pl_model *model = load_text(
      ASSET
      "\"buffers\":[{\"byteLength\":136,\"uri\":\"mirror.bin\"}],\"bufferViews\":["
      "{\"buffer\":0,\"byteLength\":136}],\"accessors\":["
      "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
      "{\"bufferView\":0,\"byteOffset\":48,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
      "{\"bufferView\":0,\"byteOffset\":96,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
      "{\"bufferView\":0,\"byteOffset\":128,\"componentType\":5121,\"count\":6,\"type\":\"SCALAR\"}"
      "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,"
      "\"TEXCOORD_0\":2},\"indices\":3,\"material\":0}]}],\"nodes\":[{\"mesh\":0}],"
      "\"images\":[{\"uri\":\"t+x.png\"}],\"textures\":[{\"source\":0}],"
      "\"materials\":[{\"normalTexture\":{\"index\":0}}]}");
  assert_int_equal(model->vertex_count, 6);
  for (size_t t = 0; t < 2; t++) {
    for (size_t k = 0; k < 3; k++) {
      const size_t v = model->indices[3 * t + k];
      vector_near(model->tangents + 4 * v, t == 0 ? 1 : -1, 0, 0);
      assert_true(model->tangents[4 * v + 3] == (t == 0 ? 1.0f : -1.0f));
      vector_near(model->normals + 3 * v, 0, -1, 0);
    }
  }
  pl_model_destroy(model);
}

#define in_own_folder(test) cmocka_unit_test_setup_teardown(test, folder_create, folder_remove)

int main(void) {
  const struct CMUnitTest tests[] = {
      in_own_folder(axes_and_flat_normals),
      in_own_folder(nodes_place_meshes),
      in_own_folder(mirrored_nodes_keep_their_outside),
      in_own_folder(given_normals_turn_with_the_mesh),
      in_own_folder(list_strip_and_fan_are_the_same),
      in_own_folder(accessors_of_every_kind_are_read),
      in_own_folder(sparse_accessors_are_read),
      in_own_folder(normalised_integers_become_fractions),
      in_own_folder(degenerate_triangles_are_counted),
      in_own_folder(bad_normals_are_repaired),
      in_own_folder(the_default_scene_is_read),
      in_own_folder(what_cannot_be_rendered_is_named),
      in_own_folder(materials_are_read),
      in_own_folder(maps_without_coordinates_are_left_out),
      in_own_folder(texture_transforms_follow_the_sample),
      in_own_folder(tangents_follow_the_texture),
      in_own_folder(mirrored_texture_splits_vertices),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
