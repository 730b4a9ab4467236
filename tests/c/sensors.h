/* Sensors of the tests, and images through their stages without a renderer. */
#ifndef PL_TESTS_SENSORS_H
#define PL_TESTS_SENSORS_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sensor/stage.h"

/* A plain camera: one electron in ten shows as a digital number, 12 bits, no noise. */
static inline pl_sensor sensor_plain(void) {
  return (pl_sensor){.f_number = 4.0,
                     .transmission = 1.0,
                     .pixel_m = 5e-6,
                     .mosaic = PL_MOSAIC_MONO,
                     .quantum_efficiency = {0.5, 0.5, 0.5},
                     .band_share = {0.12, 0.13, 0.14},
                     .wavelength_m = {650e-9, 550e-9, 450e-9},
                     .exposure_s = 1e-3,
                     .drain = 1.0,
                     .full_well = 30000.0,
                     .gain = 10.0,
                     .black_level = 100.0,
                     .bits = 12};
}

/* Grey radiance that frees so many electrons in the pixels that fill first. */
static inline float sensor_radiance(const pl_sensor *sensor, double electrons) {
  return (float)(electrons / pl_sensor_response_white(sensor));
}

/* Every stage that has a row at `value`; those of `off` (a name, or NULL) left out. */
static inline pl_plan sensor_plan(int value, const char *off) {
  pl_plan plan = {0};
  for (size_t i = 0; i < pl_sensor_stage_count; i++)
    if (pl_sensor_stages[i].effect != NULL)
      plan.rows[plan.count++] = (pl_plan_row){.effect = pl_sensor_stages[i].effect, .value = value};
  for (size_t i = 0; i < plan.count && off != NULL; i++)
    if (strcmp(plan.rows[i].effect->name, off) == 0)
      plan.rows[i].value = 0;
  return plan;
}

typedef struct sensor_shot {
  pl_sensor_frame frame;
  pl_arena arena;
  pl_encoder encoder;
  size_t pixels;
} sensor_shot;

/* A black image; malloc'ed memory of the caller, freed by sensor_shot_clear. */
static inline void sensor_shot_init(sensor_shot *shot, const pl_sensor *sensor, int width,
                                    int height) {
  shot->pixels = (size_t)width * (size_t)height;
  pl_arena_init(&shot->arena);
  pl_encoder_init(&shot->encoder);
  shot->frame = (pl_sensor_frame){.sensor = sensor,
                                  .width = width,
                                  .height = height,
                                  .focal_px = {1000.0, 1000.0},
                                  .centre_px = {0.5 * (width - 1), 0.5 * (height - 1)},
                                  .seed = 7,
                                  .index = 3,
                                  .threads = 1,
                                  .arena = &shot->arena,
                                  .bands = calloc(shot->pixels, sizeof(pl_vec3f)),
                                  .electrons = calloc(shot->pixels, sizeof(double)),
                                  .raw = calloc(shot->pixels, sizeof(uint16_t)),
                                  .rgb = calloc(shot->pixels, 3),
                                  .encoder = &shot->encoder};
}

static inline void sensor_shot_fill(sensor_shot *shot, float radiance) {
  for (size_t i = 0; i < shot->pixels; i++)
    shot->frame.bands[i] = (pl_vec3f){radiance, radiance, radiance};
}

static inline void sensor_shot_clear(sensor_shot *shot) {
  pl_arena_clear(&shot->arena);
  free(shot->frame.bands);
  free(shot->frame.electrons);
  free(shot->frame.raw);
  free(shot->frame.rgb);
}

/* Mean and variance of digital numbers. */
static inline void sensor_moments(const sensor_shot *shot, double *mean, double *variance) {
  double sum = 0.0, squares = 0.0;
  for (size_t i = 0; i < shot->pixels; i++)
    sum += shot->frame.raw[i];
  *mean = sum / (double)shot->pixels;
  for (size_t i = 0; i < shot->pixels; i++)
    squares += pow(shot->frame.raw[i] - *mean, 2.0);
  *variance = squares / (double)shot->pixels;
}

#endif
