/* The disc of a body, with its air, as a point sees it: a set of directions to draw from, in
 * proportion to a table of how bright its parts are.
 *
 * Everything happens in axes scaled by the body's radii, where it is the unit sphere and lines stay
 * lines. A direction on the disc is given there by its part, 0 in the middle and 1 at the rim, even
 * in solid angle, and by its turn about the line to the centre, 0 towards the sun. Parts are
 * divided into rings that are narrower towards the limb, where crescents and twilight are; turns
 * evenly. So a table that was made for one point serves others that see the body about as large and
 * from about the same side. Directions are in float: of a body n radii away they are off by about
 * 1e-7 n of its radius. */
#ifndef PL_LIGHT_BODY_DISC_H
#define PL_LIGHT_BODY_DISC_H

#include "scene/snapshot.h"

typedef struct pl_body_disc {
  const pl_shot_body *body; /* borrowed */
  pl_vec3 x, y, z;          /* scaled axes: z to the body's centre, x across it towards the sun */
  double most;              /* 1 - cosine of the rim's angle to z */
  double ground;            /* part of the disc within the limb of the ground, 0..1 */
} pl_body_disc;

/* `sun`: direction from the body to the sun in root axes, any length; `point` camera-relative, root
 * axes. False if the point is in or on the body. */
bool pl_body_disc_make(const pl_shot_body *body, pl_vec3 sun, pl_vec3 point, pl_body_disc *out);

enum { PL_DISC_RINGS = 10, PL_DISC_TURNS = 16, PL_DISC_CELLS = PL_DISC_RINGS * PL_DISC_TURNS };

/* Where draws go. */
typedef struct pl_disc_table {
  float edge[PL_DISC_RINGS + 1];                /* of the rings, rising parts, 0..1 */
  float turn[PL_DISC_TURNS + 1];                /* chance of lesser turns */
  float ring[PL_DISC_TURNS][PL_DISC_RINGS + 1]; /* of those: of lesser parts */
  float density[PL_DISC_TURNS][PL_DISC_RINGS];  /* over that of even draws from the disc */
} pl_disc_table;

/* The rings of a disc: into table->edge. */
void pl_disc_rings(const pl_body_disc *disc, pl_disc_table *table);
/* The unit direction, root axes, in the middle of a cell. */
pl_vec3 pl_disc_middle(const pl_body_disc *disc, const pl_disc_table *table, int turn, int ring);
/* What the cells are drawn by: their `light`, any unit, not negative and not all 0. Each cell gets
 * some, also where the light is 0: what is known of it may be wrong. */
void pl_disc_table_fill(const float light[PL_DISC_TURNS][PL_DISC_RINGS], pl_disc_table *table);

/* A unit direction, root axes, of a part and a turn; *even: density of draws that are even over
 * the disc, 1/sr. */
pl_vec3 pl_disc_direction(const pl_body_disc *disc, double part, double turn_rad, double *even);

/* Draws a unit direction in root axes, and its density per sr. u in [0, 1)^2. */
pl_vec3f pl_disc_sample(const pl_body_disc *disc, const pl_disc_table *table, const float u[2],
                        float *pdf);
/* Density with which a unit direction is drawn, 1/sr; 0 beyond the disc. */
float pl_disc_pdf(const pl_body_disc *disc, const pl_disc_table *table, pl_vec3f direction);

#endif
