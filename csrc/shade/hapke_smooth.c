/* Reflectance model `hapke_smooth`: Hapke's model without macroscopic roughness. */
#include "shade/regolith_law.h"

static double law(const pl_hapke *band, double limb, const pl_hapke_angles *a,
                  pl_regolith_shared *shared) {
  (void)limb;
  if (!shared->known) {
    const pl_hapke_relief relief = pl_hapke_plane(a);
    shared->terms = pl_regolith_terms_of(band, a, &relief, shared->phase);
    shared->known = true;
  }
  return pl_hapke_of_terms(band, &shared->terms);
}

PL_REGOLITH_ROW(hapke_smooth, "Hapke 2012 without macroscopic roughness; base colour is w",
                .inputs = pl_regolith_inputs, .input_count = PL_REGOLITH_INPUTS - 1,
                .set = pl_hapke_set_smooth)
