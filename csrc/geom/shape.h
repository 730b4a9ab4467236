/* Shapes of bodies: triangle models, and tests of which points are inside. */
#ifndef PL_GEOM_SHAPE_H
#define PL_GEOM_SHAPE_H

#include "geom/model.h"
#include "math/vec.h"

/* Creates a model of one part and one plain material that is opaque from both sides. Normals are
 * smooth: the mean of the face normals at a vertex, weighted by angle. Copies
 * positions[vertices][3] and indices[triangles][3]; `name` is the name of the part. Returns
 * PL_E_RANGE for no triangles, indices out of range and positions that are not finite. */
pl_status pl_shape_create(const char *name, const float *positions, size_t vertices,
                          const uint32_t *indices, size_t triangles, pl_model **out);

/* Gives a shape the materials and texture coordinates of the model that it was made from: `corners`
 * [triangles][3] are the source vertices at the shape's corners, `faces` [triangles] the source
 * triangles. Textures are borrowed from the source. Opacity, emission and transmission are not
 * copied: a body is opaque, has its own emission and is seen from outside. Returns PL_E_RANGE for
 * corners and faces out of range. */
pl_status pl_shape_dress(pl_model *shape, const pl_model *source, const uint32_t *corners,
                         const uint32_t *faces);

/* Lets rays pass through the back sides of a shape's triangles. */
void pl_shape_make_one_sided(pl_model *model);

/* Returns the winding number of the surface around a point, positive for triangles
 * counter-clockwise seen from outside: for a closed mesh 1 inside and 0 outside, one half on a
 * face; for a mesh with holes it lies between these. It is the sum of the solid angles of all
 * triangles (van Oosterom and Strackee 1983, IEEE Trans. Biomed. Eng. 30, 125, equation 8) over 4
 * pi, in double. A triangle whose plane contains the point contributes 0. */
double pl_shape_winding(const pl_model *model, pl_vec3 point);

#endif
