/* The loop over tiles: the geometry buffer from the rays through the pixels' centres, and colour by
 * path tracing. */
#ifndef PL_RENDER_RENDER_H
#define PL_RENDER_RENDER_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/parallel.h"
#include "light/emitters.h"
#include "light/limb.h"
#include "plan/effects.h"
#include "render/air_path.h"
#include "render/coverage_mask.h"
#include "render/tile.h"
#include "render/medium.h"
#include "render/planetshine.h"
#include "render/vertex.h"
#include "scene/image_sample.h"
#include "sky/backdrop.h"

typedef struct pl_render_settings {
  uint64_t seed, frame; /* part of the key of all random numbers */
  int samples;          /* colour samples per pixel; 0: no colour, only labels */
  int label_rays;       /* of labels, in each pixel that a mesh may show in; beside the centre's */
  int bounces;          /* maximum number, on meshes */
  const pl_limb *limb;  /* limb darkening of the sun's disc, with soft_sun; NULL: uniform disc */
  pl_effect_values effects;
  pl_detail detail; /* of surfaces */
  bool exact;       /* every pixel is sampled; no closed form replaces its mean */
  int lods_down;    /* steps down from Hapke's law to cheaper ones, see reflectance_lod.h */
  const pl_emitters *emitters; /* borrowed; NULL: emitters are visible but light nothing */
  const pl_air_view *air;      /* borrowed; NULL: none */
  const pl_media *media;       /* borrowed; NULL: none */
  const pl_caustics
      *caustics; /* borrowed; NULL: mirror reflections of the sun are found only by chance */
  /* borrowed; NULL: bodies that light others are found only by chance */
  const pl_planetshine *planetshine;
  bool emitters_on_bodies;     /* emitters light bodies too, not only meshes */
  const pl_backdrop *backdrop; /* borrowed; radiance behind everything; NULL: black */
  bool shadow_mask;            /* points say whether they are in shadow */
  bool shadow_cause;           /* and of what, with shadow_mask */
  bool see_subpixel;           /* sub-pixel bodies are shaded like others, not black */
  /* pixels with less noise than this get no more samples, see adaptive_sampling.c, and noisy ones
   * more than `samples`; 0: all get `samples` */
  float noise_dn;
  /* only a block of each tile is rendered, and its work is counted for the whole tile, base/work.h;
   * the picture is of no use */
  bool pilot;
  /* Error of a pixel that samples are taken for, up to `samples`, digital numbers, and how many
   * standard errors it is to be; 0: none is stated. Nothing is shared between pixels then. */
  float target_dn, target_sigmas;
  /* Pixels that `samples` samples did not bring to the target are added to it; NULL: not counted */
  atomic_size_t *missed;
  int row0, row1; /* rows of the image to render; row1 0: all */
  /* borrowed; NULL: all samples are of this instant. Otherwise radiance is the contribution of this
   * instant's samples to the mean, and points are not filled */
  const pl_slice *slice;
  /* Radiance encoded as 255, which noise_dn refers to, W m-2 sr-1: the lower one of the requested
   * images, and that of the other image, which shows brighter lights too; 0: there is one image. */
  float white_radiance, white_other;
} pl_render_settings;

/* A finished tile. Arrays have PL_TILE_SIDE pixels per row and are valid until the callback
 * returns. A pixel that sees nothing has points[i].surface_id = PL_NO_SURFACE. */
typedef struct pl_tile_result {
  pl_tile tile;
  bool empty; /* nothing was or could be hit; no point has a surface */
  /* hits of the rays through the pixels' centres; in_shadow and shadow_cause only where there is a
   * surface, and if settings ask for it */
  const pl_point *points;
  const pl_vec3f *radiance; /* W m-2 sr-1; zero if samples is 0 */
  /* of the instant, for labels that need more rays */
  const pl_tracer *tracer;
  const pl_coverage *coverage; /* where meshes may be, valid in the rows of the tile */
} pl_tile_result;

typedef pl_status (*pl_tile_fn)(void *context, const pl_tile_result *result, int worker);

/* Per-worker memory, kept between frames. */
typedef struct pl_render_scratch pl_render_scratch;
pl_status pl_render_scratch_create(int threads, pl_render_scratch **out);
void pl_render_scratch_destroy(pl_render_scratch *scratch);
int pl_render_scratch_threads(const pl_render_scratch *scratch);

/* Renders the snapshot that `tracer` was set to. Calls `done` once per tile, on the worker that
 * made it. With noise_dn set, calls it again, without points, for tiles whose radiance is complete
 * only after all tiles are made. Results do not depend on the number of threads. */
pl_status pl_render(const pl_snapshot *shot, const pl_tracer *tracer,
                    const pl_render_settings *settings, pl_render_scratch *scratch, pl_tile_fn done,
                    void *context, pl_cancel *cancel);

#endif
