/* A point of a surface for light transport: frame, colours, lobe parameters. */
#ifndef PL_SHADE_SURFACE_H
#define PL_SHADE_SURFACE_H

#include "math/vec.h"
#include "shade/lobes.h"
#include "shade/regolith.h"

typedef struct pl_reflectance pl_reflectance;

/* Relief too small for the geometry; see shade/rough.h. All zero: there is none. */
typedef struct pl_rough {
  pl_vec3f slope; /* mean slope of facets to the shading frame: rise over distance, along it */
  /* Of slopes along any one axis: variance around the mean, and of the mean itself and around it,
   * from place to place */
  float variance, whole;
  float stones, stone_height;   /* share of the ground under rocks; their height over their width */
  float stone_relief;           /* variance of slopes of their surface along any one axis */
  float stone_roughness_rad[3]; /* of their law, by band; read by photometric models only */
} pl_rough;

/* Directions point away from the surface. wo and wi below are in the local frame (t, b, n). */
typedef struct pl_surface {
  pl_vec3f t, b, n;       /* shading frame, right-handed, unit; n on the viewer's side */
  pl_vec3f ng;            /* geometric normal on the viewer's side */
  pl_vec3f color;         /* base colour or albedo, linear, 0..1 */
  pl_vec3f emission;      /* W m-2 sr-1 */
  float metallic;         /* 0..1 */
  float alpha;            /* GGX alpha = roughness^2 */
  pl_rough rough;         /* read by photometric models and Lambert only */
  float water;            /* 0..1: part that is open water; read by the water model only */
  pl_vec3f below;         /* part of color that is light from below the water; read likewise */
  union {                 /* no model is both layered and photometric */
    pl_lobes lobes;       /* read by layered models only */
    pl_regolith regolith; /* read by photometric models only */
  };
  const pl_reflectance *reflectance; /* row of the table */
} pl_surface;

static inline pl_vec3f pl_surface_to_local(const pl_surface *s, pl_vec3f v) {
  return (pl_vec3f){pl_vec3f_dot(s->t, v), pl_vec3f_dot(s->b, v), pl_vec3f_dot(s->n, v)};
}
static inline pl_vec3f pl_surface_to_world(const pl_surface *s, pl_vec3f v) {
  return pl_vec3f_madd(pl_vec3f_madd(pl_vec3f_scale(s->t, v.x), v.y, s->b), v.z, s->n);
}
/* Rotates the tangents about the normal, counter-clockwise from t to b. */
static inline void pl_surface_turn(pl_surface *s, float cosine, float sine) {
  const pl_vec3f t = s->t;
  s->t = pl_vec3f_madd(pl_vec3f_scale(t, cosine), sine, s->b);
  s->b = pl_vec3f_madd(pl_vec3f_scale(s->b, cosine), -sine, t);
}

#endif
