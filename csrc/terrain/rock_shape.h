/* Shapes of rocks: bodies around a centre, a function of direction, in a dozen families.
 *
 * A ball is cut by random planes, whose corners are chipped by more, with edges rounded as the
 * family says, and displaced by noise. Each family has PL_ROCK_VARIANTS such balls; a rock is one
 * of them, stretched along three axes by numbers of its own. The last family has no balls, but the
 * shapes of the rocks that users give (terrain/rock_scan.h). So rocks are affine images of a few
 * hundred shapes, and share their meshes (terrain/rock_mesh.h). Every ray from the centre meets the
 * surface once, so any mesh of a sphere gives a closed mesh of the rock. z is its short axis. */
#ifndef PL_TERRAIN_ROCK_SHAPE_H
#define PL_TERRAIN_ROCK_SHAPE_H

#include <stdint.h>

#include "base/status.h"
#include "math/vec.h"
#include "terrain/rock_scan.h"

enum {
  PL_ROCK_PLANES = 24,
  PL_ROCK_OCTAVES = 4,
  PL_ROCK_VARIANTS = 32,
  PL_ROCK_PROBES = 162,
  PL_ROCK_LODS = 6
};

typedef struct pl_rock_family {
  const char *name, *doc;
  double width, height;     /* means of the middle and short axes over the long one */
  int planes;               /* at most PL_ROCK_PLANES */
  double nearest, furthest; /* distance of planes from the centre; beyond 1 they cut nothing */
  int sharpness;            /* edges: exponent 2^sharpness of the norm that joins planes, 2 to 6 */
  double lumps, roughness;  /* amplitudes of wide and of narrow noise over the radius */
  double knobs;             /* fraction of narrow noise that is folded */
  int chips; /* further planes, that break corners and edges off; at most PL_ROCK_PLANES in all */
} pl_rock_family;

typedef enum pl_rock_family_kind {
  PL_ROCK_BLOCK,
  PL_ROCK_CUBE,
  PL_ROCK_WEDGE,
  PL_ROCK_SLAB,
  PL_ROCK_TABLET,
  PL_ROCK_SHARD,
  PL_ROCK_SPLIT,
  PL_ROCK_COBBLE,
  PL_ROCK_BOULDER,
  PL_ROCK_EGG,
  PL_ROCK_BRECCIA,
  PL_ROCK_PITTED,
  PL_ROCK_MODEL,
  PL_ROCK_FAMILIES
} pl_rock_family_kind;
extern const pl_rock_family pl_rock_families[PL_ROCK_FAMILIES];

/* Spheres of triangles: subdivided icosahedra, 20 4^level triangles. */
typedef struct pl_rock_sphere {
  int vertex_count, triangle_count;
  pl_vec3 *vertices;        /* unit */
  uint32_t (*triangles)[3]; /* counter-clockwise from outside */
} pl_rock_sphere;
pl_status pl_rock_spheres_create(pl_rock_sphere **out); /* PL_ROCK_LODS of them, one block */
void pl_rock_spheres_destroy(pl_rock_sphere *spheres);
/* Level with triangles about as wide as cells: 80 triangles from 2 cells on, four times as many for
 * each factor of 2. */
int pl_rock_lod(double diameter_m, double cell_m);

/* A ball with its cuts and noise. */
typedef struct pl_rock_variant {
  const pl_rock_family *family;
  const pl_rock_scan *scan; /* borrowed; NULL for a ball */
  uint32_t number;          /* of a variant among those of all families */
  uint32_t siblings;        /* variants of its family */
  uint32_t seed;            /* of noise */
  int planes;
  pl_vec3 normals[PL_ROCK_PLANES]; /* over their distance */
  pl_vec3 probes[PL_ROCK_PROBES];  /* points of its surface */
  double plan;                     /* geometric mean of its widths along x and y */
  double scale[PL_ROCK_LODS];      /* at which its meshes throw the mean shadow of the finest */
} pl_rock_variant;

/* No point of a shape is further from its centre, in plan diameters. */
#define PL_ROCK_SHAPE_REACH 1.2

/* All variants, by number: those of a family follow one another. `scans`: up to PL_ROCK_VARIANTS
 * measured shapes, which must outlive the variants; PL_E_RANGE for one that is too long for its
 * width. Freed with pl_free. */
pl_status pl_rock_variants_create(const pl_rock_sphere *spheres, const pl_rock_scan *const *scans,
                                  size_t scan_count, pl_rock_variant **out);

/* One rock, of plan diameter 1 (the geometric mean of its widths along x and y). */
typedef struct pl_rock_shape {
  const pl_rock_variant *variant; /* borrowed */
  pl_vec3 axes;
  double radius; /* no point is further from the centre */
} pl_rock_shape;

/* Draws a shape of a family that has variants from three random words. */
void pl_rock_shape_draw(const pl_rock_variant *variants, pl_rock_family_kind family,
                        const uint64_t words[3], pl_rock_shape *out);

/* Distance of a variant's surface from the centre in a unit direction. */
double pl_rock_variant_radius(const pl_rock_variant *variant, pl_vec3 direction);
/* Extent along a unit axis: it misses at most 5 % of it. */
void pl_rock_shape_extent(const pl_rock_shape *shape, pl_vec3 axis, double *low, double *high);
/* Distance from the centre over that of the surface on the same ray: below 1 inside. */
double pl_rock_shape_depth(const pl_rock_shape *shape, pl_vec3 point);

#endif
