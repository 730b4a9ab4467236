/* Motion of visible points to another frame: optical flow, occlusion there, and scene flow.
 *
 * The point that a pixel sees is carried with its surface (object, moving node, body), and
 * projected with the camera, lens and shutter of the other frame. Where nothing is hit, the
 * direction is carried, which only the camera's rotation moves. */
#ifndef PL_ANNOTATE_FLOW_H
#define PL_ANNOTATE_FLOW_H

#include "annotate/sight.h"

typedef enum pl_flow_to { PL_FLOW_NEXT, PL_FLOW_PREVIOUS, PL_FLOW_FRAMES } pl_flow_to;

/* Another frame of the same scene, as requested. */
typedef struct pl_other_frame {
  pl_placement placement;
  /* borrowed, one per body: whether its shape or terrain is another one there, so that no point of
   * it has a motion; NULL: none */
  const bool *changed;
} pl_other_frame;

typedef enum pl_flow_image {
  PL_FLOW_FORWARD,
  PL_FLOW_BACKWARD,
  PL_FLOW_OCCLUDED_FORWARD,
  PL_FLOW_OCCLUDED_BACKWARD,
  PL_FLOW_SCENE,
  PL_FLOW_IMAGES
} pl_flow_image;

typedef struct pl_flow {
  const pl_sight_frame *frames[PL_FLOW_FRAMES]; /* NULL: there is no such frame */
  void *images[PL_FLOW_IMAGES];                 /* NULL: not asked for */
  bool wanted[PL_FLOW_FRAMES];                  /* whether an image needs the frame */
} pl_flow;

/* Finds the images among those of pl_channels; without frames. Returns false if there are none. */
bool pl_flow_init(void *const *channels, pl_flow *out);

/* Whether an image needs to know what hides points there. */
static inline bool pl_flow_wants_hidden(const pl_flow *flow, pl_flow_to to) {
  return flow->images[to == PL_FLOW_NEXT ? PL_FLOW_OCCLUDED_FORWARD : PL_FLOW_OCCLUDED_BACKWARD] !=
         NULL;
}

/* Writes all images of a tile (x0, y0, width, height), with `stride` points a row. `shot`: that of
 * the tile's instant. `points` NULL: nothing is hit. */
void pl_flow_write(const pl_flow *flow, const pl_snapshot *shot, const pl_point *points,
                   size_t stride, const int tile[4]);

#endif
