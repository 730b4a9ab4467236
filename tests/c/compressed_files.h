/* The compressed models of the fuzzers' corpus, and copies of them with changes. */
#ifndef PL_TESTS_COMPRESSED_FILES_H
#define PL_TESTS_COMPRESSED_FILES_H

#include "gltf_files.h"

enum { COMPRESSED_MOST = 4096 };

/* A .glb and where its binary chunk begins (glTF 2.0, section 4.4). */
typedef struct compressed_file {
  unsigned char bytes[COMPRESSED_MOST];
  size_t size, binary;
} compressed_file;

static inline compressed_file read_corpus(const char *name) {
  compressed_file out = {.size = 0};
  char path[512];
  snprintf(path, sizeof path, "%s/tests/fuzz/corpus/gltf/%s", PL_SOURCE_DIR, name);
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  out.size = fread(out.bytes, 1, sizeof out.bytes, file);
  fclose(file);
  assert_in_range(out.size, 28, COMPRESSED_MOST - 1);
  uint32_t json;
  memcpy(&json, out.bytes + 12, 4);
  out.binary = 28 + json;
  assert_true(out.binary < out.size);
  return out;
}

/* Replaces a text of the JSON by one as long. */
static inline void edit(compressed_file *file, const char *from, const char *to) {
  const size_t length = strlen(from);
  assert_int_equal(length, strlen(to));
  for (size_t at = 20; at + length <= file->binary - 8; at++)
    if (memcmp(file->bytes + at, from, length) == 0) {
      memcpy(file->bytes + at, to, length);
      return;
    }
  fail_msg("no %s in the file", from);
}

static inline const char *write_compressed(const compressed_file *file) {
  return write_file("model.glb", file->bytes, file->size);
}

/* The corpus file with one text replaced; refused. */
static inline void refuse_changed(const char *name, const char *from, const char *to,
                                  pl_status expected, const char *fault) {
  compressed_file file = read_corpus(name);
  edit(&file, from, to);
  refuse_file(write_compressed(&file), expected, fault);
}

/* A bumpy grid of 4 x 4 points, x and y whole, z = x y mod 3 in the file's axes (make_corpus.py),
 * within `error`. */
static inline void check_grid(const pl_model *model, float error) {
  assert_int_equal(model->triangle_count, 18);
  assert_int_equal(model->vertex_count, 16);
  unsigned seen = 0;
  for (size_t v = 0; v < 16; v++) {
    const float *p = model->positions + 3 * v;
    const int x = (int)(p[0] + 0.5f), y = (int)(p[2] + 0.5f);
    const double expected[3] = {x, -(x * y % 3), y};
    for (int k = 0; k < 3; k++)
      assert_true((double)p[k] - expected[k] <= (double)error &&
                  expected[k] - (double)p[k] <= (double)error);
    seen |= 1u << (4 * y + x);
    vector_near(model->normals + 3 * v, 0, -1, 0);
  }
  assert_int_equal(seen, 0xFFFF);
  /* Each triangle has two sides of length 1 in (x, y), counter-clockwise. */
  for (size_t t = 0; t < 18; t++) {
    double n[3];
    face_normal(model, t, n);
    assert_true(n[1] < -0.9 && n[1] > -1.1);
  }
}

/* Changes bytes of the binary chunk at random: nothing may crash, and what loads must be sound. */
static inline void spoil(const char *name, int times, uint64_t seed, int loaded[2]) {
  const compressed_file good = read_corpus(name);
  test_random random = {.seed = seed};
  for (int i = 0; i < times; i++) {
    compressed_file file = good;
    const int flips = 1 + random_below(&random, 4);
    for (int k = 0; k < flips; k++)
      file.bytes[good.binary + (size_t)random_below(&random, (int)(good.size - good.binary))] =
          (unsigned char)random_below(&random, 256);
    pl_model *model;
    const char *path = write_compressed(&file);
    const bool fine = pl_gltf_load(path, NULL, &model) == PL_OK;
    pl_model_destroy(model);
    if (fine)
      pl_model_destroy(load_file(path));
    loaded[fine]++;
  }
}

#endif
