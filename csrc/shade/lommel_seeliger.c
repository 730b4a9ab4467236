/* Lommel-Seeliger: single scattering in an optically thick layer of dark grains. */
#include "shade/regolith_law.h"

static double law(const pl_hapke *band, double limb, const pl_hapke_angles *a,
                  pl_regolith_shared *shared) {
  (void)shared;
  (void)limb;
  return band->w / (4.0 * PL_PI) * pl_regolith_single(band, a) * (a->mu0 / (a->mu0 + a->mu));
}

PL_REGOLITH_ROW(
    lommel_seeliger,
    "Lommel-Seeliger: w/4pi p(g) cos(i)/(cos(i) + cos(e)), with p and the shadow-hiding "
    "surge of Hapke 2012; base colour is w",
    .inputs = pl_regolith_inputs, .input_count = PL_REGOLITH_PHASE_INPUTS,
    .set = pl_regolith_set_phase)
