/* What the rows of the sun's disc have in common. */
#ifndef PL_LIGHT_PENUMBRA_H
#define PL_LIGHT_PENUMBRA_H

#include "plan/view.h"

/* Width of the widest penumbra in pixels: disc diameter times the reach of the shadow over the
 * size of a pixel at the receiver. */
double pl_penumbra_px(const pl_view *view);

/* A lobe this many times wider than the sun hides its shape. */
#define PL_SUN_LOBE_RATIO 16.0

#endif
