/* Places, points and normals of hits on the ground. */
#include "terrain/height_field.h"

enum { SIDE = PL_GROUND_TILE_SIDE, POSTS = PL_GROUND_TILE_POSTS, CELLS = PL_GROUND_TILE_CELLS };

static int cell_of(double along) {
  const int cell = (int)floor(along);
  return cell < 0 ? 0 : cell > SIDE - 2 ? SIDE - 2 : cell;
}

pl_height_field_cell pl_height_field_locate(float u, float v) {
  const double along = (double)u * (SIDE - 1), up = (double)v * (SIDE - 1);
  const int column = cell_of(along), row = cell_of(up);
  return (pl_height_field_cell){column - 1, row - 1, along - column, up - row};
}

/* Embree splits the quad of a cell along the diagonal between its second and its last post, counted
 * around it, and turns u and v of the upper triangle by half a turn. */
void pl_height_field_corners(const pl_height_field *field, uint32_t tile, float u, float v,
                             pl_vec3 out[3], double weights[3]) {
  const pl_height_field_cell at = pl_height_field_locate(u, v);
  const pl_ground_tile *of = field->tiles[tile];
  const int low = (at.row + 1) * SIDE + at.column + 1, high = low + SIDE;
  const bool upper = at.x + at.y > 1.0;
  const int posts[3] = {upper ? high + 1 : low, upper ? high : low + 1, upper ? low + 1 : high};
  const pl_vec3 from = pl_vec3_sub(of->origin, field->origin);
  for (int k = 0; k < 3; k++) {
    const float *p = of->positions[posts[k]];
    out[k] = pl_vec3_add(from, (pl_vec3){p[0], p[1], p[2]});
  }
  weights[1] = upper ? 1.0 - at.x : at.x;
  weights[2] = upper ? 1.0 - at.y : at.y;
  weights[0] = 1.0 - weights[1] - weights[2];
}

pl_vec3 pl_height_field_point(const pl_height_field *field, uint32_t tile, float u, float v) {
  pl_vec3 corners[3], out = field->origin;
  double weights[3];
  pl_height_field_corners(field, tile, u, v, corners, weights);
  for (int k = 0; k < 3; k++)
    out = pl_vec3_madd(out, weights[k], corners[k]);
  return out;
}

/* Cell and place in it, moved from the skirt to the edge. */
static int to_edge(int cell, double *in) {
  if (cell >= 0 && cell < CELLS)
    return cell;
  *in = cell < 0 ? 0.0 : 1.0;
  return cell < 0 ? 0 : CELLS - 1;
}

pl_vec3 pl_height_field_normal(const pl_height_field *field, uint32_t tile, float u, float v) {
  pl_height_field_cell at = pl_height_field_locate(u, v);
  const int column = to_edge(at.column, &at.x), row = to_edge(at.row, &at.y);
  const pl_ground_tile *of = field->tiles[tile];
  const int16_t(*low)[2] = &of->slopes[row * POSTS + column], (*high)[2] = low + POSTS;
  const pl_vec3 up = pl_vec3_unit(pl_height_field_point(field, tile, u, v));
  pl_vec3 axis[2], normal = up;
  pl_ground_tile_axes(of->id.face, up, &axis[0], &axis[1]);
  for (int a = 0; a < 2; a++) {
    const double south = low[0][a] * (1.0 - at.x) + low[1][a] * at.x;
    const double north = high[0][a] * (1.0 - at.x) + high[1][a] * at.x;
    const double slope = (south * (1.0 - at.y) + north * at.y) * (double)of->slope_unit;
    normal = pl_vec3_madd(normal, -slope, axis[a]);
  }
  return pl_vec3_unit(normal);
}

float pl_height_field_rays(const pl_height_field *field, uint32_t tile, float u, float v) {
  const struct pl_ground_rays *rays = field->tiles[tile]->rays;
  if (rays == NULL)
    return 0.0f;
  pl_height_field_cell at = pl_height_field_locate(u, v);
  const int column = to_edge(at.column, &at.x), row = to_edge(at.row, &at.y);
  const int16_t *low = &rays->posts[row * POSTS + column], *high = low + POSTS;
  const double south = low[0] + at.x * (low[1] - low[0]),
               north = high[0] + at.x * (high[1] - high[0]);
  return PL_GROUND_RAYS_UNIT * (float)(south + at.y * (north - south));
}

pl_rock_hit pl_height_field_rock(const pl_height_field *field, uint32_t triangle) {
  size_t low = 0, high = field->count;
  while (high - low > 1) {
    const size_t middle = (low + high) / 2;
    if (field->first_rocks[middle] <= triangle)
      low = middle;
    else
      high = middle;
  }
  const pl_ground_tile *tile = field->tiles[low];
  const uint32_t own = triangle - field->first_rocks[low];
  const size_t rock = pl_ground_rocks_of(tile->rocks, own);
  return (pl_rock_hit){tile, own - tile->rocks->first[rock], &tile->rocks->rocks[rock]};
}

static pl_vec3 of_floats(const float p[3]) {
  return (pl_vec3){(double)p[0], (double)p[1], (double)p[2]};
}

void pl_rock_hit_corners(const pl_height_field *field, const pl_rock_hit *hit, pl_vec3 out[3]) {
  const pl_rock_mesh *mesh = hit->rock->mesh;
  const pl_vec3 from = pl_vec3_sub(hit->rock->rock.center, field->origin);
  for (int c = 0; c < 3; c++) {
    const float *p = mesh->positions[mesh->triangles[hit->triangle][c]];
    out[c] = pl_vec3_add(from, pl_ground_rock_out(hit->rock, of_floats(p)));
  }
}

pl_vec3 pl_rock_hit_normal(const pl_rock_hit *hit, const float weights[3]) {
  const pl_rock_mesh *mesh = hit->rock->mesh;
  pl_vec3 sum = {0.0, 0.0, 0.0};
  for (int c = 0; c < 3; c++) {
    const float *n = mesh->normals[mesh->triangles[hit->triangle][c]];
    sum = pl_vec3_madd(sum, (double)weights[c],
                       pl_vec3_unit(pl_ground_rock_normal(hit->rock, of_floats(n))));
  }
  return pl_vec3_unit(sum);
}
