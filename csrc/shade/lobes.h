/* What the principled surface has beyond base colour, metalness and roughness. */
#ifndef PL_SHADE_LOBES_H
#define PL_SHADE_LOBES_H

#include <stdbool.h>

#include "math/vec.h"

/* Read by the row `principled` alone. All zero: no coat, nothing passes, and a base below the
 * metal that mirrors nothing (ior 1); pl_lobes_plain mirrors as the metallic-roughness row does. */
typedef struct pl_lobes {
  pl_vec3f f0;      /* reflectance of the dielectric at normal incidence, 0..1 */
  float f90;        /* at grazing incidence, 0..1 */
  float index;      /* between them it rises as Fresnel's of this index, >= 1 */
  float anisotropy; /* 0..1: alpha along t grows from `alpha` to 1 with its square */
  float coat;       /* weight of the clear coat, 0..1 */
  float coat_alpha; /* GGX alpha of the coat */
  /* The coat's normal in the axes of pl_surface.n, unit, on the viewer's side; zero: the surface's.
   */
  pl_vec3f coat_normal;
  float transmission; /* part of the dielectric's light that passes instead of scattering, 0..1 */
  /* Index of refraction of the solid that the surface bounds, against vacuum; 0: a thin wall. */
  float ior;
  bool inside;         /* the viewer is inside that solid */
  pl_vec3f extinction; /* of the solid, per unit of the mesh */
} pl_lobes;

/* Part of the light that a way of `length` model units through the solid leaves (Beer, Lambert). */
static inline pl_vec3f pl_lobes_passed(const pl_lobes *lobes, float length) {
  return pl_vec3f_make(expf(-length * lobes->extinction.x), expf(-length * lobes->extinction.y),
                       expf(-length * lobes->extinction.z));
}

/* ior 1.5, full weight, white; all else off. */
pl_lobes pl_lobes_plain(void);

/* Sets f0, f90 and index from the index of refraction against vacuum (>= 0; 0 counts as infinite,
 * as KHR_materials_ior has it), the weight 0..1 of the mirrored light and its tint at normal
 * incidence.
 */
void pl_lobes_set_dielectric(pl_lobes *lobes, float ior, float weight, pl_vec3f tint);

#endif
