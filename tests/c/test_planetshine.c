/* Light of bodies on a plate against integrals over their surfaces, and the noise of drawing to
 * them against that of meeting them by chance. */
#include "harness.h"

#include <stdio.h>

#include "frames.h"
#include "geom/ellipsoid.h"
#include "math/sampler.h"
#include "math/sampling.h"
#include "random.h"
#include "render/planetshine.h"
#include "scene/shot_frame.h"

static const double AU = 149597870700.0, SOLAR = 1361.0;

/* The plate is here, small, and faces the camera at the root's origin. */
static const pl_vec3 PLATE = {0, 0, 0.05}, FACING = {0, 0, -1};
static const double HALF = 0.05, ALBEDO = 0.5;
enum { WIDTH = 8, HEIGHT = 8, PIXELS = WIDTH * HEIGHT, SAMPLES = PL_DRAWS(4096, 512) };

typedef struct ball {
  pl_vec3 center;
  double radius, albedo;
} ball;

typedef struct world {
  ball balls[2];
  int count;
  pl_vec3 sun; /* unit */
} world;

/* Whether a ball is on the way from a point, before `reach`. */
static bool hides(const ball *b, pl_vec3 from, pl_vec3 direction, double reach) {
  const pl_vec3 to = pl_vec3_sub(b->center, from);
  const double along = pl_vec3_dot(to, direction);
  const double miss2 = pl_vec3_dot(to, to) - along * along;
  if (!(along > 0.0) || !(miss2 < b->radius * b->radius))
    return false;
  return along - sqrt(b->radius * b->radius - miss2) < reach * (1.0 - 1e-9);
}

/* Irradiance of the plate by Lambert balls over that of the sun: the cosine law over what of their
 * surfaces sees both, by the midpoint rule. */
static double expected(const world *w) {
  enum { RINGS = PL_DRAWS(600, 200), TURNS = RINGS };
  double sum = 0.0;
  for (int k = 0; k < w->count; k++) {
    const ball *b = &w->balls[k];
    const pl_vec3 to = pl_vec3_sub(PLATE, b->center);
    const double d = pl_vec3_norm(to);
    const pl_vec3 z = pl_vec3_scale(to, 1.0 / d);
    const pl_vec3 x =
        pl_vec3_unit(pl_vec3_cross(z, fabs(z.x) < 0.5 ? (pl_vec3){1, 0, 0} : (pl_vec3){0, 1, 0}));
    const pl_vec3 y = pl_vec3_cross(z, x);
    /* Rings lie closer below the plate. */
    const double top = sqrt((d - b->radius) * (d + b->radius)), near = d - b->radius;
    for (int i = 0; i < RINGS; i++) {
      const double r0 = near * pow(top / near, (double)i / RINGS);
      const double r1 = near * pow(top / near, (i + 1.0) / RINGS), r = sqrt(r0 * r1);
      /* r^2 = d^2 + R^2 - 2 d R cos(polar), so that the ring's area is 2 pi R r dr/d. */
      const double area = 2.0 * PL_PI * b->radius * 0.5 * (r1 * r1 - r0 * r0) / d / TURNS;
      const double depth = (r - near) * (r + near) / (2.0 * d * b->radius); /* 1 - cosine */
      const double cosine = 1.0 - depth, sine = sqrt(depth * (2.0 - depth));
      for (int j = 0; j < TURNS; j++) {
        const double a = 2.0 * PL_PI * (j + 0.5) / TURNS;
        const pl_vec3 n = pl_vec3_madd(pl_vec3_madd(pl_vec3_scale(z, cosine), sine * cos(a), x),
                                       sine * sin(a), y);
        const pl_vec3 p = pl_vec3_madd(b->center, b->radius, n);
        const pl_vec3 in = pl_vec3_unit(pl_vec3_sub(p, PLATE));
        const double lit = pl_vec3_dot(n, w->sun), facing = pl_vec3_dot(in, FACING);
        if (!(lit > 0.0) || !(facing > 0.0))
          continue;
        const ball *other = &w->balls[1 - k];
        if (w->count > 1 && (hides(other, PLATE, in, r) || hides(other, p, w->sun, INFINITY)))
          continue;
        sum += b->albedo / PL_PI * lit * facing * fmax(-pl_vec3_dot(in, n), 0.0) * area / (r * r);
      }
    }
  }
  return sum;
}

/* Irradiance of the plate in a frame, over that of the sun. */
static double rendered(const world *w, const char *off) {
  stage s;
  film f;
  pl_renderer *renderer;
  pl_model *plate = square_create(HALF);
  plate->materials[0].lambert = true;
  for (int k = 0; k < 3; k++)
    plate->materials[0].base_color[k] = (float)ALBEDO;
  stage_init(&s, WIDTH, HEIGHT, 40.0);
  s.placement.sun.position_m = pl_vec3_scale(w->sun, AU);
  s.placement.sun.radius_m = 1e6; /* the integral is of a point */
  stage_add_object(&s, plate, PLATE, PL_QUAT_IDENTITY, 1.0);
  for (int k = 0; k < w->count; k++) {
    const double r = w->balls[k].radius;
    stage_add_body(&s, w->balls[k].center, (pl_vec3){r, r, r}, (float)w->balls[k].albedo);
  }
  film_init(&f, &s);
  pl_frame_request request = request_all(&s, &f);
  request.samples = SAMPLES;
  request.max_bounces = 1;
  request.exposure = (pl_exposure){.white_radiance = 1e-12};
  request.wish = (pl_plan_wish){.force_on = one_effect("antialiasing"),
                                .force_off = off != NULL ? one_effect(off) : no_effects()};
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  render(renderer, &request);
  double sum = 0.0;
  for (int i = 0; i < 3 * PIXELS; i++)
    sum += (double)f.radiance[i] / (3 * PIXELS);
  pl_renderer_destroy(renderer);
  film_clear(&f);
  stage_clear(&s);
  pl_model_destroy(plate);
  return sum * PL_PI / ALBEDO / SOLAR;
}

/* At an angle from where the plate faces, in the plane of x. */
static pl_vec3 aside(double degrees) {
  return (pl_vec3){sin(degrees * PL_PI / 180.0), 0, -cos(degrees * PL_PI / 180.0)};
}

static void compare(const char *what, const world *w, double exact, double tolerance) {
  const double found = rendered(w, NULL);
  print_message("%-44s %.5g of the sun, %+.2f %%\n", what, found, 100.0 * (found / exact - 1.0));
  assert_true(fabs(found / exact - 1.0) < PL_DRAWS(1.0, 3.0) * tolerance);
}

/* A Lambert sphere far away: irradiance albedo (R/d)^2 2/3 F(phase) cos(tilt), where F = (sin(a) +
 * (pi - a) cos(a))/pi (Russell 1916; Lester, McCall and Tatum 1979). */
static void test_far_sphere(void **state) {
  (void)state;
  static const struct far_case {
    double tilt, phase, distance;
  } cases[] = {{0, 0, 1e3},    {0, 85, 1e3},  {60, 0, 1e3}, {60, 90, 1e3},
               {60, 145, 1e4}, {30, 60, 1e4}, {0, 0, 1e5},  {40, 125, 1e5}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i += PL_DRAWS(1, 5)) {
    const double a = cases[i].phase * PL_PI / 180.0, t = cases[i].tilt * PL_PI / 180.0;
    const double radius = 100.0, f = (sin(a) + (PL_PI - a) * cos(a)) / PL_PI;
    char what[80];
    world w = {.count = 1};
    w.balls[0] =
        (ball){pl_vec3_scale(aside(cases[i].tilt), radius * cases[i].distance), radius, 0.3};
    w.sun = aside(cases[i].tilt + 180.0 - cases[i].phase);
    assert_true(pl_vec3_dot(w.sun, FACING) < -0.01); /* does not light the plate itself */
    snprintf(what, sizeof what, "tilt %g, phase %g, %g radii away", cases[i].tilt, cases[i].phase,
             cases[i].distance);
    compare(what, &w, 0.2 * f * cos(t) / pow(cases[i].distance, 2.0), 0.01);
  }
}

/* From low orbits to 1 m above the ground, tilted until the planet is half below the plate. */
static void test_near_sphere(void **state) {
  (void)state;
  static const struct near_case {
    double tilt, phase, height, radius;
  } cases[] = {{0, 0, 0.06e6, 1e6},   {0, 80, 0.06e6, 1e6},   {45, 30, 0.06e6, 1e6},
               {90, 40, 0.06e6, 1e6}, {120, 70, 0.06e6, 1e6}, {60, 85, 0.3e6, 1e6},
               {0, 45, 1.0, 1e6},     {0, 45, 1.0, 1e8},      {80, 60, 2e6, 1e6}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i += PL_DRAWS(1, 5)) {
    char what[80];
    world w = {.count = 1};
    w.balls[0] =
        (ball){pl_vec3_madd(PLATE, cases[i].height + cases[i].radius, aside(cases[i].tilt)),
               cases[i].radius, 0.8};
    w.sun = aside(cases[i].tilt + 180.0 - cases[i].phase);
    assert_true(pl_vec3_dot(w.sun, FACING) < -0.01); /* does not light the plate itself */
    snprintf(what, sizeof what, "tilt %g, phase %g, %g m above %g m", cases[i].tilt, cases[i].phase,
             cases[i].height, cases[i].radius);
    compare(what, &w, expected(&w), 0.01);
  }
}

/* Two bodies: side by side; one before the other; one in the shadow of the other. */
static void test_two_spheres(void **state) {
  (void)state;
  world w = {.count = 2, .sun = {0.3, 0.1, 0.8}};
  w.sun = pl_vec3_unit(w.sun);
  w.balls[0] = (ball){{2e6, 0, -5e6}, 1e6, 0.3};
  w.balls[1] = (ball){{-8e6, 3e6, -9e6}, 4e6, 0.9};
  compare("side by side", &w, expected(&w), 0.01);
  w.balls[1] = (ball){{0.8e6, 0.2e6, -2.5e6}, 0.3e6, 0.05};
  compare("one before the other", &w, expected(&w), 0.01);
  w.balls[1].center = pl_vec3_madd(w.balls[0].center, 2e6, w.sun);
  w.balls[1].center.x += 0.2e6;
  w.balls[1].radius = 0.8e6;
  compare("one in the shadow of the other", &w, expected(&w), 0.01);
}

/* Without the row the plate is black: nothing else lights it. With it, it is as bright as without
 * the other rows that are of no use here. */
static void test_off(void **state) {
  (void)state;
  world w = {.count = 1, .sun = {0, 0, 1}};
  w.balls[0] = (ball){{0, 0, -3e6}, 1e6, 0.5};
  assert_true(rendered(&w, "planetshine") == 0.0);
  const double lit = rendered(&w, NULL);
  assert_true(rendered(&w, "body_bounces") == lit);
  assert_true(lit > 0.0);
}

/* What one draw says of the light of Lambert balls on a Lambert surface: mean, and mean square. */
typedef struct moments {
  double mean, square;
} moments;

static moments draw_light(const world *w, const pl_planetshine_ray *shine, const pl_surface *s) {
  enum { DRAWS = 1 << 15 };
  moments out = {0.0, 0.0};
  const pl_vec3f wo = {0, 0, 1};
  for (uint32_t i = 0; i < DRAWS; i++) {
    float u[2], choice[2];
    pl_planetshine_draw drawn;
    pl_sample_2d(i, 3, 0, u);
    pl_sample_2d(i, 3, 1, choice);
    if (!pl_planetshine_sample(shine, s, wo, u, choice[0], &drawn))
      continue;
    const pl_vec3 v = pl_vec3f_to_double(drawn.direction);
    const pl_vec3 to = pl_vec3_sub(w->balls[0].center, PLATE);
    const double r = w->balls[0].radius, along = pl_vec3_dot(to, v);
    const double gap2 = r * r - (pl_vec3_dot(to, to) - along * along);
    if (!(gap2 > 0.0) || !(along > 0.0))
      continue;
    const pl_vec3 p = pl_vec3_madd(PLATE, along - sqrt(gap2), v);
    const double lit = pl_vec3_dot(pl_vec3_sub(p, w->balls[0].center), w->sun) / r;
    const double light = (double)drawn.weight.y * w->balls[0].albedo * fmax(lit, 0.0);
    out.mean += light / DRAWS;
    out.square += light * light / DRAWS;
  }
  return out;
}

/* Draws to what is lit scatter far less than draws by the lobe alone, and agree with them. */
static void test_noise(void **state) {
  (void)state;
  static const struct noise_case {
    double distance, phase, least; /* radii, degrees; ratio of the variances */
  } cases[] = {{1.06, 60, 0.99}, {2.0, 0, 5.0},    {2.0, 60, 7.0},   {6.6, 60, 30.0},
               {6.6, 120, 25.0}, {60.0, 0, 300.0}, {60.0, 90, 700.0}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i += PL_DRAWS(1, 3)) {
    stage s;
    pl_arena arena;
    pl_snapshot shot;
    pl_planetshine planetshine;
    pl_planetshine_ray shine, none = {.fraction = 0.0f};
    const pl_render_settings settings = {.white_radiance = 1.0f, .detail = PL_DETAIL_FULL};
    pl_model *plate = square_create(HALF);
    world w = {.count = 1, .sun = aside(180.0 - cases[i].phase)};
    w.balls[0] = (ball){pl_vec3_madd(PLATE, 1e6 * cases[i].distance, FACING), 1e6, 0.3};
    stage_init(&s, WIDTH, HEIGHT, 40.0);
    s.placement.sun.position_m = pl_vec3_scale(w.sun, AU);
    stage_add_object(&s, plate, PLATE, PL_QUAT_IDENTITY, 1.0);
    stage_add_body(&s, w.balls[0].center, (pl_vec3){1e6, 1e6, 1e6}, 0.3f);
    pl_arena_init(&arena);
    assert_int_equal(pl_snapshot_build(&s.scene, &s.placement, &arena, &shot), PL_OK);
    assert_int_equal(pl_planetshine_build(&shot, &settings, &arena, &planetshine), PL_OK);
    pl_vertex vertex = {.position = PLATE};
    vertex.surface = (pl_surface){.color = {0.5f, 0.5f, 0.5f},
                                  .reflectance = &pl_reflectance_lambert,
                                  .ng = pl_vec3_to_float(FACING)};
    pl_surface_set_frame(&vertex.surface, pl_vec3_to_float(FACING), (pl_vec3f){1, 0, 0}, 1.0f);
    pl_planetshine_at(&planetshine, NULL, &vertex, (pl_vec3f){0, 0, 1}, &shine);
    const moments drawn = draw_light(&w, &shine, &vertex.surface);
    const moments chance = draw_light(&w, &none, &vertex.surface);
    const double gain =
        (chance.square - chance.mean * chance.mean) / (drawn.square - drawn.mean * drawn.mean);
    print_message("%g radii, phase %g: fraction %.2f, variance a %.3gth, light %.4f\n",
                  cases[i].distance, cases[i].phase, (double)shine.fraction, gain,
                  drawn.mean / chance.mean);
    assert_true(gain > cases[i].least);
    assert_true(fabs(drawn.mean / chance.mean - 1.0) < (cases[i].distance > 10.0 ? 0.2 : 0.02));
    pl_arena_clear(&arena);
    stage_clear(&s);
    pl_model_destroy(plate);
  }
}

/* Nodes of the tree of bodies that are visited for the skies of `count` moons, which are too small
 * to light each other but for a few neighbours. */
static size_t steps_of(size_t count) {
  enum { MOST = 1000 };
  static pl_body body;
  static pl_body_state state;
  static pl_shot_body bodies[MOST];
  static pl_sphere leaves[MOST];
  pl_arena arena;
  pl_planetshine planetshine;
  const pl_render_settings settings = {.white_radiance = 400.0f, .detail = PL_DETAIL_FULL};
  pl_snapshot shot = {.bodies = bodies, .body_count = count};
  test_random random = {.seed = 5};
  const double side = 100.0 * cbrt((double)count);
  body = (pl_body){.reflectance = &pl_reflectance_lambert};
  state = (pl_body_state){.radii_m = {0.1, 0.1, 0.1}, .albedo = {0.5f, 0.5f, 0.5f}};
  shot.sun = (pl_shot_sun){.position = {0, 0, AU}, .radius_m = 7e8, .irradiance_au = SOLAR};
  for (size_t i = 0; i < count; i++) {
    const pl_vec3 center = {random_range(&random, -side, side), random_range(&random, -side, side),
                            random_range(&random, -side, side)};
    bodies[i] = (pl_shot_body){.body = &body,
                               .state = &state,
                               .center = center,
                               .radius_m = 0.1,
                               .outer_m = 0.1,
                               .rotation = pl_mat3_from_quat(PL_QUAT_IDENTITY),
                               .bounced = true};
    leaves[i] = (pl_sphere){.center = center, .radius_m = 0.1};
  }
  pl_arena_init(&arena);
  assert_int_equal(pl_sphere_tree_build(&arena, leaves, count, &shot.body_tree), PL_OK);
  assert_int_equal(pl_planetshine_build(&shot, &settings, &arena, &planetshine), PL_OK);
  pl_arena_clear(&arena);
  print_message("%zu bodies: %zu steps\n", count, planetshine.steps);
  return planetshine.steps;
}

/* By pairs it would be a hundred times as many. */
static void test_steps_grow_with_the_bodies(void **state) {
  (void)state;
  assert_true(steps_of(1000) < 35 * steps_of(100));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_far_sphere),  cmocka_unit_test(test_near_sphere),
      cmocka_unit_test(test_two_spheres), cmocka_unit_test(test_off),
      cmocka_unit_test(test_noise),       cmocka_unit_test(test_steps_grow_with_the_bodies),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
