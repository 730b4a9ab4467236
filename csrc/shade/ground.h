/* Properties of a body's surface other than its colour: relief, open water, lights at night. */
#ifndef PL_SHADE_GROUND_H
#define PL_SHADE_GROUND_H

#include <stdbool.h>

#include "geom/texture.h"
#include "math/vec.h"
#include "shade/body_map.h"

/* Maps are equirectangular, with the same centre longitude as the body's colour map; borrowed, NULL
 * for none. All zero: no such properties. */
typedef struct pl_ground {
  const pl_texture *heights; /* linear; black is low */
  const pl_texture *normals; /* linear; 2 c - 1 is a normal: x east, y by `north`, z up */
  float north;               /* 1: green increases northwards; -1: southwards */
  bool ocean;                /* there is open water */
  /* Linear: fraction of open water, 0..1; NULL with `ocean`: the whole body is water. */
  const pl_texture *water;
  const pl_texture *lights; /* lights at night */
} pl_ground;

/* Values that may differ from frame to frame. */
typedef struct pl_ground_state {
  float height_m;  /* height of white above black in `heights` */
  float steepness; /* factor on the slopes of `normals` */
  float wind_m_s;  /* wind speed 12.5 m above the water */
  /* Albedo of the light from below the water's surface; NAN: that of the colour map. */
  float water[3];
  float lights[3]; /* radiance of the lights where their map is white, W m-2 sr-1 */
  /* Cell size of the noise that splits the lights; 0: none; NAN: a texel of the map. */
  float towns_m;
} pl_ground_state;

static inline bool pl_ground_has_relief(const pl_ground *ground) {
  return ground->heights != NULL || ground->normals != NULL;
}

/* True if there is no relief, water or light. */
static inline bool pl_ground_is_plain(const pl_ground *ground) {
  return !pl_ground_has_relief(ground) && !ground->ocean && ground->lights == NULL;
}

/* Slope (rise over run) of the relief at a point of the body: vector uphill, in body axes and
 * perpendicular to `up`, the body's unit normal there. Slopes smaller than the footprint are
 * averaged. */
pl_vec3 pl_ground_slope(const pl_ground *ground, const pl_ground_state *state,
                        const pl_body_place *place, pl_vec3 up, pl_filter filter);

#endif
