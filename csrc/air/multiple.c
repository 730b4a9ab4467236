/* Light that is scattered more than once, after Hillaire (2020), A Scalable and Production Ready
 * Sky and Atmosphere Rendering Technique, section 5.5: from the second scattering on light counts
 * as coming evenly from all sides and as being the same all around, so that its orders are a
 * geometric series, 1/(1 - f). And the irradiance of the sky on the ground. */
#include <math.h>

#include "air/table.h"

/* Directions and nodes of the integrals: zenith angles, azimuths of half a turn, steps. */
enum { ZENITHS = 6, AZIMUTHS = 3, STEPS = 6, SKY_ZENITHS = 8, SKY_AZIMUTHS = 6, SKY_STEPS = 8 };
/* Sines of the sun's height in the tables begin where no light counts any more, and are dense about
 * the horizon, within this. */
static const double LOWEST = -0.3, BEND = 0.1;

static double bent(double sine) { return sine / (BEND + fabs(sine)); }

static double sine_at(int node, int count) {
  const double low = bent(LOWEST), w = low + (bent(1.0) - low) * node / (count - 1);
  return BEND * w / (1.0 - fabs(w));
}

static float node_of(double sine, int count) {
  const double low = bent(LOWEST);
  return (float)((bent(fmin(sine, 1.0)) - low) / (bent(1.0) - low) * (count - 1));
}

/* A sun on a round body, at height `sine` over a point on the z axis. */
static pl_air_sun sun_at(double sine) {
  const double across = sqrt(fmax(0.0, (1.0 - sine) * (1.0 + sine)));
  return (pl_air_sun){{across, 0.0, sine}, 1.0, 0.00465};
}

static pl_air_ray ray_at(const pl_air *air, double height_m, double mu, double azimuth,
                         const pl_air_sun *sun) {
  const double across = sqrt(fmax(0.0, (1.0 - mu) * (1.0 + mu)));
  pl_air_ray ray = {.origin = {0.0, 0.0, 1.0 + height_m / air->radius_m},
                    .direction = {across * cos(azimuth), across * sin(azimuth), mu},
                    .stretch = 1.0,
                    .end = INFINITY};
  ray.sun_cosine = (float)pl_vec3_dot(ray.direction, sun->direction);
  return ray;
}

/* Radiance of the sunlit ground where a ray ends on it. */
static pl_vec3f ground(const pl_air *air, const pl_air_ray *ray, const pl_air_sun *sun) {
  const double along = pl_vec3_dot(ray->origin, ray->direction);
  const pl_vec3 lowest = pl_vec3_madd(ray->origin, -along, ray->direction);
  const double low = pl_vec3_dot(lowest, lowest) - 1.0;
  if (along >= 0.0 || low >= 0.0)
    return (pl_vec3f){0.0f, 0.0f, 0.0f};
  const pl_vec3 point = pl_vec3_madd(lowest, -sqrt(-low), ray->direction);
  const double *a = air->settings.ground_albedo;
  const double height = fmax(0.0, pl_vec3_dot(point, sun->direction)) / PL_PI;
  const pl_vec3f albedo =
      pl_vec3f_make((float)(a[0] * height), (float)(a[1] * height), (float)(a[2] * height));
  return pl_vec3f_mul(albedo, pl_air_sunlight(air, sun, point));
}

static pl_vec3f several_at(const pl_air *air, double height_m, double sun_sine) {
  const pl_air_rule zeniths = pl_air_rule_make(ZENITHS), steps = pl_air_rule_make(STEPS);
  const pl_air_sun sun = sun_at(sun_sine);
  pl_vec3f second = {0.0f, 0.0f, 0.0f}, kept = {0.0f, 0.0f, 0.0f};
  for (int half = 0; half < 2; half++) /* below and above the horizontal */
    for (int i = 0; i < ZENITHS; i++)
      for (int k = 0; k < AZIMUTHS; k++) {
        const double mu = half == 0 ? -zeniths.place[i] : zeniths.place[i];
        const float weight = (float)(0.5 * zeniths.weight[i] / AZIMUTHS);
        const double azimuth = PL_PI * (k + 0.5) / AZIMUTHS;
        const pl_air_ray ray = ray_at(air, height_m, mu, azimuth, &sun);
        const pl_air_light light = pl_air_scatter_by(air, &ray, &sun, &steps, PL_AIR_EVENLY);
        const pl_air_light own = pl_air_scatter_by(air, &ray, &sun, &steps, PL_AIR_FROM_ALL_SIDES);
        const pl_vec3f below = pl_vec3f_mul(light.transmitted, ground(air, &ray, &sun));
        second = pl_vec3f_madd(second, weight, pl_vec3f_add(light.scattered, below));
        kept = pl_vec3f_madd(kept, weight, own.scattered);
      }
  const float most = 0.999f; /* of air that absorbs nothing and fills space */
  return pl_vec3f_make(second.x / (1.0f - pl_minf(kept.x, most)),
                       second.y / (1.0f - pl_minf(kept.y, most)),
                       second.z / (1.0f - pl_minf(kept.z, most)));
}

/* Heights are dense at the surface, by a square law, up to where the air is thin. */
static double height_of(const pl_air *air, int node) {
  const double v = (double)node / (PL_AIR_MULTIPLE_HEIGHTS - 1);
  return v * v * air->settings.top_m;
}

void pl_air_build_multiple(pl_air *air) {
  for (int i = 0; i < PL_AIR_MULTIPLE_HEIGHTS; i++)
    for (int k = 0; k < PL_AIR_MULTIPLE_SINES; k++)
      air->several[i][k] = several_at(air, height_of(air, i), sine_at(k, PL_AIR_MULTIPLE_SINES));
}

static pl_vec3f mix(pl_vec3f a, pl_vec3f b, float t) {
  return pl_vec3f_madd(pl_vec3f_scale(a, 1.0f - t), t, b);
}

pl_vec3f pl_air_several(const pl_air *air, const pl_air_place *place, double sun_sine) {
  if (sun_sine <= LOWEST)
    return (pl_vec3f){0.0f, 0.0f, 0.0f};
  const float y = sqrtf((float)fmin(1.0, place->height_m / air->settings.top_m)) *
                  (PL_AIR_MULTIPLE_HEIGHTS - 1);
  const float x = node_of(sun_sine, PL_AIR_MULTIPLE_SINES);
  const int i = y < PL_AIR_MULTIPLE_HEIGHTS - 2 ? (int)y : PL_AIR_MULTIPLE_HEIGHTS - 2;
  const int k = x < PL_AIR_MULTIPLE_SINES - 2 ? (int)x : PL_AIR_MULTIPLE_SINES - 2;
  const float u = x - (float)k;
  return mix(mix(air->several[i][k], air->several[i][k + 1], u),
             mix(air->several[i + 1][k], air->several[i + 1][k + 1], u), y - (float)i);
}

static pl_vec3f sky_at(const pl_air *air, double sun_sine, bool multiple) {
  const pl_air_rule zeniths = pl_air_rule_make(SKY_ZENITHS), steps = pl_air_rule_make(SKY_STEPS);
  const pl_air_sun sun = sun_at(sun_sine);
  pl_vec3f sum = {0.0f, 0.0f, 0.0f};
  for (int i = 0; i < SKY_ZENITHS; i++)
    for (int k = 0; k < SKY_AZIMUTHS; k++) {
      const double mu = zeniths.place[i];
      const pl_air_ray ray = ray_at(air, 0.0, mu, PL_PI * (k + 0.5) / SKY_AZIMUTHS, &sun);
      const pl_air_light light = pl_air_scatter(air, &ray, &sun, &steps, multiple);
      sum = pl_vec3f_madd(sum, (float)(2.0 * PL_PI * mu * zeniths.weight[i] / SKY_AZIMUTHS),
                          light.scattered);
    }
  return sum;
}

void pl_air_build_sky(pl_air *air) {
  for (int k = 0; k < PL_AIR_SKY; k++) {
    const double sine = sine_at(k, PL_AIR_SKY);
    air->sky[0][k] = sky_at(air, sine, false);
    air->sky[1][k] = air->settings.multiple ? sky_at(air, sine, true) : air->sky[0][k];
  }
}

pl_vec3f pl_air_skylight(const pl_air *air, double sun_sine, bool multiple) {
  if (sun_sine <= LOWEST)
    return (pl_vec3f){0.0f, 0.0f, 0.0f};
  const pl_vec3f *sky = air->sky[multiple];
  const float x = node_of(sun_sine, PL_AIR_SKY);
  const int k = x < PL_AIR_SKY - 2 ? (int)x : PL_AIR_SKY - 2;
  return mix(sky[k], sky[k + 1], x - (float)k);
}
