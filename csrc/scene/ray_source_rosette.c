/* Rosette scan: one beam through two turning wedge prisms (Risley prisms). Prisms are thin: each
 * deflects the beam by a fixed angle, and the angles add as vectors (Marshall, "Risley prism scan
 * patterns", Proc. SPIE 3787, 1999). At 10 degrees off the axis that is right to a few per cent of
 * the angle. */
#include "scene/ray_source.h"

enum { PULSES, FIRST, SECOND, FIRST_HZ, SECOND_HZ, RATE };
static const pl_ray_value values[] = {
    {"pulses", "pulses", 1.0, 1e9, true},
    {"first_rad", "deflection by the first prism", 0.0, 1.5, false},
    {"second_rad", "deflection by the second prism", 0.0, 1.5, false},
    {"first_hz", "turns of the first prism per second; below 0: the other way round", -1e9, 1e9,
     false},
    {"second_hz", "turns of the second prism per second", -1e9, 1e9, false},
    {"rate_hz", "pulses per second", 1e-9, 1e12, false},
};

static size_t count(const pl_ray_source *source) { return (size_t)source->value[PULSES]; }

static double duration_s(const pl_ray_source *source) {
  return (source->value[PULSES] - 1.0) / source->value[RATE];
}

static void ray(const pl_ray_source *source, size_t index, int sub, pl_sensor_ray *out) {
  const double *v = source->value, t = (double)index / v[RATE];
  const double a = 2.0 * PL_PI * v[FIRST_HZ] * t, b = 2.0 * PL_PI * v[SECOND_HZ] * t;
  const double x = v[FIRST] * cos(a) + v[SECOND] * cos(b);
  const double y = v[FIRST] * sin(a) + v[SECOND] * sin(b);
  const double off = hypot(x, y), per = off > 0.0 ? sin(off) / off : 1.0;
  (void)sub;
  out->origin = (pl_vec3){0.0, 0.0, 0.0};
  out->direction = (pl_vec3){per * x, per * y, cos(off)};
  out->time_s = t;
  out->line = 0;
}

const pl_ray_source_kind pl_ray_source_rosette = {
    .name = "rosette",
    .doc = "one beam through two turning wedge prisms (Risley prisms)",
    .values = values,
    .value_count = sizeof values / sizeof values[0],
    .count = count,
    .duration_s = duration_s,
    .ray = ray,
};
