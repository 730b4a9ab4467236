/* Fuzzes the glTF reader: libFuzzer's entry point, also called by replay.c. The reader takes paths,
 * so every input becomes the content of one file in memory; what it refers to beside itself does
 * not exist, so that external files are tried and refused. */
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "io/gltf.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What every model promises; a broken promise is a crash for the fuzzer to report. */
static void check_model(const pl_model *model) {
  for (size_t i = 0; i < 3 * model->triangle_count; i++)
    if (model->indices[i] >= model->vertex_count)
      abort();
  for (size_t t = 0; t < model->triangle_count; t++)
    if (model->triangle_part[t] >= model->part_count)
      abort();
  for (size_t p = 0; p < model->part_count; p++)
    if ((size_t)model->parts[p].material >= model->material_count)
      abort();
  for (int k = 0; k < 3; k++) /* also false for what is not a number */
    if (!(model->bounds_min[k] <= model->bounds_max[k]))
      abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const int file = memfd_create("gltf", MFD_CLOEXEC);
  if (file < 0)
    return 0;
  if (write(file, data, size) == (ssize_t)size) {
    char path[64];
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    pl_model *model;
    if (pl_gltf_load(path, &model) == PL_OK) {
      check_model(model);
      pl_model_destroy(model);
    }
  }
  close(file);
  return 0;
}
