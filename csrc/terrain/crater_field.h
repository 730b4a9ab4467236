/* Craters of a whole body as a function of place: nothing is stored, nothing depends on the view.
 *
 * Craters are scattered by a size-frequency law (terrain/scatter.h). A crater on an edge of cells
 * or of the cube is found from both sides.
 *
 * Relief is the sum of the profiles of craters. Inside the rim of a crater, older ones that are
 * smaller or about as large are gone; those that are larger stay, as the slope that it lies on.
 * Sums are taken in a fixed order, so the height of a point has the same bits in any block. */
#ifndef PL_TERRAIN_CRATER_FIELD_H
#define PL_TERRAIN_CRATER_FIELD_H

#include <stdint.h>

#include "math/vec.h"
#include "terrain/crater_sizes.h"

/* Craters are left out below 2 footprints of diameter, and at full height from 4 on. */
#define PL_CRATER_FADE_FROM 2.0
#define PL_CRATER_FADE_TO 4.0
/* Greatest density times D^2; geometric saturation is 1.54. */
#define PL_CRATER_DENSEST 2.5
/* Most craters that a list may be expected to have. */
#define PL_CRATER_LIST_MOST 2e6

/* Bright ejecta and rays of fresh craters (terrain/crater_rays.h). */
typedef struct pl_crater_rays {
  double brightness; /* of fresh ejecta over old ground, less 1; 0: no rays */
  double fade_ga;    /* time in which those of craters of 3 km or more fade */
  double reach;      /* length of the longest, over the crater's radius */
} pl_crater_rays;

typedef struct pl_crater_frame {
  double radius_m; /* of the body; an oblate body's mean: densities are those of this sphere */
  pl_crater_law law;
  uint64_t seed;
  double min_m, max_m;           /* diameters */
  double diffusivity_m2_per_myr; /* that degrades craters of 1 km; 0 or more */
  double diffusivity_exponent;   /* by diameter */
  double ellipticity;  /* greatest 1 - minor/major axis, [0, 0.6]; drawn uniformly from 0 on */
  double irregularity; /* of rims and floors: 1 as real ones, 0 to 3 */
  double terraces;     /* of the walls of complex craters: 1 as real ones, 0: smooth walls */
  double model_posts;  /* an elevation model shows craters of so many of its posts or more; > 0 */
  pl_crater_rays rays;
} pl_crater_frame;

/* The Moon's craters on a body of this radius: neukum_equilibrium on a surface of 3.5 Ga, from 0.1
 * m (or the least possible) to 300 km (or the greatest possible), diffusivity of Fassett and
 * Thomson, round, irregular and terraced as real ones, left to models of 6 posts a diameter,
 * without rays. */
pl_crater_frame pl_crater_frame_default(double radius_m);

typedef struct pl_crater_field pl_crater_field;

/* PL_E_RANGE for numbers that are not valid, and for laws denser than PL_CRATER_DENSEST. The law's
 * table is copied. The field is immutable, so that threads can share it. */
pl_status pl_crater_field_create(const pl_crater_frame *frame, pl_crater_field **out);
void pl_crater_field_destroy(pl_crater_field *field);
const pl_crater_frame *pl_crater_field_frame(const pl_crater_field *field);

/* Elevation models under the craters. Craters that they show, from model_posts of their posts on,
 * are not drawn again: not at all if they show the centre and the rim, else beside the model. Must
 * be pure. */
typedef struct pl_crater_model {
  /* Spacing of posts (m) in a direction, infinite where there are none. */
  double (*spacing_m)(const void *context, pl_vec3 direction);
  const void *context;
  /* Fraction of the relief of a crater of a size that is drawn in a direction: 0 on models with
   * posts closer than its diameter over `posts`, 1 farther than half its radius from them. NULL:
   * craters are drawn wholly or not, by the spacing at their centre. */
  double (*left)(const void *context, pl_vec3 direction, double diameter_m, double posts);
  double least_spacing_m; /* of all posts; what is smaller than model_posts of them is drawn */
} pl_crater_model;

/* Adds the heights (m) of craters at unit directions, for a footprint (the width of a cell of the
 * mesh, m; 0: all craters). Fast if neighbours in the array are near each other. `model` may be
 * NULL. */
pl_status pl_crater_add_heights(const pl_crater_field *field, const pl_crater_model *model,
                                const pl_vec3 *directions, size_t count, double footprint_m,
                                double *heights);

/* Bounds of relief (m) by all craters of at most `largest_m`: heights lie between them but for
 * chance overlaps of many large craters. */
void pl_crater_bounds(const pl_crater_field *field, double largest_m, double *low_m,
                      double *high_m);

/* Writes, for meshes with cells of these widths, the variance of slopes along any one axis that
 * such a mesh leaves out of the relief of craters: those below PL_CRATER_FADE_TO cells, and what
 * normals between posts lose of larger ones. It is that of the law, a mean over the ground. */
void pl_crater_slope_variances(const pl_crater_field *field, const double *cells_m, size_t count,
                               double *variances);

typedef struct pl_crater {
  uint64_t id; /* below 2^63, not 0; the same in any query */
  pl_vec3 direction;
  pl_vec3 major;     /* unit direction of the major axis at the centre */
  double diameter_m; /* geometric mean of both axes */
  double axis_ratio; /* minor over major axis */
  double age_ga;
  double tau;     /* degradation: time of diffusion over R^2/diffusivity */
  double depth_m; /* rim to floor, degraded */
  double rim_m;   /* rim over the surface before the impact, degraded */
  double kept;    /* fraction of the height at its centre that younger craters and models left */
} pl_crater;

/* Lists the craters with centres within radius_m (along the ground) of a direction, with diameters
 * in [min_m, max_m), larger octaves first. *out is freed with pl_free. PL_E_RANGE if more than
 * PL_CRATER_LIST_MOST are to be expected. */
pl_status pl_crater_list(const pl_crater_field *field, const pl_crater_model *model,
                         pl_vec3 direction, double radius_m, double min_m, double max_m,
                         pl_crater **out, size_t *count);

#endif
