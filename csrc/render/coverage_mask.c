/* Marks the pixels in which meshes may be visible, by projecting boxes and triangles. */
#include "render/coverage_mask.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "render/geometry.h"

/* In pixels, inclusive, with the origin at the centre of pixel (0, 0). */
typedef struct extent {
  double x0, y0, x1, y1;
} extent;
typedef struct area {
  int x0, y0, x1, y1;
} area;

/* Rays leave through any point of a pixel, and slightly beyond: pl_image_sample_offset reaches
 * 0.542 with three samples. */
static const double MARGIN_PX = 0.55;
/* Meshes are traced in single precision. Hits are off by less than ROUNDING times the lengths that
 * are summed in the model's frame (some sixteen roundings), and by less than ROUNDING_AWAY times
 * the distance to the model, which is handled in double precision. */
static const double ROUNDING = 1e-6, ROUNDING_AWAY = 1e-15;

/* Boxes that touch at most AREA_LEAST pixels are not subdivided. Nor are boxes of at most COARSE
 * triangles if triangles are not projected. */
enum { AREA_LEAST = 9, COARSE = 64 };
/* Minimum number of rays per pixel for which triangles are projected. A triangle costs about as
 * much as one ray in each of its pixels, so that frames of labels alone would not become faster. */
enum { CLOSE_RAYS = 2 };
/* Triangles that touch at most this many columns or rows of pixels mark their whole bounding
 * rectangle. */
enum { NARROW = 2 };
/* Margin for projections of corners: a point between the corners of a box may be nearer than all of
 * them. */
static const double CORNER_ROOM_PX = 0.2;
/* Up to ALONE boxes, starting threads does not pay. The boxes of each object are divided into
 * SLICES jobs, unless there are more than SLICED_MOST objects. */
enum { ALONE = 1024, SLICES = 32, SLICED_MOST = 64 };

/* A mesh in camera coordinates. Without lens distortion and aperture, a point p of the model
 * projects to (cx + u/w, cy + v/w) with (u, v, w) = linear p + origin, w in m. */
typedef struct placed {
  const pl_snapshot *shot;
  const pl_shot_object *object;
  const pl_shot_piece *piece; /* NULL for an object without pieces */
  const pl_cover *cover;
  pl_mat3 linear;
  pl_vec3 origin;
  double rounding_m; /* bound of the position error of hits */
  double rounding;   /* px m: divided by w and added to the margin */
  double rays;       /* per pixel */
} placed;

/* A box being traversed, and the pixels that its contents may mark. Marks are limited to these
 * pixels; otherwise they would depend on whether another thread had marked all of the box before it
 * was visited. */
typedef struct opened {
  area area;
  uint32_t after; /* as in pl_box */
} opened;

/* fmin and fmax are library calls. */
static double lesser(double a, double b) { return a < b ? a : b; }
static double greater(double a, double b) { return a > b ? a : b; }

/* Corners of a box as seen from the centre of the lens or, with an aperture, from the four corners
 * of a square that encloses it. From a point o of the lens, a point p appears where p - o (1 -
 * depth / F) appears from the centre. */
enum { BOX_POINTS = 32 };

static pl_vec3 by_lens(const pl_camera *camera, int point, pl_vec3 p) {
  const double shift = 0.5 * camera->aperture_m * (1.0 - p.z * camera->focus_per_m);
  return (pl_vec3){p.x + (point & 8 ? shift : -shift), p.y + (point & 16 ? shift : -shift), p.z};
}

static bool is_pinhole(const pl_camera *camera) {
  return camera->lens.model == NULL && !(camera->aperture_m > 0.0);
}

/* Transform from model units to metres in camera axes. */
static void view_of(const placed *at, pl_mat3 *linear, pl_vec3 *origin) {
  const pl_shot_object *object = at->object;
  pl_mat3 turn = object->rotation;
  pl_vec3 place =
      pl_vec3_sub(object->position,
                  pl_mat3_mul_vec(turn, pl_vec3_scale(object->object->offset, object->scale)));
  for (int i = 0; i < 3; i++)
    turn.row[i] = pl_vec3_scale(turn.row[i], object->scale);
  if (at->piece != NULL) {
    turn = at->piece->linear;
    place = at->piece->origin;
  }
  *linear = pl_mat3_mul(pl_mat3_transpose(at->shot->camera_to_root), turn);
  *origin = pl_mat3_mul_vec_t(at->shot->camera_to_root, place);
}

/* Bound of the position error of hits, m. */
static double rounding_of(const pl_mat3 *linear, pl_vec3 origin, const pl_box *whole) {
  const pl_mat3 columns = pl_mat3_transpose(*linear);
  double length = 0.0;
  for (int i = 0; i < 3; i++)
    length += pl_vec3_norm(columns.row[i]) *
              fmax(fabs((double)whole->low[i]), fabs((double)whole->high[i]));
  return ROUNDING * length + ROUNDING_AWAY * pl_vec3_norm(origin);
}

static placed place(const pl_snapshot *shot, const pl_shot_object *object,
                    const pl_shot_piece *piece, int rays) {
  const pl_camera *camera = &shot->rays.camera;
  placed at = {.shot = shot,
               .object = object,
               .piece = piece,
               .cover = piece != NULL ? piece->cover : object->object->cover,
               .rays = rays};
  pl_mat3 view;
  pl_vec3 origin;
  view_of(&at, &view, &origin);
  at.rounding_m = rounding_of(&view, origin, &at.cover->boxes[0]);
  at.rounding = 2.0 * at.rounding_m * (fmax(camera->fx, camera->fy) + fabs(camera->skew));
  const pl_vec3 x = pl_vec3_scale(view.row[0], camera->fx);
  at.linear.row[0] = pl_vec3_madd(x, camera->skew, view.row[1]);
  at.linear.row[1] = pl_vec3_scale(view.row[1], camera->fy);
  at.linear.row[2] = view.row[2];
  at.origin =
      (pl_vec3){camera->fx * origin.x + camera->skew * origin.y, camera->fy * origin.y, origin.z};
  return at;
}

/* Largest |row . p| over points p within `half` of the origin. */
static double reach_of(pl_vec3 row, pl_vec3 half) {
  return fabs(row.x) * half.x + fabs(row.y) * half.y + fabs(row.z) * half.z;
}

/* Extent in which a box may be visible through a pinhole, infinite if part of the box is beside or
 * behind the camera. If the centre is seen at (x, y), a point offset from it by (u, v, w) is
 * displaced in x by (u - x w) over its depth. */
static void project_box(const placed *at, const pl_box *box, extent *out) {
  const pl_vec3 low = {(double)box->low[0], (double)box->low[1], (double)box->low[2]};
  const pl_vec3 high = {(double)box->high[0], (double)box->high[1], (double)box->high[2]};
  const pl_vec3 half = pl_vec3_scale(pl_vec3_sub(high, low), 0.5);
  const pl_vec3 *rows = at->linear.row;
  const pl_vec3 c = pl_vec3_add(
      at->origin, pl_mat3_mul_vec(at->linear, pl_vec3_scale(pl_vec3_add(low, high), 0.5)));
  const double deep = reach_of(rows[2], half);
  const double near_m = c.z - deep;
  *out = (extent){1.0, 1.0, -1.0, -1.0};
  if (c.z + deep < -at->rounding_m)
    return; /* no ray leaves backwards */
  *out = (extent){-INFINITY, -INFINITY, INFINITY, INFINITY};
  if (!(near_m > 0.0))
    return;
  const double x = c.x / c.z, y = c.y / c.z, by = 1.0 / near_m;
  const double margin = MARGIN_PX + at->rounding * by;
  const double dx = reach_of(pl_vec3_madd(rows[0], -x, rows[2]), half) * by + margin;
  const double dy = reach_of(pl_vec3_madd(rows[1], -y, rows[2]), half) * by + margin;
  const pl_camera *camera = &at->shot->rays.camera;
  *out =
      (extent){camera->cx + x - dx, camera->cy + y - dy, camera->cx + x + dx, camera->cy + y + dy};
}

/* Computes the corners of a box in camera axes; returns their number. */
static size_t corners_of(const placed *at, const pl_box *box, pl_vec3 corners[BOX_POINTS]) {
  const pl_camera *camera = &at->shot->rays.camera;
  const size_t count = camera->aperture_m > 0.0 ? BOX_POINTS : 8;
  pl_mat3 linear;
  pl_vec3 origin;
  view_of(at, &linear, &origin);
  for (size_t i = 0; i < count; i++) {
    const pl_vec3 p = {(double)(i & 1 ? box->high[0] : box->low[0]),
                       (double)(i & 2 ? box->high[1] : box->low[1]),
                       (double)(i & 4 ? box->high[2] : box->low[2])};
    corners[i] = pl_vec3_add(origin, pl_mat3_mul_vec(linear, p));
    if (camera->aperture_m > 0.0)
      corners[i] = by_lens(camera, (int)i, corners[i]);
  }
  return count;
}

/* The same for a lens with distortion or an aperture, from the box's corners. */
static void project_corners(const placed *at, const pl_box *box, extent *out) {
  const pl_camera *camera = &at->shot->rays.camera;
  pl_vec3 corners[BOX_POINTS];
  const size_t count = corners_of(at, box, corners);
  double near_m = INFINITY, rect[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
  *out = (extent){-INFINITY, -INFINITY, INFINITY, INFINITY};
  for (size_t i = 0; i < count; i++) {
    double pixel[2];
    near_m = fmin(near_m, pl_vec3_norm(corners[i]));
    if (camera->lens.model != NULL)
      continue;
    if (!(corners[i].z > 1e-3 * pl_vec3_norm(corners[i])) ||
        !pl_camera_project(camera, corners[i], pixel))
      return;
    rect[0] = fmin(rect[0], pixel[0]);
    rect[1] = fmin(rect[1], pixel[1]);
    rect[2] = fmax(rect[2], pixel[0]);
    rect[3] = fmax(rect[3], pixel[1]);
  }
  if (camera->lens.model != NULL)
    pl_camera_bound(camera, corners, count, rect);
  const double margin = MARGIN_PX + CORNER_ROOM_PX + at->rounding / near_m;
  if (rect[0] > rect[2])
    *out = (extent){1.0, 1.0, -1.0, -1.0};
  else
    *out = (extent){rect[0] - margin, rect[1] - margin, rect[2] + margin, rect[3] + margin};
}

/* Intersects an area with an extent; false if that is empty. An extent of NaN counts as unbounded.
 */
static bool area_of(const area *in, const extent *e, area *out) {
  if (e->x0 > e->x1 || e->x1 < in->x0 || e->y1 < in->y0 || e->x0 > in->x1 || e->y0 > in->y1)
    return false;
  *out = (area){e->x0 > in->x0 ? (int)e->x0 : in->x0, e->y0 > in->y0 ? (int)e->y0 : in->y0,
                e->x1 < in->x1 ? (int)e->x1 : in->x1, e->y1 < in->y1 ? (int)e->y1 : in->y1};
  out->x0 += out->x0 < e->x0;
  out->y0 += out->y0 < e->y0;
  return out->x0 <= out->x1 && out->y0 <= out->y1;
}

static atomic_uchar *row_of(const pl_coverage *coverage, int y) {
  return coverage->pixels + (size_t)y * (size_t)coverage->width;
}

/* Relaxed stores suffice: no thread depends on the marks of another. */
static void mark_run(const pl_coverage *coverage, int y, int x0, int x1, pl_coverage_mark mark) {
  atomic_uchar *row = row_of(coverage, y);
  for (int x = x0; x <= x1; x++)
    atomic_store_explicit(&row[x], (unsigned char)mark, memory_order_relaxed);
}

static void mark_area(const pl_coverage *coverage, const area *a, pl_coverage_mark mark) {
  for (int y = a->y0; y <= a->y1; y++)
    mark_run(coverage, y, a->x0, a->x1, mark);
}

static bool is_marked(const pl_coverage *coverage, const area *a) {
  for (int y = a->y0; y <= a->y1; y++)
    for (int x = a->x0; x <= a->x1; x++)
      if (pl_coverage_of(coverage, x, y) != PL_COVERED_BY_MESH)
        return false;
  return true;
}

/* Widens a span by the part of an edge between two heights. `slope` is 0 for horizontal edges. */
static void span_edge(const double a[2], const double b[2], double slope, double low, double high,
                      double span[2]) {
  if ((a[1] < low && b[1] < low) || (a[1] > high && b[1] > high))
    return;
  const double from = a[0] + (lesser(greater(a[1], low), high) - a[1]) * slope;
  const double to = b[0] + (lesser(greater(b[1], low), high) - b[1]) * slope;
  span[0] = lesser(span[0], lesser(from, to));
  span[1] = greater(span[1], greater(from, to));
}

/* Marks, row by row, the pixels covered by the triangle dilated by a square of the margin. */
static void mark_rows(const pl_coverage *coverage, const double p[3][2], double margin,
                      const area *a) {
  double slope[3];
  for (int k = 0; k < 3; k++) {
    const double *from = p[k], *to = p[(k + 1) % 3];
    slope[k] = to[1] != from[1] ? (to[0] - from[0]) / (to[1] - from[1]) : 0.0;
  }
  for (int y = a->y0; y <= a->y1; y++) {
    double span[2] = {INFINITY, -INFINITY};
    for (int k = 0; k < 3; k++)
      span_edge(p[k], p[(k + 1) % 3], slope[k], y - margin, y + margin, span);
    const double x0 = span[0] - margin, x1 = span[1] + margin;
    if (x0 > a->x1 || x1 < a->x0)
      continue;
    const int first = x0 > a->x0 ? (int)x0 + (x0 > (int)x0) : a->x0;
    mark_run(coverage, y, first, x1 < a->x1 ? (int)x1 : a->x1, PL_COVERED_BY_MESH);
  }
}

/* Projects the corners of a triangle through a pinhole, x and y in pixels. Returns the inverse of
 * the smallest depth: 0 for a triangle behind the camera, infinity for one that is partly beside or
 * behind it. */
static double project_triangle(const placed *at, uint32_t triangle, double p[3][2]) {
  const pl_camera *camera = &at->shot->rays.camera;
  const uint32_t *corners = at->cover->model->indices + 3 * (size_t)triangle;
  double nearest = INFINITY, farthest = -INFINITY;
  for (int k = 0; k < 3; k++) {
    const float *v = at->cover->model->positions + 3 * (size_t)corners[k];
    const pl_vec3 point = {(double)v[0], (double)v[1], (double)v[2]};
    const pl_vec3 seen = pl_vec3_add(at->origin, pl_mat3_mul_vec(at->linear, point));
    const double by = 1.0 / seen.z;
    p[k][0] = camera->cx + seen.x * by;
    p[k][1] = camera->cy + seen.y * by;
    nearest = lesser(nearest, seen.z);
    farthest = greater(farthest, seen.z);
  }
  if (farthest < -at->rounding_m)
    return 0.0;
  return nearest > 0.0 ? 1.0 / nearest : INFINITY;
}

static void mark_triangle(const placed *at, const pl_coverage *coverage, uint32_t triangle,
                          const area *in) {
  double p[3][2];
  const double by = project_triangle(at, triangle, p), margin = MARGIN_PX + at->rounding * by;
  if (by == 0.0)
    return;
  const extent e = {lesser(p[0][0], lesser(p[1][0], p[2][0])) - margin,
                    lesser(p[0][1], lesser(p[1][1], p[2][1])) - margin,
                    greater(p[0][0], greater(p[1][0], p[2][0])) + margin,
                    greater(p[0][1], greater(p[1][1], p[2][1])) + margin};
  area a;
  if (!area_of(in, &e, &a) || is_marked(coverage, &a))
    return;
  if (a.x1 - a.x0 < NARROW || a.y1 - a.y0 < NARROW || isinf(by))
    mark_area(coverage, &a, PL_COVERED_BY_MESH);
  else
    mark_rows(coverage, p, margin, &a);
}

static double pixels_of(const area *a) {
  return (double)(a->x1 - a->x0 + 1) * (double)(a->y1 - a->y0 + 1);
}

/* Marks the pixels of an area in which a box may be visible; *out is set to them. Returns true, and
 * marks nothing, if the contents of the box should be visited instead. */
static bool visit(const placed *at, const pl_coverage *coverage, uint32_t index, const area *in,
                  area *out) {
  const pl_box *box = &at->cover->boxes[index];
  const bool pinhole = is_pinhole(&at->shot->rays.camera), leaf = box->after == index + 1;
  const bool closely = pinhole && at->rays >= CLOSE_RAYS;
  extent e;
  if (pinhole)
    project_box(at, box, &e);
  else
    project_corners(at, box, &e);
  if (!area_of(in, &e, out) || is_marked(coverage, out))
    return false;
  const bool small = pixels_of(out) <= AREA_LEAST || (!closely && box->count <= COARSE);
  if (!small && !leaf)
    return true;
  if (small || !closely || box->count > pixels_of(out) * at->rays) {
    mark_area(coverage, out, PL_COVERED_BY_MESH);
    return false;
  }
  for (uint32_t i = box->first; i < box->first + box->count; i++)
    mark_triangle(at, coverage, at->cover->triangles[i], out);
  return false;
}

static area rows_of(const pl_coverage_job *job) {
  return (area){0, job->row0, job->coverage->width - 1, job->row1};
}

/* Marks one slice of the boxes of an object, or of its piece. A slice may begin within a box that
 * belongs to an earlier slice; the contents of that box are then visited here as well. The slices
 * do not depend on the number of threads. */
static void mark_cover(const pl_coverage_job *job, const pl_shot_object *object,
                       const pl_shot_piece *piece, size_t slice) {
  const pl_cover *cover = piece != NULL ? piece->cover : object->object->cover;
  const uint32_t first = (uint32_t)(cover->count * slice / job->slices);
  const uint32_t end = (uint32_t)(cover->count * (slice + 1) / job->slices);
  if (first == end)
    return;
  const placed at = place(job->shot, object, piece, job->rays);
  opened open[PL_COVER_DEPTH + 1] = {{rows_of(job), UINT32_MAX}};
  size_t last = 0;
  for (uint32_t i = first; i < end;) {
    area area;
    while (i >= open[last].after)
      last--;
    const uint32_t after = cover->boxes[i].after;
    const bool into = visit(&at, job->coverage, i, &open[last].area, &area);
    if (into)
      open[++last] = (opened){area, after};
    i = into ? i + 1 : after;
  }
}

void pl_coverage_object(const pl_coverage_job *job, pl_surface_id id, size_t slice) {
  const pl_shot_object *object = pl_shot_object_of(job->shot, id);
  if (object->pieces == NULL)
    mark_cover(job, object, NULL, slice);
  for (size_t k = 0; k < object->piece_count; k++)
    if (object->pieces[k].present)
      mark_cover(job, object, &object->pieces[k], slice);
}

static pl_status mark_item(void *context, size_t item, int worker) {
  const pl_coverage_job *job = context;
  const pl_shot_object *object = &job->shot->objects[item / job->slices];
  (void)worker;
  if (object->in_frame)
    pl_geometry_of(object->id)->cover(job, object->id, item % job->slices);
  return PL_OK;
}

static size_t boxes_of(const pl_snapshot *shot) {
  size_t sum = 0;
  for (size_t i = 0; i < shot->object_count; i++) {
    const pl_shot_object *object = &shot->objects[i];
    if (object->in_frame && object->pieces == NULL)
      sum += object->object->cover->count;
    for (size_t k = 0; object->in_frame && k < object->piece_count; k++)
      sum += object->pieces[k].cover->count;
  }
  return sum;
}

enum { BLOCK = 16 };

void pl_coverage_sphere(const pl_coverage_job *job, pl_vec3 center, double radius_m) {
  const int x_end = job->coverage->width, y_end = job->row1 + 1;
  for (int y = job->row0; y < y_end; y += BLOCK)
    for (int x = 0; x < x_end; x += BLOCK) {
      const area block = {x, y, (x + BLOCK < x_end ? x + BLOCK : x_end) - 1,
                          (y + BLOCK < y_end ? y + BLOCK : y_end) - 1};
      const double rect[4] = {block.x0 - 0.5, block.y0 - 0.5, block.x1 + 0.5, block.y1 + 0.5};
      pl_vec3 axis;
      double half_angle_rad;
      pl_snapshot_cone(job->shot, rect, &axis, &half_angle_rad);
      if (pl_snapshot_sees(job->shot, center, radius_m, axis, half_angle_rad))
        mark_area(job->coverage, &block, PL_COVERED_BY_GROUND);
    }
}

/* Marks bodies that rays do not meet in closed form; those with a shape are objects, whose marks
 * come later and are stronger. */
static void mark_bodies(const pl_coverage_job *job) {
  for (size_t i = 0; i < job->shot->body_count; i++) {
    const pl_shot_body *body = &job->shot->bodies[i];
    const pl_surface_id id = pl_shot_surface_of(body, i);
    if (body->in_frame && pl_geometry_of(id)->cover != NULL)
      pl_geometry_of(id)->cover(job, id, 0);
  }
}

pl_status pl_coverage_update(pl_coverage *coverage, const pl_snapshot *shot, int row0, int row1,
                             int rays, int threads) {
  coverage->width = shot->rays.camera.width;
  coverage->height = shot->rays.camera.height;
  const size_t count = (size_t)coverage->width * (size_t)coverage->height;
  if (count > coverage->room) {
    atomic_uchar *grown = pl_realloc(coverage->pixels, count, sizeof *grown);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for marks of %zu pixels", count);
    coverage->pixels = grown;
    coverage->room = count;
  }
  for (atomic_uchar *pixel = row_of(coverage, row0); pixel < row_of(coverage, row1); pixel++)
    atomic_init(pixel, 0);
  pl_coverage_job job = {.coverage = coverage,
                         .shot = shot,
                         .rays = rays,
                         .slices = shot->object_count > SLICED_MOST ? 1 : SLICES,
                         .row0 = row0,
                         .row1 = row1 - 1};
  if (!shot->rays.kind->projects) {
    mark_area(coverage, &(area){0, row0, coverage->width - 1, row1 - 1}, PL_COVERED_BY_MESH);
    return PL_OK;
  }
  mark_bodies(&job);
  const int workers = boxes_of(shot) > ALONE ? threads : 1;
  return pl_parallel_for(workers, shot->object_count * job.slices, mark_item, &job, NULL);
}

void pl_coverage_clear(pl_coverage *coverage) {
  pl_free(coverage->pixels);
  *coverage = (pl_coverage){0};
}
