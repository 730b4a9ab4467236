/* Effect rows that describe light sources. */
#ifndef PL_LIGHT_EFFECTS_H
#define PL_LIGHT_EFFECTS_H

#include "plan/effect.h"

extern const pl_effect pl_effect_soft_sun;
extern const pl_effect pl_effect_limb_darkening;
extern const pl_effect pl_effect_emission;
extern const pl_effect pl_effect_emitters;

#endif
