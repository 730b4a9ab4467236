/* Shared by the effect rows of the sun's disc. */
#ifndef PL_LIGHT_PENUMBRA_H
#define PL_LIGHT_PENUMBRA_H

#include "plan/view.h"

/* Width of the widest penumbra in pixels: the sun's angular diameter times the largest distance
 * from caster to receiver, divided by the size of a pixel at the receiver. */
double pl_penumbra_px(const pl_view *view);

/* A BSDF lobe this many times wider than the sun hides the shape of its disc. */
#define PL_SUN_LOBE_RATIO 16.0

#endif
