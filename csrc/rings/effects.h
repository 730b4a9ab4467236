/* Effect rows of rings. */
#ifndef PL_RINGS_EFFECTS_H
#define PL_RINGS_EFFECTS_H

#include "plan/effect.h"

extern const pl_effect pl_effect_rings;

#endif
