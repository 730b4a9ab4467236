/* Heights are radial, from the body's centre; so is the vertical of slopes. */
#include "annotate/ground_channels.h"

#include <math.h>
#include <string.h>

#include "geom/ellipsoid.h"
#include "terrain/crater_marks.h"
#include "terrain/height_field.h"

const pl_shot_body *pl_ground_body(const pl_snapshot *shot, pl_surface_id id) {
  switch (pl_surface_kind_of(id)) {
  case PL_SURFACE_SHAPE:
    return &shot->bodies[pl_shot_object_of(shot, id)->object->body];
  case PL_SURFACE_ELLIPSOID:
  case PL_SURFACE_HEIGHT_FIELD:
  case PL_SURFACE_ROCKS:
    return pl_shot_body_of(shot, id);
  default:
    return NULL;
  }
}

static const pl_shot_body *body_of(const pl_label_run *run) {
  return pl_ground_body(run->shot, run->surface_id);
}

static void fill(const pl_label_run *run, float value, float *out) {
  for (size_t i = 0; i < run->count; i++)
    out[i] = value;
}

/* Position of pixel `i` from the body's centre, root axes, m. */
static pl_vec3 from_center(const pl_label_run *run, const pl_shot_body *body, size_t i) {
  const pl_vec3 p = {run->position[0][i], run->position[1][i], run->position[2][i]};
  return pl_vec3_sub(p, body->center);
}

double pl_ground_datum_m(const pl_shot_body *body, pl_vec3 point) {
  const pl_vec3 p = pl_mat3_mul_vec_t(body->rotation, point), r = body->state->radii_m;
  const pl_vec3 scaled = {p.x / r.x, p.y / r.y, p.z / r.z};
  return pl_vec3_norm(p) / pl_vec3_norm(scaled);
}

void pl_write_elevation(const pl_label_run *run, void *pixels) {
  const pl_shot_body *body = body_of(run);
  float *out = pixels;
  if (body == NULL) {
    fill(run, NAN, out);
    return;
  }
  for (size_t i = 0; i < run->count; i++) {
    const pl_vec3 p = from_center(run, body, i);
    out[i] = pl_surface_is_ellipsoid(run->surface_id)
                 ? 0.0f
                 : (float)(pl_vec3_norm(p) - pl_ground_datum_m(body, p));
  }
}

void pl_write_altitude(const pl_label_run *run, void *pixels) {
  const pl_shot_body *body = body_of(run);
  float *out = pixels;
  if (body == NULL) {
    fill(run, NAN, out);
    return;
  }
  const double camera_m = pl_vec3_norm(body->center);
  for (size_t i = 0; i < run->count; i++)
    out[i] = (float)(camera_m - pl_vec3_norm(from_center(run, body, i)));
}

void pl_write_slope(const pl_label_run *run, void *pixels) {
  const pl_shot_body *body = body_of(run);
  float *out = pixels;
  if (body == NULL) {
    fill(run, NAN, out);
    return;
  }
  for (size_t i = 0; i < run->count; i++)
    out[i] =
        (float)pl_vec3_angle(from_center(run, body, i),
                             (pl_vec3){run->normal[0][i], run->normal[1][i], run->normal[2][i]});
}

void pl_write_rock_id(const pl_label_run *run, void *pixels) {
  int64_t *out = pixels;
  const bool rocks = pl_surface_kind_of(run->surface_id) == PL_SURFACE_ROCKS;
  const pl_shot_body *body = rocks ? body_of(run) : NULL;
  for (size_t i = 0; i < run->count; i++)
    out[i] = rocks
                 ? (int64_t)pl_height_field_rock(body->field, run->points[i].triangle).rock->rock.id
                 : 0;
}

void pl_find_craters(pl_label_run *run) {
  if (pl_surface_kind_of(run->surface_id) != PL_SURFACE_HEIGHT_FIELD) {
    memset(run->craters, 0, sizeof run->craters);
    return;
  }
  const pl_shot_body *body = body_of(run);
  const pl_camera *camera = &run->shot->rays.camera;
  const pl_crater_view view = {.eye = body->camera,
                               .pixel_rad = 1.0 / fmax(camera->fx, camera->fy),
                               .criteria = body->body->craters};
  pl_vec3 points[PL_LABEL_RUN];
  for (size_t i = 0; i < run->count; i++)
    points[i] = pl_mat3_mul_vec_t(body->rotation, from_center(run, body, i));
  pl_crater_marks(body->body->terrain, &view, points, run->count, run->craters);
}

void pl_write_crater_id(const pl_label_run *run, void *pixels) {
  memcpy(pixels, run->craters, run->count * sizeof run->craters[0]);
}

void pl_write_ground_mask(const pl_label_run *run, void *pixels) {
  const pl_shot_body *body = body_of(run);
  const bool masked = body != NULL && body->body->terrain != NULL;
  int32_t *out = pixels;
  for (size_t i = 0; i < run->count; i++) {
    out[i] = 0;
    if (!masked)
      continue;
    const pl_vec3 d = pl_mat3_mul_vec_t(body->rotation, from_center(run, body, i));
    out[i] =
        (int32_t)pl_raster_stack_nearest(pl_terrain_mask(body->body->terrain), pl_vec3_unit(d));
  }
}
