/* Object labels and masks of one frame: prepared before rendering, gathered from tiles, then
 * finished. */
#ifndef PL_FRAME_LABELS_H
#define PL_FRAME_LABELS_H

#include "annotate/cloud_map.h"
#include "annotate/flow.h"
#include "annotate/ground_map.h"
#include "annotate/silhouette.h"
#include "frame/frame.h"
#include "render/render.h"

/* Data gathered while a frame renders. A pointer is NULL if no requested label needs it. */
typedef struct pl_labels {
  const pl_frame_request *request;
  const pl_snapshot *shot;
  pl_extent *extents;   /* workers x slots (pl_shot_slot): for object labels or masks */
  size_t first_body;    /* slot of the first body; PL_EXTENT_NO_BODIES if none has a label */
  pl_outline *outlines; /* per object, then per piece: for amodal labels or masks */
  pl_seen *seen;        /* whole image: for masks, or when an object may be occluded or cut off */
  pl_ground_map ground; /* of channels that need one; without points: none does */
  pl_instance_coverage coverage; /* without images: none is asked for */
  float *clouds;                 /* image of cloud_opacity; NULL: not asked for */
  const pl_flow *flow;           /* of channels that need other frames */
} pl_labels;

/* Kept from frame to frame; created on first use. */
typedef struct pl_label_tools {
  pl_solo *solo;
  pl_cluster_cache clusters;
  pl_adjacency_cache adjacencies;
  pl_coverage others[PL_FLOW_FRAMES]; /* where meshes may be in other frames */
} pl_label_tools;
void pl_label_tools_init(pl_label_tools *tools);
void pl_label_tools_clear(pl_label_tools *tools); /* call before the accelerators are destroyed */

/* Allocates everything in the arena, which no label needs that is not requested. */
pl_status pl_labels_prepare(const pl_frame_request *request, const pl_snapshot *shot,
                            pl_label_tools *tools, pl_arena *arena, pl_labels *out);
/* Called by the worker threads; `shot`: that of the tile's instant. */
void pl_labels_tile(const pl_labels *labels, const pl_snapshot *shot, const pl_tile_result *result,
                    int worker);
/* Writes the request's objects and masks, and the channels of the ground map. */
pl_status pl_labels_finish(const pl_labels *labels, pl_accelerators *kept, pl_label_tools *tools,
                           pl_arena *arena);

#endif
