/* The tables of an atmosphere, for the files of this folder. */
#ifndef PL_AIR_TABLE_H
#define PL_AIR_TABLE_H

#include "air/air.h"
#include "air/reach.h"

/* Nodes in height and in the cosine of the zenith angle. */
enum { PL_AIR_HEIGHTS = 97, PL_AIR_COSINES = 48 };
enum { PL_AIR_SKY = 64, PL_AIR_MULTIPLE_HEIGHTS = 16, PL_AIR_MULTIPLE_SINES = 32 };

/* A column of one constituent from a height upwards under the zenith angle of cosine mu >= 0, of
 * density 1 at the reference height, is that straight up times the air mass
 * 2/(mu + sqrt(mu^2 + s^2)), times the ratio. s is such that the air mass is right at the horizon;
 * for an exponential density it is near the asymptote of Chapman's function, sqrt(8 H/(pi r)), and
 * the rest follows a bound of the error function (Abramowitz and Stegun 7.1.13) that the ratio,
 * between 0.9 and 1.1 or so, mends. */
typedef struct pl_air_column {
  double top_m;            /* where the density ends */
  double per_height, bend; /* of the nodes in height */
  double above;            /* of ozone: part of its layer that is above the top */
  float grazing[PL_AIR_HEIGHTS];
  float up[PL_AIR_HEIGHTS]; /* of a bent density: straight up, over the density there */
  float ratio[PL_AIR_HEIGHTS][PL_AIR_COSINES];
} pl_air_column;

/* A density that thins out by e over scale_m[0] at the surface and over scale_m[1] far above
 * bend_m: its logarithm is a hyperbola, round over `round_m`, so that integrals along rays meet no
 * corner. Straight where there is one scale height. */
typedef struct pl_air_layers {
  bool bent;
  double scale_m[2], bend_m, round_m;
  double lower, upper; /* minus one over the first; half of what the second's differs by */
  double offset_m;     /* of the hyperbola at the surface */
  float rest;          /* density at the top */
} pl_air_layers;
float pl_air_layers_density(const pl_air_layers *layers, double height_m);
/* Of the density at another height over that at a first one. */
double pl_air_layers_ratio(const pl_air_layers *layers, double height_m, double other_m);

struct pl_air {
  pl_air_settings settings;
  double radius_m;
  float extinction[PL_AIR_PARTS][3];
  float scattering[2][3];     /* Rayleigh, Mie */
  bool present[PL_AIR_PARTS]; /* with any extinction */
  pl_air_layers layers[2];    /* of Rayleigh, Mie */
  pl_air_column columns[PL_AIR_PARTS];
  pl_vec3f sky[2][PL_AIR_SKY]; /* irradiance by the sine of the sun's height; with multiple */
  /* Mean radiance, over the sphere, of light scattered several times. */
  pl_vec3f several[PL_AIR_MULTIPLE_HEIGHTS][PL_AIR_MULTIPLE_SINES];
  pl_air_reach reach;
};

/* A place in the air: its height, the distance from the centre over the radius, and of each
 * constituent the density, the column straight up and s. */
typedef struct pl_air_place {
  double height_m, r;
  float density[PL_AIR_PARTS], up[PL_AIR_PARTS], grazing[PL_AIR_PARTS];
  float node[PL_AIR_PARTS]; /* in height */
} pl_air_place;
pl_air_place pl_air_place_of(const pl_air *air, double squared_r_less_1);

/* Fills air->columns. */
void pl_air_build_columns(pl_air *air);
/* Metres of density 1 of each constituent, upwards: mu >= 0. */
void pl_air_column_up(const pl_air *air, const pl_air_place *place, double mu,
                      float out[PL_AIR_PARTS]);
/* In any direction, from anywhere outside the surface; see pl_air_depth. lowest2: the squared
 * distance of the whole line from the centre. */
void pl_air_column_any(const pl_air *air, const pl_air_place *place, double mu,
                       double lowest2_less_1, float out[PL_AIR_PARTS]);
/* Optical depths of columns. */
pl_vec3f pl_air_depth_of(const pl_air *air, const float column[PL_AIR_PARTS], float length);
pl_vec3f pl_air_dimmed(pl_vec3f depth); /* exp(-depth) */

/* Depth of the air towards the sun at a place where the sun's height has sine mu; *part: of the
 * disc that is above the horizon, 0..1. With none the depth is not set. */
pl_vec3f pl_air_depth_sun(const pl_air *air, const pl_air_sun *sun, const pl_air_place *place,
                          double mu, float *part);
/* What is scattered: sunlight by its phase functions; that and light scattered before, evenly to
 * all sides; or such light alone. */
typedef enum pl_air_mode { PL_AIR_ONCE, PL_AIR_SEVERAL, PL_AIR_AGAIN } pl_air_mode;
pl_air_light pl_air_scatter_by(const pl_air *air, const pl_air_ray *ray, const pl_air_sun *sun,
                               const pl_air_rule *rule, pl_air_mode mode);

/* Fills air->several; then air->sky. */
void pl_air_build_multiple(pl_air *air);
void pl_air_build_sky(pl_air *air);
/* Fills air->reach, of all the rest. */
void pl_air_build_reach(pl_air *air);
/* What so many steps along a ray are off by: see pl_air_step_error. depth: of the longest way. */
void pl_air_measure_steps(const pl_air *air, double depth, double off[PL_AIR_RULES]);
/* Mean radiance at a place of light that was scattered before. */
pl_vec3f pl_air_several(const pl_air *air, const pl_air_place *place, double sun_sine);

#endif
