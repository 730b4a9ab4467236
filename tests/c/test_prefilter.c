/* Pixels of bodies whose light has a closed form against finer images and against many paths. */
#include "harness.h"

#include "frames.h"

enum { WIDTH = 64, HEIGHT = 48, COUNT = 3 * WIDTH * HEIGHT, FINER = 4 };

static const double AU = 149597870700.0;
static const double WHITE = 400.0; /* W m-2 sr-1 */

typedef void arrange_fn(stage *s);

/* A globe so near that a pixel spans 0.01 to 0.03 of its radius, with its limb, lit from the left.
 */
static void arrange_globe(stage *s) {
  s->placement.sun.position_m = (pl_vec3){-AU, 0.1 * AU, -0.6 * AU};
  stage_add_body(s, (pl_vec3){25, 0, 80}, (pl_vec3){40, 39, 38}, 0.8f);
}

/* A globe in front of another, both lit from behind the camera: their light is even but for
 * outlines, where pixels must be sampled. */
static void arrange_two(stage *s) {
  s->placement.sun.position_m = (pl_vec3){-0.3 * AU, 0.2 * AU, -AU};
  stage_add_body(s, (pl_vec3){0, 0, 300}, (pl_vec3){80, 80, 80}, 0.8f);
  stage_add_body(s, (pl_vec3){20, 10, 150}, (pl_vec3){12, 12, 12}, 0.2f);
}

/* A globe before another, so small that it lies between the centres of four pixels. */
static void arrange_transit(stage *s) {
  s->placement.sun.position_m = (pl_vec3){-0.3 * AU, 0.2 * AU, -AU};
  stage_add_body(s, (pl_vec3){0, 0, 300}, (pl_vec3){80, 80, 80}, 0.8f);
  stage_add_body(s, (pl_vec3){0, 0, 150}, (pl_vec3){1.1, 1.1, 1.1}, 0.5f);
}

/* A disc seen from its edge, thinner than a pixel, between two rows of centres; only sky behind. */
static void arrange_edge(stage *s) {
  s->placement.sun.position_m = (pl_vec3){-0.3 * AU, 0.2 * AU, -AU};
  stage_add_body(s, (pl_vec3){0, 0, 150}, (pl_vec3){40, 0.4, 40}, 0.8f);
}

/* A dark globe, of which one side faces a bright one beside the camera. */
static void arrange_lit(stage *s) {
  s->placement.sun.position_m = (pl_vec3){0.1 * AU, 0.0, AU};
  stage_add_body(s, (pl_vec3){0, 0, 100}, (pl_vec3){30, 30, 30}, 0.8f);
  stage_add_body(s, (pl_vec3){-90, 0, -20}, (pl_vec3){60, 60, 60}, 0.9f);
}

static pl_rings *rings; /* of the scene below */

/* The night side of a globe, over whose horizon another stays out of sight; its rings do not. */
static void arrange_rings(stage *s) {
  s->placement.sun.position_m = (pl_vec3){0.0, -0.5 * AU, AU};
  stage_add_body(s, (pl_vec3){0, 0, 100}, (pl_vec3){30, 30, 30}, 0.9f);
  const pl_vec3 place = {-150, 60, 110};
  const size_t body = stage_add_body(s, place, (pl_vec3){5, 5, 5}, 0.1f);
  s->bodies[body].motion = still(place, pl_quat_axis_angle((pl_vec3){1, 0, 0}, 0.5 * PL_PI));
  s->scene.bodies[body].rings = rings;
}

/* An image of `scale` times as many pixels, as means over squares of so many: floats, 3 a pixel. */
static float *shoot(arrange_fn *arrange, int scale, double white, pl_plan_wish wish, int samples,
                    uint64_t index) {
  stage s;
  film f;
  pl_renderer *renderer;
  const int width = WIDTH * scale, height = HEIGHT * scale;
  stage_init(&s, width, height, 80.0 * scale);
  arrange(&s);
  film_init(&f, &s);
  pl_frame_request request = request_all(&s, &f);
  request.index = index;
  request.samples = samples;
  request.exposure = (pl_exposure){.white_radiance = white};
  request.wish = wish;
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  render(renderer, &request);
  float *out = calloc(COUNT, sizeof *out);
  assert_non_null(out);
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++)
      for (int c = 0; c < 3; c++)
        out[3 * (y / scale * WIDTH + x / scale) + c] +=
            f.radiance[3 * (y * width + x) + c] / (float)(scale * scale);
  pl_renderer_destroy(renderer);
  film_clear(&f);
  stage_clear(&s);
  return out;
}

/* Digital numbers of linear light. */
static double dn(double radiance, double white) { return 255.0 * radiance / white; }

/* Whether light changes little about value `i` of the image: no outline crosses the pixel. */
static bool is_inside(const float *image, size_t i) {
  const size_t row = 3 * WIDTH;
  if (i < row + 3 || i + row + 3 >= COUNT)
    return false;
  const size_t around[] = {i - row - 3, i - row,     i - row + 3, i - 3,
                           i + 3,       i + row - 3, i + row,     i + row + 3};
  for (size_t k = 0; k < 8; k++)
    if (fabs((double)image[around[k]] - image[i]) > 0.1 * image[i])
      return false;
  return true;
}

/* Pixels of four times the width leave the light as it is; towards the limb and on outlines there
 * is the noise of sampling. */
static void check_finer(arrange_fn *arrange, double most_dn) {
  const pl_plan_wish wish = {.tolerance_dn = 0.5};
  float *coarse = shoot(arrange, 1, WHITE, wish, 256, 0);
  float *fine = shoot(arrange, FINER, WHITE, wish, 16, 0);
  double inside = 0.0, outline = 0.0;
  size_t count = 0;
  for (size_t i = 0; i < COUNT; i++) {
    const double d = dn(fabs((double)coarse[i] - fine[i]), WHITE);
    const bool even = fine[i] > 0.0f && is_inside(fine, i);
    inside += even ? d * d : 0.0;
    outline = fmax(outline, even ? 0.0 : d);
    count += even;
  }
  inside = sqrt(inside / (double)count);
  print_message("against finer pixels: RMS %.3f DN in %zu pixels, %.2f DN on outlines\n", inside,
                count / 3, outline);
  assert_true(count > 3 * 400);
  assert_true(inside < most_dn);
  assert_true(outline < 10.0);
  free(coarse);
  free(fine);
}

static void test_arcs(void **state) {
  (void)state;
  check_finer(arrange_globe, 0.2);
}

static void test_outlines_of_two(void **state) {
  (void)state;
  check_finer(arrange_two, 0.7);
}

/* A small body hides what lies behind it also where it covers no centre of a pixel; by finer
 * pixels, of which it is many wide. */
static void test_transit(void **state) {
  (void)state;
  const pl_plan_wish wish = {.tolerance_dn = 0.5};
  float *coarse = shoot(arrange_transit, 1, WHITE, wish, 256, 0);
  float *fine = shoot(arrange_transit, 4 * FINER, WHITE, wish, 8, 0);
  for (int y = HEIGHT / 2 - 2; y < HEIGHT / 2 + 2; y++)
    for (int x = WIDTH / 2 - 2; x < WIDTH / 2 + 2; x++) {
      const size_t i = 3 * (size_t)(y * WIDTH + x);
      assert_true(dn(fabs((double)coarse[i] - fine[i]), WHITE) < 2.0);
    }
  free(coarse);
  free(fine);
}

/* A thin body is not lost in the sky around it, though it is on no centre of a pixel. */
static void test_edge_in_sky(void **state) {
  (void)state;
  const pl_plan_wish wish = {.tolerance_dn = 0.5};
  float *coarse = shoot(arrange_edge, 1, WHITE, wish, 256, 0);
  float *fine = shoot(arrange_edge, 4 * FINER, WHITE, wish, 8, 0);
  double found = 0.0, expected = 0.0;
  for (int y = HEIGHT / 2 - 1; y <= HEIGHT / 2; y++)
    for (int x = 0; x < WIDTH; x++) {
      found += dn(coarse[3 * (y * WIDTH + x)], WHITE);
      expected += dn(fine[3 * (y * WIDTH + x)], WHITE);
    }
  print_message("a disc's edge: %.2f DN, by finer pixels %.2f\n", found, expected);
  assert_true(expected > 40.0 * 5.0);
  assert_true(fabs(found / expected - 1.0) < 0.02);
  free(coarse);
  free(fine);
}

/* Light by way of another body: in the mean over frames that of paths of each pixel's own, but that
 * pools at the limb reach inwards, and next to none where that body has
 * not risen. */
static void test_lit_by_another(void **state) {
  (void)state;
  enum { FRAMES = 24 };
  const double white = 150.0;
  const pl_plan_wish analytic = {.tolerance_dn = 0.5};
  const pl_plan_wish even = {.tolerance_dn = 0.5, .force_on = one_effect("antialiasing")};
  float *truth = shoot(arrange_lit, 1, white, even, 1024, 0);
  double sum = 0.0, true_sum = 0.0, square = 0.0;
  for (uint64_t frame = 0; frame < FRAMES; frame++) {
    float *found = shoot(arrange_lit, 1, white, analytic, 4, frame);
    for (size_t i = 0; i < COUNT; i++) {
      const double d = dn((double)found[i] - truth[i], white);
      assert_true(truth[i] > 0.0f || dn(found[i], white) < 3.0);
      sum += found[i] / FRAMES;
      true_sum += truth[i] / FRAMES;
      square += d * d / (FRAMES * COUNT);
    }
    free(found);
  }
  print_message("by another body: RMS %.3f DN, light %.4f\n", sqrt(square), sum / true_sum);
  assert_true(true_sum > 0.0 && fabs(sum / true_sum - 1.0) < 0.035);
  assert_true(square < 16.0);
  free(truth);
}

static void test_lit_by_rings(void **state) {
  (void)state;
  enum { FRAMES = PL_DRAWS(12, 3) };
  const double white = 10.0, edges[2] = {10.0, 145.0}, depth = 0.5, albedo[3] = {1.0, 1.0, 1.0};
  const pl_rings_settings settings = {
      .count = 1, .edges_m = edges, .depth = &depth, .albedo = albedo};
  const pl_plan_wish analytic = {.tolerance_dn = 0.5};
  const pl_plan_wish even = {.tolerance_dn = 0.5, .force_on = one_effect("antialiasing")};
  assert_int_equal(pl_rings_create(&settings, &rings), PL_OK);
  float *truth = shoot(arrange_rings, 1, white, even, 64, 0);
  double sums[2] = {0.0, 0.0};
  for (uint64_t frame = 0; frame < FRAMES; frame++) { /* one path a pixel is noisy */
    float *found = shoot(arrange_rings, 1, white, analytic, 64, frame);
    for (int y = HEIGHT / 2 - 6; y < HEIGHT / 2 + 6; y++)
      for (int x = WIDTH / 2 - 6; x < WIDTH / 2 + 6; x++) {
        sums[0] += truth[3 * (y * WIDTH + x)] / (144.0 * FRAMES);
        sums[1] += found[3 * (y * WIDTH + x)] / (144.0 * FRAMES);
      }
    free(found);
  }
  print_message("by rings: %.4f, not %.4f\n", sums[1], sums[0]);
  assert_true(sums[0] > 0.01 * white && fabs(sums[1] / sums[0] - 1.0) < PL_DRAWS(0.05, 0.25));
  free(truth);
  pl_rings_destroy(rings);
}

/* Where the light is over white, too, nothing is made of the luck of single paths: no pixel of the
 * middle of the lit half is black. */
static void test_no_black_over_white(void **state) {
  (void)state;
  const double white = 20.0;
  const pl_plan_wish analytic = {.tolerance_dn = 0.5};
  float *found = shoot(arrange_lit, 1, white, analytic, 16, 0);
  for (int y = HEIGHT / 4; y < HEIGHT * 3 / 4; y++)
    for (int x = WIDTH / 4; x < WIDTH / 2; x++)
      assert_true(found[3 * (y * WIDTH + x)] > 0.5 * white);
  free(found);
}

/* Pixels that two images do not share to the bit. */
static int count_other(const float *a, const float *b) {
  int other = 0;
  for (size_t i = 0; i < COUNT; i += 3)
    other += memcmp(a + i, b + i, 3 * sizeof *a) != 0;
  return other;
}

/* At a tolerance of 0 all that a body covers is sampled: what is random differs from frame to
 * frame. Above, most of it has one value. */
static void test_reference_is_sampled(void **state) {
  (void)state;
  float *image[2][2];
  for (int exact = 0; exact < 2; exact++)
    for (int index = 0; index < 2; index++) {
      const pl_plan_wish wish = {.tolerance_dn = exact ? 0.0 : 0.5};
      image[exact][index] = shoot(arrange_globe, 1, WHITE, wish, 4, (uint64_t)index);
    }
  int lit = 0;
  for (size_t i = 0; i < COUNT; i += 3)
    lit += image[0][0][i] > 0.0f;
  const int other[2] = {count_other(image[0][0], image[0][1]),
                        count_other(image[1][0], image[1][1])};
  print_message("of %d lit pixels %d are sampled, %d at a tolerance of 0\n", lit, other[0],
                other[1]);
  assert_true(other[0] < lit / 2 && other[1] > lit * 9 / 10);
  for (int i = 0; i < 4; i++)
    free(image[i / 2][i % 2]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_arcs),
      cmocka_unit_test(test_outlines_of_two),
      converging_unit_test(test_transit),
      cmocka_unit_test(test_edge_in_sky),
      converging_unit_test(test_lit_by_another),
      cmocka_unit_test(test_lit_by_rings),
      cmocka_unit_test(test_no_black_over_white),
      cmocka_unit_test(test_reference_is_sampled),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
