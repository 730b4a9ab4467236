/* Small glTF files for tests: a text with one buffer of floats and bytes beside it. */
#ifndef PL_TESTS_GLTF_FILES_H
#define PL_TESTS_GLTF_FILES_H

#include "files.h"

#include "io/gltf.h"

/* A unit square in the plane z = 0 of the file (y up): corners, then indices of two triangles as
 * bytes, then the texture coordinates of an image that stands upright on it. */
static const float SQUARE[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
static const unsigned char SQUARE_INDICES[8] = {0, 1, 2, 0, 2, 3, 0, 0};
static const float SQUARE_UVS[8] = {0, 1, 1, 1, 1, 0, 0, 0};
enum { SQUARE_BYTES = 48 + 8 + 32 };

#define SQUARE_DATA                                                                                \
  "\"buffers\":[{\"byteLength\":88,\"uri\":\"square.bin\"}],"                                      \
  "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},"                                             \
  "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":6},"                                             \
  "{\"buffer\":0,\"byteOffset\":56,\"byteLength\":32}],"                                           \
  "\"accessors\":["                                                                                \
  "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"                       \
  "{\"bufferView\":1,\"componentType\":5121,\"count\":6,\"type\":\"SCALAR\"},"                     \
  "{\"bufferView\":2,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"}]"
#define SQUARE_MESH                                                                                \
  "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}]"
#define ASSET "{\"asset\":{\"version\":\"2.0\"},"

static inline void write_square(void) {
  unsigned char bytes[SQUARE_BYTES];
  memcpy(bytes, SQUARE, 48);
  memcpy(bytes + 48, SQUARE_INDICES, 8);
  memcpy(bytes + 56, SQUARE_UVS, 32);
  write_file("square.bin", bytes, sizeof bytes);
}

static inline const char *write_text(const char *name, const char *text) {
  return write_file(name, text, strlen(text));
}

/* Makes model units those of the mesh: tests of files speak of what is in them. */
static inline void in_model_units(pl_model *model) {
  for (size_t v = 0; v < model->vertex_count; v++) {
    float *p = model->positions + 3 * v;
    const pl_vec3 at = pl_model_point(model, (pl_vec3){p[0], p[1], p[2]});
    p[0] = (float)at.x;
    p[1] = (float)at.y;
    p[2] = (float)at.z;
  }
  for (size_t i = 0; i < model->material_count; i++)
    for (int k = 0; k < 3; k++)
      model->materials[i].layers.extinction[k] /= (float)model->unit;
  model->unit = 1.0;
  model->origin = (pl_vec3){0.0, 0.0, 0.0};
  pl_model_measure(model);
}

/* Loads a file that must be good, into model units. */
static inline pl_model *load_file(const char *path) {
  pl_model *model;
  if (pl_gltf_load(path, NULL, &model) != PL_OK)
    fail_msg("%s", pl_error_text());
  in_model_units(model);
  for (size_t i = 0; i < 3 * model->triangle_count; i++)
    assert_true(model->indices[i] < model->vertex_count);
  for (size_t t = 0; t < model->triangle_count; t++)
    assert_true(model->triangle_part[t] < model->part_count);
  for (size_t p = 0; p < model->part_count; p++)
    assert_in_range(model->parts[p].material, 0, model->material_count - 1);
  return model;
}

static inline pl_model *load_text(const char *text) {
  write_square();
  return load_file(write_text("model.gltf", text));
}

/* The square under the given nodes. */
static inline pl_model *load_nodes(const char *nodes) {
  char text[4096];
  snprintf(text, sizeof text, ASSET SQUARE_DATA "," SQUARE_MESH ",\"nodes\":[%s]}", nodes);
  return load_text(text);
}

/* A file that must be refused with a status and a text that names file and fault. */
static inline void refuse_file(const char *path, pl_status expected, const char *fault) {
  pl_model *model = (pl_model *)1;
  const pl_status status = pl_gltf_load(path, NULL, &model);
  if (status != expected || strstr(pl_error_text(), fault) == NULL ||
      strstr(pl_error_text(), path) == NULL)
    fail_msg("%s: %s (expected %s, \"%s\")", pl_status_name(status),
             status == PL_OK ? "loaded" : pl_error_text(), pl_status_name(expected), fault);
  assert_null(model);
}

static inline void refuse_text(const char *text, pl_status expected, const char *fault) {
  write_square();
  refuse_file(write_text("model.gltf", text), expected, fault);
}

/* The same file with `from` replaced, which must occur; refused. */
static inline void refuse_edit(const char *text, const char *from, const char *to,
                               pl_status expected, const char *fault) {
  const char *at = strstr(text, from);
  assert_non_null(at);
  char *edited = malloc(strlen(text) + strlen(to) + 1);
  assert_non_null(edited);
  const size_t before = (size_t)(at - text);
  memcpy(edited, text, before);
  strcpy(edited + before, to);
  strcat(edited, at + strlen(from));
  refuse_text(edited, expected, fault);
  free(edited);
}

static inline void warned(const pl_model *model, const char *text) {
  if (strstr(model->warnings, text) == NULL)
    fail_msg("no warning \"%s\" in \"%s\"", text, model->warnings);
}

static inline const float *corner(const pl_model *model, size_t triangle, size_t k) {
  return model->positions + 3 * (size_t)model->indices[3 * triangle + k];
}

/* Cross product of two edges: twice the area, along the normal of the winding. */
static inline void face_normal(const pl_model *model, size_t triangle, double out[3]) {
  const float *a = corner(model, triangle, 0), *b = corner(model, triangle, 1),
              *c = corner(model, triangle, 2);
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    out[k] = (double)(b[i] - a[i]) * (double)(c[j] - a[j]) -
             (double)(b[j] - a[j]) * (double)(c[i] - a[i]);
  }
}

/* Area by winding and the normals of all corners agree: both point to the same side. */
static inline void normals_agree(const pl_model *model) {
  for (size_t t = 0; t < model->triangle_count; t++) {
    double face[3];
    face_normal(model, t, face);
    for (size_t k = 0; k < 3; k++) {
      const float *n = model->normals + 3 * (size_t)model->indices[3 * t + k];
      double dot = 0;
      for (int c = 0; c < 3; c++)
        dot += face[c] * (double)n[c];
      assert_true(dot > 0);
    }
  }
}

static inline void vector_near(const float *v, double x, double y, double z) {
  const double expected[3] = {x, y, z};
  for (int k = 0; k < 3; k++) {
    const double error = (double)v[k] - expected[k];
    if (!(error < 1e-5 && error > -1e-5))
      fail_msg("(%g, %g, %g) is not (%g, %g, %g)", (double)v[0], (double)v[1], (double)v[2], x, y,
               z);
  }
}

#endif
