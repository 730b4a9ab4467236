/* Adaptive sampling against the same number of samples everywhere: no more error, no bias, nothing
 * thin lost. */
#include "harness.h"

#include <stdio.h>

#include "frames.h"

static const double AU = 149597870700.0;

enum { WIDTH = 64, HEIGHT = 48, PIXELS = WIDTH * HEIGHT };

typedef struct picture {
  uint8_t rgb[3 * PIXELS];
  float radiance[3 * PIXELS];
} picture;

/* A sphere with its terminator, and a glossy entity before it that the sun and the sphere light. */
static void shoot(const pl_model *model, double scale, int samples, double tolerance_dn,
                  uint64_t index, picture *out) {
  stage s;
  film f;
  pl_renderer *renderer;
  stage_init(&s, WIDTH, HEIGHT, 80.0);
  s.placement.sun.position_m = (pl_vec3){AU, 0.3 * AU, -0.6 * AU};
  stage_add_body(&s, (pl_vec3){3, 0, 40}, (pl_vec3){12, 12, 11}, 0.5f);
  stage_add_object(&s, model, (pl_vec3){-1, 0.3, 14},
                   pl_quat_axis_angle((pl_vec3){0.6, 0.8, 0}, 0.7), scale);
  film_init(&f, &s);
  pl_frame_request request = request_all(&s, &f);
  request.index = index;
  request.samples = samples;
  request.max_bounces = 2;
  request.wish = (pl_plan_wish){.tolerance_dn = tolerance_dn};
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  render(renderer, &request);
  memcpy(out->rgb, f.rgb, sizeof out->rgb);
  memcpy(out->radiance, f.radiance, sizeof out->radiance);
  pl_renderer_destroy(renderer);
  film_clear(&f);
  stage_clear(&s);
}

static double rms_dn(const picture *a, const picture *b) {
  double square = 0.0;
  for (size_t i = 0; i < sizeof a->rgb; i++)
    square += (double)((a->rgb[i] - b->rgb[i]) * (a->rgb[i] - b->rgb[i]));
  return sqrt(square / sizeof a->rgb);
}

static double flux(const picture *a) {
  double sum = 0.0;
  for (size_t i = 0; i < 3 * PIXELS; i++)
    sum += a->radiance[i];
  return sum;
}

/* Eight frames, which differ in their noise alone. Samples are given where they count, and their
 * error is that of equal numbers; within a fifth here, where both are below the three tolerances
 * that flat places are allowed. The noise is pooled over neighbours, so that the light in the frame
 * stays: its mean over the frames is off by less than a part in 500. */
static void test_error_and_flux(void **state) {
  (void)state;
  enum { FRAMES = 8 };
  pl_model *model = cube_create(0.5);
  picture *reference = malloc(3 * sizeof *reference);
  picture *even = reference + 1, *adaptive = reference + 2;
  assert_non_null(reference);
  shoot(model, 4.0, 2048, 0.0, 0, reference);
  double even_error = 0.0, error = 0.0, light = 0.0, even_light = 0.0;
  for (uint64_t i = 0; i < FRAMES; i++) {
    shoot(model, 4.0, 16, 0.0, i, even);
    shoot(model, 4.0, 16, 1.0, i, adaptive);
    even_error += rms_dn(even, reference) / FRAMES;
    even_light += flux(even) / flux(reference) / FRAMES;
    error += rms_dn(adaptive, reference) / FRAMES;
    light += flux(adaptive) / flux(reference) / FRAMES;
  }
  print_message("RMS %.3f DN, light %.5f; by equal numbers %.3f DN, %.5f\n", error, light,
                even_error, even_light);
  assert_true(error < 1.2 * even_error);
  assert_true(fabs(light - 1.0) < 0.002);
  free(reference);
  pl_model_destroy(model);
}

/* A strut of a tenth of a pixel: every pixel that it crosses shows it, as with equal numbers. */
static void test_thin_strut(void **state) {
  (void)state;
  pl_model *model = cube_create(0.5);
  for (size_t i = 0; i < model->vertex_count; i++) {
    model->positions[3 * i] *= 0.003f;
    model->positions[3 * i + 1] *= 0.003f;
  }
  pl_model_measure(model);
  picture *pictures = malloc(3 * sizeof *pictures);
  assert_non_null(pictures);
  shoot(model, 6.0, PL_DRAWS(1024, 512), 0.0, 0, &pictures[0]);
  shoot(model, 6.0, 16, 0.0, 0, &pictures[1]);
  shoot(model, 6.0, 16, 1.0, 0, &pictures[2]);
  const double even = rms_dn(&pictures[1], &pictures[0]);
  const double adaptive = rms_dn(&pictures[2], &pictures[0]);
  print_message("RMS %.3f DN, %.3f by equal numbers\n", adaptive, even);
  assert_true(adaptive < 1.05 * even);
  free(pictures);
  pl_model_destroy(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      converging_unit_test(test_error_and_flux),
      cmocka_unit_test(test_thin_strut),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
