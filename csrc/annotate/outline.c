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

static double cone_of(pl_vec3 center, double radius_m) {
  const double distance = pl_vec3_norm(center);
  return distance > radius_m ? asin(radius_m / distance) : PL_PI;
}

static bool hides(pl_vec3 center, double radius_m, bool in_frame, const pl_shot_object *object,
                  const pl_outline *outline) {
  return in_frame && pl_vec3_norm(center) - radius_m <= outline->far_m &&
         pl_sphere_in_cone(center, radius_m, pl_vec3_unit(object->center),
                           outline->half_angle_rad + 1e-6);
}

static bool is_hidden(const pl_snapshot *shot, size_t index, const pl_outline *outline) {
  const pl_shot_object *object = &shot->objects[index];
  for (size_t i = 0; i < shot->object_count; i++) {
    const pl_shot_object *other = &shot->objects[i];
    if (i != index && hides(other->center, other->radius_m, other->in_frame, object, outline))
      return true;
  }
  for (size_t i = 0; i < shot->body_count; i++) {
    const pl_shot_body *body = &shot->bodies[i];
    if (hides(body->center, body->radius_m, body->in_frame, object, outline))
      return true;
  }
  return false;
}

void pl_outline_build(const pl_snapshot *shot, pl_outline *outlines) {
  for (size_t i = 0; i < shot->object_count; i++) {
    const pl_shot_object *object = &shot->objects[i];
    pl_outline *out = &outlines[i];
    *out = (pl_outline){0};
    set_corners(shot, object, out);
    set_box(&shot->camera, out);
    out->far_m = (pl_vec3_norm(object->center) + object->radius_m) * (1.0 + 1e-6);
    out->half_angle_rad = cone_of(object->center, object->radius_m);
    const bool inside = out->x0 >= 0 && out->y0 >= 0 && out->x1 < shot->camera.width &&
                        out->y1 < shot->camera.height;
    const bool somewhere = out->x0 <= out->x1;
    out->whole = !somewhere || (inside && object->in_frame && !is_hidden(shot, i, out));
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
