/* The stage `cosmic_rays`: particles that cross the sensor and leave charge along straight tracks.
 * Their number is Poisson distributed with a mean of flux times area times exposure time. The
 * direction of a ray follows an isotropic flux through a plane (density cos(theta)). The ray
 * crosses a layer of depth `ray_depth_m` and frees charge in proportion to its path length. */
#include <math.h>

#include "sensor/draws.h"
#include "plan/effects.h"
#include "sensor/stages.h"

static const double TWO_PI = 6.28318530717958647692;
/* Tracks are sampled in steps of this fraction of a pixel. */
static const double STEP_PX = 0.125;
/* Upper limit of tan(theta): rays at grazing incidence would cross the whole sensor. */
static const double MOST_TANGENT = 50.0;
/* Upper limit of the number of rays. So many cover the sensor; higher values make no visible
 * difference. */
static const double MOST_RAYS = 1e6;

static void add_charge(pl_sensor_frame *frame, double x, double y, double electrons) {
  const double u = floor(x), v = floor(y);
  if (u >= 0.0 && v >= 0.0 && u < frame->width && v < frame->height)
    frame->electrons[(size_t)v * (size_t)frame->width + (size_t)u] += electrons;
}

static void draw_ray(pl_sensor_frame *frame, uint64_t ray) {
  const pl_sensor *sensor = frame->sensor;
  pl_stream stream = pl_stream_of(frame->seed, PL_DRAW_RAY, ray + 1, frame->index);
  double x = frame->width * pl_stream_uniform(&stream);
  double y = frame->height * pl_stream_uniform(&stream);
  const double sine2 = pl_stream_uniform(&stream), angle = TWO_PI * pl_stream_uniform(&stream);
  const double tangent = fmin(MOST_TANGENT, sqrt(sine2 / fmax(1.0 - sine2, 1e-12)));
  const double path_m = sensor->ray_depth_m * sqrt(1.0 + tangent * tangent);
  const double length_px = sensor->ray_depth_m * tangent / sensor->pixel_m;
  const double steps = fmin(ceil(length_px / STEP_PX) + 1.0, 1e5);
  const double each = sensor->ray_electrons_per_m * path_m / steps;
  for (double k = 0.0; k < steps; k += 1.0) {
    const double along = length_px * (k + 0.5) / steps;
    add_charge(frame, x + along * cos(angle), y + along * sin(angle), each);
  }
}

static double mean_rays(const pl_sensor *sensor, int width, int height) {
  const double area = sensor->pixel_m * sensor->pixel_m * width * height;
  return fmin(MOST_RAYS, sensor->ray_flux * area * sensor->exposure_s);
}

/* Runs on one thread, since rays are few and several may hit the same pixel. */
pl_status pl_stage_cosmic_rays(pl_sensor_frame *frame, int value) {
  (void)value;
  pl_stream stream = pl_stream_of(frame->seed, PL_DRAW_RAY, 0, frame->index);
  const double mean = mean_rays(frame->sensor, frame->width, frame->height);
  const double count = pl_stream_poisson(&stream, mean);
  for (double ray = 0.0; ray < count; ray += 1.0)
    draw_ray(frame, (uint64_t)ray);
  return PL_OK;
}

/* The effect is absent if less than one frame in a million is hit by a ray. */
static const char *absent(const pl_view *view) {
  const char *none = pl_sensor_absent(view);
  if (none != NULL)
    return none;
  const double mean = mean_rays(view->sensor, view->width, view->height);
  return mean > 1e-6 && view->sensor->ray_electrons_per_m > 0.0 ? NULL : "no ray hits the sensor";
}

/* In one pixel a ray deposits at most the charge of the longest track that fits in a pixel, plus
 * that of one step. Several rays may meet in one pixel. A track of length l crosses 1 + 4 l / pi
 * pixels on average; the mean tangent is pi / 2. */
double pl_sensor_rays_max(const pl_view *view) {
  const pl_sensor *sensor = view->sensor;
  const double track_m = 1.1 * hypot(sensor->ray_depth_m, sqrt(2.0) * sensor->pixel_m);
  const double mean = mean_rays(sensor, view->width, view->height) / view->width / view->height;
  const double crossed = 1.0 + 2.0 * sensor->ray_depth_m / sensor->pixel_m;
  return pl_poisson_most(crossed * mean) * sensor->ray_electrons_per_m * track_m;
}

static double bound_dn(const pl_view *view, int value) {
  return value > 0 ? 0.0 : pl_sensor_dn(view, pl_sensor_rays_max(view));
}

static double cost_ms(const pl_view *view, int value) {
  return value * 1e-3 * mean_rays(view->sensor, view->width, view->height);
}

const pl_effect pl_effect_cosmic_rays = {
    .name = "cosmic_rays",
    .doc = "Sensor: charge along the tracks of particles",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
