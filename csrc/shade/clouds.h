/* Clouds of a body: a thin shell with partial cover that scatters without absorption. */
#ifndef PL_SHADE_CLOUDS_H
#define PL_SHADE_CLOUDS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/wide.h"
#include "geom/texture.h"
#include "math/vec.h"

/* Parameters of a body's clouds in a frame. The cover is the covered fraction of an area: a map
 * gives its mean, which a noise splits into clouds and gaps. */
typedef struct pl_clouds {
  double altitude_m;  /* height of the shell above the surface, along the semi-axes; 0: no clouds */
  double thickness_m; /* thickness of the layer: sets the path length of a horizontal ray */
  double turn_rad;    /* eastward rotation of the shell relative to the body */
  float opacity;      /* factor on the cover, 0..1 */
  float depth;        /* vertical optical depth of the covered part */
  float color[3];     /* factor on the scattered light, 0..1 */
  float coverage;     /* mean cover, or factor on the map's cover, 0..1 */
  float softness;     /* width of the edges over the noise's standard deviation; > 0 */
  /* Octaves of the noise, 1..16, may be fractional; 0: no noise, the cover is its mean. */
  float octaves;
  float roughness;    /* ratio of the amplitudes of successive octaves, 0..1 */
  double size_m;      /* size of the largest clouds: cells of the first octave */
  float warp;         /* amplitude of the domain warp of map and noise, over size_m */
  float depth_spread; /* standard deviation of the logarithm of the depth within the noise */
  float relief_m; /* standard deviation of the height of the tops; soft clouds have less of both */
  float phase;    /* offset of the warp's noise, cells: clouds change their shape with it */
  uint32_t seed;
} pl_clouds;

/* True if all parameters are finite and in range. */
bool pl_clouds_valid(const pl_clouds *clouds);
static inline bool pl_clouds_noisy(const pl_clouds *clouds) { return clouds->octaves > 0.0f; }
/* True if depth or height vary within the covered part. */
static inline bool pl_clouds_uneven(const pl_clouds *clouds) {
  return pl_clouds_noisy(clouds) && (clouds->depth_spread > 0.0f || clouds->relief_m > 0.0f);
}

/* Lookup state, computed once per frame from pl_clouds. */
typedef struct pl_cloud_cover {
  const pl_clouds *clouds;
  const pl_texture *map; /* equirectangular about longitude 0, red channel; NULL for none */
  int detail;         /* number of octaves evaluated; the others contribute only their variance */
  float spread;       /* standard deviation of the noise including its soft edges */
  float variance;     /* variance of the noise over all octaves */
  float scale;        /* amplitude of the evaluated octaves relative to all */
  float sine, cosine; /* of turn_rad */
  double oblate;      /* of the map, as in pl_body_place; 0 unless set */
  float amplitudes[16], total; /* of the octaves, and their sum */
} pl_cloud_cover;
pl_cloud_cover pl_cloud_cover_make(const pl_clouds *clouds, const pl_texture *map, int detail);

/* Clouds over a footprint on the shell. */
typedef struct pl_cloud_place {
  float cover;    /* mean cover, 0..1 */
  float depth;    /* optical depth of the covered part */
  float unsure;   /* approximate error of the cover, where the footprint hides the noise */
  pl_vec3f slope; /* slope of the tops: gradient of their height, body axes */
} pl_cloud_place;

/* What is asked of clouds beside cover and depth; the rest of pl_cloud_place is 0. TOPS: the slope.
 * BOX: the map's mean is that of a box (pl_texture_box), for a pixel that has no other footprint.
 */
enum { PL_CLOUD_TOPS = 1, PL_CLOUD_UNSURE = 2, PL_CLOUD_BOX = 4 };

/* Clouds over a footprint of extents `across` and `along` about a point of the shell, body axes, m.
 * Where the noise is high, clouds have a larger optical depth and higher tops; the median depth and
 * the mean slope of 0 are the same everywhere. (Optical depths of cloud fields are nearly
 * log-normal: Barker, Wielicki and Parker 1996, Journal of the Atmospheric Sciences 53, 2304.) */
pl_cloud_place pl_cloud_place_at(const pl_cloud_cover *cover, pl_vec3 point, pl_vec3 across,
                                 pl_vec3 along, unsigned wants);
/* A footprint on the shell: its point and extents, body axes, m. */
typedef struct pl_cloud_spot {
  pl_vec3 point, across, along;
} pl_cloud_spot;
/* The same of up to PL_LANES footprints, which cost less together; of the same bits. */
void pl_cloud_places(const pl_cloud_cover *cover, const pl_cloud_spot *spots, size_t count,
                     unsigned wants, pl_cloud_place *out);
/* The mean cover alone. Octaves hidden by the footprint or by `detail` are treated as normally
 * distributed, so that the mean cover does not depend on the distance. */
float pl_cloud_cover_at(const pl_cloud_cover *cover, pl_vec3 point, pl_vec3 across, pl_vec3 along);

/* Upper bound of the change of the cover if only `detail` octaves are evaluated, for footprints of
 * at least `width_m`. */
double pl_clouds_detail_error(const pl_clouds *clouds, int detail, double width_m);

/* Asymmetry parameter of the droplets' phase function (King 1987, Journal of the Atmospheric
 * Sciences 44, 1734). */
#define PL_CLOUD_G 0.85f

/* Reflectance of a layer of the given optical depth for light at the cosine mu > 0 to the normal,
 * by the delta-Eddington approximation without absorption (Joseph, Wiscombe and Weinman 1976,
 * Journal of the Atmospheric Sciences 33, 2452; Meador and Weaver 1980, 37, 630): errors are up to
 * 0.05, and 0.09 where mu is below 0.3. */
float pl_cloud_reflected(float depth, float mu);
/* Direct transmittance. The rest of the light that is not reflected is transmitted diffusely. */
float pl_cloud_straight(float depth, float mu);

#endif
