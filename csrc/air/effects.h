/* Effect rows of atmospheres. */
#ifndef PL_AIR_EFFECTS_H
#define PL_AIR_EFFECTS_H

#include "plan/effect.h"

extern const pl_effect pl_effect_atmosphere;
extern const pl_effect pl_effect_skylight;
extern const pl_effect pl_effect_multiple_scattering;

#endif
