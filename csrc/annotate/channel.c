/* The table of label channels. */
#include "annotate/channel.h"

#include <stdint.h>

#include "math/angle.h"

/* Camera axes: x right, y down, z forward. */
static pl_vec3 to_camera(const pl_snapshot *shot, pl_vec3 v) {
  return pl_mat3_mul_vec_t(shot->camera_to_root, v);
}

static void write_depth(const pl_snapshot *shot, const pl_vertex *vertex, void *pixel) {
  float *out = pixel;
  *out = vertex != NULL ? (float)to_camera(shot, vertex->position).z : 0.0f;
}

static void write_range(const pl_snapshot *shot, const pl_vertex *vertex, void *pixel) {
  (void)shot;
  float *out = pixel;
  *out = vertex != NULL ? (float)pl_vec3_norm(vertex->position) : 0.0f;
}

static void write_normal(const pl_snapshot *shot, const pl_vertex *vertex, void *pixel) {
  float *out = pixel;
  out[0] = out[1] = out[2] = 0.0f;
  if (vertex == NULL)
    return;
  const pl_vec3 n = to_camera(shot, pl_vec3f_to_double(vertex->surface.n));
  out[0] = (float)n.x;
  out[1] = (float)n.y;
  out[2] = (float)n.z;
}

static void write_position(const pl_snapshot *shot, const pl_vertex *vertex, void *pixel) {
  double *out = pixel;
  out[0] = out[1] = out[2] = NAN;
  if (vertex == NULL)
    return;
  const pl_vec3 p = pl_vec3_add(shot->camera_position, vertex->position);
  out[0] = p.x;
  out[1] = p.y;
  out[2] = p.z;
}

static void write_object_coords(const pl_snapshot *shot, const pl_vertex *vertex, void *pixel) {
  float *out = pixel;
  out[0] = out[1] = out[2] = NAN;
  if (vertex == NULL)
    return;
  pl_vec3 p;
  if (vertex->thing < shot->object_count) {
    const pl_shot_object *object = &shot->objects[vertex->thing];
    p = pl_mat3_mul_vec_t(object->rotation, pl_vec3_sub(vertex->position, object->position));
  } else {
    const pl_shot_body *body = &shot->bodies[vertex->thing - shot->object_count];
    p = pl_mat3_mul_vec_t(body->rotation, pl_vec3_sub(vertex->position, body->center));
  }
  out[0] = (float)p.x;
  out[1] = (float)p.y;
  out[2] = (float)p.z;
}

static const uint16_t *classes_of(const pl_snapshot *shot, const pl_vertex *vertex) {
  if (vertex->thing >= shot->object_count)
    return shot->bodies[vertex->thing - shot->object_count].body->class_ids;
  const pl_object *object = shot->objects[vertex->thing].object;
  const size_t part = pl_object_part(object, vertex->triangle);
  return object->class_ids + part * (size_t)shot->levels;
}

static void write_semantic(const pl_snapshot *shot, const pl_vertex *vertex, void *pixel) {
  uint16_t *out = pixel;
  const uint16_t *classes = vertex != NULL ? classes_of(shot, vertex) : NULL;
  for (int level = 0; level < shot->levels; level++)
    out[level] = classes != NULL ? classes[level] : 0;
}

static void write_part(const pl_snapshot *shot, const pl_vertex *vertex, void *pixel) {
  int32_t *out = pixel;
  *out = 0;
  if (vertex == NULL)
    return;
  if (vertex->thing >= shot->object_count) {
    *out = shot->bodies[vertex->thing - shot->object_count].body->part_id;
    return;
  }
  const pl_object *object = shot->objects[vertex->thing].object;
  *out = object->part_ids[pl_object_part(object, vertex->triangle)];
}

static void write_instance(const pl_snapshot *shot, const pl_vertex *vertex, void *pixel) {
  int32_t *out = pixel;
  if (vertex == NULL)
    *out = 0;
  else if (vertex->thing >= shot->object_count)
    *out = shot->bodies[vertex->thing - shot->object_count].body->instance_id;
  else
    *out = shot->objects[vertex->thing].object->instance_id;
}

static pl_vec3 to_sun(const pl_snapshot *shot, const pl_vertex *vertex) {
  return pl_vec3_sub(shot->sun.position, vertex->position);
}

static pl_vec3 to_viewer(const pl_vertex *vertex) { return pl_vec3_scale(vertex->position, -1.0); }

static void write_incidence(const pl_snapshot *shot, const pl_vertex *vertex, void *pixel) {
  float *out = pixel;
  *out = vertex == NULL
             ? NAN
             : (float)pl_vec3_angle(pl_vec3f_to_double(vertex->surface.n), to_sun(shot, vertex));
}

static void write_emission(const pl_snapshot *shot, const pl_vertex *vertex, void *pixel) {
  (void)shot;
  float *out = pixel;
  *out = vertex == NULL
             ? NAN
             : (float)pl_vec3_angle(pl_vec3f_to_double(vertex->surface.n), to_viewer(vertex));
}

static void write_phase(const pl_snapshot *shot, const pl_vertex *vertex, void *pixel) {
  float *out = pixel;
  *out = vertex == NULL ? NAN : (float)pl_vec3_angle(to_viewer(vertex), to_sun(shot, vertex));
}

const pl_channel pl_channels[] = {
    {"depth", "float32", 4, 0, "m", "z along the optical axis; 0 where nothing is hit",
     write_depth},
    {"range", "float32", 4, 0, "m", "distance along the ray; 0 where nothing is hit", write_range},
    {"normal", "float32", 4, 3, "1",
     "unit shading normal on the viewer's side, camera axes; 0 where nothing is hit", write_normal},
    {"position", "float64", 8, 3, "m", "root frame; nan where nothing is hit", write_position},
    {"object_coords", "float32", 4, 3, "m",
     "coordinates in the object's or body's own frame; nan where nothing is hit",
     write_object_coords},
    {"semantic", "uint16", 2, -1, "id", "class at each level; 0 is background", write_semantic},
    {"part", "int32", 4, 0, "id", "part of an object, or the body; 0 is background", write_part},
    {"instance", "int32", 4, 0, "id", "object or body; 0 is background", write_instance},
    {"incidence", "float32", 4, 0, "rad", "normal to sun; nan where nothing is hit",
     write_incidence},
    {"emission", "float32", 4, 0, "rad", "normal to viewer; nan where nothing is hit",
     write_emission},
    {"phase", "float32", 4, 0, "rad", "viewer to sun at the surface; nan where nothing is hit",
     write_phase},
};
const size_t pl_channel_count = sizeof pl_channels / sizeof pl_channels[0];

size_t pl_channel_elements(const pl_channel *channel, int levels) {
  if (channel->components < 0)
    return (size_t)levels;
  return channel->components == 0 ? 1 : (size_t)channel->components;
}

void pl_channel_write(const pl_channel *channel, const pl_snapshot *shot, const pl_vertex *points,
                      size_t stride, const int tile[4], int image_width, void *pixels) {
  const size_t bytes = pl_channel_elements(channel, shot->levels) * channel->element;
  for (int y = 0; y < tile[3]; y++) {
    const size_t first = (size_t)(tile[1] + y) * (size_t)image_width + (size_t)tile[0];
    unsigned char *out = (unsigned char *)pixels + first * bytes;
    const pl_vertex *row = points + (size_t)y * stride;
    for (int x = 0; x < tile[2]; x++, out += bytes)
      channel->write(shot, row[x].thing != PL_NOTHING ? &row[x] : NULL, out);
  }
}
