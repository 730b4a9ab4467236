/* Images of rims against projected points, a published example, and the hard poses. */
#include "harness.h"

#include "annotate/rim_image.h"
#include "random.h"

static void near(double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance))
    fail_msg("%.12g, expected %.12g", value, expected);
}

static const pl_pinhole camera = {1000.0, 1000.0, 512.0, 384.0, 0.0};

static pl_vec3 point_of(const pl_rim *rim, double t) {
  return pl_vec3_madd(pl_vec3_madd(rim->centre, cos(t), rim->major), sin(t), rim->minor);
}

static void project(const pl_pinhole *k, pl_vec3 p, double uv[2]) {
  uv[0] = (k->fx * p.x + k->skew * p.y) / p.z + k->cx;
  uv[1] = k->fy * p.y / p.z + k->cy;
}

/* A circle about `centre` with a normal, of which `major` and `minor` are some axes. */
static pl_rim circle_of(pl_vec3 centre, pl_vec3 normal, double radius) {
  const pl_vec3 n = pl_vec3_unit(normal);
  const pl_vec3 other = fabs(n.x) < 0.5 ? (pl_vec3){1, 0, 0} : (pl_vec3){0, 1, 0};
  const pl_vec3 a = pl_vec3_unit(pl_vec3_cross(n, other));
  return (pl_rim){centre, pl_vec3_scale(a, radius), pl_vec3_scale(pl_vec3_cross(n, a), radius)};
}

/* Camera at (0, -300, 500) that looks at the origin with z up; circle at (20, 30, 0), normal
 * (0.1, -0.2, 1), radius 100: computed with other code, its box from 2e6 points. */
static void test_reference(void **state) {
  (void)state;
  const pl_vec3 eye = {0.0, -300.0, 500.0}, up = {0.0, 0.0, 1.0};
  const pl_vec3 z = pl_vec3_unit(pl_vec3_scale(eye, -1.0));
  const pl_vec3 x = pl_vec3_unit(pl_vec3_cross(z, up)), y = pl_vec3_cross(z, x);
  const pl_vec3 c = pl_vec3_sub((pl_vec3){20.0, 30.0, 0.0}, eye), n = {0.1, -0.2, 1.0};
  const pl_rim rim =
      circle_of((pl_vec3){pl_vec3_dot(x, c), pl_vec3_dot(y, c), pl_vec3_dot(z, c)},
                (pl_vec3){pl_vec3_dot(x, n), pl_vec3_dot(y, n), pl_vec3_dot(z, n)}, 100.0);
  const pl_rim_image image = pl_rim_project(&rim, &camera, 1.0);
  assert_int_equal(image.kind, PL_RIM_ELLIPSE);
  near(image.centre[0], 542.9670695941949, 1e-9);
  near(image.centre[1], 349.66098148356645, 1e-9);
  near(image.semi_axes[0], 167.38723754260914, 1e-9);
  near(image.semi_axes[1], 154.1411670316337, 1e-9);
  near(image.angle_rad, 18.687452726909587 * PL_PI / 180.0, 1e-11);
  const double box[4] = {376.8910002943, 194.1080134248, 709.0431388941, 505.2139495424};
  for (int k = 0; k < 4; k++)
    near(image.box[k], box[k], 1e-8);
  assert_true(image.facing > 0.0);
}

/* Distance of an ellipse's point in the direction of a point from the centre, to that point. */
static double off(const pl_rim_image *image, const double uv[2]) {
  const double c = cos(image->angle_rad), s = sin(image->angle_rad);
  const double du = uv[0] - image->centre[0], dv = uv[1] - image->centre[1];
  const double x = (c * du + s * dv) / image->semi_axes[0];
  const double y = (c * dv - s * du) / image->semi_axes[1];
  return fabs(1.0 - 1.0 / hypot(x, y)) * hypot(du, dv);
}

/* Rims of any size, ellipticity, distance and tilt: projected points lie on the ellipse and in the
 * box, which they touch. */
static void test_points(void **state) {
  (void)state;
  test_random random = {.seed = 12};
  int seen = 0;
  for (int k = 0; k < PL_DRAWS(20000, 500); k++) {
    const pl_pinhole skewed = {random_scale(&random, 100.0, 1e4), random_scale(&random, 100.0, 1e4),
                               random_range(&random, -100.0, 5e3), 384.0,
                               random_range(&random, -50.0, 50.0)};
    const double radius = random_scale(&random, 0.01, 1e5);
    const double away = radius * random_scale(&random, 0.1, 1e5);
    pl_vec3 centre = pl_vec3_scale(random_direction(&random), away);
    centre.z = fabs(centre.z);
    pl_rim rim = circle_of(centre, random_direction(&random), radius);
    rim.minor = pl_vec3_scale(rim.minor, random_range(&random, 0.3, 1.0));
    const double near_m = 1e-4 * radius;
    const pl_rim_image image = pl_rim_project(&rim, &skewed, near_m);
    if (image.kind != PL_RIM_ELLIPSE || image.semi_axes[0] > 5e3)
      continue;
    seen++;
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int step = 0; step < 720; step++) {
      double uv[2];
      project(&skewed, point_of(&rim, step * PL_PI / 360.0), uv);
      if (image.semi_axes[1] > 1e-3 * image.semi_axes[0] && step % 24 == 0)
        near(off(&image, uv), 0.0, 2e-6);
      for (int i = 0; i < 2; i++) {
        assert_true(uv[i] > image.box[i] - 1e-7 && uv[i] < image.box[i + 2] + 1e-7);
        low[i] = fmin(low[i], uv[i]);
        high[i] = fmax(high[i], uv[i]);
      }
    }
    for (int i = 0; i < 2; i++) {
      const double width = image.box[i + 2] - image.box[i];
      assert_true(low[i] - image.box[i] < 0.01 * width + 1e-7);
      assert_true(image.box[i + 2] - high[i] < 0.01 * width + 1e-7);
    }
  }
  assert_true(seen > PL_DRAWS(5000, 100));
}

/* Seen edge-on the rim is a segment: no NaN, no width, its ends in the box. */
static void test_edge_on(void **state) {
  (void)state;
  const pl_rim rim = {{0.0, 0.0, 100.0}, {10.0, 0.0, 0.0}, {0.0, 0.0, 10.0}};
  const pl_rim_image image = pl_rim_project(&rim, &camera, 0.1);
  assert_int_equal(image.kind, PL_RIM_ELLIPSE);
  near(image.semi_axes[1], 0.0, 1e-9);
  near(image.angle_rad, 0.0, 1e-9);
  near(image.facing, 0.0, 1e-15);
  const double half = 1000.0 * 10.0 / sqrt(1e4 - 100.0);
  near(image.semi_axes[0], half, 1e-9);
  near(image.box[0], 512.0 - half, 1e-9);
  near(image.box[2], 512.0 + half, 1e-9);
  near(image.box[1], 384.0, 1e-9);
  near(image.box[3], 384.0, 1e-9);
}

/* With the camera in the crater, the rim is cut by the camera's plane. Its box is that
 * of the points before the near plane, not that of a hyperbola turned inside out. */
static void test_across_the_camera(void **state) {
  (void)state;
  test_random random = {.seed = 4};
  int seen = 0;
  for (int k = 0; k < PL_DRAWS(2000, 100); k++) {
    const pl_vec3 centre =
        pl_vec3_scale(random_direction(&random), random_range(&random, 1.0, 9.0));
    const pl_rim rim = circle_of(centre, random_direction(&random), 10.0);
    const pl_rim_image image = pl_rim_project(&rim, &camera, 0.5);
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int step = 0; step < 7200; step++) {
      const pl_vec3 p = point_of(&rim, step * PL_PI / 3600.0);
      double uv[2];
      if (p.z < 0.5)
        continue;
      project(&camera, p, uv);
      for (int i = 0; i < 2; i++) {
        assert_true(uv[i] > image.box[i] - 1e-6 && uv[i] < image.box[i + 2] + 1e-6);
        low[i] = fmin(low[i], uv[i]);
        high[i] = fmax(high[i], uv[i]);
      }
    }
    if (image.kind != PL_RIM_PARTLY)
      continue;
    seen++;
    for (int i = 0; i < 2; i++) {
      const double slack = 0.02 * (image.box[i + 2] - image.box[i]) + 60.0;
      assert_true(low[i] - image.box[i] < slack && image.box[i + 2] - high[i] < slack);
    }
  }
  assert_true(seen > PL_DRAWS(500, 20));
}

static void test_behind(void **state) {
  (void)state;
  const pl_rim rim = circle_of((pl_vec3){0.0, 0.0, -100.0}, (pl_vec3){0.0, 0.3, 1.0}, 10.0);
  assert_int_equal(pl_rim_project(&rim, &camera, 0.1).kind, PL_RIM_BEHIND);
}

/* The rim of a crater on a sphere, in body axes: `direction` of the centre and `major` axis are
 * unit and orthogonal. Large craters follow the sphere: their plane lies below its surface. */
static pl_rim rim_on_sphere(pl_vec3 direction, pl_vec3 major, double diameter_m, double axis_ratio,
                            double radius_m) {
  const double angle = 0.5 * diameter_m / radius_m, root = sqrt(axis_ratio);
  const pl_vec3 minor = pl_vec3_cross(direction, major);
  return (pl_rim){pl_vec3_scale(direction, radius_m * cos(angle)),
                  pl_vec3_scale(major, radius_m * sin(angle / root)),
                  pl_vec3_scale(minor, radius_m * sin(angle * root))};
}

/* From outside the normal faces the camera, from inside the body it does not. */
static void test_on_sphere(void **state) {
  (void)state;
  const double r = 1737400.0, d = 800e3;
  const pl_rim rim = rim_on_sphere((pl_vec3){0, 0, 1}, (pl_vec3){1, 0, 0}, d, 1.0, r);
  for (int k = 0; k < 8; k++) {
    const pl_vec3 p = point_of(&rim, k);
    near(pl_vec3_norm(p), r, 1e-6);
    near(r * acos(p.z / r), 0.5 * d, 1e-3);
  }
  const pl_rim small = rim_on_sphere((pl_vec3){0, 0, 1}, (pl_vec3){0, 1, 0}, 100.0, 0.64, r);
  near(pl_vec3_norm(small.major), 62.5, 1e-6);
  near(pl_vec3_norm(small.minor), 40.0, 1e-6);
  assert_true(pl_vec3_cross(small.major, small.minor).z > 0.0);
  /* A camera above it that looks down: z of the camera is -z of the body. */
  pl_rim seen = {{0, 0, 2e6 - small.centre.z},
                 {small.major.x, -small.major.y, -small.major.z},
                 {small.minor.x, -small.minor.y, -small.minor.z}};
  near(pl_rim_project(&seen, &camera, 1.0).facing, 1.0, 1e-12);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_reference), cmocka_unit_test(test_points),
      cmocka_unit_test(test_edge_on),   cmocka_unit_test(test_across_the_camera),
      cmocka_unit_test(test_behind),    cmocka_unit_test(test_on_sphere),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
