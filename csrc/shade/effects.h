/* Effect rows that describe surfaces. */
#ifndef PL_SHADE_EFFECTS_H
#define PL_SHADE_EFFECTS_H

#include "plan/effect.h"

extern const pl_effect pl_effect_surface_maps;
extern const pl_effect pl_effect_bump_detail;
extern const pl_effect pl_effect_relief;
extern const pl_effect pl_effect_glint;
extern const pl_effect pl_effect_night_lights;
extern const pl_effect pl_effect_texture_filter;
extern const pl_effect pl_effect_regolith;
extern const pl_effect pl_effect_clear_coat;
extern const pl_effect pl_effect_transmission;
extern const pl_effect pl_effect_clouds;

#endif
