/* Back-to-back sheets: faces of a model whose back side another face covers and hides.
 *
 * Thin parts, such as solar panels, are often modelled as two sheets with opposite normals. In
 * files with quantised positions (Draco at 14 bits: by 3e-5 of the model's size) either sheet may
 * lie in front of the other. The back of such a face therefore does not exist for rays, even if its
 * material is double-sided: the face that is turned towards the ray is hit. */
#ifndef PL_TRACE_BACKING_H
#define PL_TRACE_BACKING_H

#include "base/status.h"
#include "geom/model.h"

/* Largest distance between two such sheets, as a fraction of the model's longest side. */
#define PL_HAIR 1e-4

/* Fills model->backed and model->hair; call it once per model. A face is backed if at seven points
 * of it, within `hair` along its normal, there is another face of the same node that looks in the
 * opposite direction. If the face's material is double-sided, the covering face must be covered
 * itself and not be a hull under a decal. Sheets on different nodes are excluded, since they may
 * move apart. Faces of transmissive solids have two sides and are never backed; a point that alpha
 * makes transparent covers nothing. Fails with PL_E_MEMORY or PL_E_DEVICE. */
pl_status pl_backing_find(pl_model *model);

#endif
