/* The disc of a body and its atmosphere as seen from a point: a set of directions that are sampled
 * in proportion to a table of brightness.
 *
 * All computations use axes scaled by the body's radii, in which the body is the unit sphere and
 * lines remain lines. There, a direction on the disc has two coordinates. Its part is 0 at the
 * centre and 1 at the rim, and is uniform in solid angle. Its turn is the angle about the line to
 * the body's centre, 0 towards the sun. Parts are divided into rings that become narrower towards
 * the limb, where crescents and twilight are; turns are divided uniformly. A table made for one
 * point therefore also serves other points that see the body at about the same size and from about
 * the same side. Directions are single precision: at a distance of n radii they are off by about
 * 1e-7 n of the body's radius. */
#ifndef PL_LIGHT_BODY_DISC_H
#define PL_LIGHT_BODY_DISC_H

#include "scene/snapshot.h"

typedef struct pl_body_disc {
  const pl_shot_body *body; /* borrowed */
  pl_vec3 x, y, z; /* scaled axes: z to the body's centre, x perpendicular to it towards the sun */
  double most;     /* 1 - cosine of the angle between the rim and z */
  double ground;   /* fraction of the disc inside the limb of the ground, 0..1 */
} pl_body_disc;

/* `sun`: direction from the body to the sun in root axes, any length. `point`: camera-relative,
 * root axes. Returns false if the point is inside or on the body. */
bool pl_body_disc_make(const pl_shot_body *body, pl_vec3 sun, pl_vec3 point, pl_body_disc *out);

enum { PL_DISC_RINGS = 10, PL_DISC_TURNS = 16 };

/* Sampling table of a disc. */
typedef struct pl_disc_table {
  float edge[PL_DISC_RINGS + 1];                /* edges of the rings as increasing parts, 0..1 */
  float turn[PL_DISC_TURNS + 1];                /* cumulative probability over turns */
  float ring[PL_DISC_TURNS][PL_DISC_RINGS + 1]; /* cumulative probability over parts, by turn */
  float density[PL_DISC_TURNS][PL_DISC_RINGS];  /* relative to uniform sampling */
} pl_disc_table;

/* Writes the ring edges of a disc to table->edge. */
void pl_disc_rings(const pl_body_disc *disc, pl_disc_table *table);
/* Unit direction, root axes, at the centre of a cell. */
pl_vec3 pl_disc_middle(const pl_body_disc *disc, const pl_disc_table *table, int turn, int ring);
/* Sets the densities of the cells from their `light`, in any unit, not negative and not all 0.
 * Every cell gets a positive density, even where its light is 0, since the estimate may be wrong.
 */
void pl_disc_table_fill(const float light[PL_DISC_TURNS][PL_DISC_RINGS], pl_disc_table *table);

/* Unit direction, root axes, at a part and a turn. *even: probability density of uniform sampling
 * of the disc, 1/sr. */
pl_vec3 pl_disc_direction(const pl_body_disc *disc, double part, double turn_rad, double *even);

/* Samples a unit direction in root axes and returns its density, 1/sr. u in [0, 1)^2. */
pl_vec3f pl_disc_sample(const pl_body_disc *disc, const pl_disc_table *table, const float u[2],
                        float *pdf);
/* Density with which pl_disc_sample draws a unit direction, 1/sr; 0 outside the disc. */
float pl_disc_pdf(const pl_body_disc *disc, const pl_disc_table *table, pl_vec3f direction);

#endif
