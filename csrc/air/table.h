/* Tables of an atmosphere, private to this folder. */
#ifndef PL_AIR_TABLE_H
#define PL_AIR_TABLE_H

#include "air/air.h"
#include "air/light_bounds.h"

/* Numbers of nodes in height and in the cosine of the zenith angle. */
enum { PL_AIR_HEIGHTS = 97, PL_AIR_COSINES = 48 };
enum { PL_AIR_SKY = 64, PL_AIR_MULTIPLE_HEIGHTS = 16, PL_AIR_MULTIPLE_SINES = 32 };

/* Column of one constituent from a height upwards, for a zenith cosine mu >= 0 and density 1 at the
 * reference height. It is the vertical column times the air mass 2/(mu + sqrt(mu^2 + s^2)) times
 * the ratio. s is such that the air mass is exact at the horizon. For an exponential density s is
 * near the asymptote of Chapman's function, sqrt(8 H/(pi r)), and the form of the air mass follows
 * a bound of the error function (Abramowitz and Stegun 7.1.13). The ratio, about 0.9 to 1.1,
 * corrects the rest. */
typedef struct pl_air_column {
  double top_m;            /* height where the density ends */
  double per_height, bend; /* parameters of the node spacing in height */
  double above;            /* ozone: part of its layer above the top */
  float grazing[PL_AIR_HEIGHTS];
  /* vertical column over the density at the node, m; for a density with two scale heights */
  float up[PL_AIR_HEIGHTS];
  float ratio[PL_AIR_HEIGHTS][PL_AIR_COSINES];
} pl_air_column;

/* A density with scale height scale_m[0] at the surface and scale_m[1] far above bend_m. Its
 * logarithm is a hyperbola, rounded over `round_m`, so that integrands along rays have no corner.
 * With a single scale height it is a straight line. */
typedef struct pl_air_layers {
  bool bent;
  double scale_m[2], bend_m, round_m;
  /* minus the inverse of the first scale height; half of the difference of the inverses */
  double lower, upper;
  double offset_m; /* value of the hyperbola at the surface */
  float rest;      /* density at the top */
} pl_air_layers;
/* Ratio of the density at other_m to that at height_m. */
double pl_air_layers_ratio(const pl_air_layers *layers, double height_m, double other_m);

struct pl_air {
  pl_air_settings settings;
  double radius_m;
  float extinction[PL_AIR_PARTS][3];
  float scattering[2][3];     /* Rayleigh, Mie */
  bool present[PL_AIR_PARTS]; /* has any extinction */
  pl_air_layers layers[2];    /* Rayleigh, Mie */
  pl_air_column columns[PL_AIR_PARTS];
  double twilight; /* sine of solar elevation in which the nodes of the tables below are dense */
  /* irradiance by the sine of solar elevation: [0] single scattering, [1] multiple scattering */
  pl_vec3f sky[2][PL_AIR_SKY];
  /* Mean radiance over the sphere of light that was scattered, or reflected by the ground, at least
   * once; by height and sine of solar elevation. */
  pl_vec3f several[PL_AIR_MULTIPLE_HEIGHTS][PL_AIR_MULTIPLE_SINES];
  pl_air_light_bounds bounds;
};

/* A point in the air: its height, its distance from the centre over the radius, and for each
 * constituent the density, the vertical column and s. */
typedef struct pl_air_place {
  double height_m, r;
  float density[PL_AIR_PARTS], up[PL_AIR_PARTS], grazing[PL_AIR_PARTS];
  float node[PL_AIR_PARTS]; /* position in the table's nodes in height */
} pl_air_place;
pl_air_place pl_air_place_of(const pl_air *air, double squared_r_less_1);

/* Fills air->columns. */
void pl_air_build_columns(pl_air *air);
/* Columns of the constituents upwards, as metres at density 1; mu >= 0. */
void pl_air_column_up(const pl_air *air, const pl_air_place *place, double mu,
                      float out[PL_AIR_PARTS]);
/* The same in any direction; see pl_air_depth. lowest2_less_1:
 * squared distance of the whole line from the centre, less 1. */
void pl_air_column_any(const pl_air *air, const pl_air_place *place, double mu,
                       double lowest2_less_1, float out[PL_AIR_PARTS]);
/* Optical depths of columns, times a length. */
pl_vec3f pl_air_depth_of(const pl_air *air, const float column[PL_AIR_PARTS], float length);
pl_vec3f pl_air_dimmed(pl_vec3f depth); /* exp(-depth) */

/* Light that is scattered: sunlight by the phase functions; that plus already scattered light,
 * isotropically; or already scattered light alone. */
typedef enum pl_air_mode { PL_AIR_ONCE, PL_AIR_SEVERAL, PL_AIR_AGAIN } pl_air_mode;
pl_air_light pl_air_scatter_by(const pl_air *air, const pl_air_ray *ray, const pl_air_sun *sun,
                               const pl_air_rule *rule, pl_air_mode mode);

/* Fill air->twilight, air->several, and then air->sky. */
void pl_air_set_twilight(pl_air *air);
void pl_air_build_multiple(pl_air *air);
void pl_air_build_sky(pl_air *air);
/* Fills air->bounds; all else must be filled before. */
void pl_air_build_light_bounds(pl_air *air);
/* Errors for a given number of steps along a ray: see pl_air_step_error. depth: of the longest
 * path. */
void pl_air_measure_steps(const pl_air *air, double depth, double off[PL_AIR_RULES]);
/* Mean radiance at a point of light that has been scattered before. */
pl_vec3f pl_air_several(const pl_air *air, const pl_air_place *place, double sun_sine);

#endif
