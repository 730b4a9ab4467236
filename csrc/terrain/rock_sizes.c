#include "terrain/rock_sizes.h"

#include <math.h>

#include "math/vec.h"

#define EULER_GAMMA 0.57721566490153286

/* Below 2 the series of E1 (Abramowitz and Stegun 5.1.11), above it the continued fraction of the
 * gamma function (6.5.31, even part): it has no difference of nearly equal terms where exp(-x) / x
 * and E1 agree to many digits. It is evaluated backwards; 60 terms suffice from 2 on. */
double pl_rock_gamma(double x) {
  if (x < 2.0) {
    double e1 = -EULER_GAMMA - log(x), term = -1.0;
    for (int k = 1; k < 40; k++) {
      term *= -x / k;
      e1 += term / k;
    }
    return exp(-x) / x - e1;
  }
  double tail = 0.0;
  for (int k = 60; k >= 1; k--)
    tail = k * (k + 1.0) / (x + 2.0 * k + 2.0 - tail);
  return exp(-x) / (x * (x + 2.0 - tail));
}

static double golombek(double k, double q, double d) {
  return 4.0 * k * q * q / PL_PI * pl_rock_gamma(q * d);
}

static double density_golombek(const pl_rock_law *law, double d) {
  const double k = law->abundance;
  return golombek(k, law->decay_per_m > 0.0 ? law->decay_per_m : 1.79 + 0.152 / k, d);
}
/* Di et al. (2016) at the landing site of Chang'E-3. */
static double density_change_3(const pl_rock_law *law, double d) {
  (void)law;
  return golombek(0.0125, 1.743, d);
}
static double density_surveyor_1(const pl_rock_law *law, double d) {
  (void)law;
  return 0.00234 * pow(d, -2.11);
}
/* VIPER-MSE-SPEC-001 (2021) as in NASA's synthterrain, and its low and high blockiness. */
static double density_viper(const pl_rock_law *law, double d) {
  (void)law;
  return 3.0e-4 * pow(d, -2.482);
}
static double density_intercrater(const pl_rock_law *law, double d) {
  (void)law;
  return 1.0e-4 * pow(d, -1.75457);
}
static double density_haworth(const pl_rock_law *law, double d) {
  (void)law;
  return 2.0e-3 * pow(d, -2.6607);
}
static double density_power(const pl_rock_law *law, double d) {
  return law->coefficient * pow(d, law->exponent);
}
static double density_table(const pl_rock_law *law, double d) {
  return pl_size_points_density(&law->table, d);
}

const pl_rock_law_row pl_rock_laws[PL_ROCK_LAWS] = {
    [PL_ROCKS_GOLOMBEK] =
        {"golombek",
         "Golombek and Rapp (1997): the fraction of ground covered by rocks of D or "
         "more is abundance exp(-decay D).",
         density_golombek},
    [PL_ROCKS_CHANGE_3] = {"change_3",
                           "The site of Chang'E-3 (Di et al. 2016), in a young mare: golombek with "
                           "abundance 0.0125 and decay 1.743 per m.",
                           density_change_3},
    [PL_ROCKS_SURVEYOR_1] = {"surveyor_1",
                             "The site of Surveyor 1, a mare near a blocky crater: 0.00234 D^-2.11 "
                             "per m^2.",
                             density_surveyor_1},
    [PL_ROCKS_VIPER] = {"viper",
                        "Design specification of VIPER for the south polar plains: 3e-4 D^-2.482 "
                        "per m^2.",
                        density_viper},
    [PL_ROCKS_INTERCRATER] = {"intercrater", "Few rocks, of synthterrain: 1e-4 D^-1.75457 per m^2.",
                              density_intercrater},
    [PL_ROCKS_HAWORTH] = {"haworth",
                          "Many rocks, of synthterrain, at the crater Haworth: 2e-3 D^-2.6607 per "
                          "m^2.",
                          density_haworth},
    [PL_ROCKS_POWER] = {"power", "coefficient D^exponent per m^2, D in m.", density_power},
    [PL_ROCKS_TABLE] = {"table", "The user's table, with power laws between its entries.",
                        density_table},
};

double pl_rock_density(const void *law, double diameter_m) {
  const pl_rock_law *at = law;
  const double cut = at->cutoff_m > 0.0 ? exp(-diameter_m / at->cutoff_m) : 1.0;
  return at->factor * cut * pl_rock_laws[at->kind].density(at, diameter_m);
}

/* Cover is the integral of pi/4 D^2 over the differences of the density, in steps of 2 %: each
 * counts with the product of its ends, so that errors are of second order. */
double pl_rock_cover(const pl_rock_law *law, double min_m, double max_m) {
  double sum = 0.0, density = pl_rock_density(law, min_m);
  const int steps = (int)ceil(log(max_m / min_m) / 0.02);
  for (int k = 1; k <= steps; k++) {
    const double from = min_m * pow(max_m / min_m, (k - 1.0) / steps);
    const double to = min_m * pow(max_m / min_m, (double)k / steps);
    const double next = pl_rock_density(law, to);
    sum += 0.25 * PL_PI * from * to * (density - next);
    density = next;
  }
  return sum;
}

static pl_status check_golombek(const pl_rock_law *law) {
  const double k = law->abundance, q = law->decay_per_m;
  if (!(k > 0.0 && k <= 1.0))
    return pl_fail(PL_E_RANGE, "abundance = %g of rocks; must be above 0 and at most 1", k);
  if (!(q >= 0.0 && isfinite(q)))
    return pl_fail(PL_E_RANGE, "decay_per_m = %g of rocks; must be 0 or more", q);
  if (q > 0.0 || k >= PL_ROCKS_LEAST_FITTED)
    return PL_OK;
  return pl_fail(PL_E_RANGE,
                 "abundance = %g of rocks without decay_per_m: the fit of Golombek and Rapp (1997) "
                 "holds from %g on, below it would leave no rocks; give decay_per_m (1.743 at "
                 "Chang'E-3) or use a power law",
                 k, PL_ROCKS_LEAST_FITTED);
}

pl_status pl_rock_law_check(const pl_rock_law *law, double min_m, double max_m) {
  if ((int)law->kind < 0 || law->kind >= PL_ROCK_LAWS)
    return pl_fail(PL_E_ARGUMENT, "law %d of rocks; there are %d", (int)law->kind,
                   (int)PL_ROCK_LAWS);
  if (!(law->factor >= 0.0 && isfinite(law->factor)))
    return pl_fail(PL_E_RANGE, "density factor %g of rocks; must be 0 or more", law->factor);
  if (!(law->cutoff_m >= 0.0 && isfinite(law->cutoff_m)))
    return pl_fail(PL_E_RANGE, "cutoff_m = %g of rocks; must be 0 (none) or more", law->cutoff_m);
  if (law->kind == PL_ROCKS_GOLOMBEK)
    return check_golombek(law);
  if (law->kind == PL_ROCKS_POWER)
    return pl_size_power_check("rocks", law->coefficient, law->exponent);
  return law->kind == PL_ROCKS_TABLE ? pl_size_points_check(&law->table, "rocks", min_m, max_m)
                                     : PL_OK;
}
