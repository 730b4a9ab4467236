/* Projected bounding boxes, and who can hide whom. */
#include "annotate/outline.h"

/* Room for rounding between a box projected in double and a mesh traced in float: a pixel, and what
 * the float directions of a long lens add. */
static double margin_px(const pl_camera *camera) {
  return 1.0 + 4e-7 * fmax(camera->fx, camera->fy);
}

static void set_corners(const pl_snapshot *shot, const pl_shot_object *object, pl_outline *out) {
  const pl_model *model = object->object->model;
  const float *bounds[2] = {model->bounds_min, model->bounds_max};
  for (int k = 0; k < 8; k++) {
    const pl_vec3 p = {bounds[k & 1][0], bounds[k >> 1 & 1][1], bounds[k >> 2][2]};
    const pl_vec3 local = pl_vec3_scale(pl_vec3_sub(p, object->object->offset), object->scale);
    const pl_vec3 view = pl_vec3_add(object->position, pl_mat3_mul_vec(object->rotation, local));
    out->corners[k] = pl_mat3_mul_vec_t(shot->camera_to_root, view);
  }
}

/* nan, of a model without extent, is `low`. */
static int to_pixel(double value, int low, int high) {
  return !(value > low) ? low : value >= high ? high : (int)value;
}

/* The box of the projected corners on the canvas; the whole canvas when some lie behind. */
static void set_box(const pl_camera *camera, pl_outline *out) {
  const int w = camera->width, h = camera->height;
  const double margin = margin_px(camera);
  double u0 = INFINITY, v0 = INFINITY, u1 = -INFINITY, v1 = -INFINITY;
  int before = 0;
  for (int k = 0; k < 8; k++) {
    const pl_vec3 p = out->corners[k];
    if (!(p.z > 0.0))
      continue;
    before++;
    const double u = (camera->fx * p.x + camera->skew * p.y) / p.z + camera->cx;
    const double v = camera->fy * p.y / p.z + camera->cy;
    u0 = fmin(u0, u);
    u1 = fmax(u1, u);
    v0 = fmin(v0, v);
    v1 = fmax(v1, v);
  }
  if (before < 8) {
    u0 = v0 = -INFINITY;
    u1 = v1 = INFINITY;
  }
  out->x0 = to_pixel(floor(u0 - margin), -w, 2 * w);
  out->y0 = to_pixel(floor(v0 - margin), -h, 2 * h);
  out->x1 = to_pixel(ceil(u1 + margin), -w - 1, 2 * w - 1);
  out->y1 = to_pixel(ceil(v1 + margin), -h - 1, 2 * h - 1);
  if (before == 0 || out->x0 > out->x1 || out->y0 > out->y1) {
    out->x0 = out->y0 = 0;
    out->x1 = out->y1 = -1;
  }
}

/* With room for the mesh's rounding. */
static void set_depths(pl_outline *out) {
  out->z0_m = INFINITY;
  out->z1_m = -INFINITY;
  out->far_m = 0.0;
  for (int k = 0; k < 8; k++) {
    out->z0_m = fmin(out->z0_m, out->corners[k].z);
    out->z1_m = fmax(out->z1_m, out->corners[k].z);
    out->far_m = fmax(out->far_m, pl_vec3_norm(out->corners[k]));
  }
  const double room = 1e-6 * out->far_m;
  out->z0_m -= room;
  out->z1_m += room;
  out->far_m += room;
}

/* A ray that meets both meets first the one whose depth is smaller. */
static bool object_hides(const pl_outline *other, const pl_outline *outline) {
  return other->z0_m <= outline->z1_m && other->x0 <= outline->x1 && other->x1 >= outline->x0 &&
         other->y0 <= outline->y1 && other->y1 >= outline->y0;
}

static bool body_hides(const pl_shot_body *body, const pl_shot_object *object,
                       const pl_outline *outline) {
  const double distance = pl_vec3_norm(object->center);
  if (!body->in_frame || pl_vec3_norm(body->center) - body->radius_m > outline->far_m)
    return false;
  return distance <= object->radius_m ||
         pl_sphere_in_cone(body->center, body->radius_m, pl_vec3_unit(object->center),
                           asin(object->radius_m / distance) + 1e-6);
}

static bool is_hidden(const pl_snapshot *shot, size_t index, const pl_outline *outlines) {
  for (size_t i = 0; i < shot->object_count; i++)
    if (i != index && object_hides(&outlines[i], &outlines[index]))
      return true;
  for (size_t i = 0; i < shot->body_count; i++)
    if (body_hides(&shot->bodies[i], &shot->objects[index], &outlines[index]))
      return true;
  return false;
}

void pl_outline_build(const pl_snapshot *shot, pl_outline *outlines) {
  for (size_t i = 0; i < shot->object_count; i++) {
    outlines[i] = (pl_outline){0};
    set_corners(shot, &shot->objects[i], &outlines[i]);
    set_box(&shot->camera, &outlines[i]);
    set_depths(&outlines[i]);
  }
  for (size_t i = 0; i < shot->object_count; i++) {
    pl_outline *out = &outlines[i];
    const bool inside = out->x0 >= 0 && out->y0 >= 0 && out->x1 < shot->camera.width &&
                        out->y1 < shot->camera.height;
    const bool nowhere = out->x0 > out->x1;
    out->whole = nowhere || (inside && shot->objects[i].in_frame && !is_hidden(shot, i, outlines));
  }
}

/* Corners of the box on the outer side of the plane a x + b y + c z = 0 through the camera. */
static bool parts(const pl_outline *outline, double a, double b, double c) {
  for (int k = 0; k < 8; k++) {
    const pl_vec3 p = outline->corners[k];
    if (a * p.x + b * p.y + c * p.z <= 0.0)
      return false;
  }
  return true;
}

bool pl_outline_meets(const pl_outline *outline, const pl_camera *camera, int x0, int y0, int x1,
                      int y1) {
  const double margin = margin_px(camera);
  const double left = x0 - margin - camera->cx, right = x1 + margin - camera->cx;
  const double top = y0 - margin - camera->cy, bottom = y1 + margin - camera->cy;
  const double fx = camera->fx, fy = camera->fy, skew = camera->skew;
  return !parts(outline, -fx, -skew, left) && !parts(outline, fx, skew, -right) &&
         !parts(outline, 0.0, -fy, top) && !parts(outline, 0.0, fy, -bottom) &&
         !parts(outline, 0.0, 0.0, -1.0);
}
