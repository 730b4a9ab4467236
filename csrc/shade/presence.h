/* Finds which triangles of a model the alpha of their materials leaves visible, for mesh export. */
#ifndef PL_SHADE_PRESENCE_H
#define PL_SHADE_PRESENCE_H

#include "geom/model.h"

/* Visible part of a triangle. */
typedef enum pl_presence {
  PL_PRESENCE_NONE,  /* none: rays pass everywhere */
  PL_PRESENCE_PART,  /* a part, or undecided */
  PL_PRESENCE_WHOLE, /* all of it */
} pl_presence;

/* A pl_presence for each triangle, from the material alone (not from graphs): bounds of alpha over
 * a subdivision of the triangle, down to a texel. PL_PRESENCE_NONE and _WHOLE are certain. */
void pl_presence_find(const pl_model *model, uint8_t *out);

#endif
