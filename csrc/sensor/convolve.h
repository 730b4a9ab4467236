/* Images convolved with a kernel, by Fourier transform; beyond the image all is dark. */
#ifndef PL_SENSOR_CONVOLVE_H
#define PL_SENSOR_CONVOLVE_H

#include "base/memory.h"
#include "base/parallel.h"
#include "math/fft.h"

/* A padded plane of complex numbers, sides powers of two. */
typedef struct pl_plane {
  size_t width, height;   /* padded */
  size_t inner_height;    /* rows that hold an image; the others are padding */
  pl_complex *factors[2]; /* of rows and of columns */
  pl_complex *scratch;    /* for each thread */
  size_t scratch_each;
  int threads;
  pl_cancel *cancel; /* may be NULL */
} pl_plane;

/* The padded side for a kernel that reaches `least` pixels or from end to end of the image. */
size_t pl_plane_side(int side, int least);
/* What a kernel may then reach. */
int pl_plane_reach(int side, int least);
/* `reach` (x, y; pixels): what a kernel has to reach; becomes what it reaches. */
pl_status pl_plane_init(pl_plane *plane, int width, int height, int threads, pl_cancel *cancel,
                        pl_arena *arena, int reach[2]);
/* Room for a plane's numbers, all 0; NULL when out of memory. */
pl_complex *pl_plane_alloc(const pl_plane *plane, pl_arena *arena);
/* A kernel to its spectrum. Its centre is at (0, 0), what is left of or above it at the far ends.
 */
pl_status pl_plane_spectrum(const pl_plane *plane, pl_complex *kernel);
/* Convolves an image (in the upper left corner, else 0) with the kernel of a spectrum; only the
 * image's rows are right afterwards. The real and the imaginary part are two images. */
pl_status pl_plane_convolve(const pl_plane *plane, pl_complex *data, const pl_complex *spectrum);

#endif
