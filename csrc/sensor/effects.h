/* The rows of effects of this folder. */
#ifndef PL_SENSOR_EFFECTS_H
#define PL_SENSOR_EFFECTS_H

#include "plan/effect.h"

extern const pl_effect pl_effect_filters;
extern const pl_effect pl_effect_point_spread;
extern const pl_effect pl_effect_vignetting;
extern const pl_effect pl_effect_lens_flare;
extern const pl_effect pl_effect_smear;
extern const pl_effect pl_effect_defects;
extern const pl_effect pl_effect_cosmic_rays;
extern const pl_effect pl_effect_blooming;
extern const pl_effect pl_effect_black_sun;
extern const pl_effect pl_effect_fixed_pattern;
extern const pl_effect pl_effect_dark_current;
extern const pl_effect pl_effect_shot_noise;
extern const pl_effect pl_effect_read_noise;

#endif
