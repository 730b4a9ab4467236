/* Splits vertex normals that were smoothed across hard edges. */
#ifndef PL_GEOM_CREASE_H
#define PL_GEOM_CREASE_H

#include "geom/model.h"

/* Published models often have one normal per corner of a box: the mean of faces that meet at right
 * angles. Flat plates then look rounded in shading.
 *
 * A vertex is split where two conditions hold. Its normal deviates from one of its triangles by
 * more than half of `angle_rad`. Its triangles form groups that are connected only across edges of
 * more than `angle_rad`. Each group then gets the mean of its own face normals, weighted by the
 * angles at the vertex (Thuermer and Wuethrich 1998, J. Graphics Tools 3, 43). Vertices with the
 * same position and normal count as one, whatever their texture coordinates. All other vertices
 * keep their bits; an angle of pi changes nothing.
 *
 * *split: number of vertices that were split; a line of the model's warnings reports it. New
 * vertices are appended. */
pl_status pl_model_crease(pl_model *model, double angle_rad, size_t *split);

#endif
