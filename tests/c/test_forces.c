/* Forces against published and independently computed values, and against each other. */
#include "harness.h"

#include <string.h>

#include "base/memory.h"
#include "orbit/eclipse.h"
#include "orbit/force.h"
#include "orbit/orientation.h"
#include "random.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define NUMBERS(...)                                                                               \
  {                                                                                                \
    .numbers = (const double[]){__VA_ARGS__},                                                      \
    .count = sizeof((double[]){__VA_ARGS__}) / sizeof(double)                                      \
  }

static const pl_force_setting earth = {
    .tdb_day = 2459000.0, .tdb_fraction = 0.5, .gm_m3_s2 = 398600.4418e9};
static const double upright[4] = {1.0, 0.0, 0.0, 0.0};
static const pl_force_value up_q = {.numbers = upright, .count = 4};
/* EGM96's, as published (unnormalised). */
static const double earth_j[] = {1.0826266835531513e-3, -2.5326564853322355e-6, -1.619621591367e-6,
                                 -2.272960828686982e-7, 5.406812391070848e-7};

/* A body that stands still. */
typedef struct still {
  pl_propagator base;
  pl_vec3 r_m;
} still;
static pl_status still_states(const pl_propagator *self, size_t count, const double *t_s,
                              pl_state *out) {
  (void)t_s;
  for (size_t i = 0; i < count; i++)
    out[i] = (pl_state){((const still *)self)->r_m, {0.0, 0.0, 0.0}};
  return PL_OK;
}
static const pl_propagator_kind still_kind = {"still", "", still_states, NULL};

static pl_force *make(const pl_force_kind *kind, const pl_force_value *values) {
  pl_force *force = NULL;
  if (pl_force_create(kind, &earth, values, &force) != PL_OK)
    fail_msg("%s: %s", kind->name, pl_error_text());
  return force;
}
static pl_vec3 at(const pl_force *force, double t_s, pl_vec3 r, pl_vec3 v) {
  const pl_force_point point = {t_s, r, v};
  pl_vec3 a;
  assert_int_equal(force->kind->acceleration(force, &point, &a), PL_OK);
  return a;
}
static pl_vec3 still_at(const pl_force *force, pl_vec3 r) {
  return at(force, 0.0, r, (pl_vec3){0.0, 0.0, 0.0});
}
#define assert_close(a, b, relative)                                                               \
  do {                                                                                             \
    const pl_vec3 a_ = (a), b_ = (b);                                                              \
    if (!(pl_vec3_norm(pl_vec3_sub(a_, b_)) <= (relative)*pl_vec3_norm(b_)))                       \
      fail_msg("line %d: (%.17g, %.17g, %.17g) is not (%.17g, %.17g, %.17g)", __LINE__, a_.x,      \
               a_.y, a_.z, b_.x, b_.y, b_.z);                                                      \
  } while (0)

/* Reference: 40-digit arithmetic on the published coefficients; gm 398600.4418 km^3/s^2, R
 * 6378.137 km; km and km/s^2. */
static const struct {
  double r[3], j2[3], j6[3];
} zonal_table[] = {
    {{7000, 1000, 2000},
     {-5.416194432342655e-6, -7.737420617632364e-7, -6.463021927669386e-6},
     {-5.397397413857926e-6, -7.710567734082751e-7, -6.484137979720699e-6}},
    {{0, 0, 7000}, {0, 0, 2.193478007223206e-5}, {0, 0, 2.183768545311772e-5}},
    {{7000, 0, 0},
     {-1.096739003611603e-5, 0, 0},
     {-1.098992271448844e-5, 0, -2.120014574031984e-8}},
    {{-3000, 4000, -5000},
     {-6.703211950329405e-6, 8.937615933772541e-6, 3.724006639071892e-6},
     {-6.709091151754905e-6, 8.94545486900654e-6, 3.730930177213774e-6}},
};

static pl_vec3 km(const double v[3]) { return (pl_vec3){v[0] * 1e3, v[1] * 1e3, v[2] * 1e3}; }

static void test_zonal(void **state) {
  (void)state;
  for (size_t i = 0; i < COUNT(zonal_table); i++)
    for (size_t count = 1; count <= 5; count += 4) {
      const pl_force_value values[] = {
          {0}, up_q, {0}, NUMBERS(6378.137e3), {.numbers = earth_j, .count = count}, {0}};
      pl_force *force = make(&pl_force_zonal, values);
      const double *expected = count == 1 ? zonal_table[i].j2 : zonal_table[i].j6;
      assert_close(still_at(force, km(zonal_table[i].r)), km(expected), 2e-15);
      pl_free(force);
    }
}

/* In the pole frame of a tilted centre the same values hold; a body's pole is that of its date. */
static void test_zonal_pole(void **state) {
  (void)state;
  const pl_quat q = pl_quat_unit((pl_quat){0.3, -0.5, 0.2, 0.7});
  const pl_celestial *mars = pl_celestial_find("mars");
  const pl_quat equator =
      pl_celestial_equator(mars, earth.tdb_day, earth.tdb_fraction + 3e7 / 86400.0);
  for (size_t i = 0; i < COUNT(zonal_table); i++) {
    const pl_force_value tilted[] = {{0},
                                     NUMBERS(q.w, q.x, q.y, q.z),
                                     {0},
                                     NUMBERS(6378.137e3),
                                     {.numbers = earth_j, .count = 5},
                                     {0}};
    pl_force *force = make(&pl_force_zonal, tilted);
    assert_close(still_at(force, pl_quat_rotate(q, km(zonal_table[i].r))),
                 pl_quat_rotate(q, km(zonal_table[i].j6)), 1e-14);
    pl_free(force);
    const pl_force_value dated[] = {
        {.body = mars}, {0}, {0}, NUMBERS(6378.137e3), {.numbers = earth_j, .count = 5}, {0}};
    force = make(&pl_force_zonal, dated);
    assert_close(at(force, 3e7, pl_quat_rotate(equator, km(zonal_table[i].r)), (pl_vec3){0, 0, 0}),
                 pl_quat_rotate(equator, km(zonal_table[i].j6)), 1e-13);
    pl_free(force);
  }
}

/* Coefficients of a made-up field of degree 5, fully normalised. */
#define FIELD_SIZE 21
static const double field_c[FIELD_SIZE] = {
    [0] = 1.0,  [3] = -4.8e-4, [4] = 1e-6,  [5] = 2.4e-6, [7] = 2e-6,
    [9] = 7e-7, [10] = 5e-7,   [13] = 9e-7, [17] = 6e-7,  [20] = 1.7e-7};
static const double field_s[FIELD_SIZE] = {[4] = -2e-6,  [5] = -1.4e-6, [7] = 2.5e-7,  [9] = 1.4e-6,
                                           [13] = -2e-7, [17] = -3e-7,  [20] = -6.6e-7};
#define FIELD(order_)                                                                              \
  {                                                                                                \
    {0}, up_q, {0}, NUMBERS(398600.4415e9), NUMBERS(6378136.3),                                    \
        {.numbers = field_c, .count = FIELD_SIZE}, {.numbers = field_s, .count = FIELD_SIZE},      \
        order_                                                                                     \
  }

/* Reference: mpmath, 40 digits: derivatives by differences of the potential written with Legendre
 * functions, latitude and longitude. The last point is a hand's breadth from the pole. */
static void test_harmonics(void **state) {
  (void)state;
  const pl_force_value values[] = FIELD({0});
  pl_force *force = make(&pl_force_harmonics, values);
  assert_close(still_at(force, (pl_vec3){7000e3, 1000e3, 2000e3}),
               ((pl_vec3){-0.0054403249109219092, -0.00083156946339812401, -0.006390433135233144}),
               4e-15);
  assert_close(still_at(force, (pl_vec3){-3000e3, 4000e3, -5000e3}),
               ((pl_vec3){-0.0066829449769798099, 0.0088415235627254687, 0.0037413523573992846}),
               4e-15);
  assert_close(still_at(force, (pl_vec3){1000.0, -2000.0, -6.9e6}),
               ((pl_vec3){6.4647485209211198e-5, 5.2800948161966961e-5, -0.022988556445770707}),
               4e-15);
  /* Over the pole itself: what is next to it, to first order. */
  assert_close(still_at(force, (pl_vec3){0.0, 0.0, -6.9e6}),
               still_at(force, (pl_vec3){1e-3, -1e-3, -6.9e6}), 1e-9);
  pl_free(force);
}

/* Order 0 is the zonal force, J_n = -sqrt(2 n + 1) C_n0. */
static void test_harmonics_zonal(void **state) {
  (void)state;
  const pl_force_value harmonic[] = FIELD(NUMBERS(0.0));
  const pl_force_value zonals[] = {{0},
                                   up_q,
                                   {0},
                                   NUMBERS(6378136.3),
                                   NUMBERS(4.8e-4 * sqrt(5.0), 0.0, -5e-7 * 3.0),
                                   NUMBERS(398600.4415e9)};
  pl_force *a = make(&pl_force_harmonics, harmonic), *b = make(&pl_force_zonal, zonals);
  test_random random = {.seed = 4};
  for (int i = 0; i < 200; i++) {
    const pl_vec3 r = pl_vec3_scale(random_direction(&random), random_range(&random, 6.4e6, 5e7));
    assert_close(still_at(a, r), still_at(b, r), 2e-15);
  }
  pl_free(a);
  pl_free(b);
}

/* The field turns with its centre: after a quarter turn, at a place turned by as much, the same. */
static void test_harmonics_turn(void **state) {
  (void)state;
  pl_force_value values[] = FIELD({0});
  const double rate = 7.292115e-5, t = 0.5 * PL_PI / rate;
  values[2] = (pl_force_value){.numbers = &rate, .count = 1};
  pl_force *force = make(&pl_force_harmonics, values);
  const pl_vec3 here = {7000e3, 1000e3, 2000e3}, there = {-1000e3, 7000e3, 2000e3};
  const pl_vec3 a = still_at(force, here);
  assert_close(at(force, t, there, (pl_vec3){0, 0, 0}), ((pl_vec3){-a.y, a.x, a.z}), 1e-14);
  pl_free(force);
  const pl_celestial *moon = pl_celestial_find("moon");
  const pl_quat q = pl_celestial_orientation(moon, earth.tdb_day, earth.tdb_fraction + 1.0);
  values[0] = (pl_force_value){.body = moon};
  values[1] = values[2] = (pl_force_value){0};
  force = make(&pl_force_harmonics, values);
  assert_close(at(force, 86400.0, pl_quat_rotate(q, here), (pl_vec3){0, 0, 0}),
               pl_quat_rotate(q, a), 1e-14);
  pl_free(force);
}

/* Reference: mpmath, 40 digits, the direct difference of the two pulls. The third place is as far
 * out as the body itself. */
static void test_third_body(void **state) {
  (void)state;
  static const struct {
    double gm;
    pl_vec3 r, s, a;
  } table[] = {
      {132712440041279420000.0,
       {7000e3, 1000e3, 2000e3},
       {1.2e11, -8e10, 3.5e10},
       {2.6660495444441499196e-7, -4.0783552643027077728e-7, 7.9451681983547466644e-8}},
      {4902800118457.55,
       {-42164e3, 100.0, 3.0},
       {3.2e8, 1.5e8, -1.1e8},
       {-4.6296066711529974921e-6, -3.6059452251337112039e-6, 2.6443542864261709591e-6}},
      {4902800118457.55,
       {3e8, 1e8, 0.0},
       {3.2e8, 1.5e8, -1.1e8},
       {0.000022435425368294457873, 0.00011893442634556368711, -0.00028292664541172020294}},
  };
  for (size_t i = 0; i < COUNT(table); i++) {
    const still body = {{&still_kind}, table[i].s};
    const pl_force_value values[] = {{.numbers = &table[i].gm, .count = 1}, {.motion = &body.base}};
    pl_force *force = make(&pl_force_third_body, values);
    assert_close(still_at(force, table[i].r), table[i].a, 1e-15);
    assert_true(pl_vec3_norm(still_at(force, (pl_vec3){0, 0, 0})) == 0.0);
    pl_free(force);
  }
}

/* Reference: 40-digit arithmetic of the lens of two circles. */
static void test_eclipse(void **state) {
  (void)state;
  static const double table[][4] = {
      {1, 1, 1, 0.608997781044229},
      {1, 2, 2.5, 0.833708771420077},
      {1, 0.5, 0.75, 0.809606930937407},
      {0.00465, 1.2, 1.2, 0.500411150423996},
      {0.00465, 1.2, 1.2023, 0.801798993709097},
      {0.00465, 0.00452, 0.0001, 0.0551323852468493},
      {0.00465, 0.00452, 0.003, 0.425603343574976},
      {1, 1, 1.999999, 0.999999999575587},
      {1, 1e6, 1000000.5, 0.804498959438201},
      {1, 1, 0, 0},         /* hidden exactly */
      {1, 0.5, 0.25, 0.75}, /* annular */
      {1, 1, 2, 1},         /* touching */
      {1, 0, 0.5, 1},       /* nothing in the way */
  };
  for (size_t i = 0; i < COUNT(table); i++) {
    const double got = pl_eclipse_fraction(table[i][0], table[i][1], table[i][2]);
    if (!(fabs(got - table[i][3]) < 1e-14))
      fail_msg("row %zu: %.17g, expected %.17g", i, got, table[i][3]);
  }
  double before = 0.0; /* monotone through the penumbra of the Earth from a low orbit */
  for (int i = 0; i <= 10000; i++) {
    const double f = pl_eclipse_fraction(0.00465, 1.2, 1.195 + 1e-6 * i);
    assert_true(f >= before - 1e-12 && f <= 1.0);
    before = f;
  }
  assert_true(before == 1.0);
}

/* The regimes of light are the ranges of the visible fraction. */
static void test_eclipse_regimes(void **state) {
  (void)state;
  const pl_vec3 sun = {1.5e11, 0.0, 0.0};
  test_random random = {.seed = 8};
  int seen[4] = {0, 0, 0, 0};
  for (int i = 0; i < 20000; i++) {
    const double behind = random_scale(&random, 1e5, 4e9), aside = behind * 0.00466 * 1.2;
    const pl_vec3 r = {-behind, 6378e3 + random_range(&random, -aside, aside),
                       random_range(&random, -1e5, 1e5)};
    const double light = pl_eclipse_sunlight(r, sun, 6378e3);
    const int regime = pl_eclipse_regime(r, sun, 6378e3);
    assert_in_range(regime, 0, 3);
    seen[regime]++;
    assert_true((regime == 0) == (light == 1.0) || light > 1.0 - 1e-9);
    assert_true(regime != 2 || light == 0.0);
    assert_true(regime != 3 || (light > 0.0 && light < 1.0));
  }
  assert_true(seen[0] > 100 && seen[1] > 100 && seen[2] > 100 && seen[3] > 100);
  assert_int_equal(pl_eclipse_regime((pl_vec3){3e11, 0.0, 0.0}, sun, 6378e3), 0);
  assert_int_equal(pl_eclipse_regime((pl_vec3){0.0, 100.0, 0.0}, sun, 6378e3), 2);
}

/* Full push in the Sun's light: 4.5398e-6 N/m^2 at 1 AU (1361 W/m^2 over c), inverse square; none
 * in the umbra; none to stop it when the Sun is nearer than the centre. */
static void test_radiation_pressure(void **state) {
  (void)state;
  const double au = 149597870700.0;
  still sun = {{&still_kind}, {au, 0.0, 0.0}};
  const pl_force_value values[] = {
      NUMBERS(0.02), NUMBERS(1.3), NUMBERS(6378.137e3), {.motion = &sun.base}};
  pl_force *force = make(&pl_force_radiation_pressure, values);
  const pl_vec3 lit = still_at(force, (pl_vec3){0.0, 7000e3, 0.0});
  assert_close(lit, ((pl_vec3){-4.5398e-6 * 0.02 * 1.3, 0.0, 0.0}), 6e-5); /* its printed digits */
  assert_true(pl_vec3_norm(still_at(force, (pl_vec3){-7000e3, 0.0, 0.0})) == 0.0);
  /* In the penumbra: by the fraction; far behind the Earth the shadow is annular, never full. */
  const pl_vec3 edge = {-7000e3, 6378e3, 0.0}, far = {-2e9, 0.0, 0.0};
  const double part = pl_eclipse_sunlight(edge, sun.r_m, 6378.137e3);
  assert_true(part > 0.1 && part < 0.9);
  assert_true(fabs(pl_vec3_norm(still_at(force, edge)) / (part * pl_vec3_norm(lit)) - 1) < 1e-3);
  const double ring = pl_eclipse_sunlight(far, sun.r_m, 6378.137e3);
  const double ratio = (6378.137e3 / 2e9) / (695700e3 / (au + 2e9));
  assert_true(fabs(ring - (1.0 - ratio * ratio)) < 1e-5 && ring > 0.5);
  assert_true(pl_eclipse_sunlight((pl_vec3){2.0 * au, 0, 0}, sun.r_m, 6378.137e3) == 1.0);
  assert_true(pl_eclipse_sunlight((pl_vec3){100.0, 0, 0}, sun.r_m, 6378.137e3) == 0.0);
  sun.r_m.x = 2.0 * au;
  assert_close(still_at(force, (pl_vec3){0.0, 7000e3, 0.0}), pl_vec3_scale(lit, 0.25), 1e-4);
  pl_free(force);
}

static double drag_density(double height_m) {
  const pl_force_value values[] = {
      {0}, up_q, {0}, NUMBERS(0.01), NUMBERS(2.2), NUMBERS(6378.137e3, 6356.752314245e3), {0}};
  pl_force *force = make(&pl_force_drag, values);
  const pl_vec3 a =
      at(force, 0.0, (pl_vec3){6378.137e3 + height_m, 0.0, 0.0}, (pl_vec3){0.0, 7600.0, 0.0});
  pl_free(force);
  assert_true(isfinite(a.y) && a.x == 0.0 && a.z == 0.0);
  return -a.y / (0.5 * 2.2 * 0.01 * 7600.0 * 7600.0);
}

/* Vallado table 8-4 at its knots and between; below the ground the air of the ground, above the
 * table it goes on thinning. */
static void test_drag_density(void **state) {
  (void)state;
  static const double table[][2] = {
      {0, 1.225}, {100e3, 5.297e-7}, {400e3, 3.725e-12}, {1000e3, 3.019e-15}, {450e3, 1.585e-12}};
  for (size_t i = 0; i < COUNT(table); i++)
    assert_true(fabs(drag_density(table[i][0] + 1e-3) / table[i][1] - 1.0) < 1e-6);
  assert_true(fabs(drag_density(420e3) / (3.725e-12 * exp(-20.0 / 58.515)) - 1.0) < 1e-9);
  assert_true(fabs(drag_density(-1000e3) / 1.225 - 1.0) < 1e-12);
  assert_true(fabs(drag_density(1268e3) / (3.019e-15 * exp(-1.0)) - 1.0) < 1e-9);
  assert_true(drag_density(1e9) == 0.0 || drag_density(1e9) < 1e-300);
}

/* The air turns with the Earth, and its layers follow the ellipsoid. */
static void test_drag_wind(void **state) {
  (void)state;
  const double spin = 7.292115e-5;
  const pl_force_value values[] = {{0},
                                   up_q,
                                   {.numbers = &spin, .count = 1},
                                   NUMBERS(0.01),
                                   NUMBERS(2.2),
                                   NUMBERS(6378.137e3, 6356.752314245e3),
                                   {0}};
  pl_force *force = make(&pl_force_drag, values);
  const pl_vec3 r = {6778.137e3, 0.0, 0.0}, zero = {0.0, spin * 6778.137e3, 0.0};
  assert_true(pl_vec3_norm(at(force, 0.0, r, zero)) == 0.0); /* at rest in the air */
  const pl_vec3 v = {100.0, 7500.0, 1000.0}, wind = pl_vec3_sub(v, zero), a = at(force, 0.0, r, v);
  assert_true(pl_vec3_norm(pl_vec3_cross(a, wind)) < 1e-14 * pl_vec3_norm(a) * 8000.0);
  assert_true(pl_vec3_dot(a, wind) < 0.0);
  /* Over the pole at the same height: the same density. */
  const pl_vec3 pole = {0.0, 0.0, 6356.752314245e3 + 400e3}, over = {8000.0, 0.0, 0.0};
  const double up = pl_vec3_norm(at(force, 0.0, pole, over));
  assert_true(fabs(up / (0.5 * 3.725e-12 * 2.2 * 0.01 * 64e6) - 1.0) < 1e-9);
  pl_free(force);
}

static void test_bad_parameters(void **state) {
  (void)state;
  pl_force *force = NULL;
  const pl_force_value none[PL_FORCE_PARAMETERS] = {0};
  size_t count = 0;
  const pl_force_kind *const *kinds = pl_force_kinds(&count), *found = NULL;
  for (size_t i = 0; i < count; i++) {
    assert_true(kinds[i]->parameter_count <= PL_FORCE_PARAMETERS);
    assert_int_equal(pl_force_require(kinds[i]->name, &found), PL_OK);
    assert_ptr_equal(found, kinds[i]);
    if (kinds[i] != &pl_force_point_mass) {
      assert_int_equal(pl_force_create(kinds[i], &earth, none, &force), PL_E_ARGUMENT);
      assert_non_null(strstr(pl_error_text(), "is missing"));
    }
  }
  assert_int_equal(pl_force_require("magic", &found), PL_E_ARGUMENT);
  assert_non_null(strstr(pl_error_text(), "third_body"));
  const pl_force_value bad[][PL_FORCE_PARAMETERS] = {
      {{0}, {0}, {0}, NUMBERS(6e6), NUMBERS(1e-3)},                               /* no pole */
      {{.body = pl_celestial_find("mars")}, up_q, {0}, NUMBERS(6e6), NUMBERS(1)}, /* two poles */
      {{0}, NUMBERS(0, 0, 0, 0), {0}, NUMBERS(6e6), NUMBERS(1e-3)},               /* no rotation */
      {{0}, NUMBERS(1, 0, 0), {0}, NUMBERS(6e6), NUMBERS(1e-3)},                  /* too short */
      {{0}, up_q, {0}, NUMBERS(-6e6), NUMBERS(1e-3)},     /* negative radius */
      {{0}, up_q, {0}, NUMBERS(6e6), NUMBERS(1e-3, NAN)}, /* not finite */
  };
  for (size_t i = 0; i < COUNT(bad); i++)
    assert_int_not_equal(pl_force_create(&pl_force_zonal, &earth, bad[i], &force), PL_OK);
  pl_force_value field[] = FIELD(NUMBERS(6.0)); /* order above the degree */
  assert_int_equal(pl_force_create(&pl_force_harmonics, &earth, field, &force), PL_E_RANGE);
  field[7] = (pl_force_value){0};
  field[5].count--; /* no triangle */
  assert_int_equal(pl_force_create(&pl_force_harmonics, &earth, field, &force), PL_E_ARGUMENT);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_zonal),
      cmocka_unit_test(test_zonal_pole),
      cmocka_unit_test(test_harmonics),
      cmocka_unit_test(test_harmonics_zonal),
      cmocka_unit_test(test_harmonics_turn),
      cmocka_unit_test(test_third_body),
      cmocka_unit_test(test_eclipse),
      cmocka_unit_test(test_eclipse_regimes),
      cmocka_unit_test(test_radiation_pressure),
      cmocka_unit_test(test_drag_density),
      cmocka_unit_test(test_drag_wind),
      cmocka_unit_test(test_bad_parameters),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
