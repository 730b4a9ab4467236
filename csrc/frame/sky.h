/* Stars and background of one frame: their part of the view before the plan, their pixels after it.
 */
#ifndef PL_FRAME_SKY_H
#define PL_FRAME_SKY_H

#include "plan/plan.h"
#include "render/render.h"
#include "sky/sky.h"
#include "sky/stars.h"

/* A visible star, for labels. */
typedef struct pl_seen_star {
  const pl_star *star;    /* borrowed from the catalogue */
  double u, v;            /* pixel coordinates of its centre */
  pl_vec3f transmittance; /* of air and media towards it, per band */
} pl_seen_star;

/* Radiance that a star or sub-pixel body adds to a pixel. */
typedef struct pl_star_light {
  uint32_t pixel; /* y * width + x */
  pl_vec3f light; /* W m-2 sr-1 */
} pl_star_light;

/* All memory belongs to the arena. */
typedef struct pl_frame_sky {
  pl_star_field field; /* used until the plan is made */
  pl_seen_star *seen;  /* brightest first */
  size_t seen_count;
  pl_star_light *subpixel; /* light of sub-pixel bodies, see subpixel_bodies.h */
  size_t subpixel_count;
  pl_star_light *light; /* sorted by tile, in each tile by the star's brightness */
  /* index of each tile's first item, then the number of items; NULL if there are none */
  size_t *first;
  int columns;          /* tiles per row */
  int width;            /* of the image */
  pl_backdrop backdrop; /* kind is NONE if the plan leaves the background out */
} pl_frame_sky;

/* Before the plan: fills view->sky. Exposures must be known. */
pl_status pl_frame_sky_view(const pl_sky *sky, const pl_snapshot *shot, const pl_plan_wish *wish,
                            pl_arena *arena, pl_view *view, pl_frame_sky *out);
/* After the plan: selects the stars that it keeps and that `tracer` finds visible. Air and media of
 * the settings attenuate them. */
pl_status pl_frame_sky_place(const pl_plan *plan, const pl_snapshot *shot, const pl_tracer *tracer,
                             const pl_render_settings *settings, pl_arena *arena,
                             pl_frame_sky *sky);
/* Returns the tile's radiance plus its stars in `lit` (PL_TILE_PIXELS), or result->radiance if it
 * has no stars. */
const pl_vec3f *pl_frame_sky_tile(const pl_frame_sky *sky, const pl_tile_result *result,
                                  pl_vec3f *lit);

#endif
