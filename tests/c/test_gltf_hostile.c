/* Reading glTF files that are broken or made to do harm: each is refused with a text that names
 * file and fault, and none crashes, reads outside the model's folder or takes memory it cannot
 * justify. */
#include "io/gltf.h"

#include <sys/stat.h>

#include "gltf_files.h"
#include "random.h"

#define GOOD ASSET SQUARE_DATA "," SQUARE_MESH ",\"nodes\":[{\"mesh\":0}]}"

static void the_file_the_others_spoil_is_good(void **state) {
  (void)state;
  pl_model *model = load_text(GOOD);
  assert_int_equal(model->triangle_count, 2);
  pl_model_destroy(model);
}

static void files_stay_in_the_folder(void **state) {
  (void)state;
  write_file("../pl_test_outside.bin", SQUARE, sizeof SQUARE);
  const char *const escapes[] = {"../pl_test_outside.bin",
                                 "%2e%2e/pl_test_outside.bin",
                                 "%2E%2E%2Fpl_test_outside.bin",
                                 "sub/../../pl_test_outside.bin",
                                 "./.././square.bin",
                                 "/etc/passwd",
                                 "%2Fetc%2Fpasswd"};
  for (size_t k = 0; k < sizeof escapes / sizeof escapes[0]; k++)
    refuse_edit(GOOD, "square.bin", escapes[k], PL_E_FORMAT, "outside the model's folder");
  refuse_edit(GOOD, "square.bin", "http://example.com/a.bin", PL_E_FORMAT, "URL");
  refuse_edit(GOOD, "square.bin", "file:///etc/passwd", PL_E_FORMAT, "URL");
  refuse_edit(GOOD, "square.bin", "", PL_E_FORMAT, "names no file");
  refuse_edit(GOOD, "square.bin", "a%00b", PL_E_FORMAT, "names no file");
  refuse_edit(GOOD, "square.bin", "a%zz", PL_E_FORMAT, "escape");
  refuse_edit(GOOD, "square.bin", "gone.bin", PL_E_IO, "missing file \"gone.bin\"");
  assert_int_equal(mkdir(in_folder("sub"), 0777), 0);
  refuse_edit(GOOD, "square.bin", "sub", PL_E_IO, "not a regular file");
  assert_int_equal(symlink("../pl_test_outside.bin", in_folder("link.bin")), 0);
  refuse_edit(GOOD, "square.bin", "link.bin", PL_E_FORMAT, "link out of the model's folder");
  assert_int_equal(unlink(in_folder("../pl_test_outside.bin")), 0);
}

static void names_are_decoded(void **state) {
  (void)state;
  write_square();
  assert_int_equal(mkdir(in_folder("sub"), 0777), 0);
  assert_int_equal(rename(in_folder("square.bin"), in_folder("sub/a b+c.bin")), 0);
  char text[4096];
  const char *const at = strstr(GOOD, "square.bin");
  snprintf(text, sizeof text, "%.*ssub/../sub//a%%20b+c.bin%s", (int)(at - GOOD), GOOD, at + 10);
  pl_model_destroy(load_file(write_text("model.gltf", text)));
}

static void data_uris_are_checked(void **state) {
  (void)state;
  refuse_edit(GOOD, "square.bin", "data:text/plain,abc", PL_E_FORMAT, "base64");
  refuse_edit(GOOD, "square.bin", "data:", PL_E_FORMAT, "base64");
  refuse_edit(GOOD, "square.bin", "data:application/octet-stream;base64,A?==", PL_E_FORMAT,
              "broken base64");
  refuse_edit(GOOD, "square.bin", "data:application/octet-stream;base64,AAAAA", PL_E_FORMAT,
              "broken base64");
  refuse_edit(GOOD, "square.bin", "data:application/octet-stream;base64,", PL_E_FORMAT,
              "only 0 bytes");
  refuse_edit(GOOD, "square.bin", "data:application/octet-stream;base64,AAAA", PL_E_FORMAT,
              "only 3 bytes");
}

static void ranges_are_checked(void **state) {
  (void)state;
  static const struct {
    const char *from, *to, *fault;
  } edits[] = {
      {"\"byteLength\":88", "\"byteLength\":89", "only 88 bytes"},
      {"\"byteLength\":88", "\"byteLength\":-1", "buffers[0].byteLength"},
      {"\"byteLength\":88", "\"byteLength\":1e300", "buffers[0].byteLength"},
      {"\"byteLength\":88", "\"byteLength\":\"88\"", "buffers[0].byteLength"},
      {"\"byteOffset\":48", "\"byteOffset\":87", "exceeds buffers[0]"},
      {"\"byteOffset\":48", "\"byteOffset\":9007199254740992", "exceeds buffers[0]"},
      {"\"byteOffset\":48", "\"byteOffset\":18446744073709551615", "bufferViews[1].byteOffset"},
      {"\"buffer\":0", "\"buffer\":1", "bufferViews[0].buffer: 1"},
      {"\"buffer\":0", "\"buffer\":-1", "bufferViews[0].buffer"},
      {"\"buffer\":0", "\"buffer\":0.5", "bufferViews[0].buffer"},
      {"\"count\":4", "\"count\":5", "do not fit"},
      {"\"count\":4", "\"count\":9007199254740992", "do not fit"},
      {"\"count\":4", "\"count\":0", "accessors[0].count"},
      {"\"count\":4", "\"count\":3", "but there are 3 vertices"},
      {"\"count\":6", "\"count\":7", "do not fit"},
      {"5126", "5124", "accessors[0].componentType"},
      {"5126", "5130", "accessors[0].componentType"},
      {"VEC3", "VEC4", "do not fit"},
      {"VEC3", "VEC2", "POSITION: 2 components"},
      {"VEC3", "BLOB", "\"BLOB\" is none of SCALAR"},
      {"5121", "5120", "unsigned integer scalars"},
      {"5121", "5125", "do not fit"},
      {"\"POSITION\":0", "\"POSITION\":3", "attributes.POSITION: 3, but the file has 3 accessors"},
      {"\"POSITION\":0", "\"POSITION\":0,\"NORMAL\":1", "POSITION has 4"},
      {"\"indices\":1", "\"indices\":4", "indices: 4"},
      {"\"indices\":1", "\"indices\":1,\"mode\":7", "mode"},
      {"\"indices\":1", "\"indices\":1,\"material\":0", "material: 0"},
      {"\"bufferView\":0", "\"bufferView\":3", "accessors[0].bufferView"},
      {"\"bufferView\":0", "\"byteOffset\":44,\"bufferView\":0", "do not fit"},
      {"\"mesh\":0", "\"mesh\":1", "nodes[0].mesh"},
      {"\"mesh\":0", "\"mesh\":0,\"children\":[1]", "nodes[0].children[0]"},
      {"\"mesh\":0", "\"mesh\":0,\"scale\":[1,2]", "nodes[0].scale: must be 3"},
      {"\"mesh\":0", "\"mesh\":0,\"rotation\":[0,0,0,0]", "no rotation"},
      {"\"mesh\":0", "\"mesh\":0,\"matrix\":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]", "last row"},
      {"\"nodes\"", "\"scene\":0,\"nodes\"", "scene: 0"},
      {"\"nodes\"", "\"scenes\":[{\"nodes\":[1]}],\"nodes\"", "scenes[0].nodes[0]"},
      {"\"nodes\"", "\"scenes\":[{\"nodes\":[0,0]}],\"nodes\"", "not a root"},
      {"\"nodes\":[{\"mesh\":0}]", "\"nodes\":{}", "nodes: must be an array"},
      {"\"nodes\":[{\"mesh\":0}]", "\"nodes\":[7]", "nodes[0]: must be an object"},
      {"\"byteLength\":48", "\"byteLength\":48,\"byteStride\":8", "byteStride 8"},
  };
  for (size_t k = 0; k < sizeof edits / sizeof edits[0]; k++)
    refuse_edit(GOOD, edits[k].from, edits[k].to, PL_E_FORMAT, edits[k].fault);
}

static void the_restart_value_is_refused(void **state) {
  (void)state;
  unsigned char bytes[SQUARE_BYTES] = {0};
  memcpy(bytes, SQUARE, 48);
  memcpy(bytes + 48, "\0\1\2\0\2\xFF", 6);
  write_file("square.bin", bytes, sizeof bytes);
  refuse_file(write_text("model.gltf", GOOD), PL_E_FORMAT, "255, the primitive restart value");
}

static void hierarchies_must_be_forests(void **state) {
  (void)state;
#define NODES(list) ASSET SQUARE_DATA "," SQUARE_MESH ",\"nodes\":[" list "]}"
  refuse_text(NODES("{\"children\":[0],\"mesh\":0}"), PL_E_FORMAT, "cycle");
  refuse_text(NODES("{\"mesh\":0},{\"children\":[2]},{\"children\":[3]},{\"children\":[1]}"),
              PL_E_FORMAT, "cycle");
  refuse_text(NODES("{\"children\":[2]},{\"children\":[2]},{\"mesh\":0}"), PL_E_FORMAT,
              "two parents");
  refuse_text(NODES("{\"children\":[1,1]},{\"mesh\":0}"), PL_E_FORMAT, "two parents");
  enum { DEEP = 1200 };
  char *text = malloc(64 * DEEP);
  assert_non_null(text);
  size_t at = (size_t)sprintf(text, "%s", ASSET SQUARE_DATA "," SQUARE_MESH ",\"nodes\":[");
  for (int i = 1; i < DEEP; i++)
    at += (size_t)sprintf(text + at, "{\"children\":[%d]},", i);
  strcpy(text + at, "{\"mesh\":0}]}");
  refuse_text(text, PL_E_FORMAT, "deeper than 1000");
  free(text);
}

static void deep_text_is_refused(void **state) {
  (void)state;
  enum { DEEP = 200000 };
  const char open[2] = {'[', '{'};
  for (int k = 0; k < 2; k++) {
    char *text = malloc(8 * DEEP + 200);
    assert_non_null(text);
    size_t at = (size_t)sprintf(text, "%s\"extras\":", ASSET);
    for (int i = 0; i < DEEP; i++)
      at += (size_t)sprintf(text + at, open[k] == '[' ? "[" : "{\"a\":");
    text[at] = '\0';
    refuse_text(text, PL_E_FORMAT, "nested deeper");
    free(text);
  }
}

/* Ten thousand nodes and a mesh of ten thousand triangles in accessors without bytes. */
static void few_bytes_cannot_become_many_triangles(void **state) {
  (void)state;
  enum { NODES_OF_ONE = 10000 };
  char *text = malloc(32 * NODES_OF_ONE);
  assert_non_null(text);
  size_t at = (size_t)sprintf(
      text, "%s",
      ASSET
      "\"accessors\":[{\"componentType\":5126,\"count\":30000,\"type\":\"VEC3\"}],\"meshes\":["
      "{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[");
  for (int i = 0; i < NODES_OF_ONE; i++)
    at += (size_t)sprintf(text + at, "%s{\"mesh\":0}", i > 0 ? "," : "");
  strcpy(text + at, "]}");
  refuse_text(text, PL_E_RANGE, "more triangles");
  free(text);
  refuse_text(ASSET
              "\"accessors\":[{\"componentType\":5126,\"count\":9000000000,\"type\":\"VEC3\"}],"
              "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
              "\"nodes\":[{\"mesh\":0}]}",
              PL_E_RANGE, "more triangles");
}

static void extensions_are_refused_by_name(void **state) {
  (void)state;
  const char *const names[] = {"KHR_texture_basisu", "VENDOR_entity"};
  for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
    char list[200];
    snprintf(list, sizeof list, "\"extensionsRequired\":[\"%s\"],\"nodes\"", names[k]);
    refuse_edit(GOOD, "\"nodes\"", list, PL_E_UNSUPPORTED, names[k]);
  }
  refuse_edit(GOOD, "\"nodes\"", "\"extensionsRequired\":[7],\"nodes\"", PL_E_FORMAT, "strings");
}

static void versions_are_checked(void **state) {
  (void)state;
  refuse_text("{\"asset\":{\"version\":\"1.0\"}}", PL_E_UNSUPPORTED, "\"1.0\"");
  refuse_text("{\"asset\":{\"version\":\"2.0\",\"minVersion\":\"2.1\"}}", PL_E_UNSUPPORTED, "2.1");
  refuse_text("{\"asset\":{}}", PL_E_FORMAT, "asset.version");
  refuse_text("[]", PL_E_FORMAT, "not an object");
  refuse_text("", PL_E_FORMAT, "empty");
  refuse_text("{\"asset\":", PL_E_FORMAT, "broken JSON");
  refuse_text("{\"asset\":{\"version\":\"2.0\"}}", PL_E_FORMAT, "no triangle");
  pl_model *model;
  assert_int_equal(pl_gltf_load(in_folder("gone.gltf"), NULL, &model), PL_E_IO);
  assert_int_equal(pl_gltf_load(test_folder, NULL, &model), PL_E_IO);
}

static void broken_images_are_named(void **state) {
  (void)state;
#define TEXTURED                                                                                   \
  ASSET SQUARE_DATA ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"               \
                    "\"TEXCOORD_0\":2},\"indices\":1,\"material\":0}]}],\"nodes\":[{\"mesh\":0}]," \
                    "\"images\":[{\"name\":\"skin\",\"uri\":\"skin.png\"}],"                       \
                    "\"textures\":[{\"source\":0}],\"materials\":[{\"emissiveTexture\":"           \
                    "{\"index\":0}}]}"
  refuse_text(TEXTURED, PL_E_IO, "images[0] \"skin\": missing file \"skin.png\"");
  write_text("skin.png", "\x89PNG\r\n\x1A\n");
  refuse_text(TEXTURED, PL_E_FORMAT, "images[0] \"skin\": broken PNG");
  write_file("skin.png", "RIFF\4\0\0\0WEBPVP8 ", 16);
  refuse_text(TEXTURED, PL_E_FORMAT, "images[0] \"skin\": broken WebP");
#define WEBP_SOURCE(source) "\"source\":0,\"extensions\":{\"EXT_texture_webp\":" source "}"
  refuse_edit(TEXTURED, "\"source\":0", WEBP_SOURCE("{\"source\":1}"), PL_E_FORMAT,
              "textures[0].extensions.EXT_texture_webp.source: 1, but the file has 1 images");
  refuse_edit(TEXTURED, "\"source\":0", WEBP_SOURCE("{}"), PL_E_FORMAT, "source: is missing");
  refuse_edit(TEXTURED, "\"source\":0", WEBP_SOURCE("7"), PL_E_FORMAT, "must be an object");
  refuse_edit(TEXTURED, "\"uri\":\"skin.png\"", "\"bufferView\":2", PL_E_FORMAT,
              "images[0] \"skin\": not a PNG, JPEG or WebP image");
  refuse_edit(TEXTURED, "\"uri\":\"skin.png\"", "\"bufferView\":3", PL_E_FORMAT,
              "images[0].bufferView");
  refuse_edit(TEXTURED, "\"source\":0", "\"source\":1", PL_E_FORMAT, "textures[0].source");
  refuse_edit(TEXTURED, "\"index\":0", "\"index\":5", PL_E_FORMAT, "emissiveTexture.index");
}

/* A .glb of the square; returns its size. */
static size_t make_glb(unsigned char *out) {
  char json[2048];
  const char *const at = strstr(GOOD, ",\"uri\":\"square.bin\"");
  int length = snprintf(json, sizeof json, "%.*s%s", (int)(at - GOOD), GOOD,
                        at + strlen(",\"uri\":\"square.bin\""));
  while (length % 4 != 0)
    json[length++] = ' ';
  const uint32_t header[5] = {0x46546C67, 2, (uint32_t)(12 + 8 + length + 8 + SQUARE_BYTES),
                              (uint32_t)length, 0x4E4F534A};
  const uint32_t chunk[2] = {SQUARE_BYTES, 0x004E4942};
  unsigned char *next = out;
  memcpy(next, header, 20);
  memcpy(next += 20, json, (size_t)length);
  memcpy(next += length, chunk, 8);
  memcpy(next += 8, SQUARE, 48);
  memcpy(next += 48, SQUARE_INDICES, 8);
  memcpy(next += 8, SQUARE_UVS, 32);
  return (size_t)(next + 32 - out);
}

static void containers_are_checked(void **state) {
  (void)state;
  unsigned char glb[4096];
  const size_t size = make_glb(glb);
  pl_model *model = load_file(write_file("model.glb", glb, size));
  assert_int_equal(model->triangle_count, 2);
  pl_model_destroy(model);
  memset(glb + size, 7, 9);
  model = load_file(write_file("model.glb", glb, size + 9));
  warned(model, "bytes after the end");
  pl_model_destroy(model);
  for (size_t cut = 0; cut < size; cut++)
    if (pl_gltf_load(write_file("model.glb", glb, cut), NULL, &model) == PL_OK)
      fail_msg("cut at %zu of %zu bytes it still loads", cut, size);
}

/* A short fuzz run: bytes and digits replaced at random. Whatever loads must be sound. */
static void noise_never_crashes(void **state) {
  (void)state;
  unsigned char glb[4096], broken[4096];
  const size_t size = make_glb(glb);
  test_random random = {.seed = 2026};
  int loaded = 0;
  for (int i = 0; i < 4000; i++) {
    memcpy(broken, glb, size);
    const int flips = 1 + random_below(&random, 4);
    for (int k = 0; k < flips; k++) {
      unsigned char *byte = &broken[random_below(&random, (int)size)];
      *byte = *byte >= '0' && *byte <= '9' ? (unsigned char)('0' + random_below(&random, 10))
                                           : (unsigned char)random_below(&random, 256);
    }
    pl_model *model;
    const char *path = write_file("model.glb", broken, size);
    if (pl_gltf_load(path, NULL, &model) == PL_OK) {
      pl_model_destroy(model);
      pl_model_destroy(load_file(path));
      loaded++;
    } else {
      assert_null(model);
    }
  }
  assert_in_range(loaded, 100, 3900); /* both ways are walked */
}

static void failed_allocations_are_reported(void **state) {
  (void)state;
  write_square();
  const char *path = write_text("model.gltf", GOOD);
  for (int allowed = 0;; allowed++) {
    allowance budget = {allowed};
    pl_memory_hook(allocate_allowed, &budget);
    pl_model *model;
    const pl_status status = pl_gltf_load(path, NULL, &model);
    pl_memory_hook(NULL, NULL);
    if (status == PL_OK) {
      assert_true(allowed > 10);
      pl_model_destroy(model);
      return;
    }
    assert_int_equal(status, PL_E_MEMORY);
    assert_null(model);
  }
}

#define in_own_folder(test) cmocka_unit_test_setup_teardown(test, folder_create, folder_remove)

int main(void) {
  const struct CMUnitTest tests[] = {
      in_own_folder(the_file_the_others_spoil_is_good),
      in_own_folder(files_stay_in_the_folder),
      in_own_folder(names_are_decoded),
      in_own_folder(data_uris_are_checked),
      in_own_folder(ranges_are_checked),
      in_own_folder(the_restart_value_is_refused),
      in_own_folder(hierarchies_must_be_forests),
      in_own_folder(deep_text_is_refused),
      in_own_folder(few_bytes_cannot_become_many_triangles),
      in_own_folder(extensions_are_refused_by_name),
      in_own_folder(versions_are_checked),
      in_own_folder(broken_images_are_named),
      in_own_folder(containers_are_checked),
      in_own_folder(noise_never_crashes),
      in_own_folder(failed_allocations_are_reported),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
