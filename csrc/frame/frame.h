/* Rendering of one frame: placement -> snapshot -> exposure -> plan -> rays -> arrays. */
#ifndef PL_FRAME_FRAME_H
#define PL_FRAME_FRAME_H

#include "annotate/channel.h"
#include "annotate/flow.h"
#include "annotate/ground_map.h"
#include "annotate/instance_coverage.h"
#include "annotate/keypoint.h"
#include "annotate/object_label.h"
#include "base/parallel.h"
#include "base/work.h"
#include "frame/sky.h"
#include "plan/plan.h"
#include "scene/scene.h"
#include "sensor/bands.h"
#include "sensor/exposure.h"
#include "sensor/sensor.h"

enum { PL_FRAME_CHANNELS_MAX = 64 };

typedef struct pl_frame_request {
  uint64_t seed, index;
  pl_placement placement;
  int samples;        /* upper limit of Monte Carlo samples per pixel, >= 1 */
  int max_bounces;    /* >= 0 */
  int texture_filter; /* upper limit: a pl_filter, not PL_FILTER_NONE */
  /* upper limit of steps along a ray through volumes, >= 1 if there are any volumes */
  int volume_steps;
  /* error of a pixel that samples are taken for, digital numbers, and its probability as a number
   * of standard errors; 0: every pixel is as good as `samples` make it */
  double target_dn, target_sigmas;
  pl_plan_wish wish;
  pl_exposure exposure;
  /* borrowed; NULL for no sensor: then raw, sensor_rgb and glare are not available */
  const pl_sensor *sensor;
  const float (*band_parts)[3]; /* borrowed: weights from pl_bands_write */
  int band_count;               /* 0 for none: then `bands` is not available */
  const pl_sky *sky;            /* borrowed; NULL for a black sky */
  int threads;
  pl_cancel *cancel; /* may be NULL */
  /* Only the work of the colour is counted, on a part of the picture: see pl_render_settings. No
   * output but rgb may be asked for, which is of no use. */
  bool pilot;
  /* Output arrays; NULL: not computed. All are height x width images, row-major. */
  uint8_t *rgb;        /* 3 per pixel */
  float *radiance;     /* 3 per pixel, W m-2 sr-1 */
  float *bands;        /* band_count per pixel, W m-2 sr-1 in each band */
  uint16_t *raw;       /* digital numbers of the sensor: 1 per pixel, or one per plane */
  uint8_t *sensor_rgb; /* 3 per pixel: the sensor's image as displayed */
  float *glare;        /* light from elsewhere, see sensor/glare.h */
  void *channels[PL_FRAME_CHANNELS_MAX]; /* indexed as pl_channels */
  pl_object_label *objects;              /* pl_scene_label_count elements */
  /* one image per object: 1 on its full silhouette, including occluded parts, else 0 */
  uint8_t *masks;
  pl_ground_settings ground;              /* of channels of the ground */
  pl_instance_coverage_settings coverage; /* of its channels */
  /* For channels of motion, borrowed; NULL: there is no such frame. */
  const pl_other_frame *others[PL_FLOW_FRAMES];
  const pl_keypoint *keypoints; /* borrowed */
  size_t keypoint_count;
  pl_keypoint_label *keypoint_labels; /* output, one per keypoint; NULL: not computed */
  const pl_part_group *groups;        /* borrowed */
  size_t group_count;
  /* output, one per group: its boxes and counts, with pose and ids of its object; NULL: not
   * computed */
  pl_object_label *group_labels;
  bool amodal; /* compute the labels of full silhouettes; false skips the cost */
} pl_frame_request;

/* Stages of a frame, which are timed. */
typedef enum pl_stage {
  PL_STAGE_SNAPSHOT,
  PL_STAGE_METER,
  PL_STAGE_PLAN,
  PL_STAGE_REALISE,
  PL_STAGE_RENDER,
  PL_STAGE_LABEL,
  PL_STAGE_SENSOR,
  PL_STAGE_COUNT
} pl_stage;
const char *pl_stage_name(pl_stage stage);

typedef struct pl_frame_result {
  pl_plan plan;
  /* radiance, W m-2 sr-1, that is displayed as 255; NaN if it was not measured */
  double white_radiance;
  /* white radiances of the requested images, which samples are chosen for: the lowest, and that of
   * the other image or 0 */
  double whites[2];
  double exposure_s; /* s, of the sensor; NaN without one */
  double gain;       /* of the sensor, electrons per digital number; NaN without one */
  /* Visible stars, brightest first: those that the plan keeps and nothing hides. Valid until the
   * renderer's next frame. */
  const pl_seen_star *stars;
  size_t star_count;
  /* Meshes of terrain: tiles in the middle of the frame, bytes that are kept for all frames, and
   * the largest factor by which cells are wider than asked, for the limit of tiles (1: none), with
   * the name of the body that it belongs to; borrowed from the scene, NULL for none. */
  size_t ground_tiles, ground_bytes;
  double ground_widened;
  const char *ground_widened_body;
  /* A body that states a patch of which the camera sees none; NULL for none. Borrowed, too. */
  const char *ground_missed_body;
  size_t missed; /* pixels that all samples did not bring to the target */
  /* Whether the samples of pixels are chosen at all: not behind an aperture, nor in motion. */
  bool aimed;
  pl_work_counts work;            /* of a frame or pilot; not of a plan alone */
  double seconds[PL_STAGE_COUNT]; /* wall time; never part of an output array */
} pl_frame_result;

/* Renders the frames of one scene and caches accelerators and buffers. Not thread-safe; must not be
 * used in a process other than the one that created it. */
typedef struct pl_renderer pl_renderer;
pl_status pl_renderer_create(const pl_scene *scene, pl_renderer **out); /* borrows the scene */
void pl_renderer_destroy(pl_renderer *renderer);
pl_status pl_renderer_frame(pl_renderer *renderer, const pl_frame_request *request,
                            pl_frame_result *result);
/* Runs all stages up to the plan. */
pl_status pl_renderer_plan(pl_renderer *renderer, const pl_frame_request *request,
                           pl_frame_result *result);

#endif
