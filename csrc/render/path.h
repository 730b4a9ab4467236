/* Path tracing of one tile, one sample of every pixel at a time. */
#ifndef PL_RENDER_PATH_H
#define PL_RENDER_PATH_H

#include "light/sun.h"
#include "render/patch.h"
#include "render/coverage_mask.h"
#include "render/render.h"

/* A path on its way: where it goes on is the ray of the same index. */
typedef struct pl_path {
  pl_beam beam;
  pl_vec3f throughput;
  float pdf;      /* density with which the ray's direction was drawn; infinite for the camera's */
  float lobe_pdf; /* likewise, by the lobe of the surface alone; not of the camera's */
  uint32_t pixel; /* index in the tile */
  bool shared;    /* what it brings is shared with other pixels, see irradiance_record.c */
} pl_path;

/* Light that arrives if a shadow ray is free. */
typedef struct pl_pending {
  pl_vec3f radiance;
  uint32_t pixel;
  bool shared;
} pl_pending;

/* A path casts at most two shadow rays from a vertex: to the sun and to an emitter. */
enum { PL_TILE_SHADOWS = 2 * PL_TILE_PIXELS };

/* All buffers of one worker. */
typedef struct pl_tile_buffers {
  double directions[3][PL_TILE_PIXELS]; /* of the pixels' centre rays */
  pl_vertex points[PL_TILE_PIXELS];
  pl_hit center_hits[PL_TILE_PIXELS];
  /* Sum over the samples that are on no patch; in the end the mean of all. */
  pl_vec3f radiance[PL_TILE_PIXELS];
  float square[PL_TILE_PIXELS]; /* sum of their squared luminances */
  int counts[PL_TILE_PIXELS];   /* samples, on patches or not */
  pl_pixel_patches patches[PL_TILE_PIXELS];
  /* The sample that is being traced: its patch, its radiance, and that by light that is shared. */
  uint32_t slot[PL_TILE_PIXELS];
  pl_vec3f sample[PL_TILE_PIXELS], shared[PL_TILE_PIXELS];
  uint32_t seeds[PL_TILE_PIXELS];
  int shares[PL_TILE_PIXELS]; /* of a slice: samples of it */
  /* Pixels that need more samples: of these, the first active_meshes may see a mesh. */
  uint32_t active[PL_TILE_PIXELS];
  size_t active_count, active_meshes;
  /* Radiance of the body that a pixel's centre hits, where it is one value for the whole pixel: all
   * samples that hit that body share it. PL_NOTHING: every sample is shaded. */
  uint32_t prefiltered_thing[PL_TILE_PIXELS];
  pl_vec3f prefiltered[PL_TILE_PIXELS];
  bool lit[PL_TILE_PIXELS];                       /* where it is: others light the body there */
  pl_surface prefiltered_surface[PL_TILE_PIXELS]; /* where lit: at the centre */
  pl_vec3f backdrop[PL_TILE_PIXELS]; /* with settings->backdrop: what is behind everything */
  bool single[PL_TILE_PIXELS];       /* one sample is enough */
  uint8_t followed[PL_TILE_PIXELS];  /* paths of a row that are worth following, see
                                        adaptive_sampling.c */
  bool narrow[PL_TILE_PIXELS];       /* few samples may miss a body before what is there */
  pl_path paths[PL_TILE_PIXELS];
  pl_ray rays[PL_TILE_PIXELS];
  pl_hit hits[PL_TILE_PIXELS];
  pl_pending pending[PL_TILE_SHADOWS];
  pl_ray shadow_rays[PL_TILE_SHADOWS];
  bool occluded[PL_TILE_SHADOWS];
  pl_air_tile air;                     /* not set where settings->air is NULL */
  uint32_t wave_seeds[PL_TILE_PIXELS]; /* or pixels */
  float draws[6][PL_TILE_PIXELS];
} pl_tile_buffers;

/* What a tile needs to know. */
typedef struct pl_path_context {
  const pl_snapshot *shot;
  const pl_tracer *tracer;
  const pl_render_settings *settings;
  const pl_sun_view *suns; /* the sun at each object's centre */
  pl_tile tile;
  pl_sun_view camera_sun;      /* the sun as the camera sees it */
  double pixel_rad;            /* angle of a pixel */
  float spread;                /* of a colour sample's cone, per metre */
  const pl_coverage *coverage; /* where meshes may show */
  bool centred;                /* the geometry buffer's rays are those of sample 0 */
  bool sharp;                  /* all rays of a pixel come by one point */
  bool filters_irradiance;     /* pixels pool light, see irradiance_record.c */
  bool few_samples;            /* and do so over many, for few samples */
  bool bodies, sun, air;       /* whether any body, the sun or air may be in this tile's cone */
  bool media;                  /* likewise */
  bool rough_media;            /* likewise, that are not filtered */
} pl_path_context;

/* Fills prefiltered_thing, prefiltered and the list of active pixels; pixels that need no samples
 * get their radiance. Reads points and center_hits. */
void pl_path_prefilter(const pl_path_context *context, pl_tile_buffers *buffers);

/* Adds sample `index` of every active pixel to the sums. The geometry buffer's hits serve sample 0
 * of pinhole cameras. */
void pl_path_sample(const pl_path_context *context, uint32_t index, pl_tile_buffers *buffers);

/* Of a slice: how many of each pixel's samples are of its instant; false: none in the whole tile.
 */
bool pl_path_share(const pl_path_context *context, pl_tile_buffers *buffers);
/* Of a slice, after pl_path_prefilter: draws them; radiance becomes their part of the pixels'
 * means.
 */
void pl_path_slice(const pl_path_context *context, pl_tile_buffers *buffers);

/* Where the light of a path goes. */
static inline pl_vec3f *pl_path_sink(pl_tile_buffers *buffers, uint32_t pixel, bool shared) {
  return shared ? &buffers->shared[pixel] : &buffers->sample[pixel];
}

/* Whether a path that has left its first surface is to be followed; makes it a shared one if it
 * went into a wide lobe. */
bool pl_path_follow(const pl_path_context *context, const pl_vertex *vertex, pl_path *next,
                    pl_tile_buffers *buffers);

/* Of a path that ends at its first surface, drawn to what has set there: counts as one that was
 * followed and found no light. */
void pl_path_lose(const pl_path_context *context, const pl_vertex *vertex, const pl_path *path,
                  pl_tile_buffers *buffers);

/* Counts a sample like those before, whose light stands for its own; false if there is none. */
bool pl_path_repeat(pl_patch *patch);

/* How a path goes on from what the camera's ray hits. */
typedef enum pl_continuation {
  PL_CONTINUATION_DRAWN,  /* what is drawn decides, see pl_path_follow */
  PL_CONTINUATION_SHARED, /* it is shared wherever it goes, and counted */
  PL_CONTINUATION_NONE,   /* counted, but not followed */
} pl_continuation;

/* Decides it of a surface all of whose lobes are wide, unless emitters would have to know: what
 * its path carries on is counted as about its albedo, without the luck of a draw. */
pl_continuation pl_path_continuation(const pl_path_context *context, const pl_surface *surface,
                                     pl_vec3f wo, const pl_path *path, pl_tile_buffers *buffers);

/* Digital numbers by which an error moves a mean luminance. */
float pl_path_error_dn(const pl_render_settings *settings, float mean, float error);

/* Takes the pixels that a single sample is enough for off the active list. */
void pl_path_drop_single(pl_tile_buffers *buffers);

/* Takes the pixels that have samples enough off the active list, see adaptive_sampling.c. Every
 * active pixel has had the same number. */
void pl_path_adapt(const pl_path_context *context, pl_tile_buffers *buffers);

/* Position of colour sample `index` in its pixel, from the centre, where `samples` are the usual
 * number: the Sobol (0,2)-sequence turned so that its first point is the centre, where the labels'
 * ray serves as a colour sample. Every aligned run of 2^k samples has one in each cell of every
 * 2^k-fold division; those before `samples` lie about the centre evenly, later ones fill the gaps.
 */
void pl_path_subpixel(uint32_t index, int samples, double offset[2]);

#endif
