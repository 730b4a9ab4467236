/* What the surface of a body may have beside its colour: relief, open water, lights at night. */
#ifndef PL_SHADE_GROUND_H
#define PL_SHADE_GROUND_H

#include <stdbool.h>

#include "geom/texture.h"
#include "math/vec.h"
#include "shade/body_map.h"

/* Maps are equirectangular, with the longitude of the body's colour map in their middle; borrowed,
 * NULL for none. All zero: nothing. */
typedef struct pl_ground {
  const pl_texture *heights; /* linear; black is low */
  const pl_texture *normals; /* linear; 2 c - 1 is a normal: x east, y by `north`, z up */
  float north;               /* 1: green grows northwards; -1: southwards */
  bool ocean;                /* there is open water */
  const pl_texture *water;   /* linear: part of it, 0..1; NULL with `ocean`: all over the body */
  const pl_texture *lights;  /* of the night */
} pl_ground;

/* What a frame gives. */
typedef struct pl_ground_state {
  float height_m;  /* of white over black in `heights` */
  float steepness; /* factor on the slopes of `normals` */
  float wind_m_s;  /* over the water, 12.5 m above it */
  float water[3];  /* albedo of the water below its surface; NAN: the colour map's */
  float lights[3]; /* radiance of the lights where their map is white, W m-2 sr-1 */
  float towns_m;   /* what breaks their map up: cells; 0: nothing; NAN: a texel of the map */
} pl_ground_state;

static inline bool pl_ground_has_relief(const pl_ground *ground) {
  return ground->heights != NULL || ground->normals != NULL;
}

/* Whether there is none of it. */
static inline bool pl_ground_is_plain(const pl_ground *ground) {
  return !pl_ground_has_relief(ground) && !ground->ocean && ground->lights == NULL;
}

/* Rise over run of the relief at a point of the body, uphill, in body axes and across `up`, the
 * unit normal of the body there. Slopes that the footprint hides count as their mean. */
pl_vec3 pl_ground_slope(const pl_ground *ground, const pl_ground_state *state,
                        const pl_body_place *place, pl_vec3 up, pl_filter filter);

#endif
