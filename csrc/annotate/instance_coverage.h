/* Coverage of pixels by instances: the part of a pixel's area in which each is seen, from rays over
 * the whole pixel, where other labels have one ray through its centre. */
#ifndef PL_ANNOTATE_INSTANCE_COVERAGE_H
#define PL_ANNOTATE_INSTANCE_COVERAGE_H

#include <stdint.h>

#include "geom/adjacency.h"
#include "render/render.h"

enum { PL_COVERAGE_SAMPLES_MAX = 1024, PL_COVERAGE_LAYERS_MAX = 16 };
/* Id of the last layer where a pixel has more instances than layers: it holds the sum of those that
 * have no layer of their own. */
enum { PL_COVERAGE_REST = -1 };

typedef struct pl_instance_coverage_settings {
  int samples; /* rays a pixel, 1..PL_COVERAGE_SAMPLES_MAX */
  int layers;  /* 1..PL_COVERAGE_LAYERS_MAX; 0: the channels are not available */
} pl_instance_coverage_settings;

/* Both images have `layers` numbers a pixel. */
typedef struct pl_instance_coverage {
  pl_instance_coverage_settings settings;
  float *parts; /* of the pixel's area, the largest first; NULL: not asked for */
  int32_t *ids; /* instances they belong to, 0 for layers that are not used; NULL: not asked for */
  /* by object, to spare rays (filled_pixel.h); borrowed; NULL, or entries of NULL: not known */
  const pl_adjacency *const *adjacencies;
} pl_instance_coverage;

/* Finds the images among those of pl_channels. Returns false if none is asked for. */
bool pl_instance_coverage_init(const pl_instance_coverage_settings *settings, void *const *channels,
                               pl_instance_coverage *out);
/* PL_E_RANGE for settings out of range. */
pl_status pl_instance_coverage_check(const pl_instance_coverage *coverage);
/* Writes all pixels of a tile. `shot`: that of the tile's instant. */
void pl_instance_coverage_write(const pl_instance_coverage *coverage, const pl_snapshot *shot,
                                const pl_tile_result *result);

#endif
