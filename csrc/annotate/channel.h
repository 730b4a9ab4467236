/* Per-pixel labels: one table of channels, each a function of the geometry buffer. */
#ifndef PL_ANNOTATE_CHANNEL_H
#define PL_ANNOTATE_CHANNEL_H

#include <stddef.h>

#include "render/vertex.h"

enum { PL_LABEL_RUN = 32 }; /* pixels at most */

/* Neighbouring pixels of a row whose centre rays hit the same thing. Vectors are three arrays each,
 * for loops over pixels to be fast; in root axes. */
typedef struct pl_label_run {
  const pl_snapshot *shot;
  uint32_t thing;
  size_t count;
  double position[3][PL_LABEL_RUN]; /* camera-relative, m */
  double normal[3][PL_LABEL_RUN];   /* unit, shading, on the viewer's side */
  double facet[3][PL_LABEL_RUN];    /* unit, geometric, likewise */
  double to_sun[3][PL_LABEL_RUN], to_viewer[3][PL_LABEL_RUN]; /* m */
  uint32_t parts[PL_LABEL_RUN];                               /* of an object; not set on bodies */
} pl_label_run;

/* What stands where nothing is hit. */
typedef enum pl_label_blank { PL_BLANK_ZERO, PL_BLANK_NAN } pl_label_blank;

/* components: 0 for a plain (H, W) channel, n for (H, W, n), -1 for (H, W, levels). */
typedef struct pl_channel {
  const char *name;
  const char *dtype; /* NumPy's name of the element type */
  size_t element;    /* bytes of an element */
  int components;
  const char *unit;
  const char *doc;
  pl_label_blank blank;
  /* Writes the pixels of a run, which are beside each other. */
  void (*write)(const pl_label_run *run, void *pixels);
} pl_channel;

extern const pl_channel pl_channels[];
extern const size_t pl_channel_count;

/* Elements a pixel. */
size_t pl_channel_elements(const pl_channel *channel, int levels);

/* Writes `count` pixels of a row to every channel that has an image: `images` by index in
 * pl_channels, NULL: not wanted. `first`: the pixels' place in the images, row-major. */
void pl_channels_write(const pl_snapshot *shot, const pl_vertex *points, size_t count, size_t first,
                       void *const *images);
/* The same for pixels that hit nothing. */
void pl_channels_blank(const pl_snapshot *shot, size_t count, size_t first, void *const *images);

#endif
