/* Atmospheres: gases, haze and ozone in layers about a body, and the tables made of them once. */
#ifndef PL_AIR_AIR_H
#define PL_AIR_AIR_H

#include <stdbool.h>

#include "base/status.h"
#include "math/vec.h"

/* What an atmosphere is made of; values of three for the colour bands. Heights are above the
 * surface. Densities are cut off at the top. Gas and haze thin out by e over one scale height up to
 * a height, and over another one above it: as the troposphere and what lies above do. */
typedef struct pl_air_settings {
  double rayleigh_scattering[3]; /* at the surface, 1/m */
  double rayleigh_height_m;      /* scale height */
  double rayleigh_upper_from_m;  /* above this, the upper one; 0: there is none */
  double rayleigh_upper_height_m;
  double mie_scattering[3];                                  /* at the surface, 1/m */
  double mie_extinction[3];                                  /* scattering and absorption, 1/m */
  double mie_height_m, mie_upper_from_m, mie_upper_height_m; /* as of Rayleigh */
  double mie_g[3];            /* mean cosine of the scattering angle, of Cornette and Shanks */
  double ozone_absorption[3]; /* in the middle of its layer, 1/m */
  double ozone_center_m;      /* the density falls linearly from here to 0 */
  double ozone_width_m;       /* at so much above and below */
  double top_m;
  double ground_albedo[3]; /* of the surface, where it lights the air */
  bool multiple;           /* with the table of light that is scattered several times */
} pl_air_settings;

/* Immutable once built; shared by all threads. */
typedef struct pl_air pl_air;

/* radius_m: of the body, the geometric mean of its semi-axes. PL_E_RANGE naming what is wrong. */
pl_status pl_air_create(const pl_air_settings *settings, double radius_m, pl_air **out);
void pl_air_destroy(pl_air *air);

const pl_air_settings *pl_air_settings_of(const pl_air *air);
double pl_air_radius_m(const pl_air *air);
/* Radius of a sphere that holds the air of a body whose largest semi-axis is this. */
double pl_air_reach_m(const pl_air *air, double largest_m);

/* Density of each constituent over that at its reference height: Rayleigh, Mie, ozone. */
enum { PL_AIR_PARTS = 3 };
void pl_air_density(const pl_air *air, double height_m, float out[PL_AIR_PARTS]);

/* Phase functions, 1/sr, whose mean over the sphere is 1/(4 pi). The second is that of Cornette and
 * Shanks (1992), Applied Optics 31, 3152. */
float pl_air_rayleigh_phase(float cosine);
float pl_air_mie_phase(float cosine, float g);

/* Points and directions are in the axes of the body divided by its radii: its surface is the unit
 * sphere. A length along a direction counts as it does in metres in the direction's own units, so
 * that an oblate body's air is as thick as it is, with heights of (norm of the point - 1) radius_m:
 * off the true ones by less than the flattening times the height. */

/* Optical depth by band from a point outside the surface to the end of the air, or to infinity,
 * past the limb. `direction` is of unit length there; `stretch`: radius_m over the metres that it
 * is long, 1 on a sphere. A ray that meets the surface counts as tangent to it. */
pl_vec3f pl_air_depth(const pl_air *air, pl_vec3 point, pl_vec3 direction, double stretch);

/* Part of the light that comes through that. */
pl_vec3f pl_air_transmittance(const pl_air *air, pl_vec3 point, pl_vec3 direction, double stretch);

/* The sun as a body's air sees it. */
typedef struct pl_air_sun {
  pl_vec3 direction; /* to it, of unit length in those axes */
  double stretch;    /* as of pl_air_depth */
  double radius_rad; /* of the disc */
} pl_air_sun;

/* Part of the sun's light, by band, that reaches a point: through the air, and of the disc above
 * the horizon. The disc counts as dimmed as the middle of what is seen of it. */
pl_vec3f pl_air_sunlight(const pl_air *air, const pl_air_sun *sun, pl_vec3 point);

/* Nodes of the integral along a ray, on 0..1 (Gauss and Legendre). */
enum { PL_AIR_STEPS_MAX = 64 };
typedef struct pl_air_rule {
  int count;
  double place[PL_AIR_STEPS_MAX], weight[PL_AIR_STEPS_MAX];
} pl_air_rule;
pl_air_rule pl_air_rule_make(int count); /* cut off to 1..PL_AIR_STEPS_MAX */

/* A ray from a point outside the surface. */
typedef struct pl_air_ray {
  pl_vec3 origin, direction; /* the direction of unit length in those axes */
  double stretch;            /* as of pl_air_depth */
  double end;                /* in units of `direction`; INFINITY: to the surface, or past it */
  float sun_cosine;          /* of the true angle between the ray and the direction to the sun */
} pl_air_ray;

typedef struct pl_air_light {
  pl_vec3f scattered;   /* radiance for a sun of irradiance 1, 1/sr */
  pl_vec3f transmitted; /* part of the light from the ray's end that arrives, 0..1 */
} pl_air_light;

/* Light scattered towards the origin of a ray, once, and `multiple` times where the settings have
 * that. */
pl_air_light pl_air_scatter(const pl_air *air, const pl_air_ray *ray, const pl_air_sun *sun,
                            const pl_air_rule *rule, bool multiple);

/* Whether a ray passes through any air before its end. */
bool pl_air_meets(const pl_air *air, const pl_air_ray *ray);

/* Irradiance of the sky on flat ground, for a sun of irradiance 1 whose height has this sine. */
pl_vec3f pl_air_skylight(const pl_air *air, double sun_sine, bool multiple);

#endif
