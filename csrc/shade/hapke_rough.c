/* Reflectance model `hapke`: Hapke's complete model. */
#include "shade/regolith_law.h"

static double law(const pl_hapke *band, double limb, const pl_hapke_angles *a,
                  pl_regolith_shared *shared) {
  (void)limb;
  if (!shared->known) {
    if (band->roughness_rad != shared->roughness_rad)
      shared->relief = pl_hapke_relief_of(a, band->roughness_rad);
    shared->roughness_rad = band->roughness_rad;
    shared->terms = pl_regolith_terms_of(band, a, &shared->relief, shared->phase);
    shared->known = true;
  }
  return pl_hapke_of_terms(band, &shared->terms);
}

PL_REGOLITH_ROW(hapke,
                "Hapke 2012 with macroscopic roughness, surges and porosity; base colour is "
                "the single-scattering albedo w",
                .inputs = pl_regolith_inputs, .input_count = PL_REGOLITH_INPUTS,
                .set = pl_hapke_set)
