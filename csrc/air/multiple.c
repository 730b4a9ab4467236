/* Multiple scattering. The mean radiance over all directions is tabulated by height and solar
 * elevation, one order of scattering at a time. The first order scatters with the phase functions
 * and later orders isotropically. All orders include light reflected by the ground. After Hillaire
 * (2020), A Scalable and Production Ready Sky and Atmosphere Rendering Technique, section 5.5.
 * There all orders form a geometric series; here only the remainder does. Also computes the
 * irradiance of the sky on the ground. */
#include <math.h>
#include <string.h>

#include "air/table.h"

/* Directions and nodes of the integrals: zenith angles, azimuths over half a turn, steps. */
enum { ZENITHS = 6, FIRST_AZIMUTHS = 6, AZIMUTHS = 2, STEPS = 6 };
enum { SKY_ZENITHS = 8, SKY_AZIMUTHS = 6, SKY_STEPS = 8 };
/* Orders that are computed before the geometric series. */
enum { ORDERS = 4 };

/* The tables hold all solar elevations, since air that is high compared with the radius carries
 * light deep into the night. They are dense within air->twilight, a sine, of the horizon: a few
 * times the angle from which a scale height of air is seen over the horizon. */
static double twilight_of(const pl_air *air) {
  const double least = 0.1, most = 1.0;
  double scale_m = 0.0;
  for (int part = 0; part < 2; part++)
    for (int layer = 0; layer < 2 && air->present[part]; layer++)
      scale_m = fmax(scale_m, air->layers[part].scale_m[layer]);
  return fmin(most, fmax(least, 2.0 * sqrt(2.0 * scale_m / air->radius_m)));
}

static double sine_at(const pl_air *air, int node, int count) {
  const double w = (2.0 * node / (count - 1) - 1.0) / (1.0 + air->twilight);
  return fmin(1.0, fmax(-1.0, air->twilight * w / (1.0 - fabs(w))));
}

static float node_of(const pl_air *air, double sine, int count) {
  const double s = fmin(1.0, fmax(-1.0, sine)), w = s / (air->twilight + fabs(s));
  return (float)(0.5 * (1.0 + w * (1.0 + air->twilight)) * (count - 1));
}

static pl_vec3f mix(pl_vec3f a, pl_vec3f b, float t) {
  return pl_vec3f_madd(pl_vec3f_scale(a, 1.0f - t), t, b);
}

/* Interpolates a table over the sine of solar elevation. */
static pl_vec3f from_sines(const pl_air *air, const pl_vec3f *table, int count, double sine) {
  const float x = node_of(air, sine, count);
  const int k = x < count - 2 ? (int)x : count - 2;
  return mix(table[k], table[k + 1], x - (float)k);
}

/* The sun over a spherical body, with this sine of elevation at a point on the z axis. */
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

/* Point where a ray ends on the ground; false if it does not. */
static bool meet_ground(const pl_air_ray *ray, pl_vec3 *point) {
  const double along = pl_vec3_dot(ray->origin, ray->direction);
  const pl_vec3 lowest = pl_vec3_madd(ray->origin, -along, ray->direction);
  const double low = pl_vec3_dot(lowest, lowest) - 1.0;
  if (along >= 0.0 || low >= 0.0)
    return false;
  *point = pl_vec3_madd(lowest, -sqrt(-low), ray->direction);
  return true;
}

typedef pl_vec3f order_table[PL_AIR_MULTIPLE_HEIGHTS][PL_AIR_MULTIPLE_SINES];

/* One order of scattering. `ground`: irradiance of the ground from the previous order, by the sine
 * of solar elevation (NULL: from the sun). The other fields are the quadrature rules. The radiance
 * that the air scatters is read from air->several. */
typedef struct order {
  const pl_air *air;
  const pl_vec3f *ground;
  int azimuths;
  pl_air_rule zeniths, steps;
} order;

/* Radiance of the ground at the end of a ray; 0 if the ray does not end there. */
static pl_vec3f ground(const order *o, const pl_air_ray *ray, const pl_air_sun *sun) {
  pl_vec3 point;
  pl_vec3f light;
  if (!meet_ground(ray, &point))
    return (pl_vec3f){0.0f, 0.0f, 0.0f};
  const double *a = o->air->settings.ground_albedo, sine = pl_vec3_dot(point, sun->direction);
  if (o->ground == NULL)
    light = pl_vec3f_scale(pl_air_sunlight(o->air, sun, point), (float)fmax(0.0, sine));
  else
    light = from_sines(o->air, o->ground, PL_AIR_MULTIPLE_SINES, sine);
  return pl_vec3f_scale(pl_vec3f_mul(light, pl_vec3f_make((float)a[0], (float)a[1], (float)a[2])),
                        1.0f / PL_PI_F);
}

/* Mean radiance over all directions at a height, and irradiance from above. */
static pl_vec3f gather(const order *o, double height_m, double sun_sine, pl_vec3f *from_above) {
  const pl_air_sun sun = sun_at(sun_sine);
  const pl_air_mode mode = o->ground == NULL ? PL_AIR_ONCE : PL_AIR_AGAIN;
  pl_vec3f mean = {0.0f, 0.0f, 0.0f};
  *from_above = mean;
  for (int half = 0; half < 2; half++) /* below and above the horizontal */
    for (int i = 0; i < ZENITHS; i++)
      for (int k = 0; k < o->azimuths; k++) {
        const double mu = half == 0 ? -o->zeniths.place[i] : o->zeniths.place[i];
        const float weight = (float)(0.5 * o->zeniths.weight[i] / o->azimuths);
        const double azimuth = PL_PI * (k + 0.5) / o->azimuths;
        const pl_air_ray ray = ray_at(o->air, height_m, mu, azimuth, &sun);
        const pl_air_light light = pl_air_scatter_by(o->air, &ray, &sun, &o->steps, mode);
        const pl_vec3f below = pl_vec3f_mul(light.transmitted, ground(o, &ray, &sun));
        mean = pl_vec3f_madd(mean, weight, pl_vec3f_add(light.scattered, below));
        if (half == 1)
          *from_above =
              pl_vec3f_madd(*from_above, 4.0f * PL_PI_F * weight * (float)mu, light.scattered);
      }
  return mean;
}

/* Heights are spaced quadratically up to the top, and so are dense at the surface. */
static double height_of(const pl_air *air, int node) {
  const double v = (double)node / (PL_AIR_MULTIPLE_HEIGHTS - 1);
  return v * v * air->settings.top_m;
}

static void work_out(const order *o, order_table out, pl_vec3f irradiance[PL_AIR_MULTIPLE_SINES]) {
  pl_vec3f above;
  for (int i = 0; i < PL_AIR_MULTIPLE_HEIGHTS; i++)
    for (int k = 0; k < PL_AIR_MULTIPLE_SINES; k++)
      out[i][k] = gather(o, height_of(o->air, i), sine_at(o->air, k, PL_AIR_MULTIPLE_SINES),
                         i == 0 ? &irradiance[k] : &above);
}

/* Sum of the orders after the last one, if the ratio of successive orders stays that of the last
 * two. */
static float rest_of(float last, float before) {
  const float most = 0.98f; /* bound for air that fills space and does not absorb */
  const float ratio = before > 0.0f ? pl_minf(last / before, most) : 0.0f;
  return last * ratio / (1.0f - ratio);
}

static pl_vec3f all_orders(pl_vec3f sum, pl_vec3f last, pl_vec3f before) {
  return pl_vec3f_add(sum, pl_vec3f_make(rest_of(last.x, before.x), rest_of(last.y, before.y),
                                         rest_of(last.z, before.z)));
}

static void add_order(order_table sum, order_table now) {
  for (int i = 0; i < PL_AIR_MULTIPLE_HEIGHTS; i++)
    for (int k = 0; k < PL_AIR_MULTIPLE_SINES; k++)
      sum[i][k] = pl_vec3f_add(sum[i][k], now[i][k]);
}

void pl_air_set_twilight(pl_air *air) { air->twilight = twilight_of(air); }

void pl_air_build_multiple(pl_air *air) {
  order_table sum = {0}, now, before;
  pl_vec3f irradiance[2][PL_AIR_MULTIPLE_SINES];
  order o = {.air = air, .azimuths = FIRST_AZIMUTHS};
  o.zeniths = pl_air_rule_make(ZENITHS);
  o.steps = pl_air_rule_make(STEPS);
  for (int n = 0; n < ORDERS; n++) {
    memcpy(before, air->several, sizeof before);
    work_out(&o, now, irradiance[n % 2]);
    add_order(sum, now);
    memcpy(air->several, now, sizeof now);
    o.ground = irradiance[n % 2];
    o.azimuths = AZIMUTHS;
  }
  for (int i = 0; i < PL_AIR_MULTIPLE_HEIGHTS; i++)
    for (int k = 0; k < PL_AIR_MULTIPLE_SINES; k++)
      air->several[i][k] = all_orders(sum[i][k], now[i][k], before[i][k]);
}

pl_vec3f pl_air_several(const pl_air *air, const pl_air_place *place, double sun_sine) {
  const float y = sqrtf((float)fmax(0.0, fmin(1.0, place->height_m / air->settings.top_m))) *
                  (PL_AIR_MULTIPLE_HEIGHTS - 1);
  const float x = node_of(air, sun_sine, PL_AIR_MULTIPLE_SINES);
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
    const double sine = sine_at(air, k, PL_AIR_SKY);
    air->sky[0][k] = sky_at(air, sine, false);
    air->sky[1][k] = air->settings.multiple ? sky_at(air, sine, true) : air->sky[0][k];
  }
}

pl_vec3f pl_air_skylight(const pl_air *air, double sun_sine, bool multiple) {
  return from_sines(air, air->sky[multiple], PL_AIR_SKY, sun_sine);
}
