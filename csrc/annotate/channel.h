/* Per-pixel labels: one table of channels, each a function of the geometry buffer. */
#ifndef PL_ANNOTATE_CHANNEL_H
#define PL_ANNOTATE_CHANNEL_H

#include <stddef.h>

#include "render/geometry.h"

enum { PL_LABEL_RUN = 32 }; /* largest number of pixels */

/* Neighbouring pixels of a row whose centre rays hit the same object or body. Vectors are stored as
 * three arrays, so that loops over pixels vectorise; root axes. */
typedef struct pl_label_run {
  const pl_snapshot *shot;
  pl_surface_id surface_id;
  pl_geometry_label label;
  size_t count;
  const pl_point *points;           /* of the pixels */
  double position[3][PL_LABEL_RUN]; /* camera-relative, m */
  double normal[3][PL_LABEL_RUN];   /* unit shading normal, facing the viewer */
  double facet[3][PL_LABEL_RUN];    /* unit geometric normal, facing the viewer */
  double to_sun[3][PL_LABEL_RUN], to_viewer[3][PL_LABEL_RUN]; /* m */
  uint32_t parts[PL_LABEL_RUN];  /* part of an object, or area of a body */
  int64_t craters[PL_LABEL_RUN]; /* ids of craters if a channel asks for them; 0: none */
} pl_label_run;

/* Value of pixels where nothing is hit. */
typedef enum pl_label_blank { PL_BLANK_ZERO, PL_BLANK_NAN } pl_label_blank;

/* Components of (H, W, baselines); see pl_ground_settings. */
#define PL_COMPONENTS_BASELINES (-3)
/* Components of (H, W, layers); see pl_instance_coverage_settings. */
#define PL_COMPONENTS_LAYERS (-4)

/* components is 0 for a plain (H, W) channel, n for (H, W, n), -1 for (H, W, levels). */
typedef struct pl_channel {
  const char *name;
  const char *dtype; /* NumPy's name of the element type */
  size_t element;    /* bytes of an element */
  int components;
  const char *unit;
  const char *doc;
  pl_label_blank blank;
  /* Writes the pixels of a run, which are contiguous; NULL: the channel needs more than
   * its own pixel: of the ground (annotate/ground_map.h), another frame (annotate/flow.h), or rays
   * of its own (annotate/instance_coverage.h), or what lies before the surface
   * (annotate/cloud_map.h). */
  void (*write)(const pl_label_run *run, void *pixels);
} pl_channel;

extern const pl_channel pl_channels[];
extern const size_t pl_channel_count;

/* Returns the number of elements per pixel; where components is negative, `many`: the number of
 * levels, or of baselines. */
size_t pl_channel_elements(const pl_channel *channel, int many);

/* What requested channels need of the points beyond where they are: a sum of these. */
enum {
  PL_POINTS_SHADOWS = 1,       /* in_shadow, see render/shadow_mask.h */
  PL_POINTS_SHADOW_CAUSES = 2, /* shadow_cause, too */
  PL_POINTS_ALBEDO = 4         /* what surfaces are made of */
};
unsigned pl_channels_need(void *const *images);

/* Writes `count` pixels of a row to every requested channel. `images` is indexed as pl_channels;
 * NULL where a channel is not requested. `first` is the row-major index of the first pixel. */
void pl_channels_write(const pl_snapshot *shot, const pl_point *points, size_t count, size_t first,
                       void *const *images);
/* The same for pixels that hit nothing. */
void pl_channels_blank(const pl_snapshot *shot, size_t count, size_t first, void *const *images);

#endif
