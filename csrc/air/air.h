/* Atmospheres: gases, aerosols and ozone in layers about a body, and the tables that are computed
 * from them once. */
#ifndef PL_AIR_AIR_H
#define PL_AIR_AIR_H

#include <stdbool.h>

#include "base/status.h"
#include "math/vec.h"

/* Composition of an atmosphere. Arrays of three hold the values of the colour bands. Heights are
 * above the surface. Densities are cut off at the top. The densities of gas and aerosols fall by a
 * factor of e per scale height. One scale height holds up to a certain height and another above it,
 * as in the troposphere and the layers above. */
typedef struct pl_air_settings {
  double rayleigh_scattering[3]; /* at the surface, 1/m */
  double rayleigh_height_m;      /* e-folding scale height */
  /* height above which the upper scale height applies; 0: it does not */
  double rayleigh_upper_from_m;
  double rayleigh_upper_height_m;
  double mie_scattering[3];                                  /* at the surface, 1/m */
  double mie_extinction[3];                                  /* scattering plus absorption, 1/m */
  double mie_height_m, mie_upper_from_m, mie_upper_height_m; /* as for Rayleigh */
  double mie_g[3];            /* asymmetry parameter of the phase function of Cornette and Shanks */
  double ozone_absorption[3]; /* at the centre of the layer, 1/m */
  double ozone_center_m;      /* height of the maximum, from which the density falls linearly */
  double ozone_width_m;       /* the density is 0 at this distance above and below the centre */
  double top_m;
  double ground_albedo[3]; /* of the surface, for the light it reflects into the air */
  bool multiple;           /* whether the table of multiple scattering is built */
} pl_air_settings;

/* Immutable once built; shared by all threads. */
typedef struct pl_air pl_air;

/* radius_m: geometric mean of the body's semi-axes. PL_E_RANGE with a message that names what is
 * wrong. */
pl_status pl_air_create(const pl_air_settings *settings, double radius_m, pl_air **out);
void pl_air_destroy(pl_air *air);

const pl_air_settings *pl_air_settings_of(const pl_air *air);
double pl_air_radius_m(const pl_air *air);
/* Radius of a sphere that encloses the air of a body with this largest semi-axis. */
double pl_air_reach_m(const pl_air *air, double largest_m);

/* Densities of the constituents (Rayleigh, Mie, ozone) relative to those at their reference
 * heights. */
enum { PL_AIR_PARTS = 3 };
void pl_air_density(const pl_air *air, double height_m, float out[PL_AIR_PARTS]);

/* Part of the scattering air above the surface that is above a height, per band: 1 or less. */
pl_vec3f pl_air_above(const pl_air *air, double height_m);

/* Phase functions, 1/sr, with a mean over the sphere of 1/(4 pi). The second is that of Cornette
 * and Shanks (1992), Applied Optics 31, 3152. */
float pl_air_rayleigh_phase(float cosine);
float pl_air_mie_phase(float cosine, float g);

/* Points and directions are in body axes divided by the body's radii, in which the surface is the
 * unit sphere. Points may lie below it, on the ground of a basin: densities go on to grow there,
 * and the horizon is level. A length along a direction is converted to metres by the scale of that
 * direction, so that optical depths hold for an oblate body too. Heights are (norm of the point -
 * 1) radius_m. They differ from the true heights by less than the flattening times the height. */

/* Optical depth per band from a point to the top of the air, or to infinity
 * past the limb. `direction` is a unit vector in the scaled axes; `stretch` is radius_m over its
 * length in metres, 1 on a sphere. A ray that meets the surface is treated as tangent to it,
 * and one that descends from below it as level. */
pl_vec3f pl_air_depth(const pl_air *air, pl_vec3 point, pl_vec3 direction, double stretch);

/* Transmittance of that path, exp(-depth). */
pl_vec3f pl_air_transmittance(const pl_air *air, pl_vec3 point, pl_vec3 direction, double stretch);

/* The sun for the air of a body. */
typedef struct pl_air_sun {
  pl_vec3 direction; /* to the sun, a unit vector in the scaled axes */
  double stretch;    /* as for pl_air_depth */
  double radius_rad; /* angular radius of the disc */
} pl_air_sun;

/* Part of the sun's light, per band, that reaches a point: transmittance of the air times the part
 * of the disc above the horizon. The transmittance is that of the centre of the visible part. */
pl_vec3f pl_air_sunlight(const pl_air *air, const pl_air_sun *sun, pl_vec3 point);

/* Gauss-Legendre rule on 0..1 for the integral along a ray. */
enum { PL_AIR_STEPS_MAX = 64 };
typedef struct pl_air_rule {
  int count;
  double place[PL_AIR_STEPS_MAX], weight[PL_AIR_STEPS_MAX];
} pl_air_rule;
pl_air_rule pl_air_rule_make(int count); /* clamped to 1..PL_AIR_STEPS_MAX */

typedef struct pl_air_ray {
  pl_vec3 origin, direction; /* `direction`: unit vector in the scaled axes */
  double stretch;            /* as for pl_air_depth */
  double end; /* in units of `direction`; INFINITY: to the surface or past the limb */
  /* The body has ground of its own, which may lie below the surface: the ray goes on to its end. */
  bool to_ground;
  float sun_cosine; /* of the true angle between the ray and the direction to the sun */
} pl_air_ray;

typedef struct pl_air_light {
  pl_vec3f scattered;   /* radiance for a solar irradiance of 1, 1/sr */
  pl_vec3f transmitted; /* transmittance from the end of the ray, 0..1 */
} pl_air_light;

/* Light scattered towards the origin of a ray. `multiple` includes multiple scattering if the
 * settings have it; otherwise the result is single scattering. */
pl_air_light pl_air_scatter(const pl_air *air, const pl_air_ray *ray, const pl_air_sun *sun,
                            const pl_air_rule *rule, bool multiple);

/* True if a ray passes through any air before its end. */
bool pl_air_meets(const pl_air *air, const pl_air_ray *ray);

/* Irradiance of the sky on horizontal ground for a solar irradiance of 1. `sun_sine`: sine of the
 * sun's elevation. */
pl_vec3f pl_air_skylight(const pl_air *air, double sun_sine, bool multiple);

#endif
