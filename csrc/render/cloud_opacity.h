/* Opacity of clouds, for labels. */
#ifndef PL_RENDER_CLOUD_OPACITY_H
#define PL_RENDER_CLOUD_OPACITY_H

#include "scene/snapshot.h"

/* Rays from the camera. */
typedef struct pl_cloud_rays {
  size_t count;
  const pl_vec3 *directions; /* unit, root axes; zero: no ray */
  const double *t_max;       /* m: where the ray ends */
  float spread;              /* width of their beams over the distance */
} pl_cloud_rays;

/* Multiplies `transmittance`, one per ray, by the part of light that passes the clouds of all
 * bodies straight on. All detail of clouds counts, whatever a plan leaves out. */
void pl_cloud_pass(const pl_snapshot *shot, const pl_cloud_rays *rays, float *transmittance);

#endif
