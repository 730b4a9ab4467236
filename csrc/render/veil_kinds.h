/* The kinds of veils, each in its own file. */
#ifndef PL_RENDER_VEIL_KINDS_H
#define PL_RENDER_VEIL_KINDS_H

#include "render/veil.h"

extern const pl_veil_kind pl_veil_clouds;
extern const pl_veil_kind pl_veil_rings;
extern const pl_veil_kind pl_veil_volumes;

#endif
