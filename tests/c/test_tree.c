/* The tree: cycles, order, sums, attitudes, bad nodes, failing allocations. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/memory.h"
#include "math/philox.h"
#include "orbit/attitude.h"
#include "orbit/elements.h"
#include "orbit/orientation.h"
#include "orbit/tree.h"
#include "orbit/two_body.h"

#define DAY 2461000.5

static pl_tree_node node(const char *name, ptrdiff_t parent, double x) {
  return (pl_tree_node){.name = name,
                        .parent = parent,
                        .path = {.kind = PL_PATH_FIXED, .position_m = {x, 0, 0}},
                        .turn = PL_TURN_NONE};
}

static const pl_turn_kind *kind(const char *name) {
  const pl_turn_kind *out = NULL;
  assert_int_equal(pl_turn_require(name, &out), PL_OK);
  return out;
}

/* Propagators of the running test; destroyed at its end. */
static pl_propagator *made[32];
static size_t made_count;
static int destroy_made(void **state) {
  (void)state;
  while (made_count > 0)
    pl_propagator_destroy(made[--made_count]);
  return 0;
}

static pl_tree_node around(const char *name, ptrdiff_t parent, double gm, const pl_elements *el,
                           pl_quat frame) {
  pl_tree_node out = node(name, parent, 0.0);
  pl_orbit orbit;
  assert_int_equal(pl_orbit_from_elements(el, gm, &orbit), PL_OK);
  assert_true(made_count < sizeof made / sizeof made[0]);
  assert_int_equal(pl_kepler_create(&orbit, frame, &made[made_count]), PL_OK);
  out.path = (pl_path){.kind = PL_PATH_PROPAGATED, .propagator = made[made_count++]};
  return out;
}
static pl_tree_node orbiting(const char *name, ptrdiff_t parent, double gm, double q, double e) {
  const pl_elements el = {q, e, 0.9, 1.0, 2.0, 100.0};
  return around(name, parent, gm, &el, PL_QUAT_IDENTITY);
}

static pl_status make(size_t count, const pl_tree_node *nodes, pl_tree **tree) {
  return pl_tree_create(count, nodes, DAY, 0.25, tree);
}

enum { MOST = 64 };
static pl_vec3 velocities[MOST];

static pl_status evaluate(size_t count, const pl_tree_node *nodes, size_t times, const double *t,
                          const pl_tree_given *given, pl_pose *out) {
  static pl_state relative[MOST];
  assert_true(count * times <= MOST);
  pl_tree *tree = NULL;
  PL_TRY(make(count, nodes, &tree));
  const pl_tree_states states = {out, velocities, relative};
  const pl_status status = pl_tree_evaluate(tree, times, t, given, &states);
  pl_tree_destroy(tree);
  return status;
}
static pl_status poses(size_t count, const pl_tree_node *nodes, size_t times, const double *t,
                       pl_pose *out) {
  return evaluate(count, nodes, times, t, NULL, out);
}

static void test_cycles(void **state) {
  (void)state;
  pl_tree *tree = NULL;
  pl_tree_node three[] = {node("sun", -1, 0), node("ann", 3, 0), node("bob", 1, 0),
                          node("cid", 2, 0)};
  assert_int_equal(make(4, three, &tree), PL_E_ARGUMENT);
  assert_string_equal(pl_error_text(), "cycle of parents: ann -> cid -> bob -> ann");
  pl_tree_node self[] = {node("solo", 0, 0)};
  assert_int_equal(make(1, self, &tree), PL_E_ARGUMENT);
  assert_string_equal(pl_error_text(), "cycle of parents: solo -> solo");
  /* a tail that leads into a cycle is not part of it */
  pl_tree_node tail[] = {node("tail", 1, 0), node("a", 2, 0), node("b", 1, 0)};
  assert_int_equal(make(3, tail, &tree), PL_E_ARGUMENT);
  assert_string_equal(pl_error_text(), "cycle of parents: a -> b -> a");
  /* a cycle too long to print is cut, not overrun */
  static pl_tree_node many[500];
  for (int i = 0; i < 500; i++)
    many[i] = node("a_rather_long_name_of_a_node", (i + 1) % 500, 0);
  assert_int_equal(make(500, many, &tree), PL_E_ARGUMENT);
  assert_non_null(strstr(pl_error_text(), "-> ... -> a_rather_long_name_of_a_node"));
  assert_null(tree);
}

/* A satellite of the Moon of the Earth: sums of the parts, at several times. */
static void test_moon_of_planet(void **state) {
  (void)state;
  const pl_tree_node nodes[] = {node("earth", -1, 0), orbiting("moon", 0, 4.04e14, 3.6e8, 0.05),
                                orbiting("lro", 1, 4.9e12, 1.8e6, 0.01)};
  const double t[3] = {0.0, 1e4, -1e6};
  pl_pose out[9];
  assert_int_equal(poses(3, nodes, 3, t, out), PL_OK);
  pl_state moon[3], lro[3];
  assert_int_equal(pl_propagator_states(nodes[1].path.propagator, 3, t, moon), PL_OK);
  assert_int_equal(pl_propagator_states(nodes[2].path.propagator, 3, t, lro), PL_OK);
  for (int i = 0; i < 3; i++) {
    assert_true(pl_vec3_norm(out[3 * i].t) == 0.0);
    assert_true(pl_vec3_norm(pl_vec3_sub(out[3 * i + 1].t, moon[i].r_m)) == 0.0);
    const pl_vec3 sum = pl_vec3_add(moon[i].r_m, lro[i].r_m);
    assert_true(pl_vec3_norm(pl_vec3_sub(out[3 * i + 2].t, sum)) == 0.0);
    const pl_vec3 speed = pl_vec3_add(moon[i].v_m_s, lro[i].v_m_s);
    assert_true(pl_vec3_norm(pl_vec3_sub(velocities[3 * i + 2], speed)) == 0.0);
  }
}

/* Bitwise the same poses whatever the order of declaration: a chain and branches, shuffled. */
static void test_order_independence(void **state) {
  (void)state;
  enum { N = 12 };
  pl_tree_node nodes[N];
  nodes[0] = node("n0", -1, 7.5);
  for (int i = 1; i < N; i++) {
    nodes[i] = orbiting("n", (i - 1) / 2, 4e14, 1e9 / (i * i), 0.03 * i);
    static const char *const kinds[] = {"inertial", "lvlh", "target", "parent", "velocity"};
    nodes[i].turn.kind = kind(kinds[i % 5]);
    nodes[i].turn.towards = i % 5 == 2 ? N - i : -1;
    nodes[i].turn.axis = pl_vec3_make(0, 1, i);
    nodes[i].turn.rate_rad_s = 0.1 * i;
  }
  const double t[2] = {12.0, 3456.0};
  pl_pose expected[2 * N], got[2 * N];
  assert_int_equal(poses(N, nodes, 2, t, expected), PL_OK);
  for (uint64_t trial = 0; trial < 50; trial++) {
    int place[N]; /* where node i goes */
    for (int i = 0; i < N; i++)
      place[i] = i;
    for (int i = N - 1; i > 0; i--) {
      uint64_t words[4];
      pl_philox((uint64_t[2]){1, 2}, (uint64_t[4]){trial, (uint64_t)i, 0, 0}, words);
      const int j = (int)(words[0] % (uint64_t)(i + 1)), swap = place[i];
      place[i] = place[j];
      place[j] = swap;
    }
    pl_tree_node shuffled[N];
    for (int i = 0; i < N; i++) {
      shuffled[place[i]] = nodes[i];
      if (nodes[i].turn.towards >= 0)
        shuffled[place[i]].turn.towards = place[nodes[i].turn.towards];
      if (nodes[i].parent >= 0)
        shuffled[place[i]].parent = place[nodes[i].parent];
    }
    assert_int_equal(poses(N, shuffled, 2, t, got), PL_OK);
    for (int k = 0; k < 2; k++)
      for (int i = 0; i < N; i++)
        assert_memory_equal(&got[k * N + place[i]], &expected[k * N + i], sizeof(pl_pose));
  }
}

/* "equator" tilts the plane of the orbit by the body's pole of the epoch; bodies turn with time. */
static void test_equator_and_body(void **state) {
  (void)state;
  const pl_celestial *mars = pl_celestial_find("mars");
  const pl_elements flat = {3.7e6, 0.01, 0.0, 0.0, 0.0, 0.0};
  const pl_quat equator = pl_celestial_equator(mars, DAY, 0.25);
  pl_tree_node nodes[] = {node("mars", -1, 0), around("mro", 0, 4.28e13, &flat, equator)};
  nodes[0].turn.kind = kind("body");
  nodes[0].turn.body = mars;
  nodes[1].turn.kind = kind("lvlh");
  const double t[2] = {0.0, 43200.0};
  pl_pose out[4];
  assert_int_equal(poses(2, nodes, 2, t, out), PL_OK);
  const pl_pole pole = pl_celestial_pole(mars, DAY, 0.25);
  const pl_vec3 north = {cos(pole.dec_rad) * cos(pole.ra_rad), cos(pole.dec_rad) * sin(pole.ra_rad),
                         sin(pole.dec_rad)};
  for (int i = 0; i < 2; i++) {
    assert_true(fabs(pl_vec3_dot(out[2 * i + 1].t, north)) < 1e-8);
    const pl_vec3 y = pl_quat_rotate(out[2 * i + 1].q, pl_vec3_make(0, 1, 0));
    assert_true(pl_vec3_norm(pl_vec3_add(y, north)) < 1e-14);
    const pl_quat q = pl_celestial_orientation(mars, DAY, 0.25 + t[i] / 86400.0);
    assert_memory_equal(&out[2 * i].q, &q, sizeof q);
  }
  /* at periapsis, along the node of the equator on ICRF's */
  const pl_vec3 axis = {-sin(pole.ra_rad), cos(pole.ra_rad), 0.0};
  assert_true(pl_vec3_norm(pl_vec3_sub(pl_vec3_unit(out[1].t), axis)) < 1e-14);
}

static void test_bad_nodes(void **state) {
  (void)state;
  pl_tree *tree = NULL;
  pl_tree_node bad = node("stray", 3, 0);
  assert_int_equal(make(1, &bad, &tree), PL_E_ARGUMENT);
  assert_non_null(strstr(pl_error_text(), "'stray': parent 3"));
  bad = node("stray", -2, 0);
  assert_int_equal(make(1, &bad, &tree), PL_E_ARGUMENT);
  bad = node("nan", -1, NAN);
  assert_int_equal(make(1, &bad, &tree), PL_E_RANGE);
  bad = orbiting("free", -1, 4e14, 7e6, 0.0);
  assert_int_equal(make(1, &bad, &tree), PL_E_ARGUMENT);
  bad = node("root", -1, 0);
  bad.turn.kind = kind("lvlh");
  assert_int_equal(make(1, &bad, &tree), PL_E_ARGUMENT);
  bad.turn = (pl_turn){.rate_rad_s = 0.0};
  assert_int_equal(make(1, &bad, &tree), PL_E_RANGE);
  bad.turn = (pl_turn){.q = PL_QUAT_IDENTITY, .rate_rad_s = 1.0};
  assert_int_equal(make(1, &bad, &tree), PL_E_RANGE);
  bad.turn = PL_TURN_NONE;
  bad.turn.kind = kind("body");
  assert_int_equal(make(1, &bad, &tree), PL_E_ARGUMENT);
  assert_null(tree);
  pl_tree_node inside[] = {node("earth", -1, 0), node("probe", 0, 0)};
  inside[1].turn.kind = kind("lvlh");
  const double t = 0.0, never = NAN;
  pl_pose out[2];
  assert_int_equal(poses(2, inside, 1, &t, out), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "'probe'"));
  assert_int_equal(poses(1, inside, 1, &never, out), PL_E_RANGE);
  assert_int_equal(poses(0, NULL, 1, &t, out), PL_OK);
}

/* Nodes point at nodes declared, and moved, after them, and at each other. */
static void test_pointing(void **state) {
  (void)state;
  pl_tree_node nodes[] = {node("chaser", 2, 0), orbiting("target", 2, 4e14, 7e6, 0.1),
                          node("earth", 3, 0), node("sun", -1, 1.5e11)};
  nodes[0] = orbiting("chaser", 2, 4e14, 7.1e6, 0.01);
  nodes[0].turn.kind = kind("target");
  nodes[0].turn.towards = 1;
  nodes[1].turn.kind = kind("sun");
  nodes[1].turn.towards = 3;
  nodes[2].turn.kind = kind("target");
  nodes[2].turn.towards = 0;
  nodes[2].turn.up = pl_vec3_make(0, 0, -2);
  nodes[2].path.position_m = pl_vec3_make(-1.5e11, 2e10, 0);
  const double t[3] = {0.0, 1234.5, 1e6};
  pl_pose out[12];
  assert_int_equal(poses(4, nodes, 3, t, out), PL_OK);
  static const int aims[3][2] = {{0, 1}, {1, 3}, {2, 0}};
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) {
      const pl_pose *own = &out[4 * i + aims[k][0]], *other = &out[4 * i + aims[k][1]];
      const pl_vec3 axis = k == 1 ? pl_vec3_make(1, 0, 0) : pl_vec3_make(0, 0, 1);
      const pl_vec3 aim = pl_vec3_unit(pl_vec3_sub(other->t, own->t));
      assert_true(pl_vec3_norm(pl_vec3_sub(pl_quat_rotate(own->q, axis), aim)) < 1e-14);
      if (k == 1) /* z of the sun's frame is on the side of the orbit normal */
        assert_true(pl_vec3_dot(pl_quat_rotate(own->q, pl_vec3_make(0, 0, 1)),
                                pl_vec3_cross(pl_vec3_sub(own->t, out[4 * i + 2].t),
                                              velocities[4 * i + 1])) > 0.0);
      if (k == 2)
        assert_true(pl_quat_rotate(own->q, pl_vec3_make(0, 1, 0)).z > 0.0);
    }
  nodes[0].turn.towards = 0;
  assert_int_equal(poses(4, nodes, 3, t, out), PL_E_ARGUMENT);
  assert_string_equal(pl_error_text(), "node 'chaser': it cannot point at itself");
  nodes[0].turn.towards = 4;
  assert_int_equal(poses(4, nodes, 3, t, out), PL_E_ARGUMENT);
  nodes[0].turn.towards = -1; /* and no direction */
  assert_int_equal(poses(4, nodes, 3, t, out), PL_E_RANGE);
  nodes[0].turn.direction = pl_vec3_make(0, -5, 0);
  assert_int_equal(poses(4, nodes, 3, t, out), PL_OK);
  assert_true(fabs(pl_quat_rotate(out[0].q, pl_vec3_make(0, 0, 1)).y + 1.0) < 1e-15);
}

/* Evaluating allocates nothing, at any number of times. */
static void test_no_allocations(void **state) {
  (void)state;
  pl_tree_node nodes[] = {node("sun", -1, 0), orbiting("earth", 0, 1.3e20, 1.5e11, 0.02),
                          orbiting("moon", 1, 4e14, 3.8e8, 0.05), orbiting("lro", 2, 5e12, 2e6, 0)};
  nodes[3].turn.kind = kind("sun");
  nodes[3].turn.towards = 0;
  nodes[2].turn.kind = kind("tumble");
  assert_int_equal(pl_tumble_init((pl_vec3){1, 2, 2.5}, (pl_vec3){1, 2, 3}, PL_QUAT_IDENTITY,
                                  &nodes[2].turn.tumble),
                   PL_OK);
  pl_tree *tree = NULL;
  assert_int_equal(make(4, nodes, &tree), PL_OK);
  double t[16];
  for (int i = 0; i < 16; i++)
    t[i] = 1e9 * sin(i);
  pl_pose out[MOST];
  pl_state relative[MOST];
  const pl_tree_states states = {out, velocities, relative};
  const uint64_t before = pl_memory_allocations();
  assert_int_equal(pl_tree_evaluate(tree, 16, t, NULL, &states), PL_OK);
  assert_int_equal(pl_tree_evaluate(tree, 1, t + 3, NULL, &states), PL_OK);
  assert_int_equal(pl_memory_allocations(), before);
  pl_tree_destroy(tree);
}

/* Places and axes that the caller gives, at each time its own; a child follows both. */
static void test_given(void **state) {
  (void)state;
  pl_tree_node nodes[] = {node("sun", -1, 0), node("comet", 0, 0), node("lander", 1, 10.0)};
  nodes[1].path = (pl_path){.kind = PL_PATH_GIVEN, .slot = 1};
  nodes[1].turn.kind = kind("given");
  nodes[2].turn.kind = kind("parent");
  nodes[2].turn.q = (pl_quat){0, 0, 0, 2};
  const double t[2] = {0.0, 5.0};
  const pl_state states[4] = {{{9, 9, 9}, {9, 9, 9}},
                              {{1, 2, 3}, {4, 5, 6}},
                              {{9, 9, 9}, {9, 9, 9}},
                              {{-1, 0, 1}, {7, 8, 9}}};
  const pl_quat quats[2] = {{2, 0, 0, 0}, {0, 3, 0, 0}};
  pl_tree_given given = {2, states, 1, quats};
  pl_pose out[6];
  assert_int_equal(evaluate(3, nodes, 2, t, &given, out), PL_OK);
  for (int i = 0; i < 2; i++) {
    const pl_state *s = &states[2 * i + 1];
    assert_memory_equal(&out[3 * i + 1].t, &s->r_m, sizeof(pl_vec3));
    assert_memory_equal(&velocities[3 * i + 1], &s->v_m_s, sizeof(pl_vec3));
    assert_memory_equal(&velocities[3 * i + 2], &s->v_m_s, sizeof(pl_vec3));
    /* a fixed position is in ICRF axes, whatever the parent's rotation */
    assert_true(out[3 * i + 2].t.x == s->r_m.x + 10.0);
    const pl_quat unit = pl_quat_unit(quats[i]), z = {0, 0, 0, 1};
    const pl_quat child = pl_quat_mul(unit, z);
    assert_memory_equal(&out[3 * i + 1].q, &unit, sizeof unit);
    assert_true(fabs(child.w * out[3 * i + 2].q.w + child.x * out[3 * i + 2].q.x +
                     child.y * out[3 * i + 2].q.y + child.z * out[3 * i + 2].q.z) > 1.0 - 1e-15);
  }
  given.state_slots = 1;
  assert_int_equal(evaluate(3, nodes, 2, t, &given, out), PL_E_ARGUMENT);
  assert_string_equal(pl_error_text(),
                      "node 'comet': takes slot 1 of the given states, which have 1");
  given.state_slots = 2;
  given.quat_slots = 0;
  assert_int_equal(evaluate(3, nodes, 2, t, &given, out), PL_E_ARGUMENT);
  assert_int_equal(evaluate(3, nodes, 2, t, NULL, out), PL_E_ARGUMENT);
  const pl_quat none[2] = {PL_QUAT_IDENTITY, {0, 0, 0, 0}};
  given = (pl_tree_given){2, states, 1, none};
  assert_int_equal(evaluate(3, nodes, 2, t, &given, out), PL_E_RANGE);
  pl_state lost[4];
  memcpy(lost, states, sizeof lost);
  lost[1].r_m.x = NAN;
  given = (pl_tree_given){2, lost, 1, quats};
  assert_int_equal(evaluate(3, nodes, 2, t, &given, out), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "'comet'"));
}

/* Every allocation failing in turn gives PL_E_MEMORY; leaks are the sanitizer's to report. */
static void *fail_nth(void *context, size_t size) {
  int *left = context;
  return (*left)-- == 0 ? NULL : malloc(size);
}
static void test_failing_allocations(void **state) {
  (void)state;
  const pl_tree_node nodes[] = {node("a", 1, 0), node("b", -1, 0)};
  int n = 0;
  pl_status status = PL_E_MEMORY;
  for (; n < 20 && status != PL_OK; n++) {
    int left = n;
    pl_tree *tree = NULL;
    pl_memory_hook(fail_nth, &left);
    status = make(2, nodes, &tree);
    pl_memory_hook(NULL, NULL);
    assert_true(status == PL_OK || (status == PL_E_MEMORY && !tree));
    pl_tree_destroy(tree);
  }
  assert_true(n > 1 && status == PL_OK);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_cycles),
      cmocka_unit_test_teardown(test_moon_of_planet, destroy_made),
      cmocka_unit_test_teardown(test_order_independence, destroy_made),
      cmocka_unit_test_teardown(test_equator_and_body, destroy_made),
      cmocka_unit_test_teardown(test_bad_nodes, destroy_made),
      cmocka_unit_test_teardown(test_pointing, destroy_made),
      cmocka_unit_test_teardown(test_no_allocations, destroy_made),
      cmocka_unit_test(test_given),
      cmocka_unit_test(test_failing_allocations),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
