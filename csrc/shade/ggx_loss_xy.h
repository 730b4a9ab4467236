/* Light that single-scattering GGX loses where it is anisotropic, to be given back as multiple
 * scattering. */
#ifndef PL_SHADE_GGX_LOSS_XY_H
#define PL_SHADE_GGX_LOSS_XY_H

#include "math/vec.h"

/* 1 - directional albedo, towards the unit direction w (z = normal, |w.z| counts), of a GGX surface
 * of reflectance 1 and alphas ax >= ay along x and y, from PL_GGX_ALPHA_MIN to 1. Off by at most
 * 0.006. */
float pl_ggx_loss_xy(float ax, float ay, pl_vec3f w);
/* The cosine-weighted mean of pl_ggx_loss_xy over the hemisphere. */
float pl_ggx_loss_xy_mean(float ax, float ay);

#endif
