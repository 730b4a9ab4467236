/* Places the pieces of an articulated object. */
#ifndef PL_SCENE_PIECES_H
#define PL_SCENE_PIECES_H

#include "scene/snapshot.h"

/* Fills in the pieces and the bounding sphere of an object whose pose is set; memory belongs to the
 * arena. */
pl_status pl_pieces_place(const pl_object_state *state, pl_arena *arena, pl_shot_object *object);

#endif
