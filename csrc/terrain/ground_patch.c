/* Bicubic patches of cells, and where rays meet them. */
#include "terrain/ground_patch.h"

enum { SIDE = PL_GROUND_TILE_SIDE, POSTS = PL_GROUND_TILE_POSTS, CELLS = PL_GROUND_TILE_CELLS };

static pl_vec3 post_of(const pl_ground_tile *tile, int column, int row) {
  const float *p = tile->positions[(row + 1) * SIDE + column + 1];
  return pl_vec3_add(tile->origin, (pl_vec3){p[0], p[1], p[2]});
}

/* Change of the distance from the centre along an edge of a cell, by the slope at a post. */
static double change_m(const double slope[2], const pl_vec3 axes[2], pl_vec3 edge) {
  return slope[0] * pl_vec3_dot(edge, axes[0]) + slope[1] * pl_vec3_dot(edge, axes[1]);
}

/* Axes of slopes turn from post to post: not in cells below this part of the radius. */
static const double TURNS = 1e-4;

static void set_corners(pl_ground_patch *out) {
  const pl_ground_tile *tile = out->tile;
  const int column = out->column, row = out->row;
  pl_vec3 posts[2][2], axes[2];
  for (int k = 0; k < 4; k++)
    posts[k >> 1][k & 1] = post_of(tile, column + (k & 1), row + (k >> 1));
  for (int j = 0; j < 2; j++)
    for (int i = 0; i < 2; i++) {
      const int16_t *stored = tile->slopes[(row + j) * POSTS + column + i];
      const double unit = (double)tile->slope_unit;
      const double slope[2] = {unit * stored[0], unit * stored[1]};
      out->radius_m[j][i] = pl_vec3_norm(posts[j][i]);
      if (i + j == 0 || out->cell_m > TURNS * out->radius_m[0][0])
        pl_ground_tile_axes(tile->id.face, pl_vec3_scale(posts[j][i], 1.0 / out->radius_m[j][i]),
                            &axes[0], &axes[1]);
      out->along_m[j][i][0] = change_m(slope, axes, pl_vec3_sub(posts[j][1], posts[j][0]));
      out->along_m[j][i][1] = change_m(slope, axes, pl_vec3_sub(posts[1][i], posts[0][i]));
    }
  const pl_vec3 area = pl_vec3_cross(out->edge1, out->edge2);
  const double whole = pl_vec3_dot(area, area);
  out->across[0] = pl_vec3_scale(pl_vec3_cross(out->edge2, area), 1.0 / whole);
  out->across[1] = pl_vec3_scale(pl_vec3_cross(area, out->edge1), 1.0 / whole);
}

void pl_ground_patch_at(const pl_height_field *field, uint32_t tile, float u, float v,
                        pl_ground_patch *out) {
  const pl_height_field_cell at = pl_height_field_locate(u, v);
  pl_vec3 corners[3];
  double weights[3];
  pl_height_field_corners(field, tile, u, v, corners, weights);
  out->origin = field->origin;
  out->corner = corners[0];
  out->edge1 = pl_vec3_sub(corners[1], corners[0]);
  out->edge2 = pl_vec3_sub(corners[2], corners[0]);
  out->normal = pl_vec3_unit(pl_vec3_cross(out->edge1, out->edge2));
  out->cell_m = fmax(pl_vec3_norm(out->edge1), pl_vec3_norm(out->edge2));
  out->upper = at.x + at.y > 1.0;
  out->tile = field->tiles[tile];
  out->column = at.column;
  out->row = at.row;
}

/* Cubic Hermite weights of the values and the slopes at 0 and 1. */
static void weights_at(double x, double value[2], double slope[2]) {
  value[1] = x * x * (3.0 - 2.0 * x);
  value[0] = 1.0 - value[1];
  slope[0] = x * (1.0 - x) * (1.0 - x);
  slope[1] = x * x * (x - 1.0);
}

/* The patch's distance from the centre at a place of the cell, m. */
static double radius_at(const pl_ground_patch *patch, double x, double y) {
  double vx[2], sx[2], vy[2], sy[2], sum = 0.0;
  const double base_m = patch->radius_m[0][0];
  weights_at(x, vx, sx);
  weights_at(y, vy, sy);
  for (int j = 0; j < 2; j++)
    for (int i = 0; i < 2; i++)
      sum += vx[i] * vy[j] * (patch->radius_m[j][i] - base_m) +
             sx[i] * vy[j] * patch->along_m[j][i][0] + vx[i] * sy[j] * patch->along_m[j][i][1];
  return base_m + sum;
}

/* Height of a point, relative to the field's origin, over the patch, along the radius; m. False
 * where it is more than this part of a cell beside the cell. */
static bool above(const pl_ground_patch *patch, pl_vec3 point, double *height_m) {
  static const double BESIDE = 0x1p-10;
  const pl_vec3 from_center = pl_vec3_add(patch->origin, point);
  const double away_m = pl_vec3_norm(from_center);
  const pl_vec3 up = pl_vec3_scale(from_center, 1.0 / away_m);
  const pl_vec3 off = pl_vec3_sub(point, patch->corner);
  const double above_plane = pl_vec3_dot(off, patch->normal) / pl_vec3_dot(up, patch->normal);
  const pl_vec3 on = pl_vec3_madd(off, -above_plane, up);
  double x = pl_vec3_dot(on, patch->across[0]), y = pl_vec3_dot(on, patch->across[1]);
  if (patch->upper) {
    x = 1.0 - x;
    y = 1.0 - y;
  }
  if (!(fabs(x - 0.5) <= 0.5 + BESIDE && fabs(y - 0.5) <= 0.5 + BESIDE))
    return false;
  *height_m = away_m - radius_at(patch, x, y);
  return true;
}

/* By secants: the first has the triangle's slope. */
double pl_ground_patch_meet(pl_ground_patch *patch, pl_vec3 from, pl_vec3 along, double t) {
  enum { STEPS = 8 };
  static const double CLOSE = 0x1p-17; /* of a cell: posts are rounded to that */
  const pl_vec3 up = pl_vec3_unit(pl_vec3_add(patch->origin, patch->corner));
  double at[2] = {t, t}, height_m[2];
  double fall = pl_vec3_dot(along, patch->normal) / pl_vec3_dot(up, patch->normal);
  if (patch->column < 0 || patch->row < 0 || patch->column >= CELLS || patch->row >= CELLS)
    return t;
  set_corners(patch);
  if (!above(patch, pl_vec3_madd(from, t, along), &height_m[1]))
    return t;
  for (int k = 0; k < STEPS; k++) {
    if (fabs(height_m[1]) <= CLOSE * patch->cell_m)
      return at[1];
    at[0] = at[1];
    height_m[0] = height_m[1];
    at[1] = at[0] - height_m[0] / fall;
    if (!(fabs(at[1] - t) <= patch->cell_m) ||
        !above(patch, pl_vec3_madd(from, at[1], along), &height_m[1]))
      return t;
    fall = (height_m[1] - height_m[0]) / (at[1] - at[0]);
  }
  return t;
}
