/* Clouds of a body: a thin shell that covers part of the sky and scatters without absorbing. */
#ifndef PL_SHADE_CLOUDS_H
#define PL_SHADE_CLOUDS_H

#include <stdbool.h>
#include <stdint.h>

#include "geom/texture.h"
#include "math/vec.h"

/* What a frame says of a body's clouds. Cover is the part of a place that has clouds: a map gives
 * its mean, which a noise breaks into clouds and gaps. */
typedef struct pl_clouds {
  double altitude_m;  /* of the shell over the surface, along the semi-axes; 0: no clouds */
  double thickness_m; /* of the layer: how long a way through it a level ray has */
  double turn_rad;    /* of the shell eastwards against the body */
  float opacity;      /* factor on the cover, 0..1 */
  float depth;        /* optical, of what is covered, straight through */
  float color[3];     /* factor on the light that is scattered, 0..1 */
  float coverage;     /* mean of the cover; factor on a map's, 0..1 */
  float softness;     /* of the edges, over the noise's standard deviation; > 0 */
  float octaves;      /* of the noise, 1..16, parts of one count; 0: none, the cover is its mean */
  float roughness;    /* amplitude of an octave by the one before, 0..1 */
  double size_m;      /* of the largest clouds: cells of the first octave */
  float warp;         /* by which map and noise are bent, over size_m */
  float depth_spread; /* of the depth within the noise: standard deviation of its logarithm */
  float relief_m;     /* of the tops: standard deviation; soft clouds have less of both */
  float phase;        /* moves what bends them, cells: clouds change their shape with it */
  uint32_t seed;
} pl_clouds;

/* Whether all is finite and in range. */
bool pl_clouds_valid(const pl_clouds *clouds);
static inline bool pl_clouds_noisy(const pl_clouds *clouds) { return clouds->octaves > 0.0f; }
/* Whether what is covered is not the same everywhere. */
static inline bool pl_clouds_uneven(const pl_clouds *clouds) {
  return pl_clouds_noisy(clouds) && (clouds->depth_spread > 0.0f || clouds->relief_m > 0.0f);
}

/* Made once a frame of the above. */
typedef struct pl_cloud_cover {
  const pl_clouds *clouds;
  const pl_texture *map;       /* equirectangular about longitude 0, red; NULL for none */
  int detail;                  /* octaves that are looked up; the others count as their spread */
  float spread;                /* of the noise and its soft edges, standard deviations */
  float variance;              /* of the whole noise */
  float scale;                 /* of the octaves that are looked up, in the whole */
  float sine, cosine;          /* of the turn */
  double oblate;               /* of the map, as of pl_body_place; 0 unless it is set */
  float amplitudes[16], total; /* of the octaves, and their sum */
} pl_cloud_cover;
pl_cloud_cover pl_cloud_cover_make(const pl_clouds *clouds, const pl_texture *map, int detail);

/* What a footprint sees of the shell. */
typedef struct pl_cloud_place {
  float cover;    /* mean, 0..1 */
  float depth;    /* optical, of what is covered */
  float unsure;   /* about what the cover may be off by, where the noise hides in the footprint */
  pl_vec3f slope; /* of its tops: how their height grows along body axes */
} pl_cloud_place;

/* Of a footprint of extents `across` and `along` about a point of the shell, body axes, m. Where
 * the noise is high, clouds are deeper and their tops higher, about the same median depth and mean
 * slope of 0 everywhere; `tops`: whether the slope is wanted (the depths of cloud fields are nearly
 * log-normal: Barker, Wielicki and Parker 1996, Journal of the Atmospheric Sciences 53, 2304). */
pl_cloud_place pl_cloud_place_at(const pl_cloud_cover *cover, pl_vec3 point, pl_vec3 across,
                                 pl_vec3 along, bool tops);
/* The mean cover alone. The noise counts as normally distributed where the footprint or `detail`
 * hides octaves: then the mean stays what it is at any distance. */
float pl_cloud_cover_at(const pl_cloud_cover *cover, pl_vec3 point, pl_vec3 across, pl_vec3 along);

/* Most by which the cover changes when only so many octaves are looked up, for footprints of
 * `width_m` or more. */
double pl_clouds_detail_error(const pl_clouds *clouds, int detail, double width_m);

/* Mean cosine of the angle by which a droplet turns light (King 1987, Journal of the Atmospheric
 * Sciences 44, 1734). */
#define PL_CLOUD_G 0.85f

/* Part of the light at the cosine mu > 0 to the normal that a layer of some depth sends back, by
 * the delta-Eddington approximation without absorption (Joseph, Wiscombe and Weinman 1976, Journal
 * of the Atmospheric Sciences 33, 2452; Meador and Weaver 1980, 37, 630): off by up to 0.05, and
 * 0.09 where mu is below 0.3. */
float pl_cloud_reflected(float depth, float mu);
/* Part that comes through straight. The rest comes through diffusely. */
float pl_cloud_straight(float depth, float mu);

#endif
