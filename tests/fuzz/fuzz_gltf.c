/* Fuzzes the glTF reader: libFuzzer's entry point, also called by replay.c. The reader takes paths,
 * so every input becomes the content of one file in memory; what it refers to beside itself does
 * not exist, so that external files are tried and refused. */
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "geom/articulation.h"
#include "geom/cut.h"
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

/* Plays each animation and cuts the model at what it moves. */
static void check_motion(const pl_model *model) {
  for (int i = 0; (size_t)i < model->animation_count; i++) {
    pl_articulation *articulation;
    const int *nodes;
    if (pl_articulation_create(model, NULL, 0, &i, 1, &articulation) != PL_OK)
      continue;
    const size_t count = pl_articulation_nodes(articulation, &nodes);
    pl_affine *motions = calloc(count + 1, sizeof *motions);
    pl_cut *cut;
    if (motions != NULL)
      pl_articulation_pose(articulation, NULL, NULL, 0.7, PL_LOOP_REPEAT, NULL, motions);
    if (pl_cut_create(model, nodes, count, &cut) == PL_OK) {
      if (cut->first[cut->count] != model->triangle_count)
        abort();
      pl_cut_destroy(cut);
    }
    free(motions);
    pl_articulation_destroy(articulation);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const int file = memfd_create("gltf", MFD_CLOEXEC);
  if (file < 0)
    return 0;
  if (write(file, data, size) == (ssize_t)size) {
    char path[64];
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    pl_model *model;
    if (pl_gltf_load(path, NULL, &model) == PL_OK) {
      check_model(model);
      check_motion(model);
      pl_model_destroy(model);
    }
  }
  close(file);
  return 0;
}
