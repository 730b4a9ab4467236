/* KHR_draco_mesh_compression: meshes of both methods, and streams that are broken or claim too
 * much. The files are made by DracoPy (tests/fuzz/make_corpus.py), quantised to 8 bits. */
#include "random.h"

#include "compressed_files.h"

static const char *const files[] = {"draco_sequential.glb", "draco_edgebreaker.glb",
                                    "draco_valence.glb"};

static void every_method_is_read(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    const compressed_file file = read_corpus(files[k]);
    pl_model *model = load_file(write_compressed(&file));
    assert_string_equal(model->warnings, "");
    check_grid(model, 3.0f / 255.0f);
    for (size_t v = 0; v < 16; v++)
      for (int c = 0; c < 2; c++) {
        const float uv = model->uvs[0][2 * v + (size_t)c];
        const float expected = model->positions[3 * v + 2 * (size_t)c] / 3.0f;
        assert_true(uv - expected < 0.004f && expected - uv < 0.004f);
      }
    pl_model_destroy(model);
  }
}

static void types_and_indices_are_checked(void **state) {
  (void)state;
  static const struct {
    const char *from, *to, *fault;
  } edits[] = {
      {"\"bufferView\":0", "\"bufferView\":1", "KHR_draco_mesh_compression.bufferView: 1"},
      {"\"bufferView\":0", "\"bufferVieW\":0", "bufferView: is missing"},
      {"\"byteOffset\":0", "\"byteOffset\":9", "exceeds buffers[0]"},
      {"\"VEC2\"", "\"VEC4\"", "2 components in the Draco data, 4"},
      {"5126", "5121", "floats for an accessor of integers"},
  };
  for (size_t k = 0; k < sizeof edits / sizeof edits[0]; k++)
    refuse_changed(files[1], edits[k].from, edits[k].to, PL_E_FORMAT, edits[k].fault);
  refuse_changed(files[1], "\"TEXCOORD_0\":0,\"NORMAL\":1,\"POSITION\":2}}}",
                 "\"TEXCOORD_0\":7,\"NORMAL\":1,\"POSITION\":2}}}", PL_E_FORMAT,
                 "TEXCOORD_0: the Draco data have no attribute 7");
}

static void counts_of_accessors_are_only_remarked_on(void **state) {
  (void)state;
  compressed_file file = read_corpus(files[1]);
  edit(&file, "\"count\":16", "\"count\":17");
  pl_model *model = load_file(write_compressed(&file));
  warned(model, "16 vertices in the Draco data, 17 in the accessor");
  check_grid(model, 3.0f / 255.0f);
  pl_model_destroy(model);
}

/* Every cut of the stream, by the length of its view. */
static void truncated_streams_are_refused(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    const compressed_file good = read_corpus(files[k]);
    const char *const key = "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":";
    const char *const at = strstr((const char *)good.bytes + 20, key);
    assert_non_null(at);
    const int length = atoi(at + strlen(key));
    assert_in_range(length, 100, 999);
    for (int cut = 100; cut < length; cut++) {
      char from[100], to[100];
      snprintf(from, sizeof from, "%s%d", key, length);
      snprintf(to, sizeof to, "%s%d", key, cut);
      refuse_changed(files[k], from, to, PL_E_FORMAT, "broken Draco data");
    }
  }
}

/* The stream begins with "DRACO", version, type, method and flags; then, in an edgebreaker stream,
 * the kind of traversal, vertices and faces as variable-length integers. */
static void headers_are_checked(void **state) {
  (void)state;
  static const struct {
    size_t offset;
    const char *bytes;
    size_t size;
    pl_status status;
    const char *fault;
  } edits[] = {
      {0, "d", 1, PL_E_FORMAT, "no header"},
      {5, "\1", 1, PL_E_UNSUPPORTED, "bitstream 1.2; only 2.2"},
      {6, "\3", 1, PL_E_UNSUPPORTED, "bitstream 2.3"},
      {7, "\0", 1, PL_E_FORMAT, "no triangle mesh"},
      {8, "\7", 1, PL_E_FORMAT, "unknown method"},
      {12, "\x7F\xFF\xFF\xFF\x0F", 5, PL_E_FORMAT, "more faces than its bytes"},
      {12, "\x10\xFF\xFF\xFF\x0F", 5, PL_E_FORMAT, "more faces than its bytes"},
      {12, "\xFF\xFF\xFF\xFF\xFF\xFF\xFF", 7, PL_E_FORMAT, "truncated"},
  };
  for (size_t k = 0; k < sizeof edits / sizeof edits[0]; k++) {
    compressed_file file = read_corpus(files[1]);
    memcpy(file.bytes + file.binary + edits[k].offset, edits[k].bytes, edits[k].size);
    refuse_file(write_compressed(&file), edits[k].status, edits[k].fault);
  }
}

static void noise_never_crashes(void **state) {
  (void)state;
  int loaded[2] = {0, 0};
  for (int k = 0; k < 3; k++)
    spoil(files[k], 600, 31 + (uint64_t)k, loaded);
  assert_true(loaded[0] > 50 && loaded[1] > 50); /* both ways are walked */
}

static void failed_allocations_are_reported(void **state) {
  (void)state;
  const compressed_file file = read_corpus(files[1]);
  const char *path = write_compressed(&file);
  for (int allowed = 0;; allowed++) {
    allowance budget = {allowed};
    pl_memory_hook(allocate_allowed, &budget);
    pl_model *model;
    const pl_status status = pl_gltf_load(path, NULL, &model);
    pl_memory_hook(NULL, NULL);
    if (status == PL_OK) {
      assert_true(allowed > 5);
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
      in_own_folder(every_method_is_read),
      in_own_folder(types_and_indices_are_checked),
      in_own_folder(counts_of_accessors_are_only_remarked_on),
      in_own_folder(truncated_streams_are_refused),
      in_own_folder(headers_are_checked),
      in_own_folder(noise_never_crashes),
      in_own_folder(failed_allocations_are_reported),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
