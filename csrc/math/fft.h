/* The discrete Fourier transform of a power of two of complex numbers. */
#ifndef PL_MATH_FFT_H
#define PL_MATH_FFT_H

#include <stdbool.h>
#include <stddef.h>

typedef struct pl_complex {
  double re, im;
} pl_complex;

/* The smallest power of two that is at least n; n in 1..2^30. */
size_t pl_fft_size(size_t n);
/* Fills the n / 2 factors exp(-2 pi i k / n) that transforms of n numbers need. */
void pl_fft_factors(size_t n, pl_complex *factors);
/* In place: X_k = sum_j x_j exp(-2 pi i j k / n), or with the other sign and divided by n if
 * `inverse`. `scratch` has room for n. Stockham's radix-2 (Cochran et al. 1967). */
void pl_fft(pl_complex *data, pl_complex *scratch, size_t n, const pl_complex *factors,
            bool inverse);

#endif
