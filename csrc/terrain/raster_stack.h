/* Rasters of one number on a body (albedo, roughness), each laid over those before it, filtered by
 * a footprint. */
#ifndef PL_TERRAIN_RASTER_STACK_H
#define PL_TERRAIN_RASTER_STACK_H

#include "terrain/raster.h"

enum { PL_RASTER_STACK = 1024 };

typedef struct pl_raster_sheet {
  const pl_raster *raster; /* borrowed */
  double border_posts;     /* width of its blending into what lies below it */
} pl_raster_sheet;

/* A number of the stack is value + below * x, with x the number below all rasters. */
typedef struct pl_raster_mix {
  double value, below;
} pl_raster_mix;

typedef struct pl_raster_stack {
  pl_raster_sheet sheets[PL_RASTER_STACK]; /* from the lowest to the uppermost */
  size_t count;
  pl_raster_mix mean; /* over the whole body */
  double low, high;   /* bounds of all rasters; 0 without any */
} pl_raster_stack;

/* Copies the sheets. PL_E_RANGE for too many, or a border that is not finite. */
pl_status pl_raster_stack_init(const pl_raster_sheet *sheets, size_t count, pl_raster_stack *out);

/* Returns the mean over a footprint `width_rad` wide about a unit direction, seen from the body's
 * centre: bilinear between the posts, and between the two levels of the pyramid whose cells are
 * about as wide. Continuous in both arguments. */
pl_raster_mix pl_raster_stack_at(const pl_raster_stack *stack, pl_vec3 direction, double width_rad);

/* Returns the sample of the uppermost raster that is nearest to a unit direction, without borders:
 * for numbers that are names. 0 where no raster reaches. */
double pl_raster_stack_nearest(const pl_raster_stack *stack, pl_vec3 direction);

static inline double pl_raster_mixed(pl_raster_mix mix, double below) {
  return mix.value + mix.below * below;
}

#endif
