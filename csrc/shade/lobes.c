/* Parameters of the dielectric lobe from the index of refraction. */
#include "shade/ggx.h"
#include "shade/lobes.h"

/* Below this F0 (index 1.105), f90 falls in proportion to F0, so that index 1 reflects nothing. */
static const float F0_LEAST = 0.0025f;

pl_lobes pl_lobes_plain(void) {
  const float f0 = PL_DIELECTRIC_F0;
  return (pl_lobes){
      .f0 = {f0, f0, f0}, .f90 = 1.0f, .index = PL_DIELECTRIC_INDEX, .coat_alpha = 1.0f};
}

void pl_lobes_set_dielectric(pl_lobes *lobes, float ior, float weight, pl_vec3f tint) {
  /* Fresnel reflectance at normal incidence. KHR_materials_specular clamps the tinted value before
   * it applies the weight. */
  const float r = (ior - 1.0f) / (ior + 1.0f), f = r * r;
  lobes->f0 = pl_vec3f_make(weight * pl_minf(f * tint.x, 1.0f), weight * pl_minf(f * tint.y, 1.0f),
                            weight * pl_minf(f * tint.z, 1.0f));
  lobes->f90 = weight * pl_minf(f * (1.0f / F0_LEAST), 1.0f);
  lobes->index = ior < 1.0f ? 1.0f / pl_maxf(ior, 1e-6f) : ior;
}
