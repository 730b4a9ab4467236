/* Connected components of a model's triangles: the separate pieces of a file with a single mesh. */
#ifndef PL_GEOM_COMPONENTS_H
#define PL_GEOM_COMPONENTS_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "geom/model.h"

/* Sets first[v] to the first vertex at the position of each vertex v: bit for bit, 0 = -0.
 * PL_E_MEMORY when out of memory. */
pl_status pl_components_weld(const pl_model *model, uint32_t *first);

/* Two triangles are connected when they share a corner position; normals and uv do not matter:
 * vertices at the same position (bit for bit, 0 = -0) are one. Components are numbered from 0 by
 * decreasing number of triangles, equal ones by their first triangle, so that the numbers depend on
 * the mesh alone.
 *
 * triangle_component: room for model->triangle_count numbers; count: number of components (0 for an
 * empty mesh). Time is linear in the mesh size except for the sort of the components. Returns
 * PL_E_MEMORY when out of memory. */
pl_status pl_components_find(const pl_model *model, uint32_t *triangle_component, size_t *count);

#endif
