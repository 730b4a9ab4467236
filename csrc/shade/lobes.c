/* Reflectance of dielectrics at normal incidence from their index. */
#include "shade/lobes.h"

pl_lobes pl_lobes_plain(void) {
  return (pl_lobes){.f0 = {0.04f, 0.04f, 0.04f}, .f90 = 1.0f, .coat_alpha = 1.0f};
}

void pl_lobes_set_dielectric(pl_lobes *lobes, float ior, float weight, pl_vec3f tint) {
  /* Fresnel at normal incidence. KHR_materials_specular: the tint is clipped before the weight. */
  const float r = (ior - 1.0f) / (ior + 1.0f), f = r * r;
  lobes->f0 = pl_vec3f_make(weight * pl_minf(f * tint.x, 1.0f), weight * pl_minf(f * tint.y, 1.0f),
                            weight * pl_minf(f * tint.z, 1.0f));
  lobes->f90 = weight * pl_minf(1.0f, 50.0f * pl_vec3f_max(tint) * f);
}
