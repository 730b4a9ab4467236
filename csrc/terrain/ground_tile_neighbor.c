/* Neighbours of tiles. */
#include "terrain/ground_tile_neighbor.h"

/* A point on a side of a face, or a little beyond. */
static void point_of(int side, double depth, double along, double *s, double *t) {
  const double across = side & 1 ? depth : -depth;
  *s = side < 2 ? across : along;
  *t = side < 2 ? along : across;
}

void pl_cube_seams_find(pl_cube_seams *out) {
  for (int face = 0; face < PL_CUBE_FACES; face++)
    for (int side = 0; side < PL_GROUND_TILE_SIDES; side++) {
      pl_cube_seam *seam = &out->of[face][side];
      double s, t;
      point_of(side, 1.0 + 0x1p-10, 0.5, &s, &t);
      pl_cube_locate(pl_cube_direction(face, s, t), &seam->face, &s, &t);
      const bool across_s = fabs(s) > fabs(t);
      seam->side = across_s ? s > 0.0 : 2 + (t > 0.0);
      seam->reversed = (across_s ? t : s) < 0.0;
    }
}

bool pl_ground_tile_neighbor(const pl_cube_seams *seams, int level, pl_ground_tile_place from,
                             int di, int dj, pl_ground_tile_place *out) {
  const int64_t last = ((int64_t)1 << level) - 1, i = from.i + di, j = from.j + dj;
  const bool out_i = i < 0 || i > last, out_j = j < 0 || j > last;
  *out = (pl_ground_tile_place){from.face, i, j};
  if (!out_i && !out_j)
    return true;
  if (out_i && out_j)
    return false;
  const pl_cube_seam *seam = &seams->of[from.face][out_i ? i > 0 : 2 + (j > 0)];
  const int64_t along = seam->reversed ? last - (out_i ? j : i) : (out_i ? j : i);
  const int64_t across = seam->side & 1 ? last : 0;
  *out = (pl_ground_tile_place){seam->face, seam->side < 2 ? across : along,
                                seam->side < 2 ? along : across};
  return true;
}
