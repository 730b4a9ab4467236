/* Light that single-scattering GGX loses to shadowing, to be given back as multiple scattering. */
#ifndef PL_SHADE_GGX_LOSS_H
#define PL_SHADE_GGX_LOSS_H

/* 1 - directional albedo of a GGX surface of reflectance 1 seen at `cosine`; `roughness` is the
 * square root of GGX's alpha. Both 0..1; values beyond count as the limit. Off by at most 0.002 for
 * roughness from 0.05 and cosines from 0.08. */
float pl_ggx_loss(float roughness, float cosine);
/* The cosine-weighted mean of pl_ggx_loss over the hemisphere, exact for its interpolation. */
float pl_ggx_loss_mean(float roughness);

#endif
