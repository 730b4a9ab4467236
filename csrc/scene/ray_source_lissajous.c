/* Lissajous scan: one beam on a mirror that swings about two axes as sines. */
#include "scene/ray_source.h"

enum { PULSES, WIDTH, HEIGHT, X_HZ, Y_HZ, PHASE, RATE };
static const pl_ray_value values[] = {
    {"pulses", "pulses", 1.0, 1e9, true},
    {"width_rad", "angle from the left end to the right one", 0.0, 6.2831853, false},
    {"height_rad", "angle from the top end to the bottom one", 0.0, 3.1415926, false},
    {"x_hz", "swings to the right and back per second", 0.0, 1e9, false},
    {"y_hz", "swings up and back per second", 0.0, 1e9, false},
    {"phase_rad", "phase of the swing up at the start", -100.0, 100.0, false},
    {"rate_hz", "pulses per second", 1e-9, 1e12, false},
};

static size_t count(const pl_ray_source *source) { return (size_t)source->value[PULSES]; }

static double duration_s(const pl_ray_source *source) {
  return (source->value[PULSES] - 1.0) / source->value[RATE];
}

static void ray(const pl_ray_source *source, size_t index, int sub, pl_sensor_ray *out) {
  const double *v = source->value, t = (double)index / v[RATE], turn = 2.0 * PL_PI;
  (void)sub;
  out->origin = (pl_vec3){0.0, 0.0, 0.0};
  out->direction = pl_ray_angles(0.5 * v[WIDTH] * sin(turn * v[X_HZ] * t),
                                 0.5 * v[HEIGHT] * sin(turn * v[Y_HZ] * t + v[PHASE]));
  out->time_s = t;
  out->line = 0;
}

const pl_ray_source_kind pl_ray_source_lissajous = {
    .name = "lissajous",
    .doc = "one beam on a mirror that swings about two axes as sines",
    .values = values,
    .value_count = sizeof values / sizeof values[0],
    .count = count,
    .duration_s = duration_s,
    .ray = ray,
};
