/* Rocks of a whole body as a function of place: nothing is stored, nothing depends on the view.
 *
 * Rocks are scattered by a size-frequency law (terrain/scatter.h); each draws a family, a shape, an
 * orientation and a burial from random numbers of its own, and is set on the ground as it is at a
 * scale of 1/16 to 1/32 of its diameter. Its short axis is within 20 degrees of the
 * normal of the ground. It is sunk by its burial, and further until the ground passes through it
 * all around its middle: no air is under it, its base does not show. Where it cannot be sunk so
 * without being hidden, on slopes where rocks roll, and in tracks, there is none. */
#ifndef PL_TERRAIN_ROCK_FIELD_H
#define PL_TERRAIN_ROCK_FIELD_H

#include "math/rotation.h"
#include "terrain/rock_shape.h"
#include "terrain/rock_sizes.h"
#include "terrain/scatter.h"
#include "terrain/terrain.h"

/* Greatest share of the ground that a law may cover. */
#define PL_ROCK_COVER_MOST 0.5
/* No rock reaches higher over its deepest point than this many diameters. */
#define PL_ROCK_HEIGHT_MOST 2.4
/* Most rocks that a list may be expected to have. */
#define PL_ROCK_LIST_MOST 2e6
/* The ground passes through a rock within this part of the way from its middle to its outline. */
#define PL_ROCK_CONTACT 0.5

/* Greatest mean height of fillets (terrain/rock_fillets.h) over that of their rocks. */
#define PL_ROCK_FILLET_MOST 0.3

/* Least size of the rocks that tiles of ground show, in cells. */
#define PL_ROCK_CELLS 2.0

/* Blocks about fresh craters (terrain/crater_blocks.h): more rocks of the same law. */
typedef struct pl_rock_ejecta {
  double at_rim; /* their density at the rim of a new crater, over that of the law; 0: none */
  pl_crater_blocks craters;
} pl_rock_ejecta;

typedef struct pl_rock_frame {
  double radius_m; /* pl_terrain_radius_m of the body's terrain */
  pl_rock_law law;
  uint64_t seed;
  double min_m, max_m; /* diameters */
  /* Parts of the heights that are below the ground, drawn uniformly; 0.05 to 0.9. Fresh rocks have
   * 0.05 to 0.2, old ones 0.3 to 0.7. */
  double least_burial, most_burial;
  double repose_rad; /* on steeper slopes there are none; (0, pi/2) */
  double fillet; /* mean height of the soil at their feet over theirs; 0 to PL_ROCK_FILLET_MOST */
  double families[PL_ROCK_FAMILIES]; /* shares of the families, of any sum above 0 */
  const pl_rock_scan *const *scans;  /* borrowed: shapes of PL_ROCK_MODEL, all in equal shares */
  size_t scan_count;                 /* up to PL_ROCK_VARIANTS */
  pl_rock_ejecta ejecta;
} pl_rock_frame;

/* The law of VIPER with few rocks above 3 m, burial of 0.1 to 0.5, repose of 35 degrees, angular
 * families more often than round ones, no more about craters. */
pl_rock_frame pl_rock_frame_default(double radius_m);

typedef struct pl_rock_field pl_rock_field;

/* PL_E_RANGE for numbers that are not valid, and for laws that cover more than PL_ROCK_COVER_MOST.
 * The law's table is copied; scans must outlive the field, but not their list. The field is
 * immutable, so that threads can share it. */
pl_status pl_rock_field_create(const pl_rock_frame *frame, pl_rock_field **out);
void pl_rock_field_destroy(pl_rock_field *field);
const pl_rock_frame *pl_rock_field_frame(const pl_rock_field *field);
/* No point of a rock is farther than this from where it is set on the ground; 0 without a field. */
double pl_rock_reach_m(const pl_rock_field *field);
/* Spheres that rocks are made from, by level of detail. */
const pl_rock_sphere *pl_rock_field_spheres(const pl_rock_field *field);
/* Its shapes before they are stretched, by number. */
const pl_rock_variant *pl_rock_field_variants(const pl_rock_field *field);

typedef struct pl_rock {
  uint64_t id;       /* below 2^63, not 0; the same at any level of detail */
  int64_t family;    /* pl_rock_family_kind */
  double diameter_m; /* seen from above */
  double height_m;   /* over the ground around it */
  double burial;     /* part of its height that is below the ground */
  double slope_rad;  /* of the ground under it */
  pl_vec3 direction; /* of the point of the ground that it is set on; unit, body axes */
  pl_vec3 center;    /* of the shape; body axes, m */
  pl_vec3 up;        /* normal of the ground under it, body axes */
  pl_mat3 rotation;  /* axes of the shape to those of the body */
} pl_rock;

/* Sets the rock of a site on the ground. Returns false if there is none. */
bool pl_rock_set(const pl_rock_field *field, const pl_terrain *terrain, const pl_scatter_site *site,
                 pl_rock *rock, pl_rock_shape *shape);

/* Returns a bound of the height over the ground of a site's rock, by its shape alone: fast. */
double pl_rock_height_bound_m(const pl_rock_field *field, const pl_scatter_site *site);

/* Finds the rock of an id; false if there is none. */
bool pl_rock_find(const pl_rock_field *field, const pl_terrain *terrain, uint64_t id, pl_rock *rock,
                  pl_rock_shape *shape);

/* Sites of rocks in a part of the ground: those of the law, and blocks about craters. */
typedef struct pl_rock_region {
  const pl_rock_field *field;
  pl_crater_source *sources; /* owned */
  size_t source_count;
} pl_rock_region;
/* Of what lies within an angle of a direction. */
pl_status pl_rock_region_init(const pl_rock_field *field, const pl_terrain *terrain, pl_vec3 axis,
                              double angle_rad, pl_rock_region *out);
void pl_rock_region_clear(pl_rock_region *region);

/* A square of the lattice: cell (i, j) of a level of the cube. */
typedef struct pl_rock_square {
  int face, level;
  uint64_t i, j;
} pl_rock_square;
typedef pl_status (*pl_rock_site_fn)(void *context, const pl_scatter_site *site);
/* Visits the sites of a terrain with centres in a square and diameters of at least 1/16 of its
 * width (nominal: that at the centres of faces), larger octaves first. */
pl_status pl_rock_sites(const pl_rock_field *field, const pl_terrain *terrain,
                        const pl_rock_square *square, pl_rock_site_fn visit, void *context);

/* Sites with centres within radius_m plus so many of their own diameters (along the ground) of a
 * place, with diameters in [min_m, max_m). */
typedef struct pl_rock_reach {
  double radius_m, diameters, min_m, max_m;
} pl_rock_reach;
/* Visits them by faces; a coarser cell before its parts. */
pl_status pl_rock_sites_near(const pl_rock_field *field, const pl_terrain *terrain,
                             pl_vec3 direction, const pl_rock_reach *reach, pl_rock_site_fn visit,
                             void *context);

/* Lists the rocks with centres within radius_m (along the ground) of a direction, with diameters in
 * [min_m, max_m). *out is freed with pl_free. PL_E_RANGE if more than PL_ROCK_LIST_MOST are to be
 * expected. */
pl_status pl_rock_list(const pl_rock_field *field, const pl_terrain *terrain, pl_vec3 direction,
                       double radius_m, double min_m, double max_m, pl_rock **out, size_t *count);

#endif
