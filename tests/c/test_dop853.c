/* The integrator: its numbers against the conditions they must meet, and what it makes of systems
 * whose solutions are known. */
#include "harness.h"

#include <math.h>
#include <string.h>

#include "orbit/dop853.h"
#include "orbit/dop853_table.h"

#define PI 3.14159265358979323846

/* Rounding of a row's numbers as doubles. */
static double rounding(const pl_dop853_row *row) {
  double sum = 0.0;
  for (int i = 0; i < row->count; i++)
    sum += fabs(row->term[i].weight);
  return sum * 0x1p-52;
}

/* Sum of a row against the j-th powers of the nodes. */
static double moment(const pl_dop853_row *row, int power) {
  double sum = 0.0;
  for (int i = 0; i < row->count; i++)
    sum += row->term[i].weight * pow(pl_dop853_node[row->term[i].stage], power);
  return sum;
}

/* Stage i is taken where its node says (sum of a row = node), the step integrates t^7 exactly
 * (quadrature conditions of order 8), and the weights of the error estimates sum to 0: the
 * differences of consistent methods. Hairer, Norsett, Wanner, II.1. */
static void test_order_conditions(void **state) {
  (void)state;
  for (int i = 0; i < PL_DOP853_ALL; i++)
    assert_true(fabs(moment(&pl_dop853_stage[i], 0) - pl_dop853_node[i]) <=
                rounding(&pl_dop853_stage[i]) + 1e-16);
  for (int k = 0; k < 8; k++)
    assert_true(fabs(moment(&pl_dop853_stage[PL_DOP853_STAGES], k) - 1.0 / (k + 1)) < 1e-15);
  assert_true(fabs(moment(&pl_dop853_stage[PL_DOP853_STAGES], 8) - 1.0 / 9.0) > 1e-7);
  assert_true(fabs(moment(&pl_dop853_error5, 0)) < 1e-15);
  assert_true(fabs(moment(&pl_dop853_error3, 0)) < 1e-15);
  for (int j = 0; j < 4; j++) /* the dense output's upper terms vanish for constant rates */
    assert_true(fabs(moment(&pl_dop853_dense[j], 0)) < 1e-13);
}

/* y'' = -y. */
static pl_status oscillator(void *context, double t, const double *y, double *rate) {
  (void)t;
  size_t *calls = context;
  if (calls)
    (*calls)++;
  rate[0] = y[1];
  rate[1] = -y[0];
  return PL_OK;
}

static pl_ode oscillator_ode(double rtol) {
  return (pl_ode){.size = 2, .vector = 2, .rtol = rtol, .rate = oscillator};
}

/* Largest error at the ends of steps and between them, over one period of fixed steps. */
static void fixed_step_errors(double h, double *ends, double *between) {
  const pl_ode ode = oscillator_ode(1.0); /* so loose that only h_max counts */
  const double y0[2] = {1.0, 0.0};
  pl_ode_point p;
  assert_int_equal(pl_ode_start(&ode, 0.0, y0, 1, &p), PL_OK);
  *ends = *between = 0.0;
  while (p.t < 2.0 * PI) {
    pl_ode_segment segment;
    p.h = h;
    assert_int_equal(pl_ode_step(&ode, h, &p, &segment), PL_OK);
    *ends = fmax(*ends, fabs(p.y[0] - cos(p.t)));
    for (int i = 1; i < 10; i++) {
      const double t = segment.t + 0.1 * i * segment.h;
      double y[2];
      pl_ode_at(&segment, 2, t, y);
      *between = fmax(*between, fabs(y[0] - cos(t)));
    }
  }
}

/* Halving the step divides the error by 2^8 at the ends; the dense output's by 2^8 too: locally its
 * error is O(h^8). Slack of 2^0.7 for the higher terms. */
static void test_orders(void **state) {
  (void)state;
  double ends[2], between[2];
  fixed_step_errors(PI / 5, &ends[0], &between[0]);
  fixed_step_errors(PI / 10, &ends[1], &between[1]);
  assert_in_range((int)(10.0 * log2(ends[0] / ends[1])), 73, 95);
  assert_in_range((int)(10.0 * log2(between[0] / between[1])), 73, 95);
}

/* 1 000 periods at 1e-13; then all the way back. */
static void test_there_and_back(void **state) {
  (void)state;
  const pl_ode ode = oscillator_ode(1e-13);
  const double y0[2] = {1.0, 0.0};
  pl_ode_point p;
  assert_int_equal(pl_ode_start(&ode, 0.0, y0, 1, &p), PL_OK);
  while (p.t < 2000.0 * PI)
    assert_int_equal(pl_ode_step(&ode, 2000.0 * PI - p.t > 0.1 ? INFINITY : 0.1, &p, NULL), PL_OK);
  assert_true(fabs(p.y[0] - cos(p.t)) < 1e-10 && fabs(p.y[1] + sin(p.t)) < 1e-10);
  pl_ode_point back;
  assert_int_equal(pl_ode_start(&ode, p.t, p.y, -1, &back), PL_OK);
  assert_true(back.h < 0.0);
  while (back.t > 0.0)
    assert_int_equal(pl_ode_step(&ode, back.t > 0.1 ? INFINITY : 0.1, &back, NULL), PL_OK);
  assert_true(fabs(back.y[0] - cos(back.t)) < 2e-10 && fabs(back.y[1] + sin(back.t)) < 2e-10);
}

/* With and without the dense output, and from a copy of any point, the steps are the same bits. */
static void test_same_steps(void **state) {
  (void)state;
  const pl_ode ode = oscillator_ode(1e-10);
  const double y0[2] = {0.3, -0.7};
  pl_ode_point a, b;
  assert_int_equal(pl_ode_start(&ode, 0.0, y0, 1, &a), PL_OK);
  b = a;
  for (int i = 0; i < 50; i++) {
    pl_ode_segment segment;
    const pl_ode_point before = a;
    assert_int_equal(pl_ode_step(&ode, INFINITY, &a, &segment), PL_OK);
    assert_int_equal(pl_ode_step(&ode, INFINITY, &b, NULL), PL_OK);
    assert_memory_equal(&a, &b, sizeof a);
    double y[2];
    pl_ode_at(&segment, 2, segment.t, y);
    assert_memory_equal(y, before.y, sizeof y); /* exactly where the step began */
    pl_ode_at(&segment, 2, segment.t + segment.h, y);
    assert_true(fabs(y[0] - a.y[0]) < 4e-16 && fabs(y[1] - a.y[1]) < 4e-16);
    assert_true(segment.t + segment.h == a.t);
  }
}

/* A step is 12 evaluations when it is accepted at once, 15 with its dense output. */
static void test_cost(void **state) {
  (void)state;
  size_t calls = 0;
  pl_ode ode = oscillator_ode(1e-10);
  ode.context = &calls;
  const double y0[2] = {1.0, 0.0};
  pl_ode_point p;
  assert_int_equal(pl_ode_start(&ode, 0.0, y0, 1, &p), PL_OK);
  p.h = 0.01;
  calls = 0;
  assert_int_equal(pl_ode_step(&ode, INFINITY, &p, NULL), PL_OK);
  assert_int_equal(calls, 12);
  p.h = 0.01;
  pl_ode_segment segment;
  assert_int_equal(pl_ode_step(&ode, INFINITY, &p, &segment), PL_OK);
  assert_int_equal(calls, 27);
}

/* y' = 1/7: a million steps of 0.1 to a sum of 1e5/7. Plain summation is off by 1e-7 or so; the
 * compensated sum by the rounding of the weights alone. (Steps of y' = 1 are multiples of t's last
 * bit, and nothing would round.) */
static pl_status constant(void *context, double t, const double *y, double *rate) {
  (void)context, (void)t, (void)y;
  rate[0] = 1.0 / 7.0;
  return PL_OK;
}
static void test_compensated_sum(void **state) {
  (void)state;
  const pl_ode ode = {.size = 1, .vector = 1, .rtol = 1e-6, .atol = 1.0, .rate = constant};
  const double y0[1] = {1.0 / 3.0};
  pl_ode_point p;
  assert_int_equal(pl_ode_start(&ode, 0.0, y0, 1, &p), PL_OK);
  for (int i = 0; i < 1000000; i++)
    assert_int_equal(pl_ode_step(&ode, 0.1, &p, NULL), PL_OK);
  assert_true(p.t > 0.99e5);
  const double sure =
      p.t * rounding(&pl_dop853_stage[PL_DOP853_STAGES]); /* sum of weights: not 1 */
  assert_true(sure < 1e-9 && fabs(p.y[0] - p.t / 7.0 - 1.0 / 3.0) <= sure / 7.0 + 4e-12);
}

/* y' = y^2 from 1: infinite at t = 1. Not a hang, not an infinity. */
static pl_status blow_up(void *context, double t, const double *y, double *rate) {
  (void)context, (void)t;
  rate[0] = y[0] * y[0];
  return PL_OK;
}
/* y' = 1, and none from y = 2 on. */
static pl_status end_at_2(void *context, double t, const double *y, double *rate) {
  (void)context, (void)t;
  rate[0] = y[0] < 2.0 ? 1.0 : (double)NAN;
  return PL_OK;
}
static void test_singularity(void **state) {
  (void)state;
  const pl_ode ode = {.size = 1, .vector = 1, .rtol = 1e-8, .rate = blow_up};
  const double y0[1] = {1.0};
  pl_ode_point p;
  assert_int_equal(pl_ode_start(&ode, 0.0, y0, 1, &p), PL_OK);
  pl_status status = PL_OK;
  int steps = 0;
  while (status == PL_OK && ++steps < 100000) {
    const pl_ode_point before = p;
    status = pl_ode_step(&ode, INFINITY, &p, NULL);
    if (status != PL_OK)
      assert_memory_equal(&before, &p, sizeof p);
  }
  assert_int_equal(status, PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "singularity"));
  assert_true(fabs(p.t - 1.0) < 1e-6);
  const pl_ode ends = {.size = 1, .vector = 1, .rtol = 1e-8, .rate = end_at_2};
  assert_int_equal(pl_ode_start(&ends, 0.0, y0, 1, &p), PL_OK);
  while ((status = pl_ode_step(&ends, INFINITY, &p, NULL)) == PL_OK)
    assert_true(isfinite(p.y[0]));
  assert_int_equal(status, PL_E_RANGE);
  assert_true(fabs(p.t - 1.0) < 1e-6);
  const double bad[1] = {NAN};
  assert_int_equal(pl_ode_start(&ode, 0.0, bad, 1, &p), PL_E_RANGE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_order_conditions),
      cmocka_unit_test(test_orders),
      cmocka_unit_test(test_there_and_back),
      cmocka_unit_test(test_same_steps),
      cmocka_unit_test(test_cost),
      cmocka_unit_test(test_compensated_sum),
      cmocka_unit_test(test_singularity),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
