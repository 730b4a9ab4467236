/* Per-pixel labels: one table of channels, each a function of the geometry buffer. */
#ifndef PL_ANNOTATE_CHANNEL_H
#define PL_ANNOTATE_CHANNEL_H

#include <stddef.h>

#include "render/vertex.h"

/* components: 0 for a plain (H, W) channel, n for (H, W, n), -1 for (H, W, levels). */
typedef struct pl_channel {
  const char *name;
  const char *dtype; /* NumPy's name of the element type */
  size_t element;    /* bytes of an element */
  int components;
  const char *unit;
  const char *doc;
  /* Writes one pixel; `vertex` is NULL where nothing is hit. */
  void (*write)(const pl_snapshot *shot, const pl_vertex *vertex, void *pixel);
} pl_channel;

extern const pl_channel pl_channels[];
extern const size_t pl_channel_count;

/* Elements a pixel. */
size_t pl_channel_elements(const pl_channel *channel, int levels);

/* Writes a tile: `points` has `stride` vertices a row; `pixels` is the whole image, `image_width`
 * pixels a row. */
void pl_channel_write(const pl_channel *channel, const pl_snapshot *shot, const pl_vertex *points,
                      size_t stride, const int tile[4], int image_width, void *pixels);

#endif
