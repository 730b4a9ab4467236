/* Light from relief too small for the geometry: facets, and rocks on them.
 *
 * The mean of a reflectance over facets with normally distributed slopes, weighted by the areas
 * that the viewer sees, which other facets neither hide nor shade: Smith's shadowing (1967), of sun
 * and viewer together by van Ginneken et al. (1998). The mean is taken over four slopes, exact to
 * the third order. The fractions that are lit and seen are taken over four, too: so all light on
 * the mean surface is received, and facets fill all of the view.
 *
 * A rock is a flat top and two rings of sides: their slopes and shares are chosen so that they
 * throw the shadows, and have the brightness, of the rocks that meshes show. Rocks lie anywhere, so
 * the ground that light reaches, and that is seen, falls exponentially with their shadows; of each
 * other they shade half as much. They have the reflectance of the ground, and relief of their own.
 *
 * `evaluate` of a model has facets; `sample` knows the mean surface alone: facets hardly change
 * light that comes from many sides, as from other ground. */
#ifndef PL_SHADE_ROUGH_H
#define PL_SHADE_ROUGH_H

#include "shade/surface.h"

/* Reflectance of one facet, as `evaluate` of pl_reflectance. */
typedef pl_vec3f (*pl_rough_fn)(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi,
                                const void *context);

/* Reflectance with surface->rough; 0 for light or a viewer below the mean surface. */
pl_vec3f pl_rough_reflect(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi, pl_rough_fn law,
                          const void *context);

static inline bool pl_rough_on(const pl_rough *rough) {
  return rough->whole > 0.0f || rough->stones > 0.0f;
}

#endif
