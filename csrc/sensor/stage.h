/* The stages of a sensor: one table, run in its order on one image. */
#ifndef PL_SENSOR_STAGE_H
#define PL_SENSOR_STAGE_H

#include "base/memory.h"
#include "base/parallel.h"
#include "math/vec.h"
#include "plan/plan.h"
#include "sensor/encode.h"
#include "sensor/sensor.h"

/* An image on its way; images are row-major. */
typedef struct pl_sensor_frame {
  const pl_sensor *sensor; /* borrowed */
  int width, height;
  pl_flare_sun sun;                 /* a source of ghosts */
  double focal_px[2], centre_px[2]; /* x, y: for angles to the axis; integer pixel centres */
  uint64_t seed, index;
  int threads;
  pl_cancel *cancel; /* may be NULL */
  pl_arena *arena;   /* borrowed */
  pl_vec3f *bands;   /* radiance, W m-2 sr-1; changed by the stages of the lens */
  double *electrons; /* from the stage `electrons` on */
  uint16_t *raw;     /* digital numbers, from `digitise` on */
  uint8_t *rgb;      /* display-encoded; NULL: not wanted */
  const pl_encoder *encoder;
} pl_sensor_frame;

typedef struct pl_sensor_stage {
  const char *name;
  const pl_effect *effect; /* its row; NULL: a conversion, which always runs */
  pl_status (*run)(pl_sensor_frame *frame, int value);
} pl_sensor_stage;

extern const pl_sensor_stage pl_sensor_stages[];
extern const size_t pl_sensor_stage_count;

/* Runs the stages that the plan keeps. `electrons` and `raw` must have room for the image. */
pl_status pl_sensor_run(pl_sensor_frame *frame, const pl_plan *plan);

/* --- for stages */

/* Work on one row or column; different ones run at once. */
typedef void (*pl_line_fn)(pl_sensor_frame *frame, int line);
pl_status pl_sensor_rows(pl_sensor_frame *frame, pl_line_fn work);
pl_status pl_sensor_columns(pl_sensor_frame *frame, pl_line_fn work);

/* --- for the rows of effects */

/* Normal random numbers stay within this many standard deviations: one in 5e8 does not. Bounds are
 * meant so, and with pl_poisson_most of numbers that are counted. */
#define PL_SENSOR_SIGMAS 6.0

/* Digital numbers (of 255, display-encoded) that so many electrons can make at most: on black, in
 * the band that is balanced up most. */
double pl_sensor_dn(const pl_view *view, double electrons);
/* The same of light, in electrons of the pixels that a white radiance fills first: other bands have
 * fewer, by what they are balanced up. */
double pl_sensor_light_dn(const pl_view *view, double electrons);
/* The least radiance that may come out white; INFINITY where nothing is gathered. */
double pl_sensor_white_radiance(const pl_view *view);
/* Upper bound of the radiance that comes to the lens; INFINITY where the sun may be mirrored or is
 * in the frame. */
double pl_sensor_radiance_max(const pl_view *view);
/* Upper bound of what ghosts add to a pixel where the frame is so bright, W m-2 sr-1. */
double pl_flare_radiance_max(const pl_view *view, double brightest);
/* Upper bound of the electrons that light frees in a pixel; INFINITY where the sun may be mirrored
 * or is in the frame. */
double pl_sensor_electrons_max(const pl_view *view);
/* The same in the pixels that respond most, where a flat field is brightest. */
double pl_sensor_light_max(const pl_view *view);
/* What dimming or brightening light by a fraction can make at most: what pl_view_dn_dimming says of
 * clean light, and as much again as noise that is read out below it lays bare on black. */
double pl_sensor_dimming_dn(const pl_view *view, double fraction);
/* The mean dark charge of the warmest pixel, electrons. */
double pl_sensor_dark_max(const pl_sensor *sensor);
/* What particles leave in a pixel at most, electrons. */
double pl_sensor_rays_max(const pl_view *view);
/* Upper bound of the charge of a pixel before it blooms: light, and what other stages add. */
double pl_sensor_charge_max(const pl_view *view);
/* Why no stage matters, or NULL. */
const char *pl_sensor_absent(const pl_view *view);
/* Cost of `ns` nanoseconds a pixel, in milliseconds. */
double pl_sensor_cost_ms(const pl_view *view, double ns);

#endif
