/* Constants of the bodies.
 *
 * GM: JPL DE440 (NAIF gm_de440.tpc), without satellites. Radii and rotation: IAU WGCCRE 2015
 * (Archinal et al., Celest. Mech. Dyn. Astr. 130:22, 2018); Earth's ellipsoid: WGS-84. Rotation
 * from older reports: Earth (2009; not in the 2015 report, accurate to 0.1 deg) and Mars (2009; the
 * 2015 constants are unusable without their slow terms, these are accurate to 0.02 deg until 2050).
 * Phobos has only its terms above 0.03 deg. Albedos: NASA planetary fact sheets. */
#include "orbit/celestial.h"

#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define TERMS(array) .terms = (array), .term_count = COUNT(array)

static const pl_rotation_term mercury_terms[] = {
    {174.7910857, 149472.535875, 0, 0, 0, 0.01067257},
    {349.5821714, 298945.07175, 0, 0, 0, -0.00112309},
    {164.3732571, 448417.607625, 0, 0, 0, -0.00011040},
    {339.1643429, 597890.1435, 0, 0, 0, -0.00002539},
    {153.9554286, 747362.679375, 0, 0, 0, -0.00000571},
};

static const pl_rotation_term moon_terms[] = {
    {125.045, -1935.5364525, 0, -3.8787, 1.5419, 3.5610},
    {250.089, -3871.0729050, 0, -0.1204, 0.0239, 0.1208},
    {260.008, 475263.3328725, 0, 0.0700, -0.0278, -0.0642},
    {176.625, 487269.6299850, 0, -0.0172, 0.0068, 0.0158},
    {357.529, 35999.0509575, 0, 0, 0, 0.0252},
    {311.589, 964468.4993100, 0, 0.0072, -0.0029, -0.0066},
    {134.963, 477198.8693250, 0, 0, 0.0009, -0.0047},
    {276.617, 12006.3007650, 0, 0, 0, -0.0046},
    {34.226, 63863.5132425, 0, 0, 0, 0.0028},
    {15.134, -5806.6093575, 0, -0.0052, 0.0008, 0.0052},
    {119.743, 131.8406400, 0, 0, 0, 0.0040},
    {239.961, 6003.1503825, 0, 0, 0, 0.0019},
    {25.053, 473327.7964200, 0, 0.0043, -0.0009, -0.0044},
};

static const pl_rotation_term phobos_terms[] = {
    {190.72646643, 15917.10818695, 0, -1.78428399, -1.07516537, 1.42421769},
    {189.63271560, 41215158.18420050, 12.711923222, 0, 0, -1.143},
};

static const pl_rotation_term jupiter_terms[] = {
    {99.360714, 4850.4046, 0, 0.000117, 0.000050, 0},
    {175.895369, 1191.9605, 0, 0.000938, 0.000404, 0},
    {300.323162, 262.5475, 0, 0.001432, 0.000617, 0},
    {114.012305, 6070.2476, 0, 0.000030, -0.000013, 0},
    {49.511251, 64.3000, 0, 0.002150, 0.000926, 0},
};

static const pl_rotation_term europa_terms[] = {
    {355.80, 1191.3, 0, 1.086, 0.468, -0.980},
    {119.90, 262.1, 0, 0.060, 0.026, -0.054},
    {229.80, 64.3, 0, 0.015, 0.007, -0.014},
    {352.25, 2382.6, 0, 0.009, 0.002, -0.008},
};

static const pl_rotation_term neptune_terms[] = {
    {357.85, 52.316, 0, 0.70, -0.51, -0.48},
};

/* clang-format off */
static const pl_celestial bodies[] = {
    {"sun", NULL, 132712440041.27942e9, {695700e3, 695700e3, 695700e3}, 0.0, 0.0,
     {{286.13, 0}, {63.87, 0}, {84.176, 14.1844000, 0}, NULL, 0}},
    {"mercury", "sun", 22031.868551400003e9, {2440.53e3, 2440.53e3, 2438.26e3}, 0.142, 0.068,
     {{281.0103, -0.0328}, {61.4155, -0.0049}, {329.5988, 6.1385108, 0}, TERMS(mercury_terms)}},
    {"venus", "sun", 324858.592e9, {6051.8e3, 6051.8e3, 6051.8e3}, 0.689, 0.77,
     {{272.76, 0}, {67.16, 0}, {160.20, -1.4813688, 0}, NULL, 0}},
    {"earth", "sun", 398600.43550702266e9, {6378.137e3, 6378.137e3, 6356.752314245e3}, 0.434, 0.294,
     {{0, -0.641}, {90, -0.557}, {190.147, 360.9856235, 0}, NULL, 0}},
    {"moon", "earth", 4902.80011845755e9, {1737.4e3, 1737.4e3, 1737.4e3}, 0.12, 0.11,
     {{269.9949, 0.0031}, {66.5392, 0.0130}, {38.3213, 13.17635815, -1.4e-12}, TERMS(moon_terms)}},
    {"mars", "sun", 42828.37362069909e9, {3396.19e3, 3396.19e3, 3376.20e3}, 0.170, 0.250,
     {{317.68143, -0.1061}, {52.88650, -0.0609}, {176.630, 350.89198226, 0}, NULL, 0}},
    {"phobos", "mars", 7.087546066894452e5, {13.0e3, 11.4e3, 9.1e3}, 0.071, 0.02,
     {{317.67071657, -0.10844326}, {52.88627266, -0.06134706},
      {35.18774440, 1128.84475928, 9.536137031212154e-9}, TERMS(phobos_terms)}},
    {"europa", "jupiter", 3202.712099607295e9, {1562.6e3, 1560.3e3, 1559.5e3}, 0.67, 0.62,
     {{268.08, -0.009}, {64.51, 0.003}, {36.022, 101.3747235, 0}, TERMS(europa_terms)}},
    {"jupiter", "sun", 126686531.9003704e9, {71492e3, 71492e3, 66854e3}, 0.538, 0.343,
     {{268.056595, -0.006499}, {64.495303, 0.002413}, {284.95, 870.5360000, 0},
      TERMS(jupiter_terms)}},
    {"saturn", "sun", 37931206.23436167e9, {60268e3, 60268e3, 54364e3}, 0.499, 0.342,
     {{40.589, -0.036}, {83.537, -0.004}, {38.90, 810.7939024, 0}, NULL, 0}},
    {"uranus", "sun", 5793951.256527211e9, {25559e3, 25559e3, 24973e3}, 0.488, 0.300,
     {{257.311, 0}, {-15.175, 0}, {203.81, -501.1600928, 0}, NULL, 0}},
    {"neptune", "sun", 6835103.145462294e9, {24764e3, 24764e3, 24341e3}, 0.442, 0.290,
     {{299.36, 0}, {43.46, 0}, {249.978, 541.1397757, 0}, TERMS(neptune_terms)}},
};
/* clang-format on */

const pl_celestial *pl_celestial_table(size_t *count) {
  *count = COUNT(bodies);
  return bodies;
}

const pl_celestial *pl_celestial_find(const char *name) {
  for (size_t i = 0; i < COUNT(bodies); i++)
    if (strcmp(bodies[i].name, name) == 0)
      return &bodies[i];
  return NULL;
}

pl_status pl_celestial_require(const char *name, const pl_celestial **out) {
  *out = pl_celestial_find(name);
  if (*out)
    return PL_OK;
  char names[256] = "";
  for (size_t i = 0; i < COUNT(bodies); i++)
    pl_names_append(names, sizeof names, bodies[i].name);
  return pl_fail(PL_E_ARGUMENT, "no body named '%s'; allowed: %s", name, names);
}
