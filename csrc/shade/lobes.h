/* Parameters of the principled surface other than base colour, metalness and roughness. */
#ifndef PL_SHADE_LOBES_H
#define PL_SHADE_LOBES_H

#include <stdbool.h>

#include "math/vec.h"

/* Read by the model `principled` only. All zero: no coat, no transmission, and a dielectric that
 * reflects nothing (ior 1). pl_lobes_plain gives the dielectric of metallic_roughness. */
typedef struct pl_lobes {
  pl_vec3f f0;      /* reflectance of the dielectric at normal incidence, 0..1 */
  float f90;        /* reflectance at grazing incidence, 0..1 */
  float index;      /* index, >= 1, whose Fresnel curve interpolates between f0 and f90 */
  float anisotropy; /* 0..1: alpha along t grows from `alpha` to 1 with its square */
  float coat;       /* weight of the clear coat, 0..1 */
  float coat_alpha; /* GGX alpha of the coat */
  /* Normal of the coat in the axes of pl_surface.n, unit, on the viewer's side; zero: that of the
   * surface. */
  pl_vec3f coat_normal;
  float transmission; /* part of the dielectric's diffuse light that is transmitted instead, 0..1 */
  /* Index of refraction of the solid that the surface bounds, relative to vacuum; 0: a thin wall.
   */
  float ior;
  bool inside;         /* the viewer is inside that solid */
  pl_vec3f extinction; /* extinction coefficient of the solid, per unit of length of the mesh */
} pl_lobes;

/* Transmittance of a path of `length` model units through the solid (Beer-Lambert law). */
static inline pl_vec3f pl_lobes_passed(const pl_lobes *lobes, float length) {
  return pl_vec3f_make(expf(-length * lobes->extinction.x), expf(-length * lobes->extinction.y),
                       expf(-length * lobes->extinction.z));
}

/* Index 1.5, full weight, white; all else off. */
pl_lobes pl_lobes_plain(void);

/* Sets f0, f90 and index from the index of refraction relative to vacuum (>= 0; 0 means infinite,
 * as in KHR_materials_ior), the weight 0..1 of the specular reflection, and its tint at normal
 * incidence. */
void pl_lobes_set_dielectric(pl_lobes *lobes, float ior, float weight, pl_vec3f tint);

#endif
