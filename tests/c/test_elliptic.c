/* Elliptic integrals and functions against 120 digits (mpmath 1.4: elliprf, elliprj, ellipk,
 * ellipfun), and their identities. */
#include "harness.h"

#include <float.h>

#include "math/elliptic.h"
#include "random.h"

static void assert_near(double got, double expected, double relative) {
  if (!(fabs(got - expected) <= relative * fabs(expected)))
    fail_msg("%.17g is not %.17g", got, expected);
}

static void test_carlson(void **state) {
  (void)state;
  static const double rf[][4] = {
      {1, 2, 0, 1.3110287771460599},     {0.5, 1, 0, 1.8540746773013719},
      {2, 3, 4, 0.58408284167715171},    {1e-30, 1e-12, 1, 15.201804918087715},
      {0, 1e-20, 1, 24.412145291060347},
  };
  for (size_t i = 0; i < sizeof rf / sizeof rf[0]; i++)
    assert_near(pl_elliptic_rf(rf[i][0], rf[i][1], rf[i][2]), rf[i][3], 8 * DBL_EPSILON);
  static const double rj[][5] = {
      {0, 1, 2, 3, 0.77688623778582332},          {2, 3, 4, 5, 0.14297579667156754},
      {0.3, 0.9, 1, 1, 1.4112554669856108},       {1e-12, 1e-6, 1, 1.5, 14.845269039596693},
      {0.25, 0.5, 1, 1e8, 4.1100437060587834e-8}, {0, 1e-20, 1, 7, 10.25533116886965},
  };
  for (size_t i = 0; i < sizeof rj / sizeof rj[0]; i++)
    assert_near(pl_elliptic_rj(rj[i][0], rj[i][1], rj[i][2], rj[i][3]), rj[i][4], 16 * DBL_EPSILON);
}

static void test_complete(void **state) {
  (void)state;
  static const double k[][2] = {
      {1.0, 1.5707963267948966},    {0.5, 1.8540746773013719},   {0.1, 2.5780921133481732},
      {1e-6, 8.29405146361544},     {1e-12, 15.201804919087715}, {1e-30, 35.925070756030575},
      {1e-200, 231.64480366052446},
  };
  for (size_t i = 0; i < sizeof k / sizeof k[0]; i++)
    assert_near(pl_elliptic_k(k[i][0]), k[i][1], 4 * DBL_EPSILON);
  assert_true(isinf(pl_elliptic_k(0.0)));
}

static void test_functions(void **state) {
  (void)state;
  static const struct {
    double m1, u;
    pl_elliptic f;
  } rows[] = {
      {1.0, 0.7, {0.64421768723769102, 0.76484218728448845, 1.0}},
      {0.5, 0.3, {0.29341273316845538, 0.95598586182778708, 0.97824050417436121}},
      {0.5, 1.8, {0.99926871524250675, 0.038236562837027485, 0.70762349972905435}},
      {0.5, -1.2, {-0.88771548861927814, 0.46039245352789642, 0.77844756126069155}},
      {0.1, 2.5, {0.99969453845058614, 0.024714971010898625, 0.3170958006862636}},
      {1e-6, 5.0, {0.99990945384100706, 0.013456749956024896, 0.013493848164806682}},
      {1e-6, 8.0, {0.99999995550634609, 0.00029830740157005048, 0.0010435455030060594}},
      {1e-12, 14.0, {0.99999999999885582, 1.5127319026919449e-6, 1.8133829737316118e-6}},
      {1e-12, 1e-9, {1.0e-9, 1.0, 1.0}},
      {1e-30, 30.0, {1.0, 1.871511235674808e-13, 1.8715379518612618e-13}},
      {0.0, 1.5, {0.90514825364486644, 0.42509603494228046, 0.42509603494228046}},
  };
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    const double k = pl_elliptic_k(rows[i].m1), u = rows[i].u;
    const pl_elliptic f = pl_elliptic_functions(u, 1.0 - rows[i].m1, rows[i].m1);
    /* an error of eps in u or K, seen from the zero of cn at K */
    const double bound =
        4 * DBL_EPSILON * (1.0 + fabs(u) + (isfinite(k) ? k / (k - fabs(u)) : 0.0));
    assert_near(f.sn, rows[i].f.sn, bound);
    assert_near(f.cn, rows[i].f.cn, bound);
    assert_near(f.dn, rows[i].f.dn, bound);
  }
}

/* sn^2 + cn^2 = 1, dn^2 = m1 + m cn^2, and u = sn RF(cn^2, dn^2, 1), the inverse function. */
static void test_identities(void **state) {
  (void)state;
  test_random random = {.seed = 17};
  for (int n = 0; n < 20000; n++) {
    const double m1 = random_scale(&random, 1e-40, 1.0), k = pl_elliptic_k(m1);
    const double u = random_range(&random, -k, k);
    const pl_elliptic f = pl_elliptic_functions(u, 1.0 - m1, m1);
    assert_near(f.sn * f.sn + f.cn * f.cn, 1.0, 4 * DBL_EPSILON);
    assert_near(f.dn * f.dn, m1 + (1.0 - m1) * f.cn * f.cn, 4 * DBL_EPSILON);
    const double back = f.sn * pl_elliptic_rf(f.cn * f.cn, f.dn * f.dn, 1.0);
    assert_near(back, u, 64 * DBL_EPSILON);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_carlson),
      cmocka_unit_test(test_complete),
      cmocka_unit_test(test_functions),
      cmocka_unit_test(test_identities),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
