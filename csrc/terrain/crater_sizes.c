#include "terrain/crater_sizes.h"

#include <math.h>

#define OLDEST_SURFACE_GA 4.5

/* Chronology of Neukum, Ivanov and Hartmann (2001, Space Sci. Rev. 96, 55), per km^2. */
#define CHRONOLOGY_EXPONENTIAL 5.44e-14
#define CHRONOLOGY_RATE_PER_GA 6.93
#define CHRONOLOGY_LINEAR 8.38e-4

/* lg N per km^2 of a surface of 1 Ga in powers of lg D with D in km. The coefficient of order 0 is
 * the one that agrees with the chronology; the 2001 paper prints -3.0876, 2.5 % less. */
enum { COEFFICIENTS = 12 };
#define POLYNOMIAL_FROM_KM 0.01
#define POLYNOMIAL_TO_KM 300.0
static const double neukum_1983[COEFFICIENTS] = {-3.0768,  -3.6269,    0.43662,     0.79347,
                                                 0.086468, -0.26485,   -0.066382,   0.037923,
                                                 0.010596, -0.0022496, -0.00051797, 0.0000397};
static const double neukum_2001[COEFFICIENTS] = {-3.0768,   -3.557528, 0.781027, 1.021521,
                                                 -0.156012, -0.444058, 0.019977, 0.086850,
                                                 -0.005874, -0.006809, 8.25e-4,  5.54e-5};

double pl_crater_chronology(double age_ga) {
  return 1e-6 * (CHRONOLOGY_EXPONENTIAL * expm1(CHRONOLOGY_RATE_PER_GA * age_ga) +
                 CHRONOLOGY_LINEAR * age_ga);
}

double pl_crater_chronology_age_ga(double density_1km) {
  const double n = 1e6 * density_1km;
  if (!(n > 0.0))
    return 0.0;
  /* Each term alone gives an upper bound; Newton's method on this convex function then falls to
   * the root without crossing it. */
  double age =
      fmin(n / CHRONOLOGY_LINEAR, log1p(n / CHRONOLOGY_EXPONENTIAL) / CHRONOLOGY_RATE_PER_GA);
  for (int step = 0; step < 32; step++) {
    const double e = CHRONOLOGY_EXPONENTIAL * exp(CHRONOLOGY_RATE_PER_GA * age);
    const double over = e - CHRONOLOGY_EXPONENTIAL + CHRONOLOGY_LINEAR * age - n;
    const double change = over / (CHRONOLOGY_RATE_PER_GA * e + CHRONOLOGY_LINEAR);
    age -= change;
    if (fabs(change) <= 1e-14 * age)
      break;
  }
  return fmax(age, 0.0);
}

/* Density per m^2 of a surface of 1 Ga. Outside the fit's range the power law of its end. */
static double polynomial(const double *c, double diameter_m) {
  const double km = 1e-3 * diameter_m;
  const double inside = fmin(fmax(km, POLYNOMIAL_FROM_KM), POLYNOMIAL_TO_KM), x = log10(inside);
  double value = 0.0, slope = 0.0;
  for (int k = COEFFICIENTS - 1; k >= 0; k--) {
    slope = slope * x + value;
    value = value * x + c[k];
  }
  return 1e-6 * pow(10.0, value + slope * log10(km / inside));
}

static double production(const pl_crater_law *law, const double *c, double diameter_m) {
  return polynomial(c, diameter_m) * pl_crater_chronology(law->surface_age_ga) /
         pl_crater_chronology(1.0);
}

static double density_neukum_1983(const pl_crater_law *law, double d) {
  return production(law, neukum_1983, d);
}
static double density_neukum_2001(const pl_crater_law *law, double d) {
  return production(law, neukum_2001, d);
}
/* Trask (1966), as in NASA SLS-SPEC-159 (DSNE), 3.4.1; the same number in m and in km. */
static double density_trask(const pl_crater_law *law, double d) {
  (void)law;
  return 0.079432823472428138 / (d * d);
}
/* Hartmann (1984, Icarus 60, 56): lg N = -1.14 - 1.83 lg D per km^2. */
static double density_hartmann(const pl_crater_law *law, double d) {
  (void)law;
  return 1e-6 * pow(10.0, -1.14) * pow(1e-3 * d, -1.83);
}
/* VIPER-MSE-SPEC-001 (2021) as in NASA's synthterrain: it falls from 6.5 to 4.4 per km^2 at 80 m.
 */
static double density_viper(const pl_crater_law *law, double d) {
  (void)law;
  return d <= 80.0 ? 0.029174 * pow(d, -1.92) : 0.156228 * pow(d, -2.389);
}
static double density_neukum_equilibrium(const pl_crater_law *law, double d) {
  return fmin(production(law, neukum_2001, d), density_trask(law, d));
}
static double density_power(const pl_crater_law *law, double d) {
  return law->coefficient * pow(d, law->exponent);
}
static double density_table(const pl_crater_law *law, double d) {
  return pl_size_points_density(&law->table, d);
}

const pl_crater_law_row pl_crater_laws[PL_CRATER_LAWS] = {
    [PL_CRATERS_NEUKUM_1983] = {"neukum_1983", "Production of Neukum (1983) in the surface's age.",
                                density_neukum_1983},
    [PL_CRATERS_NEUKUM_2001] = {"neukum_2001",
                                "Production of Neukum et al. (2001) in the surface's age.",
                                density_neukum_2001},
    [PL_CRATERS_TRASK] = {"trask", "Equilibrium of Trask (1966), as in NASA SLS-SPEC-159.",
                          density_trask},
    [PL_CRATERS_HARTMANN_1984] = {"hartmann_1984", "Equilibrium of Hartmann (1984).",
                                  density_hartmann},
    [PL_CRATERS_VIPER] = {"viper", "Design specification of VIPER for the south polar plains.",
                          density_viper},
    [PL_CRATERS_NEUKUM_EQUILIBRIUM] = {"neukum_equilibrium",
                                       "The lesser of neukum_2001 and trask: production up to "
                                       "equilibrium.",
                                       density_neukum_equilibrium},
    [PL_CRATERS_POWER] = {"power", "coefficient D^exponent per m^2, D in m.", density_power},
    [PL_CRATERS_TABLE] = {"table", "The user's table, with power laws between its entries.",
                          density_table},
};

double pl_crater_density(const void *law, double diameter_m) {
  const pl_crater_law *at = law;
  return at->factor * pl_crater_laws[at->kind].density(at, diameter_m);
}

pl_status pl_crater_law_check(const pl_crater_law *law, double min_m, double max_m) {
  if ((int)law->kind < 0 || law->kind >= PL_CRATER_LAWS)
    return pl_fail(PL_E_ARGUMENT, "law %d of craters; there are %d", (int)law->kind,
                   (int)PL_CRATER_LAWS);
  if (!(law->surface_age_ga > 0.0 && law->surface_age_ga <= OLDEST_SURFACE_GA))
    return pl_fail(PL_E_RANGE, "surface_age_ga = %g; must be above 0 and at most %g",
                   law->surface_age_ga, OLDEST_SURFACE_GA);
  if (!(law->factor >= 0.0 && isfinite(law->factor)))
    return pl_fail(PL_E_RANGE, "density factor %g of craters; must be 0 or more", law->factor);
  if (law->kind == PL_CRATERS_POWER)
    return pl_size_power_check("craters", law->coefficient, law->exponent);
  return law->kind == PL_CRATERS_TABLE ? pl_size_points_check(&law->table, "craters", min_m, max_m)
                                       : PL_OK;
}

double pl_crater_oldest_ga(const pl_crater_law *law, double diameter_m) {
  const double *c = law->kind == PL_CRATERS_NEUKUM_1983 ? neukum_1983 : neukum_2001;
  const double n = pl_crater_laws[law->kind].density(law, diameter_m);
  const double age =
      pl_crater_chronology_age_ga(n / polynomial(c, diameter_m) * pl_crater_chronology(1.0));
  return fmin(age, law->surface_age_ga);
}
