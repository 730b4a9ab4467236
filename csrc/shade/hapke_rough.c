/* Reflectance model `hapke`: Hapke's complete model. */
#include "shade/regolith_law.h"

static double law(const pl_hapke *band, double limb, const pl_hapke_angles *a,
                  pl_regolith_shared *shared) {
  (void)limb;
  if (!shared->known) {
    const pl_hapke_relief relief = pl_hapke_relief_of(a, band->roughness_rad);
    *shared = (pl_regolith_shared){true, pl_hapke_terms_of(band, a, &relief)};
  }
  return pl_hapke_of_terms(band, &shared->terms);
}

PL_REGOLITH_ROW(hapke,
                "Hapke 2012 with macroscopic roughness, surges and porosity; base colour is "
                "the single-scattering albedo w",
                .inputs = pl_regolith_inputs, .input_count = PL_REGOLITH_INPUTS,
                .set = pl_hapke_set)
