/* Reflectance model `hapke`: Hapke's complete model. */
#include "shade/regolith_law.h"

static double law(const pl_hapke *band, double limb, const pl_hapke_angles *a) {
  (void)limb;
  const pl_hapke_relief relief = pl_hapke_relief_of(a, band->roughness_rad);
  return pl_hapke_reflect(band, a, &relief);
}

PL_REGOLITH_ROW(hapke,
                "Hapke 2012 with macroscopic roughness, surges and porosity; base colour is "
                "the single-scattering albedo w",
                .inputs = pl_regolith_inputs, .input_count = PL_REGOLITH_INPUTS,
                .set = pl_hapke_set)
