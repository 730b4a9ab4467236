/* The loop over tiles: geometry buffer by the pixels' centre rays, colour by path tracing. */
#ifndef PL_RENDER_RENDER_H
#define PL_RENDER_RENDER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/parallel.h"
#include "light/emitters.h"
#include "light/limb.h"
#include "render/air_path.h"
#include "render/tile.h"
#include "render/medium.h"
#include "render/planetshine.h"
#include "render/vertex.h"
#include "sky/backdrop.h"

/* One instant of an exposure that is the mean of several: sample j of so many of a pixel of row y
 * is of the time offset_s + y row_s + spread_s (j + r) / samples, with r random, and is drawn at
 * the instant that is nearest of `count`, which are evenly in span_s from start_s on. */
typedef struct pl_slice {
  int instant, count;
  double start_s, span_s;
  double offset_s, row_s, spread_s;
} pl_slice;

typedef struct pl_render_settings {
  uint64_t seed, frame; /* key all randomness */
  int samples;          /* colour samples a pixel; 0: no colour, labels alone */
  int bounces;          /* on meshes */
  bool body_bounces;    /* paths go on from bodies */
  bool planetshine;     /* what bodies reflect lights other things */
  const pl_limb *limb;  /* of the sun's disc, with soft_sun; NULL: of even brightness */
  bool soft_sun, cast_shadows, clear_coat, transmission;
  bool emission;    /* what emits is seen to */
  pl_detail detail; /* of surfaces */
  bool exact;       /* every pixel is sampled: no closed form stands for its mean */
  int lods_down;    /* steps down from Hapke's law to cheaper ones, see reflectance_lod.h */
  const pl_emitters *emitters; /* borrowed; NULL: what emits is seen and lights nothing */
  const pl_air_view *air;      /* borrowed; NULL: none */
  const pl_media *media;       /* borrowed; NULL: none */
  const pl_caustics
      *caustics; /* borrowed; NULL: what mirrors the sun onto others is met by chance */
  const pl_planetshine *shine; /* borrowed; NULL: bodies that light others are met by chance */
  bool emitters_on_bodies;     /* or else on meshes alone */
  const pl_backdrop *backdrop; /* borrowed: what the camera sees behind everything; NULL: black */
  bool see_subpixel;           /* bodies that are subpixel are seen as others are, not black */
  float noise_dn; /* pixels quieter than this get no more samples, see adaptive_sampling.c, and
                   * busy ones more than `samples`; 0: all get `samples` */
  int row0, row1; /* of the image; row1 0: all */
  const pl_slice *slice; /* borrowed; NULL: all samples are of this instant. Else radiance is
                          * the part of it that this instant's samples give, and points are
                          * not filled */
  /* What noise_dn refers to, W m-2 sr-1 encoded as 255: the least of the pictures that are asked
   * for, and of another one, whose lights that are brighter count; 0: there is none. */
  float white_radiance, white_other;
} pl_render_settings;

/* A finished tile. Arrays have PL_TILE_SIDE pixels a row; valid until the callback returns. A pixel
 * that sees nothing has points[i].thing == PL_NOTHING. */
typedef struct pl_tile_result {
  pl_tile tile;
  bool empty;               /* nothing was or could be hit; points are all PL_NOTHING */
  const pl_vertex *points;  /* what the centre ray hits; surface holds only the frame's ng */
  const pl_vec3f *radiance; /* W m-2 sr-1; zeros when samples is 0 */
} pl_tile_result;

typedef pl_status (*pl_tile_fn)(void *context, const pl_tile_result *result, int worker);

/* Per-worker memory, kept between frames. */
typedef struct pl_render_scratch pl_render_scratch;
pl_status pl_render_scratch_create(int threads, pl_render_scratch **out);
void pl_render_scratch_destroy(pl_render_scratch *scratch);
int pl_render_scratch_threads(const pl_render_scratch *scratch);

/* The instant of a sample, see above; `part`: r, 0..1. */
static inline int pl_slice_of(const pl_slice *slice, int row, int sample, int samples,
                              double part) {
  const double t_s =
      slice->offset_s + row * slice->row_s + slice->spread_s * (sample + part) / samples;
  const double at = floor((t_s - slice->start_s) / slice->span_s * slice->count);
  return (int)fmin(fmax(at, 0.0), slice->count - 1);
}

/* Renders the snapshot that `tracer` was set to. `done` is called once a tile, on the worker that
 * made it; and again without points, when all are made, for those whose radiance was not yet
 * whole: only with a noise_dn. Results do not depend on the number of threads. */
pl_status pl_render(const pl_snapshot *shot, const pl_tracer *tracer,
                    const pl_render_settings *settings, pl_render_scratch *scratch, pl_tile_fn done,
                    void *context, pl_cancel *cancel);

#endif
