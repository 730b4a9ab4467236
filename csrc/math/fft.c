/* Stockham FFT: no bit reversal, and each pass reads and writes sequentially. */
#include "math/fft.h"

#include <math.h>
#include <string.h>

static const double TWO_PI = 6.28318530717958647692;

size_t pl_fft_size(size_t n) {
  size_t size = 1;
  while (size < n)
    size *= 2;
  return size;
}

void pl_fft_factors(size_t n, pl_complex *factors) {
  for (size_t k = 0; k < n / 2; k++) {
    const double angle = TWO_PI * (double)k / (double)n;
    factors[k] = (pl_complex){cos(angle), -sin(angle)};
  }
}

/* One pass: `half` butterflies on `stride` interleaved transforms of length 2 half. */
static void pass(const pl_complex *restrict from, pl_complex *restrict to, size_t half,
                 size_t stride, const pl_complex *factors, double sign) {
  for (size_t p = 0; p < half; p++) {
    const pl_complex w = {factors[p * stride].re, sign * factors[p * stride].im};
    const pl_complex *a = from + stride * p, *b = from + stride * (p + half);
    pl_complex *sum = to + stride * 2 * p, *rest = sum + stride;
    for (size_t q = 0; q < stride; q++) {
      const pl_complex d = {a[q].re - b[q].re, a[q].im - b[q].im};
      sum[q] = (pl_complex){a[q].re + b[q].re, a[q].im + b[q].im};
      rest[q] = (pl_complex){d.re * w.re - d.im * w.im, d.re * w.im + d.im * w.re};
    }
  }
}

void pl_fft(pl_complex *data, pl_complex *scratch, size_t n, const pl_complex *factors,
            bool inverse) {
  pl_complex *from = data, *to = scratch;
  for (size_t half = n / 2, stride = 1; half > 0; half /= 2, stride *= 2) {
    pass(from, to, half, stride, factors, inverse ? -1.0 : 1.0);
    pl_complex *other = from;
    from = to;
    to = other;
  }
  if (from != data)
    memcpy(data, from, n * sizeof *data);
  for (size_t i = 0; inverse && i < n; i++)
    data[i] = (pl_complex){data[i].re / (double)n, data[i].im / (double)n};
}
