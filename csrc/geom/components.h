/* Connected components of a model's triangles: what holds together in a file that is one mesh. */
#ifndef PL_GEOM_COMPONENTS_H
#define PL_GEOM_COMPONENTS_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "geom/model.h"

/* Two triangles are connected when they share a corner, whatever its normal or uv: vertices at the
 * same position (bit for bit, 0 = -0) are one. Components are numbered from 0 by falling number of
 * triangles, equal ones by their first triangle, so that the numbers depend on the mesh alone.
 *
 * triangle_component: room for model->triangle_count; count: number of components (0 for an empty
 * mesh). Linear in the mesh but for the sort of the components. PL_E_MEMORY. */
pl_status pl_components_find(const pl_model *model, uint32_t *triangle_component, size_t *count);

#endif
