/* Which crater of a terrain a point of the ground lies in, for labels.
 *
 * It is the smallest crater whose rim, as it is drawn, encloses the point, among those that count:
 * large enough in the view, deep enough, and with enough of their relief left at the point by
 * younger craters. Whether a crater is large enough is told by its diameter and the distance of its
 * centre, so that it holds for all of a crater. Craters of the terrain's catalogue are circles,
 * deep enough, and nothing is left out of them. */
#ifndef PL_TERRAIN_CRATER_MARKS_H
#define PL_TERRAIN_CRATER_MARKS_H

#include "terrain/terrain.h"

typedef struct pl_crater_criteria {
  double least_px;    /* diameter as seen from the front; > 0 */
  double least_depth; /* fraction of the depth of a fresh crater; 0 to 1 */
  double least_kept;  /* fraction of its relief at the point; 0 to 1 */
} pl_crater_criteria;

#define PL_CRATER_CRITERIA ((pl_crater_criteria){10.0, 0.2, 0.5})

typedef struct pl_crater_view {
  pl_vec3 eye; /* body axes, m */
  double pixel_rad;
  pl_crater_criteria criteria;
} pl_crater_view;

/* Writes the ids of craters (pl_crater.id, and minus the number of one of the catalogue) at `count`
 * points, body axes, m; 0 where there is none. Each point has the same id alone and among others.
 * Fast if the points are near each other. */
void pl_crater_marks(const pl_terrain *terrain, const pl_crater_view *view, const pl_vec3 *points,
                     size_t count, int64_t *ids);

#endif
