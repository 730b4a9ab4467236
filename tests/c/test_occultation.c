/* Eclipses by bodies: analytic cases, what must not change, what must only fall, and errors. The
 * integrals of other codes are in tests/python/test_sunlight.py. */
#include "harness.h"

#include "base/memory.h"
#include "light/cone.h"
#include "light/limb.h"
#include "light/occultation.h"
#include "orbit/eclipse.h"
#include "random.h"

enum { BODIES = 4, BANDS = 2 };
static const double AU = 149597870700.0, SUN_M = 695700e3;

/* Bodies seen from the origin, the sun at 1 au on z. */
typedef struct sky {
  size_t bodies;
  pl_pose poses[BODIES];
  pl_vec3 radii[BODIES];
  uint8_t hides[BODIES];
  double light[BANDS]; /* even, and darkened */
} sky;

static double sun_angle(void) { return asin(SUN_M / AU); }

/* A sphere of angular radius b at the angle c from the sun, turned about it. */
static void add_sphere(sky *s, double b, double c, double turn, double distance) {
  const double r = distance * sin(b);
  const pl_vec3 at = {sin(c) * cos(turn), sin(c) * sin(turn), cos(c)};
  s->poses[s->bodies] = (pl_pose){pl_vec3_scale(at, distance), PL_QUAT_IDENTITY};
  s->radii[s->bodies++] = (pl_vec3){r, r, r};
}

static void solve(sky *s) {
  const pl_vec3 here = {0, 0, 0}, sun = {0, 0, AU};
  const double um[BANDS] = {0.0, 0.55};
  const pl_occultation request = {.times = 1,
                                  .bodies = s->bodies,
                                  .bands = BANDS,
                                  .sun_radius_m = SUN_M,
                                  .points = &here,
                                  .sun_m = &sun,
                                  .poses = s->poses,
                                  .radii_m = s->radii,
                                  .wavelength_um = um,
                                  .nodes = 24};
  const pl_occultation_result out = {s->light, s->hides};
  assert_int_equal(pl_occultation_solve(&request, &out), PL_OK);
}

static sky alone(double b, double c) {
  sky s = {0};
  add_sphere(&s, b, c, 0.3, 1e8);
  solve(&s);
  return s;
}

/* The light of a darkened disc within radius r, of all of it: F(r)/F(1) by its polynomial. */
static double light_within(double r) {
  double c[PL_LIMB_TERMS], inside = 0.0, all = 0.0;
  pl_limb_polynomial(0.55, c);
  const double mu = sqrt(1.0 - r * r);
  for (int k = 0; k < PL_LIMB_TERMS; k++) {
    inside += c[k] / (k + 2.0) * (1.0 - pow(mu, k + 2));
    all += c[k] / (k + 2.0);
  }
  return inside / all;
}

/* Concentric, equal, touching, exactly behind the limb, disjoint. The fraction of a concentric disc
 * is that of the sines squared, as irradiance is. */
static void test_analytic(void **state) {
  (void)state;
  const double a = sun_angle();
  sky s = alone(0.5 * a, 0.0);
  const double r = sin(0.5 * a) / sin(a);
  assert_true(fabs(s.light[0] - (1.0 - r * r)) < 1e-14);
  assert_true(fabs(s.light[1] - (1.0 - light_within(r))) < 1e-13);
  assert_true(s.hides[0]);
  for (int i = 0; i <= 20; i++) { /* wholly inside: the same fraction wherever it is */
    const double b = 0.2 * a, c = 0.8 * a * i / 20.0 * (1.0 - 1e-9);
    s = alone(b, c);
    assert_true(fabs(s.light[0] - (1.0 - 0.04)) < 1e-5);
    assert_true(i > 0 || fabs(s.light[1] - (1.0 - light_within(sin(b) / sin(a)))) < 1e-13);
  }
  for (int i = 0; i < 5; i++) {
    const double b = a * (i < 4 ? pow(10.0, 0.6 * i) : 320.0);
    s = alone(b * (1.0 + 1e-14), b - a); /* the sun just behind the limb */
    assert_true(s.light[0] < 1e-12 && s.light[1] < 1e-12 && s.hides[0]);
    s = alone(b, b + a * (1.0 + 1e-9)); /* and just beside it */
    assert_true(s.light[0] == 1.0 && s.light[1] == 1.0 && !s.hides[0]);
    s = alone(b, b + a * (1.0 - 1e-6)); /* a sliver: of order 1e-9 */
    assert_true(s.light[0] <= 1.0 && s.light[0] > 1.0 - 1e-8 && s.hides[0]);
  }
  s = alone(a, 0.0); /* equal and concentric, up to rounding */
  assert_true(s.light[0] < 1e-14 && s.light[1] < 1e-14);
  s = alone(a, a); /* published: 0.608997781044229 in the plane */
  assert_true(fabs(s.light[0] - 0.608997781044229) < 1e-5);
}

/* The plane's formula differs by what it says: its limb is curved by 1/b instead of 1/tan b, and
 * the area between the two over a disc of radius a is at most a third of the difference times a^3.
 */
static void test_against_the_plane(void **state) {
  (void)state;
  test_random random = {.seed = 5};
  const double a = sun_angle();
  double worst = 0.0;
  for (int i = 0; i < 4000; i++) {
    const double b = a * random_scale(&random, 0.05, 330.0);
    const double c = fabs(b + a * random_range(&random, -1.1, 1.1));
    const sky s = alone(b, c);
    const double off = fabs(s.light[0] - pl_eclipse_fraction(a, b, c));
    worst = fmax(worst, off);
    assert_true(off < 1e-5 + a * (1.0 / b - 1.0 / tan(b)) / (3.0 * PL_PI));
    assert_true(off < 3.2e-4);
    /* Darkened discs lose less at the edge, more in the middle: by 0.0283 of the light at most for
     * a chord (light/limb_darkening_effect.c), somewhat more for a disc. */
    assert_true(fabs(s.light[1] - s.light[0]) < 0.08);
  }
  print_message("seed 5: %.2g from the plane\n", worst);
}

/* Ellipsoids: with a pole towards the point, a spheroid is a disc of the radius of its limb; turned
 * and scaled alike, everything is as before. */
static void test_ellipsoids(void **state) {
  (void)state;
  const double a = sun_angle();
  test_random random = {.seed = 6};
  for (int i = 0; i < 2000; i++) {
    const double far = 1e8, wide = far * a * random_scale(&random, 0.3, 100.0);
    const double flat = wide * random_scale(&random, 0.1, 3.0);
    if (flat > 0.9 * far)
      continue;
    /* Tangent from (0, far) to (x/wide)^2 + (z/flat)^2 = 1: slope^2 = wide^2 / (far^2 - flat^2). */
    const double b = atan(wide / sqrt(far * far - flat * flat));
    const double c = fabs(b + a * random_range(&random, -0.99, 0.99));
    const pl_vec3 at = {sin(c), 0.0, cos(c)};
    sky s = {.bodies = 1};
    s.poses[0] = (pl_pose){pl_vec3_scale(at, far), pl_quat_axis_angle((pl_vec3){0, 1, 0}, c)};
    s.radii[0] = (pl_vec3){wide, wide, flat};
    solve(&s);
    const sky same = alone(b, c);
    assert_true(fabs(s.light[0] - same.light[0]) < 1e-9 * fmax(1.0, b / a));
    assert_true(fabs(s.light[1] - same.light[1]) < 1e-9 * fmax(1.0, b / a));
  }
}

/* Bodies apart add up; one behind another, or in the same place, changes nothing; in any order. */
static void test_unions(void **state) {
  (void)state;
  const double a = sun_angle();
  sky s = {0}, one = alone(0.4 * a, 0.5 * a), two = alone(0.3 * a, 0.6 * a);
  add_sphere(&s, 0.4 * a, 0.5 * a, 0.3, 1e8);
  add_sphere(&s, 0.3 * a, 0.6 * a, 0.3 + PL_PI, 2e8);
  solve(&s);
  for (int band = 0; band < BANDS; band++)
    assert_true(fabs(s.light[band] - (one.light[band] + two.light[band] - 1.0)) < 1e-9);
  sky nested = {0};
  add_sphere(&nested, 0.1 * a, 0.5 * a, 0.3, 3e8);
  add_sphere(&nested, 0.4 * a, 0.5 * a, 0.3, 1e8);
  solve(&nested);
  for (int band = 0; band < BANDS; band++)
    assert_true(fabs(nested.light[band] - one.light[band]) < 1e-15);
  assert_true(nested.hides[0] && nested.hides[1]);
  for (int crossing = 0; crossing < 2; crossing++) { /* the same body twice */
    const double b = crossing ? 30.0 * a : 0.4 * a, c = crossing ? 30.3 * a : 0.5 * a;
    sky twice = {0};
    add_sphere(&twice, b, c, 0.3, 1e8);
    add_sphere(&twice, b, c, 0.3, 1e8);
    add_sphere(&twice, b, c, 0.3, 2e8);
    solve(&twice);
    const sky once = alone(b, c);
    for (int band = 0; band < BANDS; band++)
      assert_true(fabs(twice.light[band] - once.light[band]) < 1e-13);
  }
}

/* Limbs that touch within rounding, whichever way they are turned: a body inside the disc at its
 * edge, two bodies of which one touches the other's limb from within, and all three at once. */
static void test_touching(void **state) {
  (void)state;
  const double a = sun_angle();
  for (int i = 0; i < 200; i++) {
    const double turn = 0.0317 * i, b = 0.01 * a * (1 + i % 99);
    sky inner = {0}, pair = {0}, alone_outer = {0};
    add_sphere(&inner, b, a - b, turn, 1e8);
    solve(&inner);
    assert_true(fabs(inner.light[0] - (1.0 - b * b / (a * a))) < 1e-5);
    add_sphere(&pair, b, b + 0.1 * a, turn, 1e8);
    add_sphere(&pair, 3.0 * b, 3.0 * b + 0.1 * a, turn, 2e8);
    solve(&pair);
    add_sphere(&alone_outer, 3.0 * b, 3.0 * b + 0.1 * a, turn, 2e8);
    solve(&alone_outer);
    for (int band = 0; band < BANDS; band++)
      assert_true(fabs(pair.light[band] - alone_outer.light[band]) < 1e-9);
    add_sphere(&inner, 1.5 * b, a - 1.5 * b, turn, 1.1e8);
    add_sphere(&inner, 0.5 * b, a - 0.5 * b, turn, 0.9e8);
    solve(&inner);
    sky outer = {0};
    add_sphere(&outer, 1.5 * b, fabs(a - 1.5 * b), a > 1.5 * b ? turn : turn + PL_PI, 1.1e8);
    solve(&outer);
    for (int band = 0; band < BANDS; band++)
      if (!(fabs(inner.light[band] - outer.light[band]) < 1e-9))
        fail_msg("%d %g %d: %.15g %.15g", i, b / a, band, inner.light[band], outer.light[band]);
  }
}

/* A fraction stays one, falls when a body is added or grows, and two bodies never take more than
 * each alone does. */
static void test_invariants(void **state) {
  (void)state;
  test_random random = {.seed = 7};
  const double a = sun_angle();
  for (int i = 0; i < 3000; i++) {
    sky s = {0}, before = {.light = {1.0, 1.0}};
    double taken[BANDS] = {0.0, 0.0};
    for (int k = 0; k < BODIES; k++) {
      const double b = a * random_scale(&random, 0.05, 100.0);
      const double c = fabs(b + a * random_range(&random, -0.9, 1.1));
      const double turn = random_range(&random, 0.0, 6.3);
      sky lone = {0};
      add_sphere(&lone, b, c, turn, 1e8);
      solve(&lone);
      add_sphere(&s, b, c, turn, 1e8);
      s.radii[k].z *= random_range(&random, 0.7, 1.0); /* oblate: hides less than the sphere */
      solve(&s);
      for (int band = 0; band < BANDS; band++) {
        taken[band] += 1.0 - lone.light[band];
        assert_true(s.light[band] >= 0.0 && s.light[band] <= before.light[band] + 1e-12);
        assert_true(1.0 - s.light[band] <= taken[band] + 1e-9);
      }
      before = s;
    }
  }
}

/* Every limb point has depth 0, and the turn that it was made with. */
static void test_cone(void **state) {
  (void)state;
  test_random random = {.seed = 9};
  for (int i = 0; i < 3000; i++) {
    const pl_vec3 radii = {random_scale(&random, 1.0, 10.0), random_scale(&random, 1.0, 10.0), 3.0};
    const pl_vec3 point = pl_vec3_scale(random_direction(&random), random_scale(&random, 11, 1e4));
    const pl_quat q =
        pl_quat_axis_angle(random_direction(&random), random_range(&random, 0.0, 3.0));
    pl_cone cone;
    assert_true(
        pl_cone_make((pl_pose){{0, 0, 0}, q}, radii, point, random_direction(&random), &cone));
    const double turn = random_range(&random, -3.1, 3.1);
    const pl_vec3 limb = pl_cone_limb(&cone, turn);
    assert_true(fabs(pl_cone_depth(&cone, limb)) < 2e-14);
    assert_true(fabs(pl_cone_turn(&cone, limb) - turn) < 1e-10);
    assert_true(pl_cone_depth(&cone, pl_vec3_scale(point, -1.0)) > 0.0);
    assert_true(pl_cone_depth(&cone, point) < 0.0);
    /* Touched once: at the foot of the centre on the line, in scaled axes. */
    const pl_vec3 u = pl_mat3_mul_vec(cone.scaled, limb);
    const pl_vec3 foot = pl_vec3_madd(cone.p, -pl_vec3_dot(cone.p, u) / pl_vec3_dot(u, u), u);
    assert_true(fabs(pl_vec3_norm(foot) - 1.0) < 1e-9);
  }
}

/* A body beyond the sun, about the sun or around the point; the point in the sun; bad numbers. */
static void test_edges(void **state) {
  (void)state;
  const double a = sun_angle();
  sky s = {0};
  add_sphere(&s, 2.0 * a, 0.0, 0.0, 1.1 * AU);
  s.poses[1] = (pl_pose){{0, 0, AU}, PL_QUAT_IDENTITY};
  s.radii[1] = (pl_vec3){SUN_M, SUN_M, SUN_M};
  s.bodies = 2;
  solve(&s);
  assert_true(s.light[0] == 1.0 && !s.hides[0] && !s.hides[1]);
  s = (sky){.bodies = 1, .poses[0] = {{10, 0, 0}, PL_QUAT_IDENTITY}, .radii[0] = {11, 30, 30}};
  solve(&s);
  assert_true(s.light[0] == 0.0 && s.light[1] == 0.0 && s.hides[0]);
  s.radii[0].x = 9.0;
  solve(&s);
  assert_true(s.light[0] > 0.0); /* a plate beside the point, its edge towards the sun */
  s.bodies = 0;
  solve(&s);
  assert_true(s.light[0] == 1.0);

  const pl_vec3 inside = {0, 0, AU - 0.5 * SUN_M}, sun = {0, 0, AU}, good = {1, 1, 1};
  const pl_vec3 bad = {NAN, 0, 0}, flat = {1, 0, 1}, here = {0, 0, 0};
  const pl_pose pose = {{0, 0, 9e9}, PL_QUAT_IDENTITY}, lost = {{INFINITY, 0, 0}, pose.q};
  const double um = 0.5, minus = -1.0;
  double light;
  uint8_t hides;
  const pl_occultation_result out = {&light, &hides};
  const pl_occultation fine = {1, 1, 1, SUN_M, &here, &sun, &pose, &good, &um, 8};
  assert_int_equal(pl_occultation_solve(&fine, &out), PL_OK);
  pl_occultation wrong[8];
  for (int i = 0; i < 8; i++)
    wrong[i] = fine;
  wrong[0].points = &inside;
  wrong[1].sun_m = &bad;
  wrong[2].poses = &lost;
  wrong[3].radii_m = &flat;
  wrong[4].wavelength_um = &minus;
  wrong[5].nodes = 0;
  wrong[6].nodes = 65;
  wrong[7].sun_radius_m = 0.0;
  for (int i = 0; i < 8; i++)
    assert_int_equal(pl_occultation_solve(&wrong[i], &out), PL_E_RANGE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_analytic),   cmocka_unit_test(test_against_the_plane),
      cmocka_unit_test(test_ellipsoids), cmocka_unit_test(test_unions),
      cmocka_unit_test(test_touching),   cmocka_unit_test(test_invariants),
      cmocka_unit_test(test_cone),       cmocka_unit_test(test_edges),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
