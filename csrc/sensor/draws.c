/* Uniform, normal and Poisson random numbers from a Philox stream. */
#include "sensor/draws.h"

#include <math.h>

#include "math/philox.h"

static const double TWO_PI = 6.28318530717958647692;
static const double INVERSION_BELOW = 10.0, NORMAL_FROM = 1e4;
/* Separates these streams from others with the same seed: "sensor" in ASCII. */
static const uint64_t DOMAIN = UINT64_C(0x73656e736f720000);

pl_stream pl_stream_of(uint64_t seed, pl_draw what, uint64_t item, uint64_t frame) {
  return (pl_stream){{seed, DOMAIN + (uint64_t)what}, {item, frame, 0, 0}};
}

double pl_stream_uniform(pl_stream *stream) {
  uint64_t words[4];
  pl_philox(stream->key, stream->counter, words);
  stream->counter[2]++;
  return pl_philox_double(words[0]);
}

/* As pl_stream_uniform, but never 0, so that its logarithm is finite. */
static double stream_open(pl_stream *stream) { return pl_stream_uniform(stream) + 0x1p-54; }

double pl_stream_normal(pl_stream *stream) {
  uint64_t words[4];
  pl_philox(stream->key, stream->counter, words);
  stream->counter[2]++;
  const double u = pl_philox_double(words[0]) + 0x1p-54, v = pl_philox_double(words[1]);
  return sqrt(-2.0 * log(u)) * cos(TWO_PI * v);
}

static double poisson_by_inversion(pl_stream *stream, double mean) {
  const double u = pl_stream_uniform(stream);
  double probability = exp(-mean), sum = probability, count = 0.0;
  /* The tail beyond 100 is 1e-60 at a mean of 10; the limit ends the loop if rounding keeps sum
   * low. */
  while (u >= sum && count < 100.0) {
    count += 1.0;
    probability *= mean / count;
    sum += probability;
  }
  return count;
}

/* log(k!) with an error below 1e-9: Stirling's series, with the recurrence where the series is
 * inaccurate. */
static double log_factorial(double k) {
  double shift = 0.0;
  for (; k < 9.0; k += 1.0)
    shift += log(k + 1.0);
  const double x = k + 1.0, r = 1.0 / (x * x);
  const double series = (1.0 / 12.0 - r * (1.0 / 360.0 - r * (1.0 / 1260.0 - r / 1680.0))) / x;
  return (x - 0.5) * log(x) - x + 0.5 * log(TWO_PI) + series - shift;
}

static double poisson_by_rejection(pl_stream *stream, double mean) {
  const double log_mean = log(mean);
  const double b = 0.931 + 2.53 * sqrt(mean), a = -0.059 + 0.02483 * b;
  const double inverse_alpha = 1.1239 + 1.1328 / (b - 3.4), v_r = 0.9277 - 3.6224 / (b - 2.0);
  for (;;) {
    const double u = pl_stream_uniform(stream) - 0.5, v = stream_open(stream);
    const double us = 0.5 - fabs(u);
    const double k = floor((2.0 * a / us + b) * u + mean + 0.43);
    if (us >= 0.07 && v <= v_r)
      return k;
    if (k < 0.0 || (us < 0.013 && v > us))
      continue;
    if (log(v) + log(inverse_alpha) - log(a / (us * us) + b) <=
        k * log_mean - mean - log_factorial(k))
      return k;
  }
}

double pl_stream_poisson(pl_stream *stream, double mean) {
  if (!(mean > 0.0))
    return 0.0;
  if (mean < INVERSION_BELOW)
    return poisson_by_inversion(stream, mean);
  if (mean < NORMAL_FROM)
    return poisson_by_rejection(stream, mean);
  return fmax(0.0, floor(mean + sqrt(mean) * pl_stream_normal(stream) + 0.5));
}

double pl_poisson_most(double mean) {
  const double rare = 20.72326583694641; /* -log(1e-9) */
  if (!(mean > 0.0) || !isfinite(mean))
    return mean > 0.0 ? mean : 0.0;
  /* Newton's steps on a convex function stay above the root if they start there: at Bernstein's
   * bound. */
  double k = mean + rare / 3.0 + sqrt(rare * rare / 9.0 + 2.0 * rare * mean);
  for (int step = 0; step < 8; step++) {
    const double slope = log(k / mean);
    k -= slope > 0.0 ? (k * slope - k + mean - rare) / slope : 0.0;
  }
  return k;
}
