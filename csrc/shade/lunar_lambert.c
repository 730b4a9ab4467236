/* Lunar-Lambert: a disc function that mixes Lommel-Seeliger and Lambert. */
#include "shade/regolith_law.h"

/* McEwen, Icarus 92, 298, 1991, and LPSC 27, 841, 1996: L of the Moon as a polynomial in the phase
 * angle in degrees, fitted up to 135; clamped to 0 where it is negative, beyond 103.95. */
static double lunar_part(double g_deg) {
  const double l = 1.0 + g_deg * (-0.019 + g_deg * (2.42e-4 + g_deg * -1.46e-6));
  return fmax(l, 0.0);
}

static double law(const pl_hapke *band, double limb, const pl_hapke_angles *a,
                  pl_regolith_shared *shared) {
  (void)shared;
  (void)limb;
  const double part = lunar_part(2.0 * atan(a->half_tangent) * (180.0 / PL_PI));
  const double disc = 2.0 * part * a->mu0 / (a->mu0 + a->mu) + (1.0 - part) * a->mu0;
  return band->w / PL_PI * pl_regolith_fall(band, a) * disc;
}

PL_REGOLITH_ROW(lunar_lambert,
                "Lunar-Lambert (McEwen 1991): L(g) 2 cos(i)/(cos(i) + cos(e)) + (1 - L(g)) cos(i); "
                "base colour is the normal albedo, which falls with p(g) and the surge",
                .empirical = true, .inputs = pl_regolith_inputs,
                .input_count = PL_REGOLITH_PHASE_INPUTS, .set = pl_regolith_set_phase)
