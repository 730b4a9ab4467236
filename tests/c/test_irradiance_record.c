/* Light shared between pixels against paths of their own: less noise, the same light, and more
 * samples come nearer to the truth. */
#include "harness.h"

#include <stdio.h>

#include "frames.h"
#include "render/draws.h"

static const double AU = 149597870700.0;

enum { WIDTH = PL_DRAWS(64, 32), HEIGHT = PL_DRAWS(48, 24), PIXELS = WIDTH * HEIGHT };

/* The faces are about half as bright, W m-2 sr-1. */
static const double WHITE = 40.0;

typedef struct picture {
  float radiance[3 * PIXELS];
} picture;

/* A cube whose near faces the sun does not reach: a sunlit globe lights them. `bounces` 0: black.
 * `even`: no sample is spared, and none shared. */
static void shoot(const pl_model *model, int samples, int bounces, bool even, uint64_t index,
                  picture *out) {
  stage s;
  film f;
  pl_renderer *renderer;
  stage_init(&s, WIDTH, HEIGHT, 1.25 * WIDTH);
  s.placement.sun.position_m = (pl_vec3){0.2 * AU, 0.1 * AU, AU};
  stage_add_body(&s, (pl_vec3){-14, 0, -9}, (pl_vec3){12, 12, 12}, 0.9f);
  stage_add_object(&s, model, (pl_vec3){0, 0, 12}, pl_quat_axis_angle((pl_vec3){0.6, 0.8, 0}, 0.7),
                   5.0);
  film_init(&f, &s);
  pl_frame_request request = request_all(&s, &f);
  request.index = index;
  request.samples = samples;
  request.max_bounces = bounces;
  request.exposure = (pl_exposure){.white_radiance = WHITE};
  request.wish = (pl_plan_wish){.tolerance_dn = 1.0,
                                .force_on = even ? one_effect("antialiasing") : no_effects()};
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  render(renderer, &request);
  memcpy(out->radiance, f.radiance, sizeof out->radiance);
  pl_renderer_destroy(renderer);
  film_clear(&f);
  stage_clear(&s);
}

/* Root mean square difference, of white. */
static double rms(const picture *a, const picture *b) {
  double square = 0.0;
  for (size_t i = 0; i < 3 * PIXELS; i++)
    square += pow(((double)a->radiance[i] - b->radiance[i]) / WHITE, 2.0);
  return sqrt(square / (3 * PIXELS));
}

static double flux(const picture *a) {
  double sum = 0.0;
  for (size_t i = 0; i < 3 * PIXELS; i++)
    sum += a->radiance[i];
  return sum;
}

/* Mean error and light of some frames, which differ in their noise alone. */
typedef struct trial {
  double error, light;
} trial;

static trial try_frames(const pl_model *model, const picture *truth, int samples, bool even) {
  enum { FRAMES = 3 };
  trial out = {0.0, 0.0};
  picture *picture = malloc(sizeof *picture);
  assert_non_null(picture);
  for (uint64_t i = 0; i < FRAMES; i++) {
    shoot(model, samples, 2, even, i, picture);
    out.error += rms(picture, truth) / FRAMES;
    out.light += flux(picture) / flux(truth) / FRAMES;
  }
  free(picture);
  return out;
}

/* What the sun does not reach is lit by way of others alone. With four samples a pixel its noise is
 * less than half of that of as many paths of its own, and the light is the same within 1.5 %, which
 * is some three standard errors. */
static void test_noise_and_light(void **state) {
  (void)state;
  pl_model *model = cube_create(0.5);
  picture *truth = malloc(sizeof *truth);
  assert_non_null(truth);
  shoot(model, 512, 2, true, 0, truth);
  const trial alone = try_frames(model, truth, 4, true),
              shared = try_frames(model, truth, 4, false);
  const trial many = try_frames(model, truth, 64, false);
  print_message(
      "RMS of white: alone %.5f, shared %.5f, of 64 samples %.5f; light %.4f, %.4f, %.4f\n",
      alone.error, shared.error, many.error, alone.light, shared.light, many.light);
  assert_true(alone.error > 0.004);
  assert_true(shared.error < 0.5 * alone.error);
  assert_true(many.error < 0.7 * shared.error);
  assert_true(fabs(shared.light - 1.0) < 0.015);
  assert_true(fabs(many.light - 1.0) < 0.01);
  free(truth);
  pl_model_destroy(model);
}

/* The same light of glossy faces, whether what their paths carry on is known beforehand (the first
 * two: all their lobes are wide) or drawn. */
static void test_light_of_glossy_faces(void **state) {
  (void)state;
  /* Roughness, metalness, and what four samples may be off: few paths find what glosses mirror. */
  static const float looks[3][3] = {
      {0.85f, 0.0f, 0.01f}, {0.95f, 0.6f, 0.01f}, {0.5f, 0.3f, 0.05f}};
  pl_model *model = cube_create(0.5);
  picture *truth = malloc(sizeof *truth);
  assert_non_null(truth);
  for (int i = 0; i < 3; i++) {
    model->materials[0].roughness = looks[i][0];
    model->materials[0].metallic = looks[i][1];
    shoot(model, 256, 2, true, 0, truth);
    const trial few = try_frames(model, truth, 4, false);
    const trial many = try_frames(model, truth, 16, false);
    print_message("roughness %g, metalness %g: light %.4f, %.4f\n", (double)looks[i][0],
                  (double)looks[i][1], few.light, many.light);
    assert_true(fabs(few.light - 1.0) < (double)looks[i][2]);
    assert_true(fabs(many.light - 1.0) < 0.01);
  }
  free(truth);
  pl_model_destroy(model);
}

/* The cube's near faces again, lit by the sunlit back of a small cube alone: few paths find it. */
static void shoot_rare(const pl_model *model, int samples, bool even, uint64_t index,
                       picture *out) {
  stage s;
  film f;
  pl_renderer *renderer;
  stage_init(&s, WIDTH, HEIGHT, 1.25 * WIDTH);
  s.placement.sun.position_m = (pl_vec3){-0.4 * AU, 0.1 * AU, AU};
  stage_add_object(&s, model, (pl_vec3){0, 0, 12}, PL_QUAT_IDENTITY, 5.0);
  stage_add_object(&s, model, (pl_vec3){-4.5, 0, 6}, PL_QUAT_IDENTITY, 1.5);
  film_init(&f, &s);
  pl_frame_request request = request_all(&s, &f);
  request.index = index;
  request.samples = samples;
  request.max_bounces = 1;
  request.exposure = (pl_exposure){.white_radiance = WHITE};
  request.wish = (pl_plan_wish){.tolerance_dn = 0.5,
                                .force_on = even ? one_effect("antialiasing") : no_effects()};
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  render(renderer, &request);
  memcpy(out->radiance, f.radiance, sizeof out->radiance);
  pl_renderer_destroy(renderer);
  film_clear(&f);
  stage_clear(&s);
}

/* Where near pixels miss the light by luck the farthest are asked: there are fewer black
 * blotches in a dim light. */
static void test_no_blotches(void **state) {
  (void)state;
  pl_model *model = cube_create(0.5);
  picture *truth = malloc(2 * sizeof *truth), *found = truth + 1;
  assert_non_null(truth);
  shoot_rare(model, 512, true, 0, truth);
  size_t lit = 0, black = 0;
  for (uint64_t frame = 0; frame < 8; frame++) {
    shoot_rare(model, 4, false, frame, found);
    for (size_t i = 0; i < 3 * PIXELS; i++) {
      const bool dim = truth->radiance[i] > 0.005 * WHITE && truth->radiance[i] < 0.1 * WHITE;
      lit += dim;
      black += dim && !(found->radiance[i] > 0.0f);
    }
  }
  print_message("black: %zu of %zu\n", black, lit);
  assert_true(lit > 10000);
  assert_true(black < 2 * lit / 5); /* two thirds, if only near ones are asked */
  free(truth);
  pl_model_destroy(model);
}

/* Frames of one index are the same, and without other surfaces' light there is nothing to share. */
static void test_dark_without_bounces(void **state) {
  (void)state;
  pl_model *model = cube_create(0.5);
  picture *pictures = malloc(3 * sizeof *pictures);
  assert_non_null(pictures);
  shoot(model, 16, 2, false, 3, &pictures[0]);
  shoot(model, 16, 2, false, 3, &pictures[1]);
  shoot(model, 16, 0, false, 3, &pictures[2]);
  assert_memory_equal(&pictures[0], &pictures[1], sizeof *pictures);
  assert_true(flux(&pictures[2]) == 0.0);
  assert_true(flux(&pictures[0]) > 0.0);
  free(pictures);
  pl_model_destroy(model);
}

enum { ROW_BITS = 5, TILE = 1 << (2 * ROW_BITS) };

/* Whether of 4^k points one is in each of 2^k x 2^k cells. */
static bool is_even(const float *u, const float *v, const uint32_t *which, int k) {
  bool taken[TILE] = {false};
  const float cells = (float)(1 << k);
  for (int i = 0; i < 1 << (2 * k); i++) {
    const int cell = (int)(v[which[i]] * cells) << k | (int)(u[which[i]] * cells);
    if (taken[cell])
      return false;
    taken[cell] = true;
  }
  return true;
}

/* By the construction of (0,2)-nets: of any sample, the draws of every aligned square of pixels lie
 * evenly, and so do the first samples of every pixel. */
static void test_draws_lie_evenly(void **state) {
  (void)state;
  static float u[TILE], v[TILE], own_u[16][TILE], own_v[16][TILE];
  uint32_t pixels[TILE], square[TILE];
  for (uint32_t i = 0; i < TILE; i++)
    pixels[i] = i;
  float *const arrays[2] = {u, v};
  for (uint32_t sample = 0; sample < 16; sample++) {
    pl_draws_spread(arrays, pixels, TILE, ROW_BITS, 77u, sample);
    memcpy(own_u[sample], u, sizeof u);
    memcpy(own_v[sample], v, sizeof v);
    for (int k = 0; k <= ROW_BITS; k++)
      for (uint32_t at = 0; at < TILE; at += 1u << k) {
        const uint32_t row = at >> ROW_BITS, side = 1u << k;
        for (uint32_t i = 0; i < side * side; i++)
          square[i] = at + (i / side << ROW_BITS) + i % side;
        if (row % side == 0)
          assert_true(is_even(u, v, square, k));
      }
  }
  for (uint32_t pixel = 0; pixel < TILE; pixel++) {
    for (uint32_t i = 0; i < 16; i++)
      square[i] = i * TILE + pixel;
    assert_true(is_even(own_u[0], own_v[0], square, 2));
  }
}

/* Other tiles draw otherwise; a pixel draws the same whatever others do. */
static void test_draws_are_keyed(void **state) {
  (void)state;
  const uint32_t pixels[3] = {5, 700, 1023};
  float all[2][3], other[2][3], one[2];
  pl_draws_spread((float *[2]){all[0], all[1]}, pixels, 3, ROW_BITS, 1u, 3);
  pl_draws_spread((float *[2]){other[0], other[1]}, pixels, 3, ROW_BITS, 2u, 3);
  for (int i = 0; i < 3; i++) {
    pl_draws_spread((float *[2]){&one[0], &one[1]}, &pixels[i], 1, ROW_BITS, 1u, 3);
    assert_true(one[0] == all[0][i] && one[1] == all[1][i]);
    assert_true(other[0][i] != all[0][i] && other[1][i] != all[1][i]);
  }
}

/* Tiles are kept in whatever order threads finish them: frames after the first find room for any.
 */
static void test_any_order_fits(void **state) {
  (void)state;
  pl_model *model = cube_create(0.5);
  stage s;
  film f;
  pl_renderer *renderer;
  stage_init(&s, 7 * WIDTH + 20, 7 * HEIGHT + 3, 8.75 * WIDTH);
  s.placement.sun.position_m = (pl_vec3){0.2 * AU, 0.1 * AU, AU};
  stage_add_body(&s, (pl_vec3){-14, 0, -9}, (pl_vec3){12, 12, 12}, 0.9f);
  stage_add_object(&s, model, (pl_vec3){0, 0, 12}, pl_quat_axis_angle((pl_vec3){0.6, 0.8, 0}, 0.7),
                   7.0);
  film_init(&f, &s);
  pl_frame_request request = request_all(&s, &f);
  request.samples = 2;
  request.max_bounces = 1;
  request.exposure = (pl_exposure){.white_radiance = WHITE};
  request.wish = (pl_plan_wish){.tolerance_dn = 1.0};
  request.threads = 4;
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  render(renderer, &request);
  const uint64_t before = pl_memory_allocations();
  for (int i = 0; i < PL_DRAWS(12, 1); i++) {
    render(renderer, &request);
    assert_int_equal(pl_memory_allocations(), before);
  }
  pl_renderer_destroy(renderer);
  film_clear(&f);
  stage_clear(&s);
  pl_model_destroy(model);
}

/* One thread samples a high image in two bands, eight threads in one. */
static void test_bands_do_not_show(void **state) {
  (void)state;
  enum { WIDE = 33, HIGH = 32 * 66 };
  pl_model *model = cube_create(0.5);
  stage s;
  film f;
  pl_renderer *renderer;
  float *kept = malloc(3 * WIDE * HIGH * sizeof *kept);
  assert_non_null(kept);
  stage_init(&s, WIDE, HIGH, 1.5 * HIGH);
  s.placement.sun.position_m = (pl_vec3){0.2 * AU, 0.1 * AU, AU};
  stage_add_body(&s, (pl_vec3){-14, 0, -9}, (pl_vec3){12, 12, 12}, 0.9f);
  stage_add_object(&s, model, (pl_vec3){0, 0, 12}, pl_quat_axis_angle((pl_vec3){0.6, 0.8, 0}, 0.7),
                   9.0);
  film_init(&f, &s);
  pl_frame_request request = request_all(&s, &f);
  request.samples = 2;
  request.max_bounces = 1;
  request.exposure = (pl_exposure){.white_radiance = WHITE};
  request.wish = (pl_plan_wish){.tolerance_dn = 1.0};
  request.threads = 1;
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  render(renderer, &request);
  memcpy(kept, f.radiance, 3 * WIDE * HIGH * sizeof *kept);
  const float seam = kept[3 * WIDE * 2048]; /* the first row of the second band */
  request.threads = 8;
  render(renderer, &request);
  assert_true(seam > 0.0f);
  assert_memory_equal(kept, f.radiance, 3 * WIDE * HIGH * sizeof *kept);
  pl_renderer_destroy(renderer);
  film_clear(&f);
  stage_clear(&s);
  free(kept);
  pl_model_destroy(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_bands_do_not_show),   cmocka_unit_test(test_any_order_fits),
      converging_unit_test(test_noise_and_light), converging_unit_test(test_light_of_glossy_faces),
      converging_unit_test(test_no_blotches),     serial_unit_test(test_dark_without_bounces),
      serial_unit_test(test_draws_lie_evenly),    serial_unit_test(test_draws_are_keyed),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
