/* Sizes of the meshes of rocks: how large a shadow they throw. */
#ifndef PL_TERRAIN_ROCK_SHADOW_H
#define PL_TERRAIN_ROCK_SHADOW_H

#include "terrain/rock_shape.h"

/* Area of the shadow of a variant's mesh on a plane behind it, mean over directions of the light.
 * Every ray from the centre leaves the rock once, and so does every one from the shadow's. */
pl_status pl_rock_shadow_mean(const pl_rock_sphere *sphere, const pl_rock_variant *variant,
                              double *out);

/* Gives a variant the scales at which its meshes throw the shadow of the finest: those of its
 * family, or of the measured shape itself. */
pl_status pl_rock_variant_set_scales(const pl_rock_sphere *spheres, pl_rock_variant *variant);

#endif
