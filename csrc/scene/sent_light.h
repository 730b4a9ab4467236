/* Upper bound of the sunlight that a mesh sends into any one direction, as seen from afar. */
#ifndef PL_SCENE_SENT_LIGHT_H
#define PL_SCENE_SENT_LIGHT_H

#include "geom/model.h"
#include "scene/materials.h"
#include "shade/material_surface.h"

/* A facet of area A in sunlight of irradiance E has at most the radiant intensity A g E / pi, where
 * g = 1 for white paper. Where g would be larger than PL_SENT_MIRROR the facet is a mirror: what it
 * sends is bounded by the sun's own radiance instead. */
#define PL_SENT_MIRROR 4e4

typedef struct pl_sent_light {
  double area_gain; /* sum of A g over all facets but mirrors, square mesh units */
  double mirrors;   /* area of mirrors, square mesh units */
} pl_sent_light;

/* `materials`: graphs on the triangles, or NULL; `summary`: of the model's own materials, which
 * graphs may use. */
pl_sent_light pl_sent_light_of(const pl_model *model, const pl_model_summary *summary,
                               const pl_object_materials *materials);

#endif
