/* Sheets back to back: faces of a model whose back another face covers, and hides.
 *
 * Thin things, as wings of solar cells, are often two sheets that look away from each other. Files
 * that are rounded (Draco at 14 bits by 3e-5 of the model) have them in either order, so that each
 * is as often before the other as behind it. So the back of such a face is no surface, whatever the
 * sides of its material: the face that looks at the ray is hit. */
#ifndef PL_TRACE_BACKING_H
#define PL_TRACE_BACKING_H

#include "base/status.h"
#include "geom/model.h"

/* How far apart two such sheets are at most, of the model's longest side. */
#define PL_HAIR 1e-4

/* Fills model->backed and model->hair, once. A face is backed where, at seven of its points, within
 * a hair along its normal, another face of its node looks the other way. Of what a file has
 * double-sided that one must be covered so itself, and not be a hull under a decal. Sheets on
 * different nodes may part. Faces of solids that light goes through have two sides and are never
 * backed, and a point where alpha leaves no surface backs nothing. PL_E_MEMORY, PL_E_DEVICE. */
pl_status pl_backing_find(pl_model *model);

#endif
