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
 * A pixel is mixed where a mesh or ground may be, by `coverage`; where the limb of an ellipsoid may
 * be, unless one that fills the pixel lies before it; where two ellipsoids are, unless the
 * distances of their points say which is before the other; and where the lens may have no ray. */
void pl_mixed_pixels_find(const pl_snapshot *shot, const pl_coverage *coverage, pl_tile tile,
                          bool mixed[PL_TILE_PIXELS]);

#endif
