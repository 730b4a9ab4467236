/* Effect rows that describe light transport and image sampling. */
#ifndef PL_RENDER_EFFECTS_H
#define PL_RENDER_EFFECTS_H

#include "plan/effect.h"

extern const pl_effect pl_effect_cast_shadows;
extern const pl_effect pl_effect_bounces;
extern const pl_effect pl_effect_body_bounces;
extern const pl_effect pl_effect_planetshine;
extern const pl_effect pl_effect_caustics;
extern const pl_effect pl_effect_antialiasing;
extern const pl_effect pl_effect_volumes;

#endif
