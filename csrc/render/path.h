/* Path tracing of one tile, one sample of every pixel at a time. */
#ifndef PL_RENDER_PATH_H
#define PL_RENDER_PATH_H

#include "light/sun.h"
#include "render/patch.h"
#include "render/coverage_mask.h"
#include "render/render.h"

/* A path in progress. Its next segment is the ray of the same index. */
typedef struct pl_path {
  pl_beam beam;
  pl_vec3f throughput;
  float pdf;      /* density with which the ray's direction was drawn; infinite for camera rays */
  float lobe_pdf; /* likewise by the surface's lobe alone; not set for camera rays */
  uint32_t pixel; /* index in the tile */
  bool filtered;  /* the irradiance filter takes its light, see irradiance_record.c */
} pl_path;

/* Light that arrives if a shadow ray is unoccluded. */
typedef struct pl_pending {
  pl_vec3f radiance;
  uint32_t pixel;
  bool filtered;
} pl_pending;

/* A path casts at most two shadow rays from a vertex: to the sun and to an emitter. */
enum { PL_TILE_SHADOWS = 2 * PL_TILE_PIXELS };

/* All buffers of one worker. Those of effects are made by the first frame that has them. */
typedef struct pl_tile_buffers {
  double directions[3][PL_TILE_PIXELS]; /* of the rays through the pixels' centres */
  pl_point points[PL_TILE_PIXELS];
  pl_hit center_hits[PL_TILE_PIXELS];
  /* Sum over the samples without a patch; at the end the mean of all samples. */
  pl_vec3f radiance[PL_TILE_PIXELS];
  float square[PL_TILE_PIXELS]; /* sum of their squared luminances */
  int counts[PL_TILE_PIXELS];   /* number of samples, with or without a patch */
  pl_pixel_patches *patches;    /* of all pixels; NULL until a frame filters irradiance */
  /* The sample that is being traced: its patch, its radiance, and the radiance of its filtered
   * light.
   */
  uint32_t slot[PL_TILE_PIXELS];
  pl_vec3f sample[PL_TILE_PIXELS], filtered[PL_TILE_PIXELS];
  uint32_t seeds[PL_TILE_PIXELS];
  int sample_counts[PL_TILE_PIXELS]; /* of a slice */
  /* Pixels that need more samples: the first active_meshes of them may see a mesh. */
  uint32_t active[PL_TILE_PIXELS];
  size_t active_count, active_meshes;
  /* Radiance of the body that a pixel's centre hits, where one value holds for the whole pixel. All
   * samples that hit that body use it. PL_NO_SURFACE: every sample is shaded. */
  pl_surface_id prefiltered_id[PL_TILE_PIXELS];
  pl_vec3f prefiltered[PL_TILE_PIXELS];
  bool lit[PL_TILE_PIXELS]; /* where prefiltered: other surfaces light the body */
  pl_surface prefiltered_surface[PL_TILE_PIXELS]; /* where `lit`: at the pixel's centre */
  pl_vec3f backdrop[PL_TILE_PIXELS]; /* with settings->backdrop: the radiance behind everything */
  bool single[PL_TILE_PIXELS];       /* one sample is enough */
  /* number of paths of a run of PL_IRRADIANCE_ROW that are worth following, see adaptive_sampling.c
   */
  uint8_t followed[PL_TILE_PIXELS];
  bool narrow[PL_TILE_PIXELS]; /* a few samples may miss a body in front of what the centre hits */
  pl_path paths[PL_TILE_PIXELS];
  pl_ray rays[PL_TILE_PIXELS];
  pl_hit hits[PL_TILE_PIXELS];
  pl_vertex vertices[PL_SHADE_RUN]; /* of the paths that are shaded together */
  pl_pending pending[PL_TILE_SHADOWS];
  pl_ray shadow_rays[PL_TILE_SHADOWS];
  bool occluded[PL_TILE_SHADOWS];
  pl_air_tile *air;                    /* NULL until a frame has air; then not set without it */
  uint32_t wave_seeds[PL_TILE_PIXELS]; /* or indices of pixels */
  float draws[6][PL_TILE_PIXELS];
} pl_tile_buffers;

/* What is constant for a tile. */
typedef struct pl_path_context {
  const pl_snapshot *shot;
  const pl_tracer *tracer;
  const pl_render_settings *settings;
  const pl_sun_view *suns; /* the sun at each object's centre */
  pl_tile tile;
  pl_sun_view camera_sun;      /* the sun as seen from the camera */
  double pixel_rad;            /* angular size of a pixel */
  float spread;                /* of the cone of a colour sample, m per m */
  const pl_coverage *coverage; /* pixels that may show meshes */
  bool centred;                /* sample 0 has the rays of the geometry buffer */
  bool sharp;                  /* all rays of a pixel pass through one point */
  bool filters_irradiance;     /* see irradiance_record.c */
  bool few_samples;            /* and each has few samples, so that draws are spread over pixels */
  bool bodies, sun, air;       /* whether any body, the sun or air may be in this tile's cone */
  bool media;                  /* likewise */
  bool rough_media;            /* likewise, of the kinds that are not filtered */
} pl_path_context;

/* Fills prefiltered_id, prefiltered and the list of active pixels. Sets the radiance of pixels
 * that need no samples. Reads points and center_hits. */
void pl_path_prefilter(const pl_path_context *context, pl_tile_buffers *buffers);

/* Adds sample `index` of every active pixel to the sums. Sample 0 of pinhole cameras uses the hits
 * of the geometry buffer. */
void pl_path_sample(const pl_path_context *context, uint32_t index, pl_tile_buffers *buffers);

/* For a slice: counts the samples of each pixel that fall in its instant; false if the tile has
 * none. */
bool pl_path_count_slice(const pl_path_context *context, pl_tile_buffers *buffers);
/* For a slice, after pl_path_prefilter: renders these samples. `radiance` becomes their
 * contribution to the pixels' means. */
void pl_path_slice(const pl_path_context *context, pl_tile_buffers *buffers);

/* Number of patches of a pixel. */
static inline uint32_t pl_path_patch_count(const pl_tile_buffers *buffers, uint32_t pixel) {
  return buffers->patches != NULL ? buffers->patches[pixel].count : 0;
}

/* Where the light of a path is added. */
static inline pl_vec3f *pl_path_sink(pl_tile_buffers *buffers, uint32_t pixel, bool filtered) {
  return filtered ? &buffers->filtered[pixel] : &buffers->sample[pixel];
}

/* Decides whether a path is followed from its first surface, and returns that. Changes `next`: it
 * is marked as filtered if it continued into a wide lobe. */
bool pl_path_follow(const pl_path_context *context, const pl_vertex *vertex, pl_path *next,
                    pl_tile_buffers *buffers);

/* For a path that ends at its first surface because the body drawn is below the horizon there:
 * counts it as a followed path that found no light. */
void pl_path_lose(const pl_path_context *context, const pl_vertex *vertex, const pl_path *path,
                  pl_tile_buffers *buffers);

/* Counts one more sample like the previous ones, whose light is used for it; false if no path of
 * the patch was followed. */
bool pl_path_repeat(pl_patch *patch);

/* How a path continues from the camera ray's hit. */
typedef enum pl_continuation {
  PL_CONTINUATION_DRAWN,    /* decided by the direction drawn, see pl_path_follow */
  PL_CONTINUATION_FILTERED, /* filtered whatever its direction, and counted */
  PL_CONTINUATION_NONE,     /* counted, but not followed */
} pl_continuation;

/* Decides how a path continues from a surface whose lobes are all wide; PL_CONTINUATION_DRAWN if
 * some lobe is not, or if there are emitters, which depend on the draw. The throughput is counted
 * approximately, as that times the albedo, and so without the noise of a draw. */
pl_continuation pl_path_continuation(const pl_path_context *context, const pl_surface *surface,
                                     pl_vec3f wo, const pl_path *path, pl_tile_buffers *buffers);

/* Shift of the displayed value, in DN, that an error of a mean luminance causes. */
float pl_path_error_dn(const pl_render_settings *settings, float mean, float error);

/* Removes the pixels for which one sample is enough from the active list. */
void pl_path_drop_single(pl_tile_buffers *buffers);

/* Number of samples of a pixel on the sun's limb, if noise is allowed at all. The disc is so bright
 * that a thousandth of it makes a pixel white. */
enum { PL_SUN_LIMB_SAMPLES = 1024 };
/* True if the sun's limb may cross the pixel. */
bool pl_path_on_limb(const pl_path_context *context, uint32_t pixel);
/* Number of rays with which each sample of a pixel looks for the sun; 0: its own does. */
int pl_path_limb_rays(const pl_path_context *context, uint32_t pixel);
/* Adds what these rays of sample `index` find, in all active pixels. */
void pl_path_see_limb(const pl_path_context *context, uint32_t index, pl_tile_buffers *b);
/* Removes all pixels from the active list but those in which the sun's limb may be seen. */
void pl_path_keep_limb(const pl_path_context *context, pl_tile_buffers *buffers);

/* Removes the pixels with enough samples from the active list, see adaptive_sampling.c. All active
 * pixels must have the same number of samples. */
void pl_path_adapt(const pl_path_context *context, pl_tile_buffers *buffers);

/* Number of active pixels whose error is above the target that settings state. */
size_t pl_path_missed(const pl_path_context *context, const pl_tile_buffers *buffers);

#endif
