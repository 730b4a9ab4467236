/* Writes rendered tiles to the output arrays of a frame. */
#ifndef PL_FRAME_OUTPUT_H
#define PL_FRAME_OUTPUT_H

#include "frame/labels.h"
#include "frame/sky.h"
#include "sensor/encode.h"

typedef struct pl_output {
  const pl_frame_request *request;
  const pl_snapshot *shot; /* snapshot that the surface points belong to */
  const pl_encoder *encoder;
  float white_radiance;
  bool colour;             /* tiles have radiance */
  pl_vec3f *bands;         /* for the sensor; NULL if not needed */
  const pl_frame_sky *sky; /* its stars are added; NULL for none */
  pl_vec3f *film;          /* accumulated radiance of an exposure, see moving.c */
  pl_labels labels;
} pl_output;

/* Writes the radiance of `count` pixels of a row; `first` is the row-major index of the first. */
void pl_output_colour(const pl_output *output, size_t first, const pl_vec3f *row, size_t count);
/* Tile callback for pl_render; `context` is a pl_output. */
pl_status pl_output_tile(void *context, const pl_tile_result *result, int worker);

#endif
