/* Effect rows that describe what lies behind everything. */
#ifndef PL_SKY_EFFECTS_H
#define PL_SKY_EFFECTS_H

#include "plan/effect.h"

extern const pl_effect pl_effect_stars;
extern const pl_effect pl_effect_sky_background;

#endif
