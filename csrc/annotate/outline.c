/* Projection of bounding boxes, and tests of which objects can occlude which. */
#include "annotate/outline.h"

#include "annotate/hiders.h"

/* Step in pixels of the search that bounds boxes which cross the camera plane. */
enum { STEP = 16 };

static const pl_rect nowhere = {0, 0, -1, -1};

/* Margin for rounding differences between a box projected in double and a mesh traced in float: one
 * pixel, plus the error of the ray directions of a long lens. */
static double margin_px(const pl_camera *camera) {
  return 1.0 + 1e-14 * fmax(camera->fx, camera->fy);
}

/* A nan value (model without extent) gives `low`. */
static int to_pixel(double value, int low, int high) {
  return !(value > low) ? low : value >= high ? high : (int)value;
}

static void set_corners(const pl_outline *outline, const float *low, const float *high,
                        pl_vec3 corners[8]) {
  pl_vec3 sides[3];
  corners[0] = outline->origin;
  for (int k = 0; k < 3; k++) {
    corners[0] = pl_vec3_madd(corners[0], low[k], outline->axes[k]);
    sides[k] = pl_vec3_scale(outline->axes[k], (double)high[k] - (double)low[k]);
  }
  for (int k = 0, count = 1; k < 3; k++, count *= 2)
    for (int i = 0; i < count; i++)
      corners[count + i] = pl_vec3_add(corners[i], sides[k]);
}

/* Precondition: all corners lie in front of the camera. */
static pl_rect rect_before(const pl_camera *camera, const pl_vec3 corners[8]) {
  const int w = camera->width, h = camera->height;
  const double margin = margin_px(camera);
  double u0 = INFINITY, v0 = INFINITY, u1 = -INFINITY, v1 = -INFINITY;
  for (int k = 0; k < 8; k++) {
    const pl_vec3 p = corners[k];
    const double scale = 1.0 / p.z;
    const double u = (camera->fx * p.x + camera->skew * p.y) * scale + camera->cx;
    const double v = camera->fy * p.y * scale + camera->cy;
    u0 = u < u0 ? u : u0;
    u1 = u > u1 ? u : u1;
    v0 = v < v0 ? v : v0;
    v1 = v > v1 ? v : v1;
  }
  return (pl_rect){to_pixel(floor(u0 - margin), -w, 2 * w), to_pixel(floor(v0 - margin), -h, 2 * h),
                   to_pixel(ceil(u1 + margin), -w - 1, 2 * w - 1),
                   to_pixel(ceil(v1 + margin), -h - 1, 2 * h - 1)};
}

/* Returns true if every corner has a x + b y + c z > 0, i.e. lies on one side of this plane through
 * the camera. */
static bool parts(const pl_vec3 corners[8], double a, double b, double c) {
  for (int k = 0; k < 8; k++)
    if (!(a * corners[k].x + b * corners[k].y + c * corners[k].z > 0.0))
      return false;
  return true;
}

/* Finds the steps of [-size, 2 size) whose rays can meet the box: neither of the two bounding
 * planes of a step separates it from the corners. The planes are a x + b y + (center - pixel) z =
 * 0. */
static void narrow(const pl_vec3 corners[8], double a, double b, double center, double margin,
                   int size, int *from, int *to) {
  *from = 2 * size;
  *to = -size - 1;
  for (int p = -size; p < 2 * size; p += STEP) {
    const double low = p - margin, high = p + STEP - 1 + margin;
    if (parts(corners, -a, -b, low - center) || parts(corners, a, b, center - high))
      continue;
    *from = p < *from ? p : *from;
    *to = p + STEP - 1;
  }
  *to = *to < 2 * size - 1 ? *to : 2 * size - 1;
}

/* For corners in front of and behind the camera: they cannot be projected, but separating planes
 * through the camera still bound the rectangle. */
static pl_rect rect_around(const pl_camera *camera, const pl_vec3 corners[8]) {
  const double margin = margin_px(camera);
  pl_rect rect;
  narrow(corners, camera->fx, camera->skew, camera->cx, margin, camera->width, &rect.x0, &rect.x1);
  narrow(corners, 0.0, camera->fy, camera->cy, margin, camera->height, &rect.y0, &rect.y1);
  return rect;
}

static pl_rect rect_bent(const pl_camera *camera, const pl_vec3 corners[8]) {
  const int w = camera->width, h = camera->height;
  const double margin = margin_px(camera);
  double r[4];
  pl_camera_bound(camera, corners, 8, r);
  return (pl_rect){to_pixel(floor(r[0] - margin), -w, 2 * w),
                   to_pixel(floor(r[1] - margin), -h, 2 * h),
                   to_pixel(ceil(r[2] + margin), -w - 1, 2 * w - 1),
                   to_pixel(ceil(r[3] + margin), -h - 1, 2 * h - 1)};
}

pl_rect pl_outline_project(const pl_outline *outline, const pl_camera *camera, const float *low,
                           const float *high) {
  pl_vec3 corners[8];
  int before = 0;
  set_corners(outline, low, high, corners);
  for (int k = 0; k < 8; k++)
    before += corners[k].z > 0.0;
  const bool bent = camera->lens.model != NULL;
  const pl_rect rect = bent          ? rect_bent(camera, corners)
                       : before == 0 ? nowhere
                       : before == 8 ? rect_before(camera, corners)
                                     : rect_around(camera, corners);
  return rect.x0 > rect.x1 || rect.y0 > rect.y1 ? nowhere : rect;
}

bool pl_outline_before(const pl_outline *outline, const float *low, const float *high) {
  double z = outline->origin.z;
  for (int k = 0; k < 3; k++)
    z += fmin(low[k] * outline->axes[k].z, high[k] * outline->axes[k].z);
  return z > 0.0;
}

static void set_piece_axes(const pl_snapshot *shot, const pl_shot_piece *piece, pl_outline *out) {
  const pl_mat3 m =
      pl_mat3_transpose(pl_mat3_mul(pl_mat3_transpose(shot->camera_to_root), piece->linear));
  for (int k = 0; k < 3; k++)
    out->axes[k] = m.row[k];
  out->origin = pl_mat3_mul_vec_t(shot->camera_to_root, piece->origin);
}

static void set_axes(const pl_snapshot *shot, const pl_shot_object *object, pl_outline *out) {
  const pl_mat3 m = pl_mat3_mul(pl_mat3_transpose(shot->camera_to_root), object->rotation);
  const double s = object->scale;
  const pl_vec3 offset = object->object->offset;
  out->axes[0] = pl_vec3_make(s * m.row[0].x, s * m.row[1].x, s * m.row[2].x);
  out->axes[1] = pl_vec3_make(s * m.row[0].y, s * m.row[1].y, s * m.row[2].y);
  out->axes[2] = pl_vec3_make(s * m.row[0].z, s * m.row[1].z, s * m.row[2].z);
  out->origin = pl_mat3_mul_vec_t(shot->camera_to_root, object->position);
  out->origin = pl_vec3_madd(out->origin, -offset.x, out->axes[0]);
  out->origin = pl_vec3_madd(out->origin, -offset.y, out->axes[1]);
  out->origin = pl_vec3_madd(out->origin, -offset.z, out->axes[2]);
}

/* With a margin for the rounding of the mesh. */
static void set_depths(const float *low, const float *high, pl_outline *out) {
  pl_vec3 corners[8];
  set_corners(out, low, high, corners);
  out->z0_m = INFINITY;
  out->z1_m = -INFINITY;
  for (int k = 0; k < 8; k++) {
    out->z0_m = fmin(out->z0_m, corners[k].z);
    out->z1_m = fmax(out->z1_m, corners[k].z);
    out->far_m = fmax(out->far_m, pl_vec3_norm(corners[k]));
  }
  const double room = 1e-6 * out->far_m;
  out->z0_m -= room;
  out->z1_m += room;
  out->far_m += room;
}

static bool is_whole(pl_hiders *hiders, size_t index) {
  const pl_snapshot *shot = hiders->shot;
  const pl_rect r = hiders->outlines[index].rect;
  const bool inside =
      r.x0 >= 0 && r.y0 >= 0 && r.x1 < shot->rays.camera.width && r.y1 < shot->rays.camera.height;
  if (r.x0 > r.x1)
    return true;
  return inside && shot->objects[index].in_frame && !pl_hiders_any(hiders, index);
}

static pl_status find_whole(const pl_snapshot *shot, pl_arena *arena, pl_outline *outlines) {
  pl_hiders hiders;
  PL_TRY(pl_hiders_build(shot, outlines, arena, &hiders));
  for (size_t i = 0; i < shot->object_count; i++)
    outlines[i].whole = is_whole(&hiders, i);
  return PL_OK;
}

static void widen(pl_rect *all, pl_rect r) {
  if (r.x0 > r.x1)
    return;
  const bool first = all->x0 > all->x1;
  all->x0 = first || r.x0 < all->x0 ? r.x0 : all->x0;
  all->y0 = first || r.y0 < all->y0 ? r.y0 : all->y0;
  all->x1 = first || r.x1 > all->x1 ? r.x1 : all->x1;
  all->y1 = first || r.y1 > all->y1 ? r.y1 : all->y1;
}

/* Replaces the rectangle of the bounding box by the smaller one of all clusters. */
static pl_status refine(const pl_camera *camera, pl_cluster_cache *cache, pl_outline *out) {
  PL_TRY(pl_cluster_cache_get(cache, out->model, &out->clusters));
  pl_rect all = nowhere;
  for (size_t i = 0; i < out->clusters.count; i++) {
    const pl_cluster *box = &out->clusters.boxes[i];
    widen(&all, pl_outline_project(out, camera, box->low, box->high));
  }
  out->rect = all;
  return PL_OK;
}

static pl_status refine_object(const pl_camera *camera, pl_cluster_cache *cache, pl_outline *out) {
  pl_rect all = nowhere;
  if (out->pieces == NULL)
    return refine(camera, cache, out);
  for (size_t k = 0; k < out->piece_count; k++) {
    PL_TRY(refine(camera, cache, &out->pieces[k]));
    widen(&all, out->pieces[k].rect);
  }
  out->rect = all;
  return PL_OK;
}

static void set_box(const pl_camera *camera, pl_outline *out) {
  const pl_model *model = out->model;
  set_depths(model->bounds_min, model->bounds_max, out);
  out->rect = pl_outline_project(out, camera, model->bounds_min, model->bounds_max);
}

/* Fills the outlines of the pieces of an articulated object that are present, and the outline that
 * encloses them. Returns their number. */
static size_t join_pieces(const pl_snapshot *shot, const pl_shot_object *object, pl_outline *pieces,
                          pl_outline *out) {
  out->pieces = pieces;
  out->rect = nowhere;
  out->z0_m = INFINITY;
  out->z1_m = -INFINITY;
  for (size_t k = 0; k < object->piece_count; k++) {
    pl_outline *piece = &pieces[out->piece_count];
    if (!object->pieces[k].present)
      continue;
    *piece = (pl_outline){.model = object->pieces[k].model};
    set_piece_axes(shot, &object->pieces[k], piece);
    set_box(&shot->rays.camera, piece);
    widen(&out->rect, piece->rect);
    out->z0_m = fmin(out->z0_m, piece->z0_m);
    out->z1_m = fmax(out->z1_m, piece->z1_m);
    out->far_m = fmax(out->far_m, piece->far_m);
    out->piece_count++;
  }
  return out->piece_count;
}

size_t pl_outline_count(const pl_snapshot *shot) {
  size_t count = shot->object_count;
  for (size_t i = 0; i < shot->object_count; i++)
    count += shot->objects[i].piece_count;
  return count;
}

/* Later objects are shapes of bodies; those without a label only occlude. */
static bool has_label(const pl_snapshot *shot, size_t index) {
  return index < shot->craft_count ||
         shot->bodies[shot->objects[index].object->body].body->obj_id != 0;
}

pl_outline pl_outline_of_body(const pl_snapshot *shot, const pl_shot_body *body) {
  static const float low[3] = {-1.0f, -1.0f, -1.0f}, high[3] = {1.0f, 1.0f, 1.0f};
  const pl_mat3 m = pl_mat3_mul(pl_mat3_transpose(shot->camera_to_root), body->rotation);
  const pl_vec3 r = body->state->radii_m;
  const double room_m = body->outer_m - body->radius_m; /* of terrain */
  const double size_m[3] = {r.x + room_m, r.y + room_m, r.z + room_m};
  pl_outline out = {.origin = pl_mat3_mul_vec_t(shot->camera_to_root, body->center)};
  for (int k = 0; k < 3; k++)
    out.axes[k] = pl_vec3_scale(pl_mat3_transpose(m).row[k], size_m[k]);
  set_depths(low, high, &out);
  out.rect = pl_outline_project(&out, &shot->rays.camera, low, high);
  return out;
}

pl_status pl_outline_build(const pl_snapshot *shot, pl_cluster_cache *cache, pl_arena *arena,
                           pl_outline *outlines) {
  const size_t count = shot->object_count;
  pl_outline *next = outlines + count;
  for (size_t i = 0; i < count; i++) {
    const pl_shot_object *object = &shot->objects[i];
    outlines[i] = (pl_outline){.model = object->object->model};
    if (object->pieces != NULL) {
      next += join_pieces(shot, object, next, &outlines[i]);
    } else {
      set_axes(shot, object, &outlines[i]);
      set_box(&shot->rays.camera, &outlines[i]);
    }
  }
  PL_TRY(find_whole(shot, arena, outlines));
  for (size_t i = 0; i < count; i++)
    if (!outlines[i].whole && has_label(shot, i))
      PL_TRY(refine_object(&shot->rays.camera, cache, &outlines[i]));
  return find_whole(shot, arena, outlines);
}
