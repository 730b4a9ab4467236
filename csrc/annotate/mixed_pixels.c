#include "annotate/mixed_pixels.h"

#include <math.h>
#include <string.h>

/* Sides of the blocks that are tested in turn, pixels: a tile, a block in it, a pixel. With a lens
 * that bends rays, the cone of a single pixel costs more than its rays. */
static const int SIDES[] = {PL_TILE_SIDE, 8, 1};
enum { LEVELS = sizeof SIDES / sizeof SIDES[0], LEVELS_BENT = LEVELS - 1 };

/* Rays leave through any point of a pixel, and slightly beyond: pl_image_sample_offset reaches
 * 0.542 with three samples. */
static const double REACH_PX = 0.55;
/* Margin for rounding of the angles of a limb: a thousandth of a pixel of 1e-3 rad, and a hundred
 * times what rounding takes 1 mm above a planet. */
static const double ROUNDING_RAD = 1e-9;
/* Relative, of distances. */
static const double ROUNDING = 1e-12;

/* Bodies that a block may see; a tile with more is mixed as a whole. */
enum { NEAR_MOST = 8 };
typedef struct nearby {
  size_t count;
  uint32_t bodies[NEAR_MOST];
} nearby;

typedef struct search {
  const pl_snapshot *shot;
  const pl_coverage *coverage;
  pl_tile tile;
  int levels;
  bool *mixed;
} search;

/* A cone of rays about a unit axis, root axes. */
typedef struct cone {
  pl_vec3 axis;
  double half_angle_rad;
} cone;

typedef enum sight { MISSED, MET, MAYBE } sight;

/* How the rays of a cone meet an ellipsoid. Where it is the unit sphere, a ray of the cone is the
 * axis plus at most tan(half angle) in root axes, which are at most that over the least radius; the
 * limb is a cone, too. */
static sight look_at(const pl_shot_body *body, const cone *cone) {
  const pl_vec3 r = body->state->radii_m, from = body->camera_unit;
  const double away = pl_vec3_norm(from);
  const pl_vec3 along = pl_mat3_mul_vec(body->to_unit, cone->axis);
  const double spread =
      tan(cone->half_angle_rad) / (fmin(r.x, fmin(r.y, r.z)) * pl_vec3_norm(along));
  if (!(away > 1.0) || !(cone->half_angle_rad < 1.0) || !(spread < 1.0))
    return MAYBE;
  const double limb = asin(1.0 / away), room = asin(spread) + ROUNDING_RAD;
  const double aside = atan2(pl_vec3_norm(pl_vec3_cross(along, from)), -pl_vec3_dot(along, from));
  if (aside > limb + room)
    return MISSED;
  return aside < limb - room ? MET : MAYBE;
}

/* Whether the lens has a ray through each corner of a rectangle: fields of lenses are convex. */
static bool has_rays(const pl_snapshot *shot, const double rect[4]) {
  if (shot->rays.camera.lens.model == NULL)
    return true;
  for (int k = 0; k < 4; k++) {
    const pl_vec3 ray = pl_snapshot_ray(shot, rect[k & 1 ? 2 : 0], rect[k & 2 ? 3 : 1]);
    if (!(pl_vec3_dot(ray, ray) > 0.0))
      return false;
  }
  return true;
}

static double nearest_m(const pl_shot_body *body) {
  return pl_vec3_norm(body->center) - body->radius_m;
}

static double farthest_m(const pl_shot_body *body) {
  return pl_vec3_norm(body->center) + body->radius_m;
}

/* Leaves out the bodies that `before` hides, which all rays of the block meet; NULL: none does. */
static sight leave_out_hidden(const pl_snapshot *shot, const pl_shot_body *before,
                              const sight *sights, nearby *seen) {
  size_t kept = 0;
  sight all = MISSED;
  for (size_t i = 0; i < seen->count; i++) {
    const pl_shot_body *body = &shot->bodies[seen->bodies[i]];
    if (before != NULL && nearest_m(body) > farthest_m(before) * (1.0 + ROUNDING))
      continue;
    all = kept == 0 ? sights[i] : MAYBE; /* of two, one may hide the other in part */
    seen->bodies[kept++] = seen->bodies[i];
  }
  seen->count = kept;
  return all;
}

/* How a block sees the bodies `from`; those that it may see are written to `seen`. */
static sight look(const search *s, const int block[4], const nearby *from, nearby *seen) {
  const double rect[4] = {block[0] - REACH_PX, block[1] - REACH_PX,
                          block[0] + block[2] - 1 + REACH_PX, block[1] + block[3] - 1 + REACH_PX};
  const pl_shot_body *before = NULL;
  sight sights[NEAR_MOST];
  cone cone;
  *seen = *from;
  if (!has_rays(s->shot, rect))
    return MAYBE;
  seen->count = 0;
  pl_snapshot_cone(s->shot, rect, &cone.axis, &cone.half_angle_rad);
  for (size_t i = 0; i < from->count; i++) {
    const pl_shot_body *body = &s->shot->bodies[from->bodies[i]];
    const sight sight = look_at(body, &cone);
    if (sight == MISSED)
      continue;
    if (sight == MET && (before == NULL || farthest_m(body) < farthest_m(before)))
      before = body;
    sights[seen->count] = sight;
    seen->bodies[seen->count++] = from->bodies[i];
  }
  return leave_out_hidden(s->shot, before, sights, seen);
}

static void set(const search *s, const int block[4], bool mixed) {
  for (int y = block[1]; y < block[1] + block[3]; y++)
    memset(s->mixed + (y - s->tile.y0) * PL_TILE_SIDE + (block[0] - s->tile.x0), mixed,
           (size_t)block[2]);
}

/* Whether the mask leaves a pixel of a block to bodies alone. */
static bool has_clear(const search *s, const int block[4]) {
  for (int y = block[1]; y < block[1] + block[3]; y++)
    for (int x = block[0]; x < block[0] + block[2]; x++)
      if (!pl_coverage_pixel(s->coverage, x, y))
        return true;
  return false;
}

static void divide(const search *s, const int block[4], int level, const nearby *from) {
  nearby seen;
  const sight sight = has_clear(s, block) ? look(s, block, from, &seen) : MISSED;
  if (sight != MAYBE || level + 1 == s->levels) {
    set(s, block, sight == MAYBE);
    return;
  }
  const int side = SIDES[level + 1];
  for (int y = 0; y < block[3]; y += side)
    for (int x = 0; x < block[2]; x += side) {
      const int w = block[2] - x < side ? block[2] - x : side;
      const int h = block[3] - y < side ? block[3] - y : side;
      divide(s, (int[4]){block[0] + x, block[1] + y, w, h}, level + 1, &seen);
    }
}

/* Lists the ellipsoids that a tile may see; false if there are too many. */
static bool list_bodies(const pl_snapshot *shot, pl_tile tile, nearby *out) {
  const double rect[4] = {tile.x0 - REACH_PX, tile.y0 - REACH_PX,
                          tile.x0 + tile.width - 1 + REACH_PX,
                          tile.y0 + tile.height - 1 + REACH_PX};
  const bool cut = !has_rays(shot, rect); /* no cone has all its rays */
  cone cone;
  out->count = 0;
  pl_snapshot_cone(shot, rect, &cone.axis, &cone.half_angle_rad);
  for (size_t i = 0; i < shot->body_count; i++) {
    const pl_shot_body *body = &shot->bodies[i];
    if (!pl_shot_is_smooth(body) || (!cut && look_at(body, &cone) == MISSED))
      continue;
    if (out->count == NEAR_MOST)
      return false;
    out->bodies[out->count++] = (uint32_t)i;
  }
  return true;
}

void pl_mixed_pixels_find(const pl_snapshot *shot, const pl_coverage *coverage, pl_tile tile,
                          bool mixed[PL_TILE_PIXELS]) {
  const search s = {shot, coverage, tile,
                    shot->rays.camera.lens.model != NULL ? LEVELS_BENT : LEVELS, mixed};
  const int whole[4] = {tile.x0, tile.y0, tile.width, tile.height};
  nearby near;
  if (list_bodies(shot, tile, &near))
    divide(&s, whole, 0, &near);
  else
    set(&s, whole, true);
  for (int y = 0; y < tile.height; y++)
    for (int x = 0; x < tile.width; x++)
      mixed[y * PL_TILE_SIDE + x] |= pl_coverage_pixel(coverage, tile.x0 + x, tile.y0 + y);
}
