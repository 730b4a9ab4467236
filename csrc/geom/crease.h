/* Edges that vertex normals were smoothed over by mistake. */
#ifndef PL_GEOM_CREASE_H
#define PL_GEOM_CREASE_H

#include "geom/model.h"

/* Published models often have one normal at each corner of a box: the mean of faces that meet at
 * right angles, so that flat plates are shaded as if they were molten. Where triangles at a vertex
 * share its normal, which leans from one by more than half of `angle_rad`, and are joined there
 * only over edges of more than `angle_rad`, each group of triangles that other edges join gets the
 * mean of its own normals, weighted by the angles at the vertex (Thuermer and Wuethrich 1998, J.
 * Graphics Tools 3, 43). Vertices of one place and normal count as one, whatever their texture
 * coordinates. All others stay as they are, to the bit; an angle of pi changes nothing. *split: how
 * many such places there were; a line of the model's warnings tells of them. Vertices are added at
 * the end. */
pl_status pl_model_crease(pl_model *model, double angle_rad, size_t *split);

#endif
