/* EXT_meshopt_compression: all modes, and streams that are broken or claim too much. The files are
 * made by the package meshoptimizer (tests/fuzz/make_corpus.py). */
#include "random.h"

#include "compressed_files.h"

static const char *const files[] = {"meshopt_triangles.glb", "meshopt_indices.glb"};

/* Exponents, an octahedron and both kinds of indices, all without loss. */
static void every_mode_is_read(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    const compressed_file file = read_corpus(files[k]);
    pl_model *model = load_file(write_compressed(&file));
    assert_string_equal(model->warnings, "");
    check_grid(model, 0.0f);
    pl_model_destroy(model);
  }
}

static void types_and_shapes_are_checked(void **state) {
  (void)state;
  static const struct {
    const char *from, *to, *fault;
  } edits[] = {
      {"EXT_meshopt_compression\":{\"buffer\":0", "EXT_meshopt_compression\":{\"buffer\":2",
       "compression.buffer: 2, but the file has 2 buffers"},
      {"EXT_meshopt_compression\":{\"buffer\":0", "EXT_meshopt_compression\":{\"buffer\":1",
       "exceed buffers[1] of 0 bytes"},
      {"\"byteStride\":12,\"count\":16", "\"byteStride\":10,\"count\":16", "10 is not allowed"},
      {"\"byteStride\":12,\"count\":16", "\"byteStride\":12,\"count\":15", "byteLength is 192"},
      {"\"byteStride\":12,\"count\":16", "\"byteStride\":64,\"count\":16", "byteLength is 192"},
      {"\"byteStride\":2,\"count\":54", "\"byteStride\":3,\"count\":54", "3 is not allowed"},
      {"\"byteStride\":2,\"count\":54", "\"byteStride\":2,\"count\":52", "no whole triangles"},
      {"TRIANGLES", "TRIANGLEX", "\"TRIANGLEX\" is none of"},
      {"\"EXPONENTIAL\"", "\"OCTAHEDRAL\" ", "OCTAHEDRAL is not allowed for ATTRIBUTES with a"},
      {"\"OCTAHEDRAL\"", "\"QUATERNION\"", "QUATERNION is not allowed for ATTRIBUTES with a"},
      {"\"mode\":\"TRIANGLES\"", "\"mode\":\"INDICES\"  ", "broken meshopt data of mode INDICES"},
  };
  for (size_t k = 0; k < sizeof edits / sizeof edits[0]; k++)
    refuse_changed(files[0], edits[k].from, edits[k].to, PL_E_FORMAT, edits[k].fault);
}

/* Every cut of each stream, by the length that the extension says. */
static void truncated_streams_are_refused(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    const compressed_file good = read_corpus(files[k]);
    const char *at = (const char *)good.bytes + 20;
    int streams = 0;
    while ((at = strstr(at, "EXT_meshopt_compression\":{\"buffer\"")) != NULL) {
      at = strstr(at, "\"byteLength\":") + strlen("\"byteLength\":");
      const size_t digits = strspn(at, "0123456789");
      const int length = atoi(at);
      for (int cut = 1; cut < length; cut++) {
        compressed_file file = good;
        char text[32];
        snprintf(text, sizeof text, "%*d", (int)digits, cut);
        memcpy(file.bytes + (at - (const char *)good.bytes), text, digits);
        refuse_file(write_compressed(&file), PL_E_FORMAT, "broken meshopt data");
      }
      streams++;
    }
    assert_int_equal(streams, 3);
  }
}

/* A view and its extension agree on far more bytes than the file can hold. */
static void counts_cannot_claim_memory(void **state) {
  (void)state;
  refuse_text(ASSET
              "\"buffers\":[{\"byteLength\":88,\"uri\":\"square.bin\"}],\"bufferViews\":["
              "{\"buffer\":0,\"byteLength\":512000000000,\"extensions\":{"
              "\"EXT_meshopt_compression\":{\"buffer\":0,\"byteLength\":88,\"byteStride\":256,"
              "\"count\":2000000000,\"mode\":\"ATTRIBUTES\"}}}]}",
              PL_E_RANGE, "decodes to more bytes than a file of");
}

static void noise_never_crashes(void **state) {
  (void)state;
  int loaded[2] = {0, 0};
  for (int k = 0; k < 2; k++)
    spoil(files[k], 800, 41 + (uint64_t)k, loaded);
  assert_true(loaded[0] > 50 && loaded[1] > 50); /* both ways are walked */
}

#define in_own_folder(test) cmocka_unit_test_setup_teardown(test, folder_create, folder_remove)

int main(void) {
  const struct CMUnitTest tests[] = {
      in_own_folder(every_mode_is_read),
      in_own_folder(types_and_shapes_are_checked),
      in_own_folder(truncated_streams_are_refused),
      in_own_folder(counts_cannot_claim_memory),
      in_own_folder(noise_never_crashes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
