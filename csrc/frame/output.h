/* Where the pixels of a frame go. */
#ifndef PL_FRAME_OUTPUT_H
#define PL_FRAME_OUTPUT_H

#include "frame/labels.h"
#include "frame/sky.h"
#include "sensor/encode.h"

typedef struct pl_output {
  const pl_frame_request *request;
  const pl_snapshot *shot; /* that the points are of */
  const pl_encoder *encoder;
  float white_radiance;
  bool colour;             /* tiles have colours */
  pl_vec3f *bands;         /* for the sensor; NULL: none */
  const pl_frame_sky *sky; /* its stars; NULL: none */
  pl_vec3f *film;          /* what an exposure gathers, see moving.c */
  pl_labels labels;
} pl_output;

/* Writes radiance of `count` pixels of a row from pixel `first` of the image on. */
void pl_output_colour(const pl_output *output, size_t first, const pl_vec3f *row, size_t count);
/* For pl_render: `context` is a pl_output. */
pl_status pl_output_tile(void *context, const pl_tile_result *result, int worker);

#endif
