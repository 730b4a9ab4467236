/* Pixels that one mesh is known to fill, by the edges around the triangle that their centre sees.
 *
 * Triangles that share edges, and are turned the same way as seen from the camera, are a sheet that
 * projects without folds. Where no border of the sheet meets the cone of a pixel's rays, all of
 * them meet the sheet. The bound is conservative: neither rounding of traced rays nor the place of
 * a ray in the pixel changes it. */
#ifndef PL_ANNOTATE_FILLED_PIXEL_H
#define PL_ANNOTATE_FILLED_PIXEL_H

#include "geom/adjacency.h"
#include "render/tile.h"
#include "scene/snapshot.h"

/* Surfaces that a tile may see; a tile with more has no pixel that is known to be filled. */
enum { PL_FILL_NEAR_MOST = 64 };

/* A bounding sphere of what else may be before a mesh. */
typedef struct pl_fill_sphere {
  pl_vec3 center;
  double radius_m;
  size_t object; /* index; SIZE_MAX: of a body */
} pl_fill_sphere;

/* Valid for one tile. */
typedef struct pl_fill {
  const pl_snapshot *shot;
  const pl_adjacency *const *adjacencies; /* by object; NULL, or entries of NULL: not known */
  bool possible;
  size_t count;
  pl_fill_sphere near[PL_FILL_NEAR_MOST];
} pl_fill;

void pl_fill_begin(const pl_snapshot *shot, const pl_adjacency *const *adjacencies, pl_tile tile,
                   pl_fill *out);

/* Whether all rays of a pixel through the centre of the lens, as far as pl_image_sample_offset
 * goes, meet the object that the ray through its centre meets, and nothing before it. `triangle`:
 * of the object, met by that ray.
 *
 * False wherever that is not certain: at borders and folds of sheets, on edges of three faces,
 * between moving pieces, on materials with holes, and on sheets with very many triangles a pixel.
 * False also where another object or body enters the pixel nearer than the sheet's farthest point.
 * Lenses that bend rays always give false: a cone would cost as much as the rays. */
bool pl_fill_has(const pl_fill *fill, pl_surface_id id, uint32_t triangle, int x, int y);

#endif
