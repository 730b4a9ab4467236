/* EXT_texture_webp: textures whose images are WebP. */
#include <webp/encode.h>

#include "gltf_files.h"

#define WEBP_FILE(texture, images)                                                                 \
  ASSET SQUARE_DATA ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"               \
                    "\"TEXCOORD_0\":2},\"indices\":1,\"material\":0}]}],\"nodes\":[{\"mesh\":0}]," \
                    "\"images\":[" images "],\"textures\":[" texture                               \
                    "],\"materials\":[{\"emissiveTexture\":{\"index\":0}}],"                       \
                    "\"extensionsUsed\":[\"EXT_texture_webp\"],"                                   \
                    "\"extensionsRequired\":[\"EXT_texture_webp\"]}"

/* The image of the extension is taken, with a fallback or without; the fallback is not decoded. */
static void textures_are_taken_from_webp(void **state) {
  (void)state;
  const unsigned char texels[4 * 3] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
  uint8_t *made;
  const size_t size = WebPEncodeLosslessRGB(texels, 2, 2, 6, &made);
  assert_true(size > 0);
  const char *const files[] = {
      WEBP_FILE("{\"extensions\":{\"EXT_texture_webp\":{\"source\":0}}}",
                "{\"uri\":\"skin.webp\",\"mimeType\":\"image/webp\"}"),
      WEBP_FILE("{\"source\":0,\"extensions\":{\"EXT_texture_webp\":{\"source\":1}}}",
                "{\"uri\":\"square.bin\"},{\"uri\":\"skin.webp\"}")};
  for (int k = 0; k < 2; k++) {
    write_file("skin.webp", made, size);
    pl_model *model = load_text(files[k]);
    assert_string_equal(model->warnings, "");
    assert_int_equal(model->texture_count, 1);
    float out[4];
    const float nothing[2] = {0, 0};
    pl_texture_sample(model->textures[0], 0.25f, 0.75f, nothing, nothing, PL_FILTER_FINEST, out);
    vector_near(out, 0, 0, 1);
    pl_model_destroy(model);
  }
  WebPFree(made);
}

#define in_own_folder(test) cmocka_unit_test_setup_teardown(test, folder_create, folder_remove)

int main(void) {
  const struct CMUnitTest tests[] = {
      in_own_folder(textures_are_taken_from_webp),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
