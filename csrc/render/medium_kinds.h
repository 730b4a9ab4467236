/* The kinds of media, each in its own file. */
#ifndef PL_RENDER_MEDIUM_KINDS_H
#define PL_RENDER_MEDIUM_KINDS_H

#include "render/medium.h"

extern const pl_medium_kind pl_medium_clouds;
extern const pl_medium_kind pl_medium_rings;
extern const pl_medium_kind pl_medium_volumes;

#endif
