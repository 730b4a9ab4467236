/* Bright ejecta and rays of fresh craters, as an excess of albedo that is a function of place.
 *
 * A crater is as bright as its age leaves it, (1 - age/life)^2, life being `fade_ga` for craters of
 * 3 km or more and shorter in proportion to the diameter for others: thin ejecta are mixed with
 * soil sooner. Around it, x radii from its centre, lies a halo 1/(1 + (x/1.5)^4) and 12 to 24 rays
 * of drawn azimuth, width, length and strength, more to one side than to the other, all broken up
 * by noise. Sums are cut at 1, and what is expected at a place on the mean is taken away: the mean
 * albedo of ground stays, whatever of it is drawn. */
#ifndef PL_TERRAIN_CRATER_RAYS_H
#define PL_TERRAIN_CRATER_RAYS_H

#include "terrain/crater_field.h"

typedef struct pl_crater_brightness pl_crater_brightness;

/* For a field that is complete but for this; NULL without rays. */
pl_status pl_crater_brightness_create(const pl_crater_field *field, pl_crater_brightness **out);
void pl_crater_brightness_destroy(pl_crater_brightness *brightness);

/* Fraction of its first brightness that a crater keeps. */
double pl_crater_freshness(const pl_crater_rays *rays, double diameter_m, double age_ga);

/* Writes the excess over the mean at unit directions, from about -0.2 to 1, of craters of
 * half a footprint (m) or more; 0 for fields without rays. The albedo is
 * to be multiplied by 1 + brightness * excess. `model` may be NULL. */
pl_status pl_crater_add_rays(const pl_crater_field *field, const pl_crater_model *model,
                             const pl_vec3 *directions, size_t count, double footprint_m,
                             float *out);

#endif
