/* Discrete Fourier transform of complex numbers, for lengths that are powers of two. */
#ifndef PL_MATH_FFT_H
#define PL_MATH_FFT_H

#include <stdbool.h>
#include <stddef.h>

typedef struct pl_complex {
  double re, im;
} pl_complex;

/* Smallest power of two >= n; n in 1..2^30. */
size_t pl_fft_size(size_t n);
/* Fills the n / 2 twiddle factors exp(-2 pi i k / n) of transforms of length n. */
void pl_fft_factors(size_t n, pl_complex *factors);
/* In-place transform: X_k = sum_j x_j exp(-2 pi i j k / n); if `inverse`, with the opposite sign
 * and divided by n. `scratch` has room for n numbers. Stockham's radix-2 algorithm (Cochran et al.
 * 1967). */
void pl_fft(pl_complex *data, pl_complex *scratch, size_t n, const pl_complex *factors,
            bool inverse);

#endif
