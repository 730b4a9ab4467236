/* Rasters: posts to the bit, interpolation, date line, poles, borders, pyramid, errors. */
#include "harness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "random.h"
#include "terrain/raster.h"

static const double DEGREE = PL_PI / 180.0, RADIUS_M = 1737400.0;
static const pl_raster_interpolation BOTH[2] = {PL_INTERPOLATION_BILINEAR, PL_INTERPOLATION_CUBIC};

static pl_raster *make(const pl_raster_frame *frame) {
  pl_raster *raster;
  assert_int_equal(pl_raster_create(frame, &raster), PL_OK);
  return raster;
}

static void assert_close(double a, double b, double within) { assert_true(fabs(a - b) <= within); }

static double value_at(const pl_raster *raster, pl_vec3 d, pl_raster_interpolation how) {
  double u, v;
  assert_true(pl_raster_find(raster, d, &u, &v));
  return pl_raster_value(raster, 0, u, v, how);
}

static pl_vec3 at(double lon_deg, double lat_deg) {
  const double lon = lon_deg * DEGREE, lat = lat_deg * DEGREE;
  return (pl_vec3){cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)};
}

/* A whole body of 36 x 18 cells in steps of 10 degrees, from longitude 0 and the north pole. */
enum { WIDTH = 36, HEIGHT = 18 };
static pl_raster_frame whole(const int16_t *samples) {
  return (pl_raster_frame){.samples = samples,
                           .type = PL_RASTER_INT16,
                           .width = WIDTH,
                           .height = HEIGHT,
                           .scale = 0.5,
                           .offset = 100.0,
                           .x0 = 5.0 * DEGREE,
                           .y0 = 85.0 * DEGREE,
                           .dx = 10.0 * DEGREE,
                           .dy = -10.0 * DEGREE};
}

/* A patch of 40 x 30 posts, 2 m apart, about a place. */
enum { ACROSS = 40, DOWN = 30 };
static pl_raster_frame patch(const float *samples, pl_projection_kind kind) {
  return (pl_raster_frame){.samples = samples,
                           .type = PL_RASTER_FLOAT32,
                           .width = ACROSS,
                           .height = DOWN,
                           .scale = 1.0,
                           .projection = {.kind = kind,
                                          .lon0_rad = 3.6 * DEGREE,
                                          .lat0_rad = -89.0 * DEGREE,
                                          .radius_m = RADIUS_M},
                           .x0 = -39.0,
                           .y0 = 29.0,
                           .dx = 2.0,
                           .dy = -2.0};
}

static void assert_posts(const pl_raster_frame *frame, const double *expected) {
  pl_raster *raster = make(frame);
  for (size_t r = 0; r < frame->height; r++)
    for (size_t c = 0; c < frame->width; c++) {
      const double post = frame->scale * expected[r * frame->width + c] + frame->offset;
      const pl_vec3 d = pl_raster_direction(raster, (double)c, (double)r);
      double u, v;
      assert_true(pl_raster_find(raster, d, &u, &v));
      assert_true(u == (double)c && v == (double)r);
      for (int k = 0; k < 2; k++) {
        assert_true(pl_raster_value(raster, 0, u, v, BOTH[k]) == post);
        assert_true(value_at(raster, d, BOTH[k]) == post);
      }
    }
  pl_raster_destroy(raster);
}

/* Every type, whole body and patches, keeps its posts to the bit. */
static void test_posts(void **state) {
  (void)state;
  test_random random = {.seed = 48};
  static double expected[WIDTH * HEIGHT], floats[ACROSS * DOWN];
  static uint8_t bytes[WIDTH * HEIGHT];
  static int16_t shorts[WIDTH * HEIGHT];
  static uint16_t words[WIDTH * HEIGHT];
  static float samples[ACROSS * DOWN];
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    bytes[i] = (uint8_t)random_below(&random, 256);
    shorts[i] = (int16_t)(random_below(&random, 65536) - 32768);
    words[i] = (uint16_t)random_below(&random, 65536);
  }
  pl_raster_frame frame = whole(shorts);
  for (int i = 0; i < WIDTH * HEIGHT; i++)
    expected[i] = shorts[i];
  assert_posts(&frame, expected);
  frame.samples = words;
  frame.type = PL_RASTER_UINT16;
  frame.scale = 0.1;
  for (int i = 0; i < WIDTH * HEIGHT; i++)
    expected[i] = words[i];
  assert_posts(&frame, expected);
  frame.samples = bytes;
  frame.type = PL_RASTER_UINT8;
  for (int i = 0; i < WIDTH * HEIGHT; i++)
    expected[i] = bytes[i];
  assert_posts(&frame, expected);
  for (int i = 0; i < ACROSS * DOWN; i++)
    floats[i] = (double)(samples[i] = (float)random_range(&random, -1e5, 1e5));
  for (int k = PL_PROJECTION_STEREOGRAPHIC; k <= PL_PROJECTION_ORTHOGRAPHIC; k++) {
    frame = patch(samples, (pl_projection_kind)k);
    assert_posts(&frame, floats);
    frame.x0 = 1e6; /* half a quadrant away, where a post is 1e-6 rad wide */
    assert_posts(&frame, floats);
    frame.dx = 0.02; /* centimetres: rounding of directions is 4e-10 m */
    assert_posts(&frame, floats);
  }
}

/* Rows may be further apart than they are long, as in a window of a larger raster. */
static void test_stride(void **state) {
  (void)state;
  const float samples[] = {1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f, 7.0f, 8.0f};
  pl_raster_frame frame = patch(samples + 1, PL_PROJECTION_ORTHOGRAPHIC);
  frame.width = frame.height = 2;
  frame.stride = 4;
  pl_raster *raster = make(&frame);
  assert_close(pl_raster_value(raster, 0, 0.0, 1.0, PL_INTERPOLATION_BILINEAR), 6.0, 0.0);
  assert_close(pl_raster_value(raster, 0, 1.0, 1.0, PL_INTERPOLATION_CUBIC), 7.0, 0.0);
  assert_close(pl_raster_value(raster, 1, 0.5, 0.5, PL_INTERPOLATION_CUBIC), 4.5, 0.0);
  pl_raster_destroy(raster);
}

/* A plane is reproduced between all posts, edges included, and between means of 2 x 2 of them. */
static void test_planes(void **state) {
  (void)state;
  test_random random = {.seed = 49};
  static float samples[ACROSS * DOWN];
  for (int r = 0; r < DOWN; r++)
    for (int c = 0; c < ACROSS; c++)
      samples[r * ACROSS + c] = (float)(3.0 + 0.25 * c - 0.5 * r);
  const pl_raster_frame frame = patch(samples, PL_PROJECTION_ORTHOGRAPHIC);
  pl_raster *raster = make(&frame);
  for (int i = 0; i < PL_DRAWS(5000, 500); i++)
    for (int level = 0; level < 2; level++) {
      const double inset = 0.5 * ((1 << level) - 1); /* of the outermost cells' centres */
      const double u = random_range(&random, inset, ACROSS - 1.0 - inset);
      const double v = random_range(&random, inset, DOWN - 1.0 - inset);
      for (int k = 0; k < 2; k++)
        assert_close(pl_raster_value(raster, level, u, v, BOTH[k]), 3.0 + 0.25 * u - 0.5 * v, 1e-6);
    }
  pl_raster_destroy(raster);
  for (int i = 0; i < ACROSS * DOWN; i++)
    samples[i] = 0.1f; /* a flat raster is flat to the bit */
  raster = make(&frame);
  for (int i = 0; i < 200; i++)
    for (int k = 0; k < 2; k++)
      assert_true(pl_raster_value(raster, i % 3 == 0, random_range(&random, -0.5, ACROSS - 0.5),
                                  random_range(&random, -0.5, DOWN - 0.5),
                                  BOTH[k]) == (double)0.1f);
  pl_raster_destroy(raster);
}

/* Catmull-Rom: the value between posts by its published weights (-1, 9, 9, -1) / 16 and, by central
 * differences, a slope at posts that is that of the neighbours' chord from both sides. */
static void test_cubic(void **state) {
  (void)state;
  static float samples[ACROSS * DOWN];
  test_random random = {.seed = 50};
  for (int i = 0; i < ACROSS * DOWN; i++)
    samples[i] = (float)random_range(&random, -1.0, 1.0);
  const pl_raster_frame frame = patch(samples, PL_PROJECTION_ORTHOGRAPHIC);
  pl_raster *raster = make(&frame);
  const float *row = samples + 7 * ACROSS;
  for (int c = 1; c < ACROSS - 2; c++) {
    const double p[4] = {(double)row[c - 1], (double)row[c], (double)row[c + 1],
                         (double)row[c + 2]};
    assert_close(pl_raster_value(raster, 0, c + 0.5, 7.0, PL_INTERPOLATION_CUBIC),
                 (9.0 * (p[1] + p[2]) - p[0] - p[3]) / 16.0, 1e-14);
    const double e = 1e-6;
    for (int side = -1; side <= 1; side += 2) {
      const double near = pl_raster_value(raster, 0, c + side * e, 7.0, PL_INTERPOLATION_CUBIC);
      assert_close((near - p[1]) / (side * e), 0.5 * (p[2] - p[0]), 1e-5);
    }
  }
  pl_raster_destroy(raster);
}

/* The value of a smooth function over the whole sphere is continuous across the date line and over
 * the poles; rows registered to cells or to posts, with or without a column that repeats. */
static double smooth(pl_vec3 d) { return 1000.0 * d.x + 500.0 * d.y * d.z + 300.0 * d.z; }

static pl_raster *smooth_raster(float *samples, int columns, bool posts_at_poles) {
  const double step = 3.0 * DEGREE;
  pl_raster_frame frame = {.samples = samples,
                           .type = PL_RASTER_FLOAT32,
                           .width = (size_t)columns,
                           .height = posts_at_poles ? 61 : 60,
                           .scale = 1.0,
                           .x0 = -170.0 * DEGREE,
                           .y0 = (posts_at_poles ? 90.0 : 88.5) * DEGREE,
                           .dx = step,
                           .dy = -step};
  pl_projection plane = {.kind = PL_PROJECTION_CYLINDRICAL};
  assert_int_equal(pl_projection_init(&plane), PL_OK);
  for (size_t r = 0; r < frame.height; r++)
    for (size_t c = 0; c < frame.width; c++)
      samples[r * frame.width + c] = (float)smooth(
          pl_projection_inverse(&plane, frame.x0 + (double)c * step, frame.y0 - (double)r * step));
  pl_raster *raster = make(&frame);
  assert_true(pl_raster_whole(raster));
  return raster;
}

static void test_around(void **state) {
  (void)state;
  static float samples[121 * 61];
  test_random random = {.seed = 51};
  for (int columns = 120; columns <= 121; columns++)
    for (int posts = 0; posts < 2; posts++) {
      pl_raster *raster = smooth_raster(samples, columns, posts);
      for (int i = 0; i < PL_DRAWS(20000, 1000); i++) {
        pl_vec3 d = random_direction(&random);
        if (i % 4 == 0) /* about the date line, the seam and the poles */
          d = at(random_range(&random, -173.0, -167.0), 90.0 * d.z);
        if (i % 4 == 1)
          d = at(random_range(&random, 177.0, 183.0), 90.0 * d.z);
        if (i % 4 == 2)
          d = at(360.0 * d.x, copysign(90.0 - 6.0 * fabs(d.y), d.z));
        assert_close(value_at(raster, d, PL_INTERPOLATION_CUBIC), smooth(d), 0.1);
        assert_close(value_at(raster, d, PL_INTERPOLATION_BILINEAR), smooth(d), 1.5);
        double u, v;
        assert_true(pl_raster_find(raster, d, &u, &v));
        assert_close(pl_raster_weight(raster, u, v, 5.0), 1.0, 0.0);
        assert_close(pl_raster_value(raster, 2, u, v, PL_INTERPOLATION_CUBIC), smooth(d), 25.0);
      }
      for (int side = -1; side <= 1; side += 2)
        assert_close(value_at(raster, (pl_vec3){0.0, 0.0, side}, PL_INTERPOLATION_CUBIC),
                     300.0 * side, 0.6);
      pl_raster_destroy(raster);
    }
}

/* With an odd number of columns half a turn is between two of them. */
static void test_odd_columns(void **state) {
  (void)state;
  const float samples[] = {1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f};
  pl_raster_frame frame = {.samples = samples,
                           .type = PL_RASTER_FLOAT32,
                           .width = 3,
                           .height = 2,
                           .scale = 1.0,
                           .x0 = 0.0,
                           .y0 = 45.0 * DEGREE,
                           .dx = 120.0 * DEGREE,
                           .dy = -90.0 * DEGREE};
  pl_raster *raster = make(&frame);
  assert_true(pl_raster_whole(raster));
  assert_close(pl_raster_value(raster, 0, 0.0, -1.0, PL_INTERPOLATION_BILINEAR), 2.5, 0.0);
  assert_close(pl_raster_value(raster, 0, 1.0, 2.0, PL_INTERPOLATION_BILINEAR), 5.0, 0.0);
  assert_close(pl_raster_value(raster, 0, 3.0, 1.0, PL_INTERPOLATION_BILINEAR), 4.0, 0.0);
  pl_raster_destroy(raster);
}

/* A cylindrical patch across the date line is found from both sides; it is not the whole body. */
static void test_patch_across_the_date_line(void **state) {
  (void)state;
  const float samples[] = {1.0f, 2.0f, 3.0f, 4.0f, 1.0f, 2.0f, 3.0f, 4.0f};
  pl_raster_frame frame = {.samples = samples,
                           .type = PL_RASTER_FLOAT32,
                           .width = 4,
                           .height = 2,
                           .scale = 1.0,
                           .x0 = 178.5 * DEGREE,
                           .y0 = 10.0 * DEGREE,
                           .dx = 1.0 * DEGREE,
                           .dy = -1.0 * DEGREE};
  for (int turn = 0; turn < 3; turn++) {
    pl_raster *raster = make(&frame);
    assert_false(pl_raster_whole(raster));
    assert_close(value_at(raster, at(180.0, 9.3), PL_INTERPOLATION_BILINEAR), 2.5, 1e-9);
    assert_close(value_at(raster, at(-179.0, 9.3), PL_INTERPOLATION_BILINEAR), 3.5, 1e-9);
    double u, v;
    assert_false(pl_raster_find(raster, at(177.9, 9.3), &u, &v));
    assert_false(pl_raster_find(raster, at(-177.9, 9.3), &u, &v));
    assert_false(pl_raster_find(raster, at(180.0, 10.6), &u, &v));
    assert_false(pl_raster_find(raster, at(180.0, 8.4), &u, &v));
    pl_raster_destroy(raster);
    frame.x0 -= 2.0 * PL_PI; /* the same place by another name of its longitude */
  }
}

static void test_weights(void **state) {
  (void)state;
  static float samples[ACROSS * DOWN];
  const pl_raster_frame frame = patch(samples, PL_PROJECTION_ORTHOGRAPHIC);
  pl_raster *raster = make(&frame);
  assert_close(pl_raster_weight(raster, 20.0, 10.0, 4.0), 1.0, 0.0);
  assert_close(pl_raster_weight(raster, 3.5, 10.0, 4.0), 1.0, 0.0);
  assert_close(pl_raster_weight(raster, 1.5, 10.0, 4.0), 0.5, 1e-15);
  assert_close(pl_raster_weight(raster, 20.0, DOWN - 2.5, 4.0), 0.5, 1e-15);
  assert_close(pl_raster_weight(raster, 1.5, 1.5, 4.0), 0.25, 1e-15);
  assert_close(pl_raster_weight(raster, -0.5, 10.0, 4.0), 0.0, 0.0);
  assert_close(pl_raster_weight(raster, -3.0, 10.0, 4.0), 0.0, 0.0);
  assert_close(pl_raster_weight(raster, 20.0, 1e9, 4.0), 0.0, 0.0);
  assert_close(pl_raster_weight(raster, -0.5, 10.0, 0.0), 1.0, 0.0);
  assert_close(pl_raster_weight(raster, -0.6, 10.0, 0.0), 0.0, 0.0);
  assert_close(pl_raster_weight(raster, 19.5, 14.5, 1e9), 1.0, 0.0); /* at most half of it */
  const double step = 1e-3; /* neither a step nor a crease */
  for (double u = -1.0, last = 0.0, slope = 0.0; u < 6.0; u += step) {
    const double w = pl_raster_weight(raster, u, 10.0, 4.0);
    assert_true(w >= last - 1e-12);
    assert_close((w - last) / step, slope, 2e-3);
    slope = (w - last) / step;
    last = w;
  }
  pl_raster_destroy(raster);
}

/* Levels keep the mean; even sides give means of 2 x 2, odd ones share cells. */
static void test_pyramid(void **state) {
  (void)state;
  test_random random = {.seed = 52};
  static float samples[37 * 23];
  for (int width = 36; width <= 37; width++) {
    pl_raster_frame frame = patch(samples, PL_PROJECTION_ORTHOGRAPHIC);
    frame.width = (size_t)width;
    frame.height = 23;
    double mean = 0.0;
    for (int i = 0; i < width * 23; i++) {
      samples[i] = (float)random_range(&random, 0.0, 1.0);
      mean += (double)samples[i] / (width * 23);
    }
    pl_raster *raster = make(&frame);
    const int top = pl_raster_levels(raster) - 1;
    assert_int_equal(top, 6);
    assert_close(pl_raster_value(raster, top, 3.0, 4.0, PL_INTERPOLATION_CUBIC), mean, 1e-6);
    assert_close(pl_raster_value(raster, 99, 3.0, 4.0, PL_INTERPOLATION_CUBIC), mean, 1e-6);
    pl_raster_destroy(raster);
  }
  int16_t square[WIDTH * HEIGHT];
  for (int i = 0; i < WIDTH * HEIGHT; i++)
    square[i] = (int16_t)(random_below(&random, 65536) - 32768);
  const pl_raster_frame frame = whole(square);
  pl_raster *raster = make(&frame);
  for (int r = 0; r < HEIGHT / 2; r++)
    for (int c = 0; c < WIDTH / 2; c++) {
      const int16_t *p = square + 2 * r * WIDTH + 2 * c;
      const double mean = 0.25 * (p[0] + p[1] + p[WIDTH] + p[WIDTH + 1]);
      assert_close(pl_raster_value(raster, 1, 2 * c + 0.5, 2 * r + 0.5, PL_INTERPOLATION_CUBIC),
                   100.0 + 0.5 * mean, 0.0);
    }
  pl_raster_destroy(raster);
}

static void test_bounds(void **state) {
  (void)state;
  test_random random = {.seed = 53};
  static float samples[ACROSS * DOWN];
  for (int i = 0; i < ACROSS * DOWN; i++)
    samples[i] = random_unit(&random) < 0.5 ? -1.0f : 1.0f;
  pl_raster_frame frame = patch(samples, PL_PROJECTION_ORTHOGRAPHIC);
  frame.scale = -3.0;
  frame.offset = 1.0;
  pl_raster *raster = make(&frame);
  double low[2], high[2], least = 0.0;
  for (int k = 0; k < 2; k++)
    pl_raster_bounds(raster, BOTH[k], &low[k], &high[k]);
  assert_true(low[0] == -2.0 && high[0] == 4.0);
  for (int i = 0; i < PL_DRAWS(50000, 1000); i++)
    for (int k = 0; k < 2; k++) {
      const double value = pl_raster_value(raster, i % 3, random_range(&random, -0.5, ACROSS - 0.5),
                                           random_range(&random, -0.5, DOWN - 0.5), BOTH[k]);
      assert_true(value >= low[k] && value <= high[k]);
      least = fmin(least, value);
    }
  assert_true(least < low[0]); /* the cubic does exceed the posts */
  pl_raster_destroy(raster);
}

/* One row, one column, one post: constant across, and inside over the width of a post. */
static void test_thin(void **state) {
  (void)state;
  const float samples[5] = {1.0f, 2.0f, 4.0f, 8.0f, 16.0f};
  pl_raster_frame frame = patch(samples, PL_PROJECTION_ORTHOGRAPHIC);
  for (int upright = 0; upright < 2; upright++) {
    frame.width = upright ? 1 : 5;
    frame.height = upright ? 5 : 1;
    pl_raster *raster = make(&frame);
    for (int k = 0; k < 2; k++)
      for (double off = -0.5; off <= 0.5; off += 0.25)
        for (int i = 0; i < 5; i++) {
          const double u = upright ? off : i, v = upright ? i : off;
          assert_close(pl_raster_value(raster, 0, u, v, BOTH[k]), (double)samples[i], 0.0);
          assert_close(value_at(raster, pl_raster_direction(raster, 0.8 * u, 0.8 * v), BOTH[k]),
                       pl_raster_value(raster, 0, 0.8 * u, 0.8 * v, BOTH[k]), 1e-7);
        }
    assert_close(pl_raster_weight(raster, upright ? 0.0 : 2.0, upright ? 2.0 : 0.0, 4.0), 1.0, 0.0);
    assert_close(pl_raster_weight(raster, 0.5, 0.5, 4.0), 0.0, 0.0);
    pl_raster_destroy(raster);
  }
  frame.width = frame.height = 1;
  pl_raster *raster = make(&frame);
  assert_int_equal(pl_raster_levels(raster), 1);
  assert_close(pl_raster_value(raster, 3, 0.4, -0.3, PL_INTERPOLATION_CUBIC), 1.0, 0.0);
  pl_raster_destroy(raster);
}

static void test_spacing(void **state) {
  (void)state;
  static int16_t cells[WIDTH * HEIGHT];
  static float samples[ACROSS * DOWN];
  pl_raster_frame frame = whole(cells);
  pl_raster *raster = make(&frame);
  assert_close(pl_raster_spacing_m(raster, RADIUS_M), 10.0 * DEGREE * RADIUS_M, 1e-6);
  pl_raster_destroy(raster);
  frame = patch(samples, PL_PROJECTION_STEREOGRAPHIC);
  frame.dx = 8.0;
  frame.projection.scale = 0.5;
  raster = make(&frame);
  assert_close(pl_raster_spacing_m(raster, 2.0 * RADIUS_M), 16.0, 1e-12);
  const pl_vec3 step =
      pl_vec3_sub(pl_raster_direction(raster, 5.0, 14.0), pl_raster_direction(raster, 5.0, 15.0));
  assert_close(2.0 * RADIUS_M * pl_vec3_norm(step), 8.0, 1e-6);
  pl_raster_destroy(raster);
}

static void assert_refused(const pl_raster_frame *frame, pl_status status, const char *text) {
  pl_raster *raster;
  assert_int_equal(pl_raster_create(frame, &raster), status);
  assert_null(raster);
  assert_non_null(strstr(pl_error_text(), text));
}

/* What is called far of a raster is not on it: any projection, over poles and the date line. */
static void test_far(void **state) {
  (void)state;
  static float samples[ACROSS * DOWN];
  test_random random = {.seed = 77};
  int far = 0, near = 0;
  for (int k = 0; k < 400; k++) {
    pl_raster_frame frame = patch(samples, (pl_projection_kind)(k % PL_PROJECTION_COUNT));
    const double size = exp(random_range(&random, log(1e-4), log(0.5)));
    frame.projection.lat0_rad = random_range(&random, -90.0, 90.0) * DEGREE;
    frame.dx = frame.projection.kind == PL_PROJECTION_CYLINDRICAL ? size / ACROSS
                                                                  : size * RADIUS_M / ACROSS;
    frame.dy = -frame.dx;
    frame.x0 = -0.5 * ACROSS * frame.dx;
    frame.y0 = -0.5 * DOWN * frame.dy;
    if (frame.projection.kind == PL_PROJECTION_CYLINDRICAL) {
      frame.x0 += random_range(&random, -3.0, 3.0);
      frame.y0 = random_range(&random, -1.5 - DOWN * frame.dy, 1.5);
    }
    pl_raster *raster;
    if (pl_raster_create(&frame, &raster) != PL_OK)
      continue;
    for (int i = 0; i < 100; i++) {
      double u, v;
      const pl_vec3 on = pl_raster_direction(raster, random_range(&random, -0.5, ACROSS - 0.5),
                                             random_range(&random, -0.5, DOWN - 0.5));
      const pl_vec3 any =
          at(random_range(&random, -180.0, 180.0), random_range(&random, -90.0, 90.0));
      const double distance = pl_vec3_norm(pl_vec3_sub(on, any));
      near += !pl_raster_far(raster, on, 0.0);
      assert_false(pl_raster_far(raster, on, 0.0));
      assert_false(pl_raster_far(raster, any, distance));
      far += pl_raster_far(raster, any, 0.0);
      assert_false(pl_raster_far(raster, any, 0.0) && pl_raster_find(raster, any, &u, &v));
    }
    pl_raster_destroy(raster);
  }
  assert_true(near > 20000 && far > 15000);
}

static void test_errors(void **state) {
  (void)state;
  static int16_t cells[WIDTH * HEIGHT];
  static float samples[ACROSS * DOWN];
  pl_raster_frame frame = whole(cells);
  frame.samples = NULL;
  assert_refused(&frame, PL_E_ARGUMENT, "samples");
  frame = whole(cells);
  frame.height = 0;
  assert_refused(&frame, PL_E_RANGE, "36 x 0 posts");
  frame = whole(cells);
  frame.stride = 35;
  assert_refused(&frame, PL_E_RANGE, "35 samples apart");
  frame = whole(cells);
  frame.scale = NAN;
  assert_refused(&frame, PL_E_RANGE, "scale");
  frame = whole(cells);
  frame.dy = 0.0;
  assert_refused(&frame, PL_E_RANGE, "steps");
  frame = whole(cells);
  frame.y0 = 1.7;
  assert_refused(&frame, PL_E_RANGE, "latitude 97");
  frame = whole(cells);
  frame.dx *= 1.1;
  assert_refused(&frame, PL_E_RANGE, "longitude");
  frame = patch(samples, PL_PROJECTION_ORTHOGRAPHIC);
  frame.x0 = 1.8e6;
  assert_refused(&frame, PL_E_RANGE, "orthographic");
  frame = patch(samples, PL_PROJECTION_ORTHOGRAPHIC);
  frame.projection.radius_m = 0.0;
  assert_refused(&frame, PL_E_RANGE, "radius");
  samples[3 * ACROSS + 5] = INFINITY;
  frame = patch(samples, PL_PROJECTION_ORTHOGRAPHIC);
  assert_refused(&frame, PL_E_RANGE, "column 5, row 3");
  pl_raster_destroy(NULL);
}

static void *allocate_some(void *context, size_t size) {
  int *left = context;
  return (*left)-- > 0 ? malloc(size) : NULL;
}

/* Nothing is lost when memory ends at any of the allocations. */
static void test_out_of_memory(void **state) {
  (void)state;
  static int16_t cells[WIDTH * HEIGHT];
  const pl_raster_frame frame = whole(cells);
  pl_raster *raster = NULL;
  int count = -1;
  do {
    int left = ++count;
    assert_null(raster);
    pl_memory_hook(allocate_some, &left);
    const pl_status status = pl_raster_create(&frame, &raster);
    pl_memory_hook(NULL, NULL);
    assert_int_equal(status, raster != NULL ? PL_OK : PL_E_MEMORY);
  } while (raster == NULL && count < 10);
  assert_int_equal(count, 3);
  pl_raster_destroy(raster);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_posts),
      cmocka_unit_test(test_stride),
      cmocka_unit_test(test_planes),
      cmocka_unit_test(test_cubic),
      cmocka_unit_test(test_around),
      cmocka_unit_test(test_odd_columns),
      cmocka_unit_test(test_patch_across_the_date_line),
      cmocka_unit_test(test_weights),
      cmocka_unit_test(test_pyramid),
      cmocka_unit_test(test_bounds),
      cmocka_unit_test(test_thin),
      cmocka_unit_test(test_spacing),
      cmocka_unit_test(test_far),
      cmocka_unit_test(test_errors),
      cmocka_unit_test(test_out_of_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
