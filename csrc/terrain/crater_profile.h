/* Radial profile of a crater: fresh dimensions by size, and degradation by diffusion.
 *
 * Heights are over the surface before the impact, x = r / R with the radius R of the rim. */
#ifndef PL_TERRAIN_CRATER_PROFILE_H
#define PL_TERRAIN_CRATER_PROFILE_H

#include "base/status.h"

/* A crater ends here. Ejecta fade to 0 from x = 2 on, where they are 3 % of the rim. */
#define PL_CRATER_REACH 3.0
#define PL_CRATER_KNOTS_PER_RADIUS 32
/* Knots of a profile: one before the centre, and those up to the reach and one beyond. */
#define PL_CRATER_KNOTS (PL_CRATER_KNOTS_PER_RADIUS * 3 + 3)
/* Greatest tau of a shape: there a crater has 2 % of its depth. */
#define PL_CRATER_TAU_MAX 2.0

/* Dimensions of a fresh crater (m). */
typedef struct pl_crater_dimensions {
  double depth_m;  /* rim to floor */
  double rim_m;    /* rim over the surface before the impact */
  double ejecta_m; /* part of rim_m that is ejecta; the rest is uplifted */
  double peak_m;   /* central peak over the floor */
  double floor;    /* radius of the flat floor over R */
} pl_crater_dimensions;

/* Pike (1977) for simple and complex craters, joined between 10 and 20 km; depths of craters below
 * 0.7 km by Stopar et al. (2017), who found them shallower, with rims lower in proportion; ejecta
 * by McGetchin et al. (1973), at most half of the rim. Peaks are at most half of the depth: larger
 * craters have rings instead. */
pl_crater_dimensions pl_crater_fresh(double diameter_m);

/* Fraction of a crater that is complex: 0 up to 10 km, 1 from 20 km on. */
double pl_crater_complex(double diameter_m);

/* Time of diffusion over R^2/diffusivity. Diffusivity (m^2 per Myr) grows as D^exponent from its
 * value at 1 km: Fassett and Thomson (2014, 2015) have 5.5 and 0.9. */
double pl_crater_tau(double diameter_m, double age_ga, double diffusivity_1km, double exponent);
/* Greatest tau of a crater that laws count. Ages that are uniform up to it have the classes of
 * degradation of Basilevsky (1976), as in NASA SLS-SPEC-159: half are shallower than a third of a
 * fresh crater, a fifth deeper than two thirds. */
#define PL_CRATER_TAU_COUNTED 0.24

/* Shapes of craters by tau; immutable, so that threads can share it. */
typedef struct pl_crater_shapes pl_crater_shapes;
pl_status pl_crater_shapes_create(pl_crater_shapes **out);
void pl_crater_shapes_destroy(pl_crater_shapes *shapes);

/* Heights (m) of a crater that is tau old, at x = (k - 1) / PL_CRATER_KNOTS_PER_RADIUS. tau is
 * clamped to [0, PL_CRATER_TAU_MAX]. */
void pl_crater_profile(const pl_crater_shapes *shapes, const pl_crater_dimensions *fresh,
                       double tau, float profile[PL_CRATER_KNOTS]);

/* Height (m) at x >= 0; 0 from PL_CRATER_REACH on. Once differentiable. */
double pl_crater_profile_height(const float profile[PL_CRATER_KNOTS], double x);

#endif
