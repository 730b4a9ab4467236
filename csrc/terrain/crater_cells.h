/* Internal: the cells of a field of craters, and what is drawn in them. */
#ifndef PL_TERRAIN_CRATER_CELLS_H
#define PL_TERRAIN_CRATER_CELLS_H

#include "terrain/crater_field.h"
#include "terrain/crater_profile.h"
#include "terrain/scatter.h"

/* Harmonics of the rim's radius, from order 2 on, and of its height, from order 1 on. */
enum { PL_CRATER_RADIUS_ORDERS = 4, PL_CRATER_HEIGHT_ORDERS = 3, PL_CRATER_TERRACE_ORDERS = 4 };

/* Terraces of a wall. They are not circles: they come and go with the azimuth. */
typedef struct pl_crater_terraces {
  int count;    /* 0: none */
  double depth; /* by how much their treads are flatter than the wall, 0 to 1 */
  double floor; /* radius over R at which the wall begins */
  /* By azimuth, cosine and sine amplitudes from order 1 on: by how many steps they lie further
   * inwards, and by how much they are deeper than on the mean, over it. */
  double wander[PL_CRATER_TERRACE_ORDERS][2], come[PL_CRATER_TERRACE_ORDERS][2];
} pl_crater_terraces;

struct pl_crater_field {
  pl_crater_frame frame;
  double *table; /* the law's table, owned */
  pl_crater_shapes *shapes;
  double stretch;                  /* bound of a rim's radius over R */
  pl_vec3 faces[PL_CUBE_FACES][3]; /* outward, s, t */
  pl_scatter scatter;
  struct pl_crater_brightness *brightness; /* owned; NULL without rays */
};

/* Bound of a rim's radius over R, by the ellipse and the harmonics of a frame. */
double pl_crater_stretch(const pl_crater_frame *frame);

/* Selects craters: those whose centre is within `angle_rad` plus `reach` of their radii (0: the
 * centre itself) of an axis, with diameters in [min_m, max_m). */
typedef struct pl_crater_query {
  const pl_crater_model *model; /* or NULL */
  pl_vec3 axis;
  double angle_rad, reach, min_m, max_m;
} pl_crater_query;

/* Greatest age (Ga) of the drawn craters of a size: the law's, or the age at which they are worn
 * below the counted depth. */
double pl_crater_oldest_drawn_ga(const pl_crater_frame *frame, double diameter_m);

typedef pl_status (*pl_crater_visit_fn)(void *context, const pl_scatter_site *site);

/* Visits the craters by level, face, i, j and number, which is the order of their ids. */
pl_status pl_crater_visit(const pl_crater_field *field, const pl_crater_query *query,
                          pl_crater_visit_fn visit, void *context);

/* What else is drawn for a crater; words are independent of those of its site. */
typedef struct pl_crater_draw {
  double age_ga, tau, axis_ratio;
  pl_vec3 major, minor; /* unit, tangent to the sphere */
  double offset[2];     /* of the floor along major and minor, over R */
  /* cosine and sine amplitudes by order */
  double radius[PL_CRATER_RADIUS_ORDERS][2], height[PL_CRATER_HEIGHT_ORDERS][2];
  pl_crater_terraces terraces;
} pl_crater_draw;
/* Rank of its age among the craters of its size, from 0 (the youngest) to 1. */
double pl_crater_draw_rank(const pl_crater_field *field, const pl_scatter_site *site);
void pl_crater_draw_age(const pl_crater_field *field, const pl_scatter_site *site,
                        pl_crater_draw *draw); /* age_ga and tau */
void pl_crater_draw_shape(const pl_crater_field *field, const pl_scatter_site *site,
                          pl_crater_draw *draw); /* the others, but terraces */
/* Draws the terraces of a crater of known age, as far as a footprint (m) shows them. */
void pl_crater_draw_terraces(const pl_crater_field *field, const pl_scatter_site *site,
                             double footprint_m, pl_crater_draw *draw);

/* How much of a crater of a size shows on a mesh with cells of a footprint, [0, 1]. */
double pl_crater_fade(double diameter_m, double footprint_m);

/* Fraction of a crater that is drawn in a direction beside what models show; 1 without. */
double pl_crater_left(const pl_crater_field *field, const pl_crater_model *model, pl_vec3 direction,
                      double diameter_m);

/* Sets depth_m and rim_m by diameter_m and tau. */
void pl_crater_measure(const pl_crater_field *field, pl_crater *crater);

/* Whether crater a is younger than b; the later id of two of the same age. */
static inline bool pl_crater_younger(double age_a, uint64_t id_a, double age_b, uint64_t id_b) {
  return age_a < age_b || (age_a == age_b && id_a > id_b);
}

/* Radius over R up to which a crater removes older ones wholly, and at all. */
#define PL_CRATER_ERASE_FROM 1.0
#define PL_CRATER_ERASE_TO 1.3
/* Least ratio of diameters at which the younger removes some of the older; at its inverse all. */
#define PL_CRATER_ERASE_RATIO 0.70710678118654752

/* Fraction of an older crater that a younger one removes within its rim, by their diameters. */
double pl_crater_erasure(double younger_m, double older_m);
/* Fraction of that at a chord^2 from the centre of a crater of a radius (over the body's radius).
 */
double pl_crater_erasure_at(double chord2, double radius);

#endif
