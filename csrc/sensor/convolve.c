/* Fourier transforms of planes. Rows and blocks of columns run in parallel; one thread transforms
 * each line. */
#include "sensor/convolve.h"

#include <string.h>

/* Columns that are gathered together: 8 * 16 bytes are two cache lines. */
enum { BLOCK = 8 };

size_t pl_plane_side(int side, int least) {
  return pl_fft_size((size_t)side + (size_t)(least < side ? least : side - 1));
}

int pl_plane_reach(int side, int least) {
  const size_t room = pl_plane_side(side, least) - (size_t)side;
  return room < (size_t)side ? (int)room : side - 1;
}

pl_status pl_plane_init(pl_plane *plane, int width, int height, int threads, pl_cancel *cancel,
                        pl_arena *arena, int reach[2]) {
  *plane = (pl_plane){.inner_height = (size_t)height, .threads = threads, .cancel = cancel};
  plane->width = pl_plane_side(width, reach[0]);
  plane->height = pl_plane_side(height, reach[1]);
  reach[0] = pl_plane_reach(width, reach[0]);
  reach[1] = pl_plane_reach(height, reach[1]);
  const size_t longer = plane->width > plane->height ? plane->width : plane->height;
  plane->scratch_each = (BLOCK + 1) * longer;
  plane->factors[0] = pl_arena_alloc(arena, plane->width, sizeof(pl_complex));
  plane->factors[1] = pl_arena_alloc(arena, plane->height, sizeof(pl_complex));
  plane->scratch = pl_arena_alloc(arena, (size_t)threads * plane->scratch_each, sizeof(pl_complex));
  if (plane->factors[0] == NULL || plane->factors[1] == NULL || plane->scratch == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for a Fourier transform");
  pl_fft_factors(plane->width, plane->factors[0]);
  pl_fft_factors(plane->height, plane->factors[1]);
  return PL_OK;
}

pl_complex *pl_plane_alloc(const pl_plane *plane, pl_arena *arena) {
  const size_t count = plane->width * plane->height;
  pl_complex *data = pl_arena_alloc(arena, count, sizeof *data);
  if (data != NULL)
    memset(data, 0, count * sizeof *data);
  return data;
}

typedef struct job {
  const pl_plane *plane;
  pl_complex *data;
  const pl_complex *kernel; /* multiplied in before the inverse; NULL: forward */
} job;

static pl_status do_row(void *context, size_t row, int worker) {
  const job *j = context;
  const pl_plane *p = j->plane;
  pl_complex *scratch = p->scratch + (size_t)worker * p->scratch_each;
  pl_fft(j->data + row * p->width, scratch, p->width, p->factors[0], j->kernel != NULL);
  return PL_OK;
}

static pl_status do_columns(void *context, size_t block, int worker) {
  const job *j = context;
  const pl_plane *p = j->plane;
  const size_t first = block * BLOCK, height = p->height;
  const size_t count = p->width - first < BLOCK ? p->width - first : BLOCK;
  pl_complex *lines = p->scratch + (size_t)worker * p->scratch_each;
  for (size_t y = 0; y < height; y++)
    for (size_t k = 0; k < count; k++)
      lines[k * height + y] = j->data[y * p->width + first + k];
  for (size_t k = 0; k < count; k++) {
    pl_complex *line = lines + k * height;
    pl_fft(line, lines + BLOCK * height, height, p->factors[1], false);
    for (size_t y = 0; j->kernel != NULL && y < height; y++) {
      const pl_complex a = line[y], b = j->kernel[y * p->width + first + k];
      line[y] = (pl_complex){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
    }
    if (j->kernel != NULL)
      pl_fft(line, lines + BLOCK * height, height, p->factors[1], true);
  }
  for (size_t y = 0; y < height; y++)
    for (size_t k = 0; k < count; k++)
      j->data[y * p->width + first + k] = lines[k * height + y];
  return PL_OK;
}

static size_t blocks(const pl_plane *plane) { return (plane->width + BLOCK - 1) / BLOCK; }

pl_status pl_plane_spectrum(const pl_plane *plane, pl_complex *kernel) {
  job job = {plane, kernel, NULL};
  PL_TRY(pl_parallel_for(plane->threads, plane->height, do_row, &job, plane->cancel));
  return pl_parallel_for(plane->threads, blocks(plane), do_columns, &job, plane->cancel);
}

pl_status pl_plane_convolve(const pl_plane *plane, pl_complex *data, const pl_complex *spectrum) {
  job forward = {plane, data, NULL}, back = {plane, data, spectrum};
  PL_TRY(pl_parallel_for(plane->threads, plane->inner_height, do_row, &forward, plane->cancel));
  PL_TRY(pl_parallel_for(plane->threads, blocks(plane), do_columns, &back, plane->cancel));
  return pl_parallel_for(plane->threads, plane->inner_height, do_row, &back, plane->cancel);
}
