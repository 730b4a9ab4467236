/* What a sensor that lights the scene itself finds along a ray: the surfaces that send light back
 * the way it came. A ray continues from smooth mirrors and through clear walls. */
#ifndef PL_RENDER_ECHO_H
#define PL_RENDER_ECHO_H

#include "render/vertex.h"

/* Largest number of surfaces that a ray meets: mirrors and clear walls, and what ends it. */
enum { PL_ECHO_DEPTH = 4 };

/* How light came to a surface: bits. */
enum { PL_ECHO_THROUGH = 1, PL_ECHO_MIRRORED = 2 };

/* A ray on its way. */
typedef struct pl_echo_ray {
  pl_beam beam;   /* camera-relative */
  double way_m;   /* travelled before its origin */
  float passed;   /* of its power: what mirrors and walls left, one way */
  uint32_t index; /* the caller's */
  uint8_t path;   /* bits */
} pl_echo_ray;

typedef struct pl_echo {
  double range_m; /* length of the way to the surface */
  /* Returned power relative to a white Lambert surface that faces the sensor at the same range: pi
   * times the BRDF in the direction of incidence, times the cosine, times the losses at mirrors and
   * walls on both ways */
  float reflectance;
  float incidence_rad; /* to the shading normal */
  uint32_t index;      /* of its ray */
  uint8_t path;
} pl_echo;

/* Shades a located vertex of a ray and describes its echo. `band`: of the colours, 0..2. */
void pl_echo_at(const pl_snapshot *shot, const pl_echo_ray *ray, int band, pl_vertex *vertex,
                pl_echo *out);

/* Sets the ray that continues from a vertex shaded by pl_echo_at, and its query; false if none does
 * with more than a hundred-thousandth of the power. A clear wall does not bend it. */
bool pl_echo_continue(const pl_snapshot *shot, const pl_echo_ray *ray, int band,
                      const pl_vertex *vertex, pl_echo_ray *next, pl_ray *query);

#endif
