/* Which triangles of a model the alpha of their materials leaves, for meshes that are exported. */
#ifndef PL_SHADE_PRESENCE_H
#define PL_SHADE_PRESENCE_H

#include "geom/model.h"

/* What alpha leaves of a triangle. */
typedef enum pl_presence {
  PL_PRESENCE_NONE,  /* nothing: rays pass everywhere */
  PL_PRESENCE_PART,  /* something, or that is not known */
  PL_PRESENCE_WHOLE, /* all of it */
} pl_presence;

/* A pl_presence for each triangle, by the material alone (graphs are asked elsewhere): bounds of
 * alpha over ever smaller pieces of the triangle, down to a texel. PL_PRESENCE_NONE and _WHOLE are
 * certain. */
void pl_presence_find(const pl_model *model, uint8_t *out);

#endif
