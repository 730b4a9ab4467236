/* The way of one frame: placement -> snapshot -> exposure -> plan -> rays -> arrays. */
#ifndef PL_FRAME_FRAME_H
#define PL_FRAME_FRAME_H

#include "annotate/channel.h"
#include "annotate/object_label.h"
#include "base/parallel.h"
#include "frame/sky.h"
#include "plan/plan.h"
#include "scene/scene.h"
#include "sensor/bands.h"
#include "sensor/exposure.h"
#include "sensor/sensor.h"

enum { PL_FRAME_CHANNELS_MAX = 32 };

typedef struct pl_frame_request {
  uint64_t seed, index;
  pl_placement placement;
  int samples;        /* ceiling of colour samples a pixel, >= 1 */
  int max_bounces;    /* >= 0 */
  int texture_filter; /* ceiling: a pl_filter, not PL_FILTER_NONE */
  int volume_steps;   /* ceiling of steps along a ray through volumes, >= 1 where there are any */
  pl_plan_wish wish;
  pl_exposure exposure;
  const pl_sensor *sensor;      /* borrowed; NULL: none, then neither raw nor sensor_rgb */
  const float (*band_parts)[3]; /* borrowed: of pl_bands_write */
  int band_count;               /* 0: none, then no `bands` */
  const pl_sky *sky;            /* borrowed; NULL: black */
  int threads;
  pl_cancel *cancel; /* may be NULL */
  /* Where results go; NULL: not computed. All are height x width images, row-major. */
  uint8_t *rgb;        /* 3 a pixel */
  float *radiance;     /* 3 a pixel, W m-2 sr-1 */
  float *bands;        /* band_count a pixel, W m-2 sr-1 in each band */
  uint16_t *raw;       /* digital numbers of the sensor: 1 a pixel, or its planes */
  uint8_t *sensor_rgb; /* 3 a pixel: what the sensor's picture shows */
  void *channels[PL_FRAME_CHANNELS_MAX]; /* by index in pl_channels */
  pl_object_label *objects;              /* one per object of the scene */
  uint8_t *masks; /* one image per object: 1 on its full silhouette, hidden parts too, else 0 */
  bool amodal;    /* objects get the labels of their full silhouettes; false costs nothing */
} pl_frame_request;

/* Stages, timed. */
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
  double white_radiance; /* W m-2 sr-1 shown as 255; NaN if it was not measured */
  double whites[2];  /* that samples serve: the least of a picture that is asked for, and another
                      * picture's or 0 */
  double exposure_s; /* of the sensor; NaN without one */
  double gain;       /* likewise: electrons a digital number */
  /* Stars that the colours show, the brightest first: those that the plan keeps, less the hidden.
   * Valid until the renderer's next frame. */
  const pl_seen_star *stars;
  size_t star_count;
  double seconds[PL_STAGE_COUNT]; /* wall time; never part of an array */
} pl_frame_result;

/* Renders frames of one scene; keeps accelerators and buffers. Not thread-safe; not to be used in
 * a process other than the one that made it. */
typedef struct pl_renderer pl_renderer;
pl_status pl_renderer_create(const pl_scene *scene, pl_renderer **out); /* borrows the scene */
void pl_renderer_destroy(pl_renderer *renderer);
pl_status pl_renderer_frame(pl_renderer *renderer, const pl_frame_request *request,
                            pl_frame_result *result);
/* Everything up to the plan. */
pl_status pl_renderer_plan(pl_renderer *renderer, const pl_frame_request *request,
                           pl_frame_result *result);

#endif
