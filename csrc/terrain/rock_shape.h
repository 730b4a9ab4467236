/* Shapes of rocks: bodies around a centre, a function of direction, in a dozen families.
 *
 * A ball is cut by random planes, with edges rounded as the family says, displaced by noise, and
 * stretched along three axes. Every ray from the centre meets the surface once, so any mesh of a
 * sphere gives a closed mesh of the rock. z is its short axis. */
#ifndef PL_TERRAIN_ROCK_SHAPE_H
#define PL_TERRAIN_ROCK_SHAPE_H

#include <stdint.h>

#include "base/status.h"
#include "math/vec.h"

enum { PL_ROCK_PLANES = 20, PL_ROCK_OCTAVES = 3 };

typedef struct pl_rock_family {
  const char *name, *doc;
  double width, height;     /* means of the middle and short axes over the long one */
  int planes;               /* at most PL_ROCK_PLANES */
  double nearest, furthest; /* distance of planes from the centre; beyond 1 they cut nothing */
  int sharpness;            /* edges: exponent 2^sharpness of the norm that joins planes, 2 to 6 */
  double lumps, roughness;  /* amplitudes of wide and of narrow noise over the radius */
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
  PL_ROCK_FAMILIES
} pl_rock_family_kind;
extern const pl_rock_family pl_rock_families[PL_ROCK_FAMILIES];

/* One rock, of plan diameter 1 (the geometric mean of its widths along x and y). */
typedef struct pl_rock_shape {
  const pl_rock_family *family;
  pl_vec3 axes;
  int planes;
  pl_vec3 normals[PL_ROCK_PLANES]; /* over their distance */
  uint32_t seed;                   /* of noise */
  double radius;                   /* no point is further from the centre */
} pl_rock_shape;

/* Draws a shape from four random words. */
void pl_rock_shape_draw(pl_rock_family_kind family, const uint64_t words[4], pl_rock_shape *out);

/* Point of the surface on the ray through a unit direction of the unstretched ball. */
pl_vec3 pl_rock_shape_point(const pl_rock_shape *shape, pl_vec3 direction);
/* Extent along a unit axis, of about 64 points: it misses at most a few percent. */
void pl_rock_shape_extent(const pl_rock_shape *shape, pl_vec3 axis, double *low, double *high);
/* Distance from the centre over that of the surface on the same ray: below 1 inside. */
double pl_rock_shape_depth(const pl_rock_shape *shape, pl_vec3 point);

/* Spheres of triangles: subdivided icosahedra, 20 4^level triangles. */
enum { PL_ROCK_LODS = 6 };
typedef struct pl_rock_sphere {
  int vertex_count, triangle_count;
  pl_vec3 *vertices;        /* unit */
  uint16_t (*triangles)[3]; /* counter-clockwise from outside */
  double scale; /* by which the mesh of a sphere has the sphere's area, and so its mean shadow */
} pl_rock_sphere;
pl_status pl_rock_spheres_create(pl_rock_sphere **out); /* PL_ROCK_LODS of them, one block */
void pl_rock_spheres_destroy(pl_rock_sphere *spheres);

#endif
