/* The rows of effects of this folder. */
#ifndef PL_IO_EFFECTS_H
#define PL_IO_EFFECTS_H

#include "plan/effect.h"

extern const pl_effect pl_effect_compression;

#endif
