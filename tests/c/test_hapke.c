/* Hapke's model against reference values to 1e-9, its symmetries, limits and hard cases.
 *
 * Reference values: computed with mpmath at 40 digits from the formulae of Hapke 2012 in terms of
 * angles (not of vectors, as the code has them), printed to 13 digits. Parameters of P1 and P2:
 * maps of Sato et al. 2014; P0, P3 and P4 are made up to try all terms. */
#include "harness.h"

#include <stdio.h>

#include "random.h"
#include "shade/hapke.h"

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
static const double DEGREE = PL_PI / 180.0;

static const pl_hapke sets[] = {
    {.w = 0.5},
    {.w = 0.188, .b = 0.254, .c = 0.158, .b_s0 = 2.134, .h_s = 0.0623, .roughness_rad = 23.657},
    {.w = 0.3854, .b = 0.2375, .c = 0.3253, .b_s0 = 1.686, .h_s = 0.0672, .roughness_rad = 23.657},
    {0.6, 0.3, 0.4, 1.0, 0.05, 0.5, 0.01, 30.0, 0.4, false, false},
    {0.6, 0.3, 0.4, 1.0, 0.05, 0.5, 0.01, 30.0, 0.4, false, true},
};
enum { SETS = 5, GEOMETRIES = PL_DRAWS(10000000, 200000) };

/* A set above, whose angle is in degrees. */
static pl_hapke set_of(size_t i) {
  pl_hapke out = sets[i];
  out.roughness_rad *= DEGREE;
  return out;
}

typedef struct reference {
  double i, e, psi; /* degrees */
  double r[SETS];   /* 1/sr */
} reference;

static const reference references[] = {
    {0.0,
     0.0,
     0.0,
     {0.0310547111228, 0.03631586452308, 0.0702935655543, 0.2599640881016, 0.2599640881016}},
    {0.001,
     0.0,
     0.0,
     {0.03105471112009, 0.03631250118044, 0.07028826687418, 0.2597740417737, 0.2597229580993}},
    {0.1,
     0.0,
     0.0,
     {0.03105468404333, 0.0359840432452, 0.06977026628297, 0.243190503494, 0.239289377361}},
    {5.0,
     0.0,
     0.0,
     {0.03098694064049, 0.02626199749174, 0.05392096473839, 0.1378405771724, 0.1373686875529}},
    {30.0,
     0.0,
     0.0,
     {0.02852195417502, 0.0137069378604, 0.03114189167987, 0.08418205154895, 0.08417309374274}},
    {60.0,
     0.0,
     0.0,
     {0.01964870613425, 0.006112819352554, 0.0145865129605, 0.03594095451813, 0.03594011499634}},
    {85.0,
     0.0,
     0.0,
     {0.004243399497516, 0.0009754210917244, 0.002328866604471, 0.005465975848119,
      0.005465924845737}},
    {89.99,
     0.0,
     0.0,
     {8.678224815493e-6, 1.95652615041e-6, 4.646749533428e-6, 1.08456426063e-5, 1.084555752731e-5}},
    {30.0,
     30.0,
     0.0,
     {0.03040499321835, 0.03626231184302, 0.0699859809478, 0.2577249768413, 0.2577249768413}},
    {30.0,
     30.0,
     60.0,
     {0.03040499321835, 0.01497218487892, 0.03383139851497, 0.09074820208451, 0.09073781609033}},
    {30.0,
     30.0,
     180.0,
     {0.03040499321835, 0.01003296831211, 0.02404087710786, 0.06152562661969, 0.0615241894819}},
    {60.0,
     30.0,
     0.0,
     {0.02134888260549, 0.01013481720537, 0.02286603394556, 0.05991554654705, 0.05990917093793}},
    {30.0,
     60.0,
     0.0,
     {0.03697734935754, 0.01755401832513, 0.0396051325613, 0.1037767707827, 0.1037657279038}},
    {60.0,
     60.0,
     0.0,
     {0.02797196261955, 0.03614679742828, 0.06933716424523, 0.2552293799233, 0.2552293799233}},
    {60.0,
     60.0,
     90.0,
     {0.02797196261955, 0.00632677087602, 0.01497772640399, 0.0315848019641, 0.0315843903337}},
    {60.0,
     60.0,
     180.0,
     {0.02797196261955, 0.004893604009866, 0.010859260245, 0.01948212453045, 0.01948207339307}},
    {75.0,
     45.0,
     120.0,
     {0.01467487861641, 0.002903156394604, 0.006765422533758, 0.01360370172085, 0.01360362411992}},
    {45.0,
     75.0,
     120.0,
     {0.04009251397495, 0.007931570772377, 0.0184834780969, 0.03716600427238, 0.03716579226269}},
    {80.0,
     80.0,
     0.0,
     {0.02417835527614, 0.03606031185109, 0.06886422932933, 0.2529996179921, 0.2529996179921}},
    {80.0,
     80.0,
     180.0,
     {0.02417835527614, 0.001088041185365, 0.002080098692433, 0.003330226722104,
      0.003330225903519}},
    {89.0,
     89.0,
     0.0,
     {0.02067791689171, 0.03601129927849, 0.06860099282699, 0.2516564673327, 0.2516564673327}},
    {89.0,
     89.0,
     180.0,
     {0.02067791689171, 1.426099852228e-5, 2.538615826918e-5, 3.856099131347e-5,
      3.856099122043e-5}},
    {10.0,
     89.9,
     45.0,
     {0.04971379120225, 0.01169599920139, 0.027919718956, 0.06611814836551, 0.06611748327796}},
    {89.9,
     10.0,
     45.0,
     {8.81054090976e-5, 2.072826814296e-5, 4.948080202738e-5, 0.0001171780781478,
      0.0001171768994444}},
};

static pl_vec3 at(double angle, double azimuth) {
  return (pl_vec3){sin(angle) * cos(azimuth), sin(angle) * sin(azimuth), cos(angle)};
}

static double reflect(const pl_hapke *hapke, double i, double e, double psi) {
  return pl_hapke_reflectance(hapke, at(i, 0.3), at(e, 0.3 + psi));
}

static double relative(double a, double b) { return fabs(a - b) / fmax(fabs(a), fabs(b)); }

static void test_reference_tables(void **state) {
  (void)state;
  double worst = 0.0;
  for (size_t k = 0; k < COUNT(references); k++)
    for (size_t s = 0; s < SETS; s++) {
      const reference *row = &references[k];
      const pl_hapke hapke = set_of(s);
      const double r = pl_hapke_reflectance(&hapke, at(row->i * DEGREE, 0.0),
                                            at(row->e * DEGREE, row->psi * DEGREE));
      const double error = fabs(r / row->r[s] - 1.0);
      if (error > 1e-9)
        fail_msg("set %zu at (%g, %g, %g): %.13g, not %.13g", s, row->i, row->e, row->psi, r,
                 row->r[s]);
      worst = fmax(worst, error);
    }
  print_message("%zu reference values: off by at most %.1e\n", COUNT(references) * SETS, worst);
}

/* H at the cosine (divided by K) x: the root of 1 plus the light that is scattered more than once.
 */
static double h_of(const pl_hapke *hapke, double x) {
  const double logarithm = x > 0.0 ? log1p(1.0 / x) : 0.0;
  const pl_hapke_terms terms = {.phase = {.k = 1.0, .coherent = 1.0},
                                .lommel_seeliger = 1.0,
                                .shadowing = 1.0,
                                .x = {x, x},
                                .logarithm = {logarithm, logarithm}};
  return sqrt(1.0 + 4.0 * PL_PI / hapke->w * pl_hapke_of_terms(hapke, &terms));
}

/* P1 at (60, 30, 100) and P3 at (30, 60, 20), term by term; both branches of the relief. */
static void test_intermediate_terms(void **state) {
  (void)state;
  pl_hapke p1 = set_of(1), p3 = set_of(3);
  const pl_hapke_angles a = pl_hapke_angles_of(at(60 * DEGREE, 0.0), at(30 * DEGREE, 100 * DEGREE));
  const pl_hapke_relief relief = pl_hapke_relief_of(&a, p1.roughness_rad);
  assert_true(relative(2.0 * atan(a.half_tangent), 69.0335737691 * DEGREE) < 1e-11);
  assert_true(relative(pl_hapke_phase(&p1, &a), 0.936143357747) < 1e-11);
  assert_true(relative(p1.b_s0 * pl_hapke_shadow_surge(&p1, &a), 0.177261329912) < 1e-11);
  assert_true(relative(relief.mu0e, 0.507318364595) < 1e-11);
  assert_true(relative(relief.mue, 0.673145705621) < 1e-11);
  assert_true(relative(relief.shadowing, 0.769135644048) < 1e-11);
  assert_true(relative(h_of(&p1, relief.mu0e), 1.05725019868) < 1e-11);
  assert_true(relative(pl_hapke_reflect(&p1, &a, &relief), 0.00606774763474973) < 1e-12);
  const pl_hapke_angles b = pl_hapke_angles_of(at(30 * DEGREE, 0.0), at(60 * DEGREE, 20 * DEGREE));
  const pl_hapke_relief other = pl_hapke_relief_of(&b, p3.roughness_rad);
  const double k = pl_hapke_porosity(p3.filling);
  assert_true(relative(k, 1.62737362945) < 1e-11);
  assert_true(relative(p3.b_c0 * pl_hapke_coherent_surge(&p3, &b), 0.000277905909656) < 1e-11);
  assert_true(relative(other.mu0e, 0.700324396784) < 1e-11);
  assert_true(relative(other.mue, 0.523802837464) < 1e-11);
  assert_true(relative(other.shadowing, 0.999904491015) < 1e-11);
  assert_true(relative(h_of(&p3, other.mue / k), 1.1906434449) < 1e-10);
  assert_true(relative(pl_hapke_reflect(&p3, &b, &other), 0.0995278027344716) < 1e-12);
}

/* H by both forms; w, x, the form of 1981, that of 2002. By mpmath, and against the exact H of
 * Chandrasekhar within the errors that Hapke 2012 states: 4 % and 1 %. */
static const double h_values[][5] = {
    {0.1, 0.1, 1.0086265648, 1.01234009214, 1.012378098},
    {0.5, 0.5, 1.17157287525, 1.18575891156, 1.187735133},
    {0.9, 1.0, 1.83772233983, 1.83615466579, 1.850098517},
    {0.99, 0.1, 1.17647058824, 1.21991813671, 1.22487529},
    {1.0, 0.1, 1.2, 1.24365086837, 1.247350442},
    {1.0, 0.5, 2.0, 2.0, 2.01277877},
    {1.0, 1.0, 3.0, 2.88539008178, 2.907810529},
};

static void test_both_h_functions(void **state) {
  (void)state;
  for (size_t k = 0; k < COUNT(h_values); k++) {
    const double *row = h_values[k];
    pl_hapke hapke = {.w = row[0], .simple_h = true};
    const double simple = h_of(&hapke, row[1]);
    hapke.simple_h = false;
    const double improved = h_of(&hapke, row[1]);
    assert_true(relative(simple, row[2]) < 1e-10 && relative(improved, row[3]) < 1e-10);
    assert_true(relative(simple, row[4]) < 0.04 && relative(improved, row[4]) < 0.01);
    assert_true(h_of(&hapke, 0.0) == 1.0);
  }
}

/* K(0) = 1, rising; its series joins its formula. */
static void test_porosity_factor(void **state) {
  (void)state;
  assert_true(pl_hapke_porosity(0.0) == 1.0);
  assert_true(relative(pl_hapke_porosity(0.4), 1.62737362944827) < 1e-13);
  const double joint = pow(1e-4 / 1.209, 1.5);
  assert_true(relative(pl_hapke_porosity(joint * 0.999999), pl_hapke_porosity(joint * 1.000001)) <
              1e-9);
  assert_true(isfinite(pl_hapke_porosity(0.7519)));
}

/* p averages to 1 over the sphere, whatever b and c. */
static void test_phase_function_is_normalised(void **state) {
  (void)state;
  enum { STEPS = 20000 };
  for (int k = 0; k < 9; k++) {
    const pl_hapke hapke = {.b = 0.1 * k, .c = 0.9 - 0.2 * k};
    double sum = 0.0;
    for (int i = 0; i < STEPS; i++) {
      const double cosine = -1.0 + 2.0 * (i + 0.5) / STEPS;
      const pl_vec3 v = {sqrt(1.0 - cosine * cosine), 0.0, cosine};
      const pl_hapke_angles angles = pl_hapke_angles_of((pl_vec3){0.0, 0.0, 1.0}, v);
      sum += pl_hapke_phase(&hapke, &angles) / STEPS;
    }
    assert_true(fabs(sum - 1.0) < 1e-6);
  }
}

/* A smooth isotropic surface keeps A = 1 - gamma H(mu0) for the exact H; for the improved one this
 * is 0.11487285 at w = 0.5 along the normal, for the simple one at w = 1 more than all (1.03972):
 * by mpmath quadrature. */
static double kept(const pl_hapke *hapke) {
  enum { STEPS = 200000 };
  double sum = 0.0;
  for (int k = 0; k < STEPS; k++) {
    const double mu = (k + 0.5) / STEPS;
    const pl_vec3 v = {sqrt(1.0 - mu * mu), 0.0, mu};
    sum += 2.0 * PL_PI * mu * pl_hapke_reflectance(hapke, (pl_vec3){0.0, 0.0, 1.0}, v) / STEPS;
  }
  return sum;
}

static void test_energy_along_the_normal(void **state) {
  (void)state;
  const pl_hapke half = {.w = 0.5}, white = {.w = 1.0}, simple = {.w = 1.0, .simple_h = true};
  assert_true(fabs(kept(&half) - 0.11487285) < 1e-8);
  assert_true(fabs(kept(&white) - 0.98556) < 1e-5);
  assert_true(fabs(kept(&simple) - 1.03972) < 1e-5);
}

static pl_hapke random_hapke(test_random *random) {
  return (pl_hapke){
      .w = random_unit(random),
      .b = random_range(random, 0.0, 0.999),
      .c = random_range(random, -1.0, 1.2),
      .b_s0 = random_range(random, 0.0, 2.5),
      .h_s = random_below(random, 8) == 0 ? 0.0 : random_scale(random, 1e-12, 1.0),
      .b_c0 = random_range(random, 0.0, 1.0),
      .h_c = random_below(random, 8) == 0 ? 0.0 : random_scale(random, 1e-12, 1.0),
      .roughness_rad = random_below(random, 8) == 0 ? 0.0 : random_range(random, 0.0, PL_PI / 3.0),
      .filling = random_below(random, 4) == 0 ? 0.0 : random_range(random, 0.0, 0.75),
      .simple_h = random_below(random, 2) == 0,
      .narrow_surge = random_below(random, 2) == 0,
  };
}

/* An angle from the normal: anywhere, and often at the ends, or a hair beside them. */
static double random_slant(test_random *random) {
  switch (random_below(random, 8)) {
  case 0:
    return random_scale(random, 1e-300, 1e-3);
  case 1:
    return 0.5 * PL_PI - random_scale(random, 1e-17, 1e-3);
  case 2:
    return 0.5 * PL_PI * random_below(random, 3);
  default:
    return random_range(random, 0.0, 1.7);
  }
}

static double random_azimuth(test_random *random) {
  switch (random_below(random, 4)) {
  case 0:
    return random_scale(random, 1e-300, 1e-3);
  case 1:
    return PL_PI * random_below(random, 2) + random_range(random, -1e-9, 1e-9);
  default:
    return random_range(random, -PL_PI, PL_PI);
  }
}

/* Finite, never below 0, reciprocal, the same on both sides of the principal plane. */
static void test_ten_million_geometries(void **state) {
  (void)state;
  test_random random = {.seed = 61};
  pl_hapke hapke = {0};
  double worst = 0.0, largest = 0.0;
  for (int k = 0; k < GEOMETRIES; k++) {
    if (k % 8 == 0)
      hapke = random_hapke(&random);
    const pl_vec3 l = at(random_slant(&random), 0.0);
    const pl_vec3 v = at(random_slant(&random), random_azimuth(&random));
    const double r = pl_hapke_reflectance(&hapke, l, v);
    if (!(r >= 0.0 && isfinite(r)))
      fail_msg("%d: r = %g at i cosine %g, e cosine %g", k, r, l.z, v.z);
    assert_true(r == 0.0 || (l.z > 0.0 && v.z > 0.0));
    if (k % 8 == 1 && r > 1e-290) {
      const double back = pl_hapke_reflectance(&hapke, v, l);
      worst = fmax(worst, relative(r / l.z, back / v.z));
      const double mirrored = pl_hapke_reflectance(&hapke, l, (pl_vec3){v.x, -v.y, v.z});
      assert_true(r == mirrored);
    }
    largest = fmax(largest, r);
  }
  print_message("seed 61: reciprocal to %.1e, r up to %.3g\n", worst, largest);
  assert_true(worst < 1e-12);
}

/* Steps across what separates branches: i = e, psi = 0 and pi, roughness 0, the normal, g = 0 (in
 * steps far below the surges' widths). */
static void test_continuous(void **state) {
  (void)state;
  test_random random = {.seed = 62};
  for (int k = 0; k < 20000; k++) {
    pl_hapke hapke = random_hapke(&random);
    hapke.h_s = random_range(&random, 0.01, 0.2);
    hapke.h_c = random_range(&random, 0.01, 0.2);
    hapke.b = random_range(&random, 0.0, 0.8);
    hapke.roughness_rad = random_range(&random, 0.02, PL_PI / 3.0);
    const double i = random_range(&random, 0.05, 1.5), psi = random_range(&random, 0.1, 3.0);
    const double e = random_range(&random, 0.05, 1.5), step = 1e-9;
    const double off[][2] = {
        {reflect(&hapke, i, i * (1.0 - step), psi), reflect(&hapke, i, i * (1.0 + step), psi)},
        {reflect(&hapke, i, i * (1.0 - step), 0.0), reflect(&hapke, i, i * (1.0 + step), 0.0)},
        {reflect(&hapke, i, e, 0.0), reflect(&hapke, i, e, step)},
        {reflect(&hapke, i, e, PL_PI), reflect(&hapke, i, e, PL_PI - step)},
        {reflect(&hapke, i, e, PL_PI), reflect(&hapke, i, e, PL_PI + step)},
        {reflect(&hapke, 0.0, e, 0.0), reflect(&hapke, step, e, psi)},
        {reflect(&hapke, i, 0.0, 0.0), reflect(&hapke, i, step, psi)},
        {reflect(&hapke, 0.0, 0.0, 0.0), reflect(&hapke, step, step, psi)},
        {reflect(&hapke, i, i, 0.0), reflect(&hapke, i, i, step)},
    };
    for (size_t j = 0; j < COUNT(off); j++)
      if (!(relative(off[j][0], off[j][1]) < 1e-6))
        fail_msg("%d, step %zu: %.12g and %.12g", k, j, off[j][0], off[j][1]);
    hapke.roughness_rad = 0.0;
    const double smooth = reflect(&hapke, i, e, psi);
    const pl_hapke_angles angles = pl_hapke_angles_of(at(i, 0.3), at(e, 0.3 + psi));
    const pl_hapke_relief plane = pl_hapke_plane(&angles);
    assert_true(relative(smooth, pl_hapke_reflect(&hapke, &angles, &plane)) < 1e-15);
    hapke.roughness_rad = 1e-9;
    assert_true(relative(smooth, reflect(&hapke, i, e, psi)) < 1e-7);
  }
}

/* Full surge at g = 0 whatever the way there; none at widths of 0; black at w = 0; no light at 90
 * degrees and beyond. */
static void test_hard_cases(void **state) {
  (void)state;
  const pl_vec3 up = {0.0, 0.0, 1.0};
  pl_hapke hapke = set_of(3);
  const double p0 = 0.7 * 0.91 / pow(0.7, 3.0) + 0.3 * 0.91 / pow(1.3, 3.0);
  const double k = pl_hapke_porosity(hapke.filling);
  hapke.roughness_rad = 0.0;
  const double h = h_of(&hapke, 1.0 / k);
  const double full = k * 0.6 / (8.0 * PL_PI) * (2.0 * p0 + h * h - 1.0) * 1.5;
  assert_true(relative(pl_hapke_reflectance(&hapke, up, up), full) < 1e-12);
  const pl_vec3 slant = at(1.0, 0.7);
  assert_true(pl_hapke_angles_of(slant, slant).half_tangent == 0.0);
  hapke.h_s = hapke.h_c = 0.0;
  const double none = k * 0.6 / (8.0 * PL_PI) * (p0 + h * h - 1.0);
  assert_true(relative(pl_hapke_reflectance(&hapke, up, up), none) < 1e-12);
  for (int degrees = 0; degrees <= 60; degrees += 60) {
    hapke = set_of(1);
    hapke.roughness_rad = degrees * DEGREE;
    assert_true(pl_hapke_reflectance(&hapke, at(PL_PI / 3, 0.0), (pl_vec3){1.0, 0.0, 0.0}) == 0.0);
    assert_true(pl_hapke_reflectance(&hapke, (pl_vec3){1.0, 0.0, 0.0}, up) == 0.0);
    assert_true(pl_hapke_reflectance(&hapke, at(2.0, 0.0), up) == 0.0);
    assert_true(pl_hapke_reflectance(&hapke, at(1.0, 0.0), at(2.0, 0.0)) == 0.0);
    assert_true(isfinite(pl_hapke_reflectance(&hapke, at(1.5707963, 0.0), at(1.5707963, PL_PI))));
    hapke.w = 0.0;
    assert_true(pl_hapke_reflectance(&hapke, up, up) == 0.0);
    hapke.w = 1.0;
    assert_true(pl_hapke_reflectance(&hapke, slant, up) > 0.0);
  }
  /* Opposite directions along the plane: g = 180. */
  const pl_hapke_angles behind =
      pl_hapke_angles_of((pl_vec3){1.0, 0.0, 0.0}, (pl_vec3){-1.0, 0.0, 0.0});
  hapke = set_of(3);
  assert_true(isinf(behind.half_tangent) && isinf(behind.psi_tangent));
  assert_true(pl_hapke_shadow_surge(&hapke, &behind) == 0.0);
  assert_true(pl_hapke_coherent_surge(&hapke, &behind) == 0.0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_reference_tables),
      cmocka_unit_test(test_intermediate_terms),
      cmocka_unit_test(test_both_h_functions),
      cmocka_unit_test(test_porosity_factor),
      cmocka_unit_test(test_phase_function_is_normalised),
      cmocka_unit_test(test_energy_along_the_normal),
      cmocka_unit_test(test_ten_million_geometries),
      cmocka_unit_test(test_continuous),
      cmocka_unit_test(test_hard_cases),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
