/* The rows of effects of this folder. */
#ifndef PL_SENSOR_EFFECTS_H
#define PL_SENSOR_EFFECTS_H

#include "plan/effect.h"

extern const pl_effect pl_effect_point_spread;
extern const pl_effect pl_effect_fixed_pattern;
extern const pl_effect pl_effect_dark_current;
extern const pl_effect pl_effect_shot_noise;
extern const pl_effect pl_effect_read_noise;

#endif
