/* Table of the kinds of geometry. */
#include "render/geometry.h"

const pl_geometry_kind *const pl_geometry_kinds[PL_SURFACE_KINDS] = {
#define PL_KIND(NAME, name, replaces) [PL_SURFACE_##NAME] = &pl_geometry_##name,
    PL_SURFACE_KIND_LIST(PL_KIND)
#undef PL_KIND
};

pl_status pl_geometry_tracer(pl_accelerators *kept, const pl_snapshot *shot, pl_arena *arena,
                             const pl_tracer **out) {
  pl_intersects intersects;
  for (int k = 0; k < PL_SURFACE_KINDS; k++)
    intersects.of[k] = pl_geometry_kinds[k]->intersect;
  return pl_tracer_build(kept, shot, &intersects, arena, out);
}
