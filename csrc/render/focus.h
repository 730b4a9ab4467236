/* Camera rays through a thin lens: rays of one pixel start anywhere on the lens and meet in the
 * plane of focus. */
#ifndef PL_RENDER_FOCUS_H
#define PL_RENDER_FOCUS_H

#include "render/vertex.h"

/* Moves a beam through the centre of the lens to the lens point sampled for sample `index` of a
 * pixel (`seed`): uniform on the disc, stratified over the samples of a pixel. */
void pl_focus_beam(const pl_snapshot *shot, uint32_t index, uint32_t seed, pl_beam *beam);

/* Widens the beam of one of `samples` camera rays, which hits something at distance t, by its part
 * of the circle of confusion there. */
void pl_focus_widen(const pl_snapshot *shot, int samples, double t, pl_beam *beam);

#endif
