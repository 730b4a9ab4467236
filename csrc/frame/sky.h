/* The sky of one frame: the view's part before the plan, the pixels' after it. */
#ifndef PL_FRAME_SKY_H
#define PL_FRAME_SKY_H

#include "plan/plan.h"
#include "render/render.h"
#include "sky/sky.h"
#include "sky/stars.h"

/* A star that is seen, for labels. */
typedef struct pl_seen_star {
  const pl_star *star; /* borrowed from the catalogue */
  double u, v;         /* pixel position of its centre */
  pl_vec3f passed;     /* part of its light that comes through air, in each band */
} pl_seen_star;

/* What stars add to a pixel. */
typedef struct pl_star_light {
  uint32_t pixel; /* y * width + x */
  pl_vec3f light; /* W m-2 sr-1 */
} pl_star_light;

/* All memory is the arena's. */
typedef struct pl_frame_sky {
  pl_star_field field; /* until the plan */
  pl_seen_star *seen;  /* the brightest first */
  size_t seen_count;
  pl_star_light *subpixel; /* of small bodies, see subpixel_bodies.h */
  size_t subpixel_count;
  pl_star_light *light; /* tile by tile, in each by brightness of the star */
  size_t *first;        /* of a tile, and at last their number; NULL: there is none */
  int columns;          /* of tiles */
  int width;            /* of the image */
  pl_backdrop backdrop; /* of kind NONE where the plan leaves it out */
} pl_frame_sky;

/* Before the plan: fills view->sky. Exposures are known. */
pl_status pl_frame_sky_view(const pl_sky *sky, const pl_snapshot *shot, const pl_plan_wish *wish,
                            pl_arena *arena, pl_view *view, pl_frame_sky *out);
/* After it: what the plan keeps, less the stars that are hidden in `tracer`. The settings' air and
 * media dim stars. */
pl_status pl_frame_sky_place(const pl_plan *plan, const pl_snapshot *shot, const pl_tracer *tracer,
                             const pl_render_settings *settings, pl_arena *arena,
                             pl_frame_sky *sky);
/* The tile's radiance with its stars in `lit` (PL_TILE_PIXELS), or as it is where there are none.
 */
const pl_vec3f *pl_frame_sky_tile(const pl_frame_sky *sky, const pl_tile_result *result,
                                  pl_vec3f *lit);

#endif
