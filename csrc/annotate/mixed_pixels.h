/* Pixels that may see more than one instance: all others see over their whole area what the ray
 * through their centre sees. The bound is conservative, so that the sub-samples of `coverage` are
 * spared without a change of any of its bits. */
#ifndef PL_ANNOTATE_MIXED_PIXELS_H
#define PL_ANNOTATE_MIXED_PIXELS_H

#include <stdbool.h>

#include "render/coverage_mask.h"
#include "render/tile.h"

/* Sets mixed[y * PL_TILE_SIDE + x] for all pixels of a tile: false only where all rays through the
 * centre of the lens that pl_image_sample_offset can choose see the same instance, or all nothing.
 * `coverage`: of the snapshot, valid in the rows of the tile.
 *
 * A pixel is mixed
 * - if `coverage` allows a mesh or ground there;
 * - if it may contain the limb of an ellipsoid, and no nearer ellipsoid fills it;
 * - if it contains two ellipsoids whose distances do not tell which is nearer;
 * - if the lens may have no ray there. */
void pl_mixed_pixels_find(const pl_snapshot *shot, const pl_coverage *coverage, pl_tile tile,
                          bool mixed[PL_TILE_PIXELS]);

#endif
