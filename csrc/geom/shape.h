/* Shapes of bodies: models of bare triangles, and which points are inside of them. */
#ifndef PL_GEOM_SHAPE_H
#define PL_GEOM_SHAPE_H

#include "geom/model.h"
#include "math/vec.h"

/* A model of one part and one plain material that is opaque from both sides; normals are smooth,
 * the mean of the faces about a vertex by angle. Copies positions[vertices][3] and
 * indices[triangles][3]; `name` is the part's. PL_E_RANGE for no triangles, corners that are not
 * there and positions that are not finite. */
pl_status pl_shape_create(const char *name, const float *positions, size_t vertices,
                          const uint32_t *indices, size_t triangles, pl_model **out);

/* Gives a shape the materials and texture coordinates of the model that it was made of: `corners`
 * [triangles][3] are the source's vertices at the shape's corners, `faces` [triangles] its
 * triangles. Textures are borrowed from the source. A body is opaque, shines by its own light alone
 * and is seen from outside: opacity, emission and transmission are left out. PL_E_RANGE for corners
 * and faces that are not there. */
pl_status pl_shape_dress(pl_model *shape, const pl_model *source, const uint32_t *corners,
                         const uint32_t *faces);

/* Lets rays from behind pass the triangles of a shape. */
void pl_shape_make_one_sided(pl_model *model);

/* How often the surface goes around a point, counter-clockwise seen from outside: of a closed mesh
 * 1 inside and 0 outside, a half on a face, and between these for one with holes. The sum of the
 * solid angles of all triangles (van Oosterom and Strackee 1983, IEEE Trans. Biomed. Eng. 30, 125,
 * equation 8) over 4 pi, in double; a triangle in whose plane the point lies counts nothing. */
double pl_shape_winding(const pl_model *model, pl_vec3 point);

#endif
