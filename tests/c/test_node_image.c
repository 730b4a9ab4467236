/* Image nodes: what they read, where, and how far they blur. */
#include "graphs.h"

#include <math.h>

#include "base/memory.h"
#include "models.h"

/* Grey or RGBA of `codes`, row by row. */
static pl_texture *texture_of(const uint8_t *codes, int width, int height, int channels, bool srgb,
                              pl_wrap wrap) {
  const size_t size = (size_t)(width * height * channels);
  pl_image image = {
      .width = width, .height = height, .channels = channels, .texels = pl_alloc(size, 1)};
  pl_texture *texture;
  assert_non_null(image.texels);
  memcpy(image.texels, codes, size);
  assert_int_equal(pl_texture_create(&image, srgb, wrap, wrap, &texture), PL_OK);
  return texture;
}

/* The node at the object's x and y. */
static void read_at(const pl_texture *texture, float x, float y, float radius, size_t output,
                    pl_value out) {
  test_graph g = {0};
  const pl_graph_point p = graph_point(x, y, 0.0f, radius);
  const size_t where = graph_add(&g, "coordinates"), node = graph_add(&g, "image");
  graph_constant(&g, node, "file")->texture = texture;
  graph_link(&g, node, "vector", where, 0);
  graph_value_at(g, node, output, &p, out);
}

static const uint8_t row[4] = {0, 85, 170, 255}; /* 0, 1/3, 2/3, 1 */

/* Texel centres are at 1/8, 3/8, 5/8 and 7/8. */
static void test_wrap_modes(void **state) {
  (void)state;
  static const struct {
    pl_wrap wrap;
    float x, value;
  } cases[] = {{PL_WRAP_REPEAT, 0.375f, 1.0f / 3.0f},
               {PL_WRAP_REPEAT, 1.375f, 1.0f / 3.0f},
               {PL_WRAP_REPEAT, -0.125f, 1.0f},
               {PL_WRAP_REPEAT, 1.0f, 0.5f},
               {PL_WRAP_CLAMP, 0.375f, 1.0f / 3.0f},
               {PL_WRAP_CLAMP, 7.0f, 1.0f},
               {PL_WRAP_CLAMP, -7.0f, 0.0f},
               {PL_WRAP_MIRROR, 1.375f, 2.0f / 3.0f},
               {PL_WRAP_MIRROR, -0.375f, 1.0f / 3.0f},
               {PL_WRAP_MIRROR, 2.125f, 0.0f},
               {PL_WRAP_MIRROR, 1.0f, 1.0f}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    pl_texture *texture = texture_of(row, 4, 1, 1, false, cases[i].wrap);
    pl_value v;
    read_at(texture, cases[i].x, 0.3f, 0.0f, 0, v);
    if (!(fabsf(v[0] - cases[i].value) < 1e-5f))
      fail_msg("case %d: %g", (int)i, (double)v[0]);
    assert_true(v[0] == v[1] && v[1] == v[2] && v[3] == 0.0f);
    pl_texture_destroy(texture);
  }
}

/* Code 188 is 0.5029 of the light: ((188/255 + 0.055) / 1.055)^2.4 (IEC 61966-2-1). */
static void test_color_spaces_and_alpha(void **state) {
  (void)state;
  static const uint8_t texel[4] = {188, 255, 0, 51};
  for (int srgb = 0; srgb < 2; srgb++) {
    pl_texture *texture = texture_of(texel, 1, 1, 4, srgb != 0, PL_WRAP_REPEAT);
    pl_value v;
    read_at(texture, 0.7f, -3.2f, 0.0f, 0, v);
    assert_true(fabsf(v[0] - (srgb ? 0.502886f : 188.0f / 255.0f)) < 1e-5f);
    assert_true(v[1] == 1.0f && v[2] == 0.0f);
    read_at(texture, 0.7f, -3.2f, 0.0f, 1, v);
    assert_true(fabsf(v[0] - 0.2f) < 1e-6f);
    pl_texture_destroy(texture);
  }
  test_graph g = {0}; /* no image */
  pl_value v;
  const pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, 0.0f);
  graph_value_at(g, graph_add(&g, "image"), 0, &p, v);
  assert_true(v[0] == 1.0f && v[1] == 1.0f && v[2] == 1.0f);
}

/* A checkered 63 x 33 image: sharp at no footprint, its mean from one of its own size on. */
static void test_footprints_blur_to_the_mean(void **state) {
  (void)state;
  static uint8_t codes[63 * 33];
  for (int i = 0; i < 63 * 33; i++)
    codes[i] = (i % 63 + i / 63) % 2 == 0 ? 255 : 0;
  pl_texture *texture = texture_of(codes, 63, 33, 1, false, PL_WRAP_REPEAT);
  float mean[4], last = 2.0f;
  pl_texture_mean(texture, mean);
  for (int octave = -12; octave <= 30; octave++) {
    pl_value v;
    read_at(texture, 0.5f / 63.0f, 0.5f / 33.0f, ldexpf(1.0f, octave), 0, v);
    const float contrast = fabsf(v[0] - mean[0]);
    assert_true(contrast <= last + 0.02f);
    if (octave >= 0)
      assert_true(contrast < 0.005f);
    last = contrast;
  }
  pl_value v;
  read_at(texture, 0.5f / 63.0f, 0.5f / 33.0f, 0.0f, 0, v);
  assert_true(fabsf(v[0] - 1.0f) < 1e-4f);
  read_at(texture, 0.1f, 0.1f, INFINITY, 0, v);
  assert_true(v[0] == mean[0]);
  pl_texture_destroy(texture);
}

/* Without a vector the node reads as a slot of a glTF material does, longish footprints included.
 */
static void test_without_a_vector_it_is_a_texture_of_the_model(void **state) {
  (void)state;
  static uint8_t codes[16 * 16 * 4];
  static const float uvs[2][8] = {{0, 0, 2, 0, 2, 3, 0, 3}, {1, 1, 0, 1, 0, 0, 1, 0}};
  test_random random = {.seed = 5};
  for (size_t i = 0; i < sizeof codes; i++)
    codes[i] = (uint8_t)random_below(&random, 256);
  pl_model *model = square_create(1.0);
  pl_texture *texture = texture_of(codes, 16, 16, 4, true, PL_WRAP_MIRROR);
  const pl_texture *list[1] = {texture};
  model->textures = (pl_texture **)list;
  for (int set = 0; set < 2; set++) {
    model->uvs[set] = pl_alloc(8, sizeof(float));
    memcpy(model->uvs[set], uvs[set], sizeof uvs[set]);
  }
  for (int i = 0; i < 200; i++) {
    test_graph g = {0};
    pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, i % 10 == 0 ? INFINITY : 0.1f);
    const float a = (float)random_unit(&random), b = (1.0f - a) * (float)random_unit(&random);
    const float size = (float)random_scale(&random, 1e-3, 10.0);
    p.model = model;
    p.triangle = (pl_triangle_point){.triangle = 1,
                                     .w = {a, b, 1.0f - a - b},
                                     .edge1 = {2.0f, 2.0f, 0.0f},
                                     .edge2 = {0.0f, 2.0f, 0.0f},
                                     .footprint_a = {size, 0.3f * size, 0.0f},
                                     .footprint_b = {0.0f, 0.01f * size, 0.0f}};
    const size_t node = graph_add(&g, "image");
    const int set = i % 2;
    p.filter = (pl_filter)(i % PL_FILTER_COUNT);
    graph_constant(&g, node, "file")->texture = texture;
    graph_choose(&g, node, "uv", set == 0 ? "uv" : "uv1");
    const pl_texture_slot slot = {0, set, PL_UV_IDENTITY};
    float expected[4];
    pl_value v;
    const pl_detail detail = {.maps = isfinite(p.radius), .filter = p.filter};
    pl_material_slot(model, &p.triangle, &slot, detail, expected);
    graph_value_at(g, node, 0, &p, v);
    assert_memory_equal(v, expected, 3 * sizeof(float));
    graph_value_at(g, node, 1, &p, v);
    assert_true(v[0] == expected[3]);
  }
  model->textures = NULL;
  pl_model_destroy(model);
  pl_texture_destroy(texture);
}

static void test_odd_places_are_finite(void **state) {
  (void)state;
  static const float odd[] = {0.0f, -0.0f, 1e-38f, 1e7f, 3e38f, -3e38f, NAN, INFINITY};
  pl_texture *texture = texture_of(row, 4, 1, 1, false, PL_WRAP_REPEAT);
  for (size_t i = 0; i < 8; i++)
    for (size_t k = 0; k < 8; k++) {
      pl_value v;
      read_at(texture, odd[i], odd[k], odd[(i + k) % 8], 0, v);
      assert_true(v[0] >= 0.0f && v[0] <= 1.0f);
    }
  pl_texture_destroy(texture);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_wrap_modes),
      cmocka_unit_test(test_color_spaces_and_alpha),
      cmocka_unit_test(test_footprints_blur_to_the_mean),
      cmocka_unit_test(test_without_a_vector_it_is_a_texture_of_the_model),
      cmocka_unit_test(test_odd_places_are_finite),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
