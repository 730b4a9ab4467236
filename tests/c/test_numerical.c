/* The numerical propagator against closed forms and theory, and what it promises about its steps:
 * the same bits whatever is asked, in bounded memory, on any number of threads. */
#include "harness.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "orbit/elements.h"
#include "orbit/numerical.h"
#include "orbit/trail.h"
#include "random.h"

#define GM 398600.4418e9
#define EARTH_M 6378.137e3

static const double upright[4] = {1.0, 0.0, 0.0, 0.0};

static pl_numerical_spec two_body(pl_state at, double rtol) {
  return (pl_numerical_spec){.setting = {.tdb_day = 2459000.0, .tdb_fraction = 0.5, .gm_m3_s2 = GM},
                             .state = at,
                             .rtol = rtol};
}
static pl_propagator *make(const pl_numerical_spec *spec) {
  pl_propagator *out = NULL;
  if (pl_numerical_create(spec, &out) != PL_OK)
    fail_msg("%s", pl_error_text());
  return out;
}
static pl_state state_at(const pl_propagator *p, double t) {
  pl_state out;
  if (pl_propagator_states(p, 1, &t, &out) != PL_OK)
    fail_msg("t = %g: %s", t, pl_error_text());
  return out;
}
static void destroy(pl_propagator *p) { pl_propagator_destroy(p); }
static double distance(pl_state a, pl_state b) { return pl_vec3_norm(pl_vec3_sub(a.r_m, b.r_m)); }
static double energy(pl_state s) {
  return 0.5 * pl_vec3_dot(s.v_m_s, s.v_m_s) - GM / pl_vec3_norm(s.r_m);
}
static pl_state circular(double a, double inclination_rad) {
  const double v = sqrt(GM / a);
  return (pl_state){{a, 0.0, 0.0}, {0.0, v * cos(inclination_rad), v * sin(inclination_rad)}};
}
/* J2 of a centre whose pole is z. */
static pl_force *j2_force(double j2) {
  const double radius = EARTH_M;
  const pl_force_value values[] = {{0},
                                   {.numbers = upright, .count = 4},
                                   {0},
                                   {.numbers = &radius, .count = 1},
                                   {.numbers = &j2, .count = 1},
                                   {0}};
  const pl_force_setting setting = {.gm_m3_s2 = GM};
  pl_force *force = NULL;
  assert_int_equal(pl_force_create(&pl_force_zonal, &setting, values, &force), PL_OK);
  return force;
}

/* 1 000 revolutions of a low orbit: energy to 1e-11 at all of 20 000 times; and the closed form. */
static void test_energy(void **state) {
  (void)state;
  const pl_state start = {{7000e3, 0, 0}, {0, 5.4e3, 5.4e3}};
  const pl_numerical_spec spec = two_body(start, 1e-13);
  pl_propagator *p = make(&spec);
  pl_orbit orbit;
  assert_int_equal(pl_orbit_from_state(&start, GM, &orbit), PL_OK);
  const double period = pl_orbit_period_s(&orbit), e0 = energy(start);
  double drift = 0.0;
  for (int i = 1; i <= 20000; i++)
    drift = fmax(drift, fabs(energy(state_at(p, 0.05 * period * i)) / e0 - 1.0));
  assert_true(drift < 1e-11); /* 2e-12 measured */
  const double end = 1000.25 * period;
  pl_state exact;
  assert_int_equal(pl_orbit_states(&orbit, 1, &end, &exact), PL_OK);
  assert_true(distance(state_at(p, end), exact) < 1.0); /* 0.08 m measured, of 4.5e10 m of path */
  destroy(p);
}

/* Random conics of all kinds, forwards and backwards for a few radians, against Kepler. */
static void test_kepler(void **state) {
  (void)state;
  test_random random = {.seed = 11};
  for (int i = 0; i < 200; i++) {
    const double r = random_scale(&random, 7e6, 4e8), escape = sqrt(2.0 * GM / r);
    const pl_state start = {
        pl_vec3_scale(random_direction(&random), r),
        pl_vec3_scale(random_direction(&random), escape * random_range(&random, 0.6, 1.5))};
    pl_orbit orbit;
    if (pl_orbit_from_state(&start, GM, &orbit) != PL_OK || orbit.periapsis_m < 0.05 * r)
      continue; /* a close passage multiplies errors */
    const pl_numerical_spec spec = two_body(start, 1e-13);
    pl_propagator *p = make(&spec);
    for (int k = -4; k <= 4; k++) {
      const double t = k * r / escape;
      pl_state exact;
      assert_int_equal(pl_orbit_states(&orbit, 1, &t, &exact), PL_OK);
      if (!(distance(state_at(p, t), exact) < 1e-10 * pl_vec3_norm(exact.r_m)))
        fail_msg("seed 11, orbit %d at t = %g: off by %g m", i, t, distance(state_at(p, t), exact));
    }
    const pl_state zero = state_at(p, 0.0);
    assert_memory_equal(&zero, &start, sizeof start);
    destroy(p);
  }
}

/* dOmega/dt = -1.5 J2 (R/p)^2 n cos i in mean elements. The node's and the plane's are means over
 * whole revolutions, at the start and after 148; the mean semi-major axis comes from the time these
 * take. What is left is of the order of J2 relative. */
static void mean_plane(const pl_propagator *p, double t, double period, double *node,
                       double *inclination) {
  const int count = 256;
  *node = *inclination = 0.0;
  for (int i = 0; i < count; i++) {
    const pl_state s = state_at(p, t + period * i / count);
    const pl_vec3 h = pl_vec3_cross(s.r_m, s.v_m_s);
    *node += atan2(h.x, -h.y) / count;
    *inclination += atan2(hypot(h.x, h.y), h.z) / count;
  }
}
/* Time of the last passage of the ascending node at or before `near_s`. */
static double node_passage(const pl_propagator *p, double near_s) {
  double low = near_s - 600.0, high = near_s + 600.0;
  for (int i = 0; i < 60; i++) {
    const double middle = 0.5 * (low + high);
    if (state_at(p, middle).r_m.z < 0.0)
      low = middle;
    else
      high = middle;
  }
  return low;
}
static void test_node_rate(void **state) {
  (void)state;
  const double j2 = 1.0826266835531513e-3;
  pl_force *force = j2_force(j2);
  pl_numerical_spec spec = two_body(circular(7000e3, 0.9), 1e-12);
  spec.force_count = 1;
  spec.forces = &force;
  pl_propagator *p = make(&spec);
  /* The nodal period, from passages 148 revolutions apart. */
  const double guess = 2.0 * PL_PI * sqrt(7000e3 * 7000e3 * 7000e3 / GM);
  double period = node_passage(p, guess);
  for (int n = 2; n <= 148; n = n < 12 ? n + 1 : n + 8)
    period = node_passage(p, n * period) / n;
  const double span = 148.0 * period;
  double node[2], inclination = 0.0;
  mean_plane(p, 0.0, period, &node[0], &inclination);
  mean_plane(p, span, period, &node[1], &inclination);
  const double got = (node[1] - node[0]) / span;
  /* The mean a: n + dM/dt + domega/dt of J2 theory make up the nodal rate 2 pi/period. */
  const double s2 = sin(inclination) * sin(inclination);
  double a = 7000e3, n = 0.0, k = 0.0;
  for (int i = 0; i < 20; i++) {
    n = sqrt(GM / (a * a * a));
    k = 1.5 * j2 * (EARTH_M / a) * (EARTH_M / a) * n;
    const double rate = n + k * ((1.0 - 1.5 * s2) + (2.0 - 2.5 * s2));
    a *= pow(rate * period / (2.0 * PL_PI), 2.0 / 3.0);
  }
  const double expected = -k * cos(inclination);
  if (!(fabs(got / expected - 1.0) < 1e-3))
    fail_msg("node rate %.9g rad/s, theory %.9g", got, expected);
  destroy(p);
}

/* A year of a sun-synchronous orbit at 700 km: the node goes around once. The inclination is that
 * of the secular theory for the mean a of this circular start. */
static void test_sun_synchronous(void **state) {
  (void)state;
  const double j2 = 1.0826266835531513e-3, year = 365.2421897 * 86400.0, a0 = EARTH_M + 700e3;
  double inclination = 1.7;
  for (int i = 0; i < 50; i++) {
    /* Brouwer's mean a of an osculating circle that starts at the node. */
    const double c = cos(inclination), s2 = 1.0 - c * c;
    const double a = a0 - j2 * EARTH_M * EARTH_M / (2.0 * a0) * 3.0 * s2;
    const double rate = 1.5 * j2 * (EARTH_M / a) * (EARTH_M / a) * sqrt(GM / (a * a * a));
    inclination = acos(-2.0 * PL_PI / year / rate);
  }
  pl_force *force = j2_force(j2);
  pl_numerical_spec spec = two_body(circular(a0, inclination), 1e-10);
  spec.force_count = 1;
  spec.forces = &force;
  pl_propagator *p = make(&spec);
  double node = 0.0, before = 0.0;
  for (int day = 0; day <= 365; day++) {
    const pl_state s = state_at(p, year * day / 365.0);
    const pl_vec3 h = pl_vec3_cross(s.r_m, s.v_m_s);
    const double now = atan2(h.x, -h.y);
    if (day > 0)
      node += remainder(now - before, 2.0 * PL_PI);
    before = now;
  }
  if (!(fabs(node / (2.0 * PL_PI) - 1.0) < 5e-3))
    fail_msg("the node went %.4f degrees in a year", node * 180.0 / PL_PI);
  destroy(p);
}

/* The Sun, standing still. */
static pl_status sun_states(const pl_propagator *self, size_t count, const double *t_s,
                            pl_state *out) {
  (void)self, (void)t_s;
  for (size_t i = 0; i < count; i++)
    out[i] = (pl_state){{1.5e11, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  return PL_OK;
}
static void sun_destroy(pl_propagator *self) { (void)self; }
static const pl_propagator_kind sun_kind = {"sun", "", sun_states, sun_destroy};

/* A light object in and out of the shadow 200 times: steps end at its edges, so that a loose
 * tolerance gives what a tight one does. */
static void test_shadow_edges(void **state) {
  (void)state;
  static pl_propagator sun = {&sun_kind};
  const double area = 1.0, cr = 1.0, radius = EARTH_M, t = 100.0 * 6000.0;
  const pl_force_value values[] = {{.numbers = &area, .count = 1},
                                   {.numbers = &cr, .count = 1},
                                   {.numbers = &radius, .count = 1},
                                   {.motion = &sun}};
  pl_state end[2], day[2];
  for (int i = 0; i < 2; i++) {
    pl_numerical_spec spec = two_body(circular(7000e3, 0.5), i == 0 ? 1e-9 : 1e-13);
    pl_force *force = NULL;
    assert_int_equal(pl_force_create(&pl_force_radiation_pressure, &spec.setting, values, &force),
                     PL_OK);
    spec.force_count = 1;
    spec.forces = &force;
    pl_propagator *p = make(&spec);
    end[i] = state_at(p, t);
    day[i] = state_at(p, 86400.0);
    destroy(p);
  }
  /* 4 m and 0.02 m measured; 98 m and 158 m without the ends at edges. */
  assert_true(distance(end[0], end[1]) < 10.0 && distance(day[0], day[1]) < 0.1);
}

/* Whatever is asked before, and however far: the same bits; more blocks than slots, so that all are
 * forgotten and made again. */
static void test_order_does_not_matter(void **state) {
  (void)state;
  pl_force *forces[2] = {j2_force(1e-3), j2_force(1e-3)};
  pl_numerical_spec spec = two_body(circular(7000e3, 1.2), 1e-13);
  spec.force_count = 1;
  pl_propagator *one[2];
  for (int i = 0; i < 2; i++) {
    spec.forces = &forces[i];
    one[i] = make(&spec);
  }
  enum { TIMES = 400 };
  const double span = 2.0 * PL_TRAIL_SLOTS * PL_TRAIL_BLOCK * 80.0;
  double t[TIMES];
  pl_state forth[TIMES], back[TIMES];
  for (int i = 0; i < TIMES; i++)
    t[i] = span * (2.0 * i / (TIMES - 1) - 1.0);
  assert_int_equal(pl_propagator_states(one[0], TIMES, t, forth), PL_OK);
  test_random random = {.seed = 3};
  for (int i = 0; i < TIMES; i++)
    back[i] = (pl_state){{NAN, 0, 0}, {0, 0, 0}};
  for (int left = TIMES; left > 0; left--) { /* without replacement, one call a time */
    int k = random_below(&random, TIMES);
    while (!isnan(back[k].r_m.x))
      k = (k + 1) % TIMES;
    back[k] = state_at(one[1], t[k]);
  }
  assert_memory_equal(forth, back, sizeof forth);
  destroy(one[0]);
  destroy(one[1]);
}

/* Once a place has been reached, asking again allocates nothing, forgotten blocks included. */
static void test_steady_memory(void **state) {
  (void)state;
  const pl_numerical_spec spec = two_body(circular(7000e3, 0.4), 1e-13);
  pl_propagator *p = make(&spec);
  const double span = 1.5 * PL_TRAIL_SLOTS * PL_TRAIL_BLOCK * 90.0;
  state_at(p, span);
  const uint64_t before = pl_memory_allocations();
  for (int i = 0; i < 50; i++)
    state_at(p, span * (i * 17 % 50) / 50.0);
  assert_int_equal(pl_memory_allocations(), before);
  destroy(p);
}

/* On threads: the bits of one thread. */
typedef struct job {
  const pl_propagator *p;
  int first;
  pl_state out[64];
} job;
static void *run(void *argument) {
  job *j = argument;
  for (int i = 0; i < 64; i++) {
    const double t = ((i * 29 + j->first) % 64 - 32) * 7000.0;
    if (pl_propagator_states(j->p, 1, &t, &j->out[(i * 29 + j->first) % 64]) != PL_OK)
      return j;
  }
  return NULL;
}
static void test_threads(void **state) {
  (void)state;
  const pl_numerical_spec spec = two_body(circular(7000e3, 0.4), 1e-12);
  pl_propagator *p = make(&spec), *alone = make(&spec);
  pthread_t threads[4];
  static job jobs[4], reference;
  for (int i = 0; i < 4; i++) {
    jobs[i] = (job){.p = p, .first = 13 * i};
    assert_int_equal(pthread_create(&threads[i], NULL, run, &jobs[i]), 0);
  }
  reference = (job){.p = alone};
  assert_null(run(&reference));
  for (int i = 0; i < 4; i++) {
    void *failed = NULL;
    pthread_join(threads[i], &failed);
    assert_null(failed);
    assert_memory_equal(jobs[i].out, reference.out, sizeof reference.out);
  }
  destroy(p);
  destroy(alone);
}

/* An ellipse that dips below the surface: states up to the contact, which Kepler gives too, and an
 * error beyond it that says when; before the epoch the same. A start below it is refused. */
static void test_surface(void **state) {
  (void)state;
  const pl_state start = {{10000e3, 0, 0}, {0, 4500.0, 0}}; /* apoapsis; periapsis at 3 400 km */
  pl_numerical_spec spec = two_body(start, 1e-12);
  spec.surface_m = EARTH_M;
  pl_orbit orbit;
  assert_int_equal(pl_orbit_from_state(&start, GM, &orbit), PL_OK);
  double low = 0.0, high = 0.5 * pl_orbit_period_s(&orbit); /* contact, by bisection of Kepler */
  for (int i = 0; i < 80; i++) {
    const double middle = 0.5 * (low + high);
    pl_state s;
    assert_int_equal(pl_orbit_states(&orbit, 1, &middle, &s), PL_OK);
    if (pl_vec3_norm(s.r_m) > EARTH_M)
      low = middle;
    else
      high = middle;
  }
  for (int order = 0; order < 2; order++) {
    pl_propagator *p = make(&spec);
    pl_state s;
    for (int side = -1; side <= 1; side += 2) {
      const double good = side * (low - 1e-3), bad = side * (low + 1e-3), far = side * 1e9;
      if (order)
        assert_true(fabs(pl_vec3_norm(state_at(p, good).r_m) - EARTH_M) < 10.0);
      assert_int_equal(pl_propagator_states(p, 1, &far, &s), PL_E_RANGE);
      assert_non_null(strstr(pl_error_text(), "surface (6378.14 km"));
      assert_int_equal(pl_propagator_states(p, 1, &bad, &s), PL_E_RANGE);
      assert_true(fabs(pl_vec3_norm(state_at(p, good).r_m) - EARTH_M) < 10.0);
    }
    destroy(p);
  }
  /* A dip shorter than a step is seen as well. */
  spec.rtol = 1e-4;
  spec.surface_m = orbit.periapsis_m * 1.0001;
  pl_propagator *p = make(&spec);
  const double half = pl_orbit_period_s(&orbit), before = 0.4 * half;
  pl_state s;
  assert_int_equal(pl_propagator_states(p, 1, &half, &s), PL_E_RANGE);
  assert_int_equal(pl_propagator_states(p, 1, &before, &s), PL_OK);
  destroy(p);
  spec.surface_m = 10001e3;
  assert_int_equal(pl_numerical_create(&spec, &p), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "below the surface"));
}

/* Straight into the centre without a surface: an error, before and after it is known. */
static void test_infall(void **state) {
  (void)state;
  const pl_numerical_spec spec = two_body((pl_state){{7000e3, 0, 0}, {-1e3, 0, 0}}, 1e-10);
  pl_propagator *p = make(&spec);
  /* At 300 s: 6315.8012429754123 km (two-body motion in 40 digits). */
  assert_true(fabs(state_at(p, 300.0).r_m.x - 6315801.2429754123) < 1e-2);
  pl_state s;
  const double t = 1e5;
  for (int i = 0; i < 2; i++)
    assert_int_equal(pl_propagator_states(p, 1, &t, &s), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "singularity"));
  assert_true(fabs(state_at(p, 300.0).r_m.x - 6315801.2429754123) < 1e-2);
  destroy(p);
}

/* A billion seconds of a stationary orbit, both ways, within the promised memory; the energy of it;
 * and a time that needs more steps than are kept. */
static size_t allocated;
static void *count_bytes(void *context, size_t size) {
  (void)context;
  allocated += size;
  return malloc(size);
}
static void test_long_span(void **state) {
  (void)state;
  const pl_state start = circular(42164e3, 0.1);
  const pl_numerical_spec spec = two_body(start, 1e-9);
  allocated = 0;
  pl_memory_hook(count_bytes, NULL);
  pl_propagator *p = make(&spec);
  const double drift = energy(state_at(p, 1e9)) / energy(start) - 1.0;
  assert_true(fabs(drift) < 1e-5); /* 11 600 revolutions at 1e-9 a step */
  assert_true(allocated < 8u << 20);
  pl_memory_hook(NULL, NULL);
  destroy(p);
}

static int allocations_left;
static void *limited(void *context, size_t size) {
  (void)context;
  return allocations_left-- > 0 ? malloc(size) : NULL;
}
static void test_every_allocation_fails(void **state) {
  (void)state;
  const double t = 86400.0;
  pl_status status = PL_E_MEMORY;
  int n = 0;
  for (; status != PL_OK && n < 100; n++) {
    pl_force *force = j2_force(1e-3);
    pl_numerical_spec spec = two_body(circular(7000e3, 1.2), 1e-10);
    spec.force_count = 1;
    spec.forces = &force;
    pl_memory_hook(limited, NULL);
    allocations_left = n;
    pl_propagator *p = NULL;
    pl_state s;
    status = pl_numerical_create(&spec, &p);
    if (status != PL_OK)
      pl_free(force); /* still ours */
    else
      status = pl_propagator_states(p, 1, &t, &s);
    pl_memory_hook(NULL, NULL);
    if (p) { /* what failed for lack of memory goes well later */
      assert_int_equal(pl_propagator_states(p, 1, &t, &s), PL_OK);
      destroy(p);
    }
    assert_true(status == PL_OK || status == PL_E_MEMORY);
  }
  assert_true(n > 6 && n < 100);
}

static void test_bad_specs(void **state) {
  (void)state;
  const pl_state good = circular(7000e3, 0.1);
  pl_propagator *p = NULL;
  pl_numerical_spec spec = two_body(good, 0.0);
  const double rtols[] = {0.0, 1e-16, 0.1, -1.0, NAN, INFINITY};
  for (size_t i = 0; i < sizeof rtols / sizeof rtols[0]; i++) {
    spec.rtol = rtols[i];
    assert_int_equal(pl_numerical_create(&spec, &p), PL_E_RANGE);
    assert_non_null(strstr(pl_error_text(), "rtol"));
  }
  spec = two_body((pl_state){{0, 0, 0}, {1, 1, 1}}, 1e-9);
  assert_int_equal(pl_numerical_create(&spec, &p), PL_E_RANGE);
  spec = two_body((pl_state){{7e6, NAN, 0}, {1, 1, 1}}, 1e-9);
  assert_int_equal(pl_numerical_create(&spec, &p), PL_E_RANGE);
  spec = two_body(good, 1e-9);
  spec.setting.gm_m3_s2 = -1.0;
  assert_int_equal(pl_numerical_create(&spec, &p), PL_E_RANGE);
  spec = two_body(good, 1e-9);
  p = make(&spec);
  const double bad[] = {NAN, INFINITY, -INFINITY};
  pl_state s;
  for (int i = 0; i < 3; i++)
    assert_int_equal(pl_propagator_states(p, 1, &bad[i], &s), PL_E_RANGE);
  destroy(p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      serial_unit_test(test_energy),        serial_unit_test(test_kepler),
      serial_unit_test(test_node_rate),     serial_unit_test(test_sun_synchronous),
      serial_unit_test(test_shadow_edges),  serial_unit_test(test_order_does_not_matter),
      serial_unit_test(test_steady_memory), cmocka_unit_test(test_threads),
      serial_unit_test(test_surface),       serial_unit_test(test_infall),
      serial_unit_test(test_long_span),     serial_unit_test(test_every_allocation_fails),
      serial_unit_test(test_bad_specs),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
