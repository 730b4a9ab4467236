/* Effect rows that describe the camera. */
#ifndef PL_SCENE_EFFECTS_H
#define PL_SCENE_EFFECTS_H

#include "plan/effect.h"

extern const pl_effect pl_effect_distortion;
extern const pl_effect pl_effect_depth_of_field;
extern const pl_effect pl_effect_motion_blur;
extern const pl_effect pl_effect_rolling_shutter;

#endif
