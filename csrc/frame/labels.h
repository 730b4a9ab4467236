/* Object labels and masks of one frame: memory before the rays, tiles as they come, the rest after.
 */
#ifndef PL_FRAME_LABELS_H
#define PL_FRAME_LABELS_H

#include "annotate/silhouette.h"
#include "frame/frame.h"
#include "render/render.h"

/* What is gathered while a frame renders; NULL where nothing asked for needs it. */
typedef struct pl_labels {
  const pl_frame_request *request;
  const pl_snapshot *shot;
  pl_extent *extents;   /* workers x objects: with object labels or masks */
  pl_outline *outlines; /* per object, then per piece: with amodal labels or masks */
  pl_seen *seen;        /* the image: with masks, or when some object may be hidden or cut */
} pl_labels;

/* What is kept from frame to frame; made when first needed. */
typedef struct pl_label_tools {
  pl_solo *solo;
  pl_cluster_cache clusters;
} pl_label_tools;
void pl_label_tools_init(pl_label_tools *tools);
void pl_label_tools_clear(pl_label_tools *tools); /* before the accelerators are destroyed */

/* All memory is the arena's. Touches nothing when neither objects nor masks are asked for. */
pl_status pl_labels_prepare(const pl_frame_request *request, const pl_snapshot *shot,
                            pl_label_tools *tools, pl_arena *arena, pl_labels *out);
/* Called on the workers. */
void pl_labels_tile(const pl_labels *labels, const pl_tile_result *result, int worker);
/* Fills the request's objects and masks. */
pl_status pl_labels_finish(const pl_labels *labels, pl_accelerators *kept, pl_label_tools *tools,
                           pl_arena *arena);

#endif
