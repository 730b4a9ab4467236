/* The sunlit part of a body, with its air, as a point sees it, as a set of directions to draw from:
 * a disc, a half moon or a crescent, up to half of the sky.
 *
 * Everything happens in axes scaled by the body's radii, where it is the unit sphere and lines stay
 * lines. A direction is given there by its sine across the line from the point to the body and the
 * sun, and by its turn about that axis: of each sine the limb and the terminator bound the turns,
 * both in closed form. The sun counts as a point, so that the lit part ends at the terminator.
 * Directions are in float: of a body n radii away they are off by about 1e-7 n of its radius. */
#ifndef PL_LIGHT_LUNE_H
#define PL_LIGHT_LUNE_H

#include "scene/snapshot.h"

typedef struct pl_lune {
  const pl_shot_body *body; /* borrowed */
  pl_vec3 x, y, z;          /* scaled axes: z to the body's centre, x across it towards the sun */
  double d, g;              /* the point from the centre, scaled, > 1; sqrt(d^2 - 1) */
  double cosine, sine;      /* of the phase angle in scaled axes, at the centre */
  /* Sines over that of the limb's angle: of all that is lit, and from where on the terminator is
   * hidden and whole chords are lit. */
  double high, touch;
} pl_lune;

/* `sun`: direction from the body to the sun in root axes, any length; `point` camera-relative, root
 * axes. False if the point sees nothing that is lit, or is in or on the body. */
bool pl_lune_make(const pl_shot_body *body, pl_vec3 sun, pl_vec3 point, pl_lune *out);

/* Draws a unit direction in root axes, nearly evenly in solid angle, and its density per sr; false
 * where the lit part is too thin to hold the draw. u in [0, 1)^2. */
bool pl_lune_sample(const pl_lune *lune, const float u[2], pl_vec3f *direction, float *pdf);

/* Density with which a unit direction is drawn, 1/sr; 0 beyond the lit part. */
float pl_lune_pdf(const pl_lune *lune, pl_vec3f direction);

#endif
