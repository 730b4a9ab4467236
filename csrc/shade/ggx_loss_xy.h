/* Multiple scattering of anisotropic GGX lobes; method as in ggx_loss.h. */
#ifndef PL_SHADE_GGX_LOSS_XY_H
#define PL_SHADE_GGX_LOSS_XY_H

#include "shade/ggx_loss.h"

enum { PL_GGX_TURNS = 3 }; /* nodes over the azimuth */

typedef struct pl_ggx_loss_xy {
  /* The 4 slices of the table to interpolate, over both alphas. */
  const uint16_t (*slice[4])[PL_GGX_TURNS][3];
  float weight[4];
  float ax, ay;
  float mean, broad_mean;
} pl_ggx_loss_xy;

/* ax >= ay, alphas along x and y, from PL_GGX_ALPHA_MIN to 1. Errors of the losses are at most
 * 0.006. */
pl_ggx_loss_xy pl_ggx_loss_xy_of(float ax, float ay);
/* Multiple scattering for the unit direction w (z = normal, |w.z| is used). */
pl_ggx_lost pl_ggx_lost_xy_at(const pl_ggx_loss_xy *l, pl_vec3f w);
/* Only the loss 1 - E. */
float pl_ggx_loss_xy_at(const pl_ggx_loss_xy *l, pl_vec3f w);

#endif
