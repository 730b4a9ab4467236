/* Ray marching through a part of a ray. Internal to volume.c. */
#ifndef PL_RENDER_VOLUME_MARCH_H
#define PL_RENDER_VOLUME_MARCH_H

#include "render/volume.h"

/* The intervals of a ray within volumes. */
typedef struct pl_volume_spans {
  const pl_volume_item *item[PL_VOLUMES_MAX];
  double t[PL_VOLUMES_MAX][2];
  size_t count;
} pl_volume_spans;

/* A part of a ray on which the set of volumes is constant. */
typedef struct pl_volume_part {
  double start, end;
  const pl_volume_item *items[PL_VOLUMES_MAX];
  size_t count;
} pl_volume_part;

/* Adds the part's radiance, attenuated by the transmittance so far, and multiplies that by the
 * part's transmittance. */
void pl_volume_march(const pl_volume_view *view, const pl_volume_ray *ray,
                     const pl_volume_part *part, pl_volume_stretch *sum);

#endif
