/* The stages of a sensor: a table whose entries process one image in order. */
#ifndef PL_SENSOR_STAGE_H
#define PL_SENSOR_STAGE_H

#include "base/memory.h"
#include "base/parallel.h"
#include "math/vec.h"
#include "plan/plan.h"
#include "sensor/encode.h"
#include "sensor/sensor.h"

/* An image during processing; images are row-major. */
typedef struct pl_sensor_frame {
  const pl_sensor *sensor; /* borrowed */
  int width, height;
  pl_flare_sun sun;                 /* as a source of ghosts */
  double focal_px[2], centre_px[2]; /* x, y: for angles to the axis; integer pixel centres */
  uint64_t seed, index;
  int threads;
  pl_cancel *cancel; /* may be NULL */
  pl_arena *arena;   /* borrowed */
  pl_vec3f *bands;   /* radiance, W m-2 sr-1; modified by the stages of the lens */
  double *electrons; /* valid from the stage `electrons` on */
  uint16_t *raw;     /* digital numbers; valid from the stage `digitise` on */
  uint8_t *rgb;      /* display-encoded; NULL: not requested */
  float *glare;      /* see sensor/glare.h; NULL: not requested */
  const pl_encoder *encoder;
} pl_sensor_frame;

typedef struct pl_sensor_stage {
  const char *name;
  const pl_effect *effect; /* its effect row; NULL: a conversion, which always runs */
  pl_status (*run)(pl_sensor_frame *frame, int value);
} pl_sensor_stage;

extern const pl_sensor_stage pl_sensor_stages[];
extern const size_t pl_sensor_stage_count;

/* Number of stages that run by a plan, in the images of all planes. */
size_t pl_sensor_stages_of(const pl_sensor *sensor, const pl_plan *plan);
/* Runs the stages that the plan keeps. `electrons` and `raw` must have room for the image. */
pl_status pl_sensor_run(pl_sensor_frame *frame, const pl_plan *plan);

/* --- for stages */

/* Processes one row or column; several run concurrently. */
typedef void (*pl_line_fn)(pl_sensor_frame *frame, int line);
pl_status pl_sensor_rows(pl_sensor_frame *frame, pl_line_fn work);
pl_status pl_sensor_columns(pl_sensor_frame *frame, pl_line_fn work);

/* --- for the effect rows */

/* Bound of normal random numbers in standard deviations; one number in 5e8 exceeds it. Effect
 * bounds hold in this sense, and for counts in that of pl_poisson_most. */
#define PL_SENSOR_SIGMAS 6.0

/* Upper bound of the change in display-encoded digital numbers (of 255) that a number of electrons
 * causes: on black, in the band with the largest white-balance factor. */
double pl_sensor_dn(const pl_view *view, double electrons);
/* The same for light, in electrons of the most sensitive pixels. Other bands receive fewer
 * electrons, by their white-balance factor. */
double pl_sensor_light_dn(const pl_view *view, double electrons);
/* Smallest radiance that may be white in the image; INFINITY if the sensor gathers no light. */
double pl_sensor_white_radiance(const pl_view *view);
/* Upper bound of the radiance at the lens; INFINITY if the sun is in the frame or may be reflected
 * by a mirror. */
double pl_sensor_radiance_max(const pl_view *view);
/* Upper bound of the radiance that ghosts add to a pixel if the brightest radiance of the frame is
 * `brightest`, W m-2 sr-1. */
double pl_flare_radiance_max(const pl_view *view, double brightest);
/* Upper bound of the electrons that light generates in a pixel; INFINITY if the sun is in the frame
 * or may be reflected by a mirror. */
double pl_sensor_electrons_max(const pl_view *view);
/* The same in the pixels with the largest response, including the flat field. */
double pl_sensor_light_max(const pl_view *view);
/* Upper bound of the change in digital numbers if light is dimmed or brightened by a fraction:
 * pl_view_dn_dimming for light without noise, plus read noise that becomes visible on black. */
double pl_sensor_dimming_dn(const pl_view *view, double fraction);
/* Mean dark charge of the warmest pixel, electrons. */
double pl_sensor_dark_max(const pl_sensor *sensor);
/* Upper bound of the charge that particles leave in a pixel, electrons. */
double pl_sensor_rays_max(const pl_view *view);
/* Upper bound of the charge of a pixel before blooming: light, and charge that other stages add. */
double pl_sensor_charge_max(const pl_view *view);
/* The reason why no stage has an effect, or NULL. */
const char *pl_sensor_absent(const pl_view *view);
/* Cost of `ns` nanoseconds per pixel, in milliseconds. */
double pl_sensor_cost_ms(const pl_view *view, double ns);

#endif
