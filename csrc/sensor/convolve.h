/* Convolution of images with a kernel by Fourier transform. Images are 0 outside their borders. */
#ifndef PL_SENSOR_CONVOLVE_H
#define PL_SENSOR_CONVOLVE_H

#include "base/memory.h"
#include "base/parallel.h"
#include "math/fft.h"

/* A padded plane of complex numbers whose sides are powers of two. */
typedef struct pl_plane {
  size_t width, height;   /* including padding */
  size_t inner_height;    /* rows that hold the image; the others are padding */
  pl_complex *factors[2]; /* twiddle factors of rows and of columns */
  pl_complex *scratch;    /* for all threads, scratch_each numbers per thread */
  size_t scratch_each;
  int threads;
  pl_cancel *cancel; /* may be NULL */
} pl_plane;

/* Padded side length for a kernel with a half width of `least` pixels, or for one that extends
 * across the whole image if that is less. */
size_t pl_plane_side(int side, int least);
/* Largest half width of a kernel, in pixels, that the padded side allows. */
int pl_plane_reach(int side, int least);
/* `reach`: half width of the kernel (x, y; pixels). In: the required one; out: the available one.
 */
pl_status pl_plane_init(pl_plane *plane, int width, int height, int threads, pl_cancel *cancel,
                        pl_arena *arena, int reach[2]);
/* Allocates the numbers of a plane, all 0. Returns NULL if out of memory. */
pl_complex *pl_plane_alloc(const pl_plane *plane, pl_arena *arena);
/* Transforms a kernel to its spectrum. The kernel's centre is at (0, 0); the parts to the left and
 * above wrap around to the far ends. */
pl_status pl_plane_spectrum(const pl_plane *plane, pl_complex *kernel);
/* Convolves an image (in the upper left corner, 0 elsewhere) with the kernel of a spectrum.
 * Afterwards only the image's rows are valid. The real and the imaginary part are two independent
 * images. */
pl_status pl_plane_convolve(const pl_plane *plane, pl_complex *data, const pl_complex *spectrum);

#endif
