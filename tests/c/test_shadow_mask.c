/* The channel `shadow` beside spheres and cubes met in closed form. */
#include "harness.h"

#include "frames.h"

static const double AU = 149597870700.0;
enum { WIDTH = 64, HEIGHT = 48, PIXELS = WIDTH * HEIGHT, SPHERES = 3, CUBES = 2 };
static const double SIDE = 4.0;

/* A large sphere, a smaller one and a cube in front of it, and a sphere and a cube outside of the
 * frame that hide the sun from a part of what is seen. */
static void lay_out(stage *s, const pl_model *cube, test_random *random) {
  stage_init(s, WIDTH, HEIGHT, 50.0);
  const pl_vec3 sun = pl_vec3_unit(
      (pl_vec3){random_range(random, 0.5, 2.0), random_range(random, -0.7, 0.7), -0.4});
  s->placement.sun.position_m = pl_vec3_scale(sun, AU);
  stage_add_body(s, (pl_vec3){0, 0, 160}, (pl_vec3){110, 110, 110}, 0.5f);
  stage_add_body(s, (pl_vec3){random_range(random, -9, -3), random_range(random, -5, 5), 38},
                 (pl_vec3){5, 5, 5}, 0.5f);
  stage_add_body(s, pl_vec3_madd((pl_vec3){4, random_range(random, -9, 9), 50}, 300.0, sun),
                 (pl_vec3){9, 9, 9}, 0.5f);
  const pl_vec3 at = {random_range(random, 2, 9), random_range(random, -7, 7), 36};
  stage_add_object(s, cube, at, random_rotation(random), SIDE);
  stage_add_object(s, cube, pl_vec3_madd((pl_vec3){-6, 4, 44}, 120.0, sun), random_rotation(random),
                   SIDE);
}

static bool meets_sphere(const stage *s, size_t k, pl_vec3 p, pl_vec3 d, double scale) {
  const pl_vec3 to = pl_vec3_sub(s->bodies[k].motion.open.t, p);
  const double along = pl_vec3_dot(to, d), r = scale * s->bodies[k].radii_m.x;
  return along > 0.0 && pl_vec3_dot(to, to) - along * along < r * r;
}

static bool meets_cube(const stage *s, size_t k, pl_vec3 p, pl_vec3 d, double scale) {
  const pl_pose pose = s->objects[k].motion.open;
  const pl_mat3 m = pl_mat3_from_quat(pose.q);
  const pl_vec3 o = pl_mat3_mul_vec_t(m, pl_vec3_sub(p, pose.t)), w = pl_mat3_mul_vec_t(m, d);
  const double from[3] = {o.x, o.y, o.z}, way[3] = {w.x, w.y, w.z};
  double near = 0.0, far = INFINITY;
  for (int i = 0; i < 3; i++) {
    const double a = (-0.5 * scale * SIDE - from[i]) / way[i];
    const double b = (0.5 * scale * SIDE - from[i]) / way[i];
    near = fmax(near, fmin(a, b));
    far = fmin(far, fmax(a, b));
  }
  return near < far;
}

/* Whether anything but what is seen itself, all of it convex, hides the sun from a point. */
static bool hidden(const stage *s, int32_t seen, pl_vec3 p, pl_vec3 sun, double scale) {
  bool found = false;
  for (size_t k = 0; k < SPHERES; k++)
    found |= (int32_t)(1 + k) != seen && meets_sphere(s, k, p, sun, scale);
  for (size_t k = 0; k < CUBES; k++)
    found |= (int32_t)(1 + SPHERES + k) != seen && meets_cube(s, k, p, sun, scale);
  return found;
}

typedef struct counts {
  int away, cast, lit, unsure;
} counts;

static void check_pixels(const stage *s, const film *f, counts *n) {
  const double *points = film_channel(f, "position");
  const float *normals = film_channel(f, "geometric_normal");
  const int32_t *ids = film_channel(f, "instance");
  const uint8_t *shadow = film_channel(f, "shadow");
  for (size_t i = 0; i < PIXELS; i++) {
    if (ids[i] == 0) {
      assert_int_equal(shadow[i], 0);
      continue;
    }
    const pl_vec3 p = {points[3 * i], points[3 * i + 1], points[3 * i + 2]};
    const pl_vec3 normal = {normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]};
    const pl_vec3 sun = pl_vec3_unit(pl_vec3_sub(s->placement.sun.position_m, p));
    const double facing = pl_vec3_dot(normal, sun); /* camera axes are those of the root */
    const bool cast = hidden(s, ids[i], p, sun, 0.9999);
    if (fabs(facing) < 1e-6 || cast != hidden(s, ids[i], p, sun, 1.0001)) {
      n->unsure++;
      continue;
    }
    assert_int_equal(shadow[i], facing < 0.0 || cast);
    n->away += facing < 0.0;
    n->cast += facing > 0.0 && cast;
    n->lit += facing > 0.0 && !cast;
  }
}

static film shoot(const stage *s, bool colour, double tolerance_dn, int threads) {
  film f;
  pl_renderer *renderer;
  film_init(&f, s);
  pl_frame_request request = request_all(s, &f);
  request.samples = 2;
  request.max_bounces = 0;
  request.threads = threads;
  request.wish.tolerance_dn = tolerance_dn;
  if (!colour) {
    request.rgb = NULL;
    request.radiance = NULL;
  }
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  render(renderer, &request);
  pl_renderer_destroy(renderer);
  return f;
}

static void test_spheres_and_cubes(void **state) {
  (void)state;
  pl_model *cube = cube_create(0.5);
  test_random random = {41, 0};
  counts n = {0};
  for (int k = 0; k < 12; k++) {
    stage s;
    lay_out(&s, cube, &random);
    film f = shoot(&s, k % 2 == 0, 0.5, 1);
    check_pixels(&s, &f, &n);
    film_clear(&f);
    stage_clear(&s);
  }
  print_message("%d away, %d cast, %d lit, %d unsure\n", n.away, n.cast, n.lit, n.unsure);
  assert_true(n.away > 1000 && n.cast > 1000 && n.lit > 10000 && n.unsure < 50);
  pl_model_destroy(cube);
}

/* Neither colour nor a tolerance that leaves shadows out, nor threads. */
static void test_nothing_else_matters(void **state) {
  (void)state;
  pl_model *cube = cube_create(0.5);
  test_random random = {42, 0};
  stage s;
  lay_out(&s, cube, &random);
  film first = shoot(&s, true, 0.0, 1);
  const double tolerances[] = {0.5, 255.0, 0.5, 255.0};
  for (int k = 0; k < 4; k++) {
    film f = shoot(&s, k < 2, tolerances[k], 3);
    assert_memory_equal(film_channel(&first, "shadow"), film_channel(&f, "shadow"), PIXELS);
    film_clear(&f);
  }
  film_clear(&first);
  stage_clear(&s);
  pl_model_destroy(cube);
}

/* Of an exposure while casters move: that of its middle. */
static void test_middle_of_an_exposure(void **state) {
  (void)state;
  pl_model *cube = cube_create(0.5);
  test_random random = {43, 0};
  stage s;
  lay_out(&s, cube, &random);
  film still_film = shoot(&s, false, 0.5, 1);
  const pl_vec3 by = {0, 4, 0};
  s.placement.shutter.exposure_s = 1.0;
  for (int away = 0; away < 2; away++) {
    for (size_t k = 1; k < SPHERES; k++) {
      pl_motion *motion = &s.bodies[k].motion;
      const pl_vec3 middle = away == 0 ? motion->open.t : motion->close.t;
      motion->open.t = pl_vec3_sub(middle, by);
      motion->close.t = pl_vec3_add(middle, by);
    }
    film f = shoot(&s, true, 0.5, 1);
    const uint8_t *a = film_channel(&still_film, "shadow"), *b = film_channel(&f, "shadow");
    int differing = 0;
    for (size_t i = 0; i < PIXELS; i++)
      differing += a[i] != b[i];
    if (away == 0)
      assert_true(differing <= 2);
    else
      assert_true(differing > 30); /* the other end is another picture */
    film_clear(&f);
  }
  film_clear(&still_film);
  stage_clear(&s);
  pl_model_destroy(cube);
}

/* A body in the place of the sun is lit, though it faces away from the sun's centre. */
static void test_the_sun_itself(void **state) {
  (void)state;
  stage s;
  stage_init(&s, WIDTH, HEIGHT, 6000.0);
  s.placement.sun.position_m = (pl_vec3){0, 0, AU};
  const double r = s.placement.sun.radius_m;
  stage_add_body(&s, s.placement.sun.position_m, (pl_vec3){r, r, r}, 0.5f);
  film f = shoot(&s, false, 0.5, 1);
  const int32_t *ids = film_channel(&f, "instance");
  const uint8_t *shadow = film_channel(&f, "shadow");
  int seen = 0;
  for (size_t i = 0; i < PIXELS; i++) {
    assert_int_equal(shadow[i], 0);
    seen += ids[i] != 0;
  }
  assert_true(seen > PIXELS / 2);
  film_clear(&f);
  stage_clear(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_spheres_and_cubes),
      cmocka_unit_test(test_nothing_else_matters),
      cmocka_unit_test(test_middle_of_an_exposure),
      cmocka_unit_test(test_the_sun_itself),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
