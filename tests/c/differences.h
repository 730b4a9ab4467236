/* Differences between frames of the same stage beyond their noise, in digital numbers. */
#ifndef PL_TESTS_DIFFERENCES_H
#define PL_TESTS_DIFFERENCES_H

#include "frames.h"

enum { WIDTH = 24, HEIGHT = 20, PIXELS = WIDTH * HEIGHT, SEEDS = 6 };

/* IEC 61966-2-1, not rounded, of 0..1. */
static inline double encode(double x) {
  const double v = fmin(fmax(x, 0.0), 1.0);
  return 255.0 * (v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1.0 / 2.4) - 0.055);
}

/* Mean and variance of the mean, per pixel and band, of radiance over white, clipped at white: what
 * the display shows of it. */
typedef struct statistic {
  double mean[3 * PIXELS], variance[3 * PIXELS];
} statistic;

/* What is asked of frames; results are the last one's. */
typedef struct asked {
  int samples, texture_filter;
  pl_plan_wish wish;
} asked;

static inline pl_frame_result measure(const stage *s, pl_renderer *renderer, asked asked,
                                      statistic *out) {
  film f;
  pl_frame_result result;
  film_init(&f, s);
  memset(out, 0, sizeof *out);
  memset(&result, 0, sizeof result);
  for (int seed = 0; seed < SEEDS; seed++) {
    pl_frame_request request = request_all(s, &f);
    request.seed = 1000 + (uint64_t)seed;
    request.samples = asked.samples;
    request.max_bounces = 4;
    request.texture_filter = asked.texture_filter;
    request.wish = asked.wish;
    result = render(renderer, &request);
    for (size_t i = 0; i < 3 * PIXELS; i++) {
      const double x = fmin((double)f.radiance[i] / request.exposure.white_radiance, 1.0);
      assert_true(x >= 0.0);
      out->mean[i] += x / SEEDS;
      out->variance[i] += x * x / SEEDS;
    }
  }
  for (size_t i = 0; i < 3 * PIXELS; i++)
    out->variance[i] = fmax(0.0, out->variance[i] - out->mean[i] * out->mean[i]) / (SEEDS - 1);
  film_clear(&f);
  return result;
}

/* What a row of a plan may change beside a frame with every effect on. The residual of multiple
 * scattering, if it is on, is that of isotropic light, which such a frame has, too. */
static inline double left_out_dn(const pl_plan_row *row) {
  return row->effect == &pl_effect_multiple_scattering && row->value > 0 ? 0.0 : row->residual_dn;
}

/* Largest difference beyond the noise, in digital numbers: five standard errors either way in
 * linear light (with six seeds a t value passed once in 2e3 pixels), and 0.1. A pixel in a thousand
 * may pass. */
static inline double excess(const statistic *a, const statistic *b, double allowed) {
  int beyond = 0;
  double largest = 0.0;
  for (size_t i = 0; i < 3 * PIXELS; i++) {
    const double noise = 5.0 * sqrt(a->variance[i] + b->variance[i]);
    const double high = fmax(a->mean[i], b->mean[i]), low = fmin(a->mean[i], b->mean[i]);
    const double step =
        encode(high - 0.5 * fmin(noise, high - low)) - encode(low + 0.5 * fmin(noise, high - low));
    largest = fmax(largest, step);
    beyond += step > allowed + 0.1;
  }
  return beyond > 3 * PIXELS / 1000 ? largest : 0.0;
}

#endif
