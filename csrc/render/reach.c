/* Projecting boxes. */
#include "render/reach.h"

#include <string.h>

#include "base/memory.h"

/* A rectangle of pixels, inclusive. */
typedef struct extent {
  double x0, y0, x1, y1;
} extent;

/* Rays leave through any place of a pixel, and boxes are projected through float transforms. */
static const double MARGIN_PX = 0.75;

/* Corners of a box as the middle of the lens sees them, or as four points about it do whose square
 * holds the lens: by a point o, a point p looks as p - o (1 - depth / F) does by the middle. */
enum { BOX_POINTS = 32 };

static pl_vec3 by_lens(const pl_camera *camera, int point, pl_vec3 p) {
  const double shift = 0.5 * camera->aperture_m * (1.0 - p.z * camera->focus_per_m);
  return (pl_vec3){p.x + (point & 8 ? shift : -shift), p.y + (point & 16 ? shift : -shift), p.z};
}

static pl_vec3 view_of_object(const pl_shot_object *object, pl_vec3 p) {
  const pl_vec3 local = pl_vec3_scale(pl_vec3_sub(p, object->object->offset), object->scale);
  return pl_vec3_add(object->position, pl_mat3_mul_vec(object->rotation, local));
}

static pl_vec3 view_of_piece(const pl_shot_piece *piece, pl_vec3 p) {
  return pl_vec3_add(piece->origin, pl_mat3_mul_vec(piece->linear, p));
}

/* The rectangle that a box projects into; false if part of it is beside or behind a pinhole camera,
 * where projection has no bounds. */
static bool project_box(const pl_snapshot *shot, const pl_shot_object *object,
                        const pl_shot_piece *piece, const pl_box *box, extent *out) {
  const pl_camera *camera = &shot->camera;
  pl_vec3 corners[BOX_POINTS];
  const bool focuses = camera->aperture_m > 0.0;
  const int count = focuses ? BOX_POINTS : 8;
  *out = (extent){INFINITY, INFINITY, -INFINITY, -INFINITY};
  for (int corner = 0; corner < count; corner++) {
    const pl_vec3 p = {corner & 1 ? box->high[0] : box->low[0],
                       corner & 2 ? box->high[1] : box->low[1],
                       corner & 4 ? box->high[2] : box->low[2]};
    const pl_vec3 view = piece != NULL ? view_of_piece(piece, p) : view_of_object(object, p);
    corners[corner] = pl_mat3_mul_vec_t(shot->camera_to_root, view);
    if (focuses)
      corners[corner] = by_lens(camera, corner, corners[corner]);
  }
  if (camera->lens.model != NULL) {
    double rect[4];
    pl_camera_bound(camera, corners, (size_t)count, rect);
    *out = (extent){rect[0], rect[1], rect[2], rect[3]};
    return true;
  }
  for (int k = 0; k < count; k++) {
    const pl_vec3 c = corners[k];
    double pixel[2];
    if (!(c.z > 1e-3 * pl_vec3_norm(c)) || !pl_camera_project(camera, c, pixel))
      return false;
    out->x0 = fmin(out->x0, pixel[0]);
    out->y0 = fmin(out->y0, pixel[1]);
    out->x1 = fmax(out->x1, pixel[0]);
    out->y1 = fmax(out->y1, pixel[1]);
  }
  return true;
}

/* Block of a pixel coordinate, kept within [0, count - 1]. */
static int block_of(double pixel, int count) {
  const double block = floor(pixel / PL_REACH_BLOCK);
  return block < 0.0 ? 0 : block > count - 1 ? count - 1 : (int)block;
}

static void mark(pl_reach *reach, const pl_snapshot *shot, const extent *e) {
  if (e->x0 > e->x1 || e->x1 + MARGIN_PX < 0.0 || e->y1 + MARGIN_PX < 0.0 ||
      e->x0 - MARGIN_PX > shot->camera.width - 1 || e->y0 - MARGIN_PX > shot->camera.height - 1)
    return;
  const int x0 = block_of(e->x0 - MARGIN_PX, reach->columns);
  const int x1 = block_of(e->x1 + MARGIN_PX, reach->columns);
  const int y0 = block_of(e->y0 - MARGIN_PX, reach->rows);
  const int y1 = block_of(e->y1 + MARGIN_PX, reach->rows);
  for (int y = y0; y <= y1; y++)
    memset(reach->blocks + (size_t)y * (size_t)reach->columns + x0, 1, (size_t)(x1 - x0 + 1));
}

/* `piece`: whose cover it is, or NULL of an object that has none. */
static void mark_cover(pl_reach *reach, const pl_snapshot *shot, const pl_shot_object *object,
                       const pl_shot_piece *piece, const pl_cover *cover) {
  const extent everything = {0.0, 0.0, shot->camera.width, shot->camera.height};
  for (size_t i = 0; i < cover->count; i++) {
    extent e;
    const bool bounded = project_box(shot, object, piece, &cover->boxes[i], &e);
    mark(reach, shot, bounded ? &e : &everything);
  }
}

static void mark_object(pl_reach *reach, const pl_snapshot *shot, const pl_shot_object *object) {
  if (object->pieces == NULL)
    mark_cover(reach, shot, object, NULL, &object->object->cover);
  for (size_t k = 0; k < object->piece_count; k++)
    if (object->pieces[k].present)
      mark_cover(reach, shot, object, &object->pieces[k], object->pieces[k].cover);
}

pl_status pl_reach_update(pl_reach *reach, const pl_snapshot *shot) {
  reach->columns = (shot->camera.width + PL_REACH_BLOCK - 1) / PL_REACH_BLOCK;
  reach->rows = (shot->camera.height + PL_REACH_BLOCK - 1) / PL_REACH_BLOCK;
  const size_t bytes = (size_t)reach->columns * (size_t)reach->rows;
  if (bytes > reach->room) {
    uint8_t *grown = pl_realloc(reach->blocks, bytes, 1);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for %zu blocks of pixels", bytes);
    reach->blocks = grown;
    reach->room = bytes;
  }
  memset(reach->blocks, 0, bytes);
  for (size_t i = 0; i < shot->object_count; i++)
    if (shot->objects[i].in_frame)
      mark_object(reach, shot, &shot->objects[i]);
  return PL_OK;
}

void pl_reach_clear(pl_reach *reach) {
  pl_free(reach->blocks);
  *reach = (pl_reach){0};
}

bool pl_reach_pixel(const pl_reach *reach, int x, int y) {
  return reach->blocks[(size_t)(y / PL_REACH_BLOCK) * (size_t)reach->columns +
                       (size_t)(x / PL_REACH_BLOCK)] != 0;
}
