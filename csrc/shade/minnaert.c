/* Minnaert's disc function. */
#include "shade/regolith_law.h"

/* For k < 1 the function is infinite at the horizon: cosines are clamped to at least this. */
static const double COSINE_MIN = 0.05;

static double law(const pl_hapke *band, double limb, const pl_hapke_angles *a,
                  pl_regolith_shared *shared) {
  (void)shared;
  const double both = fmax(a->mu0, COSINE_MIN) * fmax(a->mu, COSINE_MIN);
  return band->w / PL_PI * pl_regolith_fall(band, a) * a->mu0 * pow(both, limb);
}

PL_REGOLITH_ROW(
    minnaert,
    "Minnaert 1941: cos(i)^k cos(e)^(k-1); base colour is the normal albedo, which falls "
    "with p(g) and the surge",
    .empirical = true, .inputs = pl_minnaert_inputs, .input_count = PL_REGOLITH_PHASE_INPUTS + 1,
    .set = pl_minnaert_set)
