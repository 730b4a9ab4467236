/* Table of the kinds of geometry. */
#include "render/geometry.h"

const pl_geometry_kind *const pl_geometry_kinds[PL_SURFACE_KINDS] = {
    [PL_SURFACE_MESH] = &pl_geometry_mesh,
    [PL_SURFACE_SHAPE] = &pl_geometry_shape,
    [PL_SURFACE_ELLIPSOID] = &pl_geometry_ellipsoid,
    [PL_SURFACE_HEIGHT_FIELD] = &pl_geometry_height_field,
    [PL_SURFACE_ROCKS] = &pl_geometry_rocks,
};
