/* The nodes `coordinates` and `mapping`: coordinates of the point; their translation, rotation and
 * scaling. */
#include <math.h>

#include "shade/node_rows.h"

enum { SPACE_OBJECT, SPACE_WORLD, SPACE_UV, SPACE_UV_1, SPACE_BOX, SPACE_FACE, SPACE_LON_LAT };
static const char *const spaces[] = {"object", "world", "uv",          "uv1",
                                     "box",    "face",  "lon_lat_deg", NULL};

/* Radius of the circle with the area of the parallelogram spanned by the footprint. */
static float radius_of(const float a[2], const float b[2]) {
  return sqrtf(fabsf(a[0] * b[1] - a[1] * b[0]) / PL_PI_F);
}

/* Normal of the triangle in model axes at rest, not of unit length; zero without a model. */
static pl_vec3f rest_normal(const pl_graph_point *p) {
  if (p->model == NULL)
    return pl_vec3f_make(0.0f, 0.0f, 0.0f);
  const uint32_t *corner = p->model->indices + 3 * (size_t)p->triangle.triangle;
  pl_vec3f at[3];
  for (size_t k = 0; k < 3; k++) {
    const float *position = p->model->positions + 3 * (size_t)corner[k];
    at[k] = pl_vec3f_make(position[0], position[1], position[2]);
  }
  return pl_vec3f_cross(pl_vec3f_sub(at[1], at[0]), pl_vec3f_sub(at[2], at[0]));
}

/* Axes of the plane onto which the surface is projected. Box: two model axes, y and z, z and x, or
 * x and y, by the largest component of the normal. Face: the first axis is the model axis nearest
 * to the plane of the face, projected into it, so that all triangles of a flat panel share it. */
static void plane_of(int space, pl_vec3f n, pl_vec3f axis[2]) {
  const float size[3] = {fabsf(n.x), fabsf(n.y), fabsf(n.z)};
  const float length = pl_vec3f_norm(n);
  const bool flat = space == SPACE_FACE && length > 0.0f;
  /* By more than rounding errors: faces of one panel must not differ. */
  const float less = flat ? 1e-4f * length : 0.0f;
  size_t most = 2, least = 1;
  for (size_t k = 3; k-- > 0;) {
    most = size[k] > size[most] + less ? k : most;
    least = size[k] < size[least] - less ? k : least;
  }
  const size_t first = flat ? least : (most + 1) % 3, second = (most + 2) % 3;
  const float unit[3][3] = {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};
  axis[0] = pl_vec3f_make(unit[first][0], unit[first][1], unit[first][2]);
  axis[1] = pl_vec3f_make(unit[second][0], unit[second][1], unit[second][2]);
  if (flat) {
    n = pl_vec3f_scale(n, 1.0f / length);
    axis[0] = pl_vec3f_unit(pl_vec3f_madd(axis[0], -pl_vec3f_dot(axis[0], n), n));
    axis[1] = pl_vec3f_cross(n, axis[0]);
  }
}

static void on_plane(const pl_graph_point *p, int space, pl_value out) {
  pl_vec3f axis[2];
  plane_of(space, rest_normal(p), axis);
  const pl_vec3f at =
      pl_vec3f_make(pl_vec3f_dot(p->object, axis[0]), pl_vec3f_dot(p->object, axis[1]), 0.0f);
  pl_value_vector(out, at, p->radius);
}

/* Longitude and latitude from a map centred at longitude 0: u spans 360 degrees, v 180. */
static void lon_lat_deg(const pl_graph_point *p, pl_value out) {
  static const float SIDE = 254.55844f; /* sqrt(360 180) */
  pl_graph_point centered = *p;
  float uv[2], a[2], b[2];
  centered.map_center_lon_rad = 0.0;
  pl_graph_point_uv(&centered, 0, uv, a, b);
  pl_value_vector(out, pl_vec3f_make(360.0f * (uv[0] - 0.5f), 180.0f * (0.5f - uv[1]), 0.0f),
                  isinf(p->radius) ? p->radius : SIDE * radius_of(a, b));
}

static void coordinates(const pl_node_call *call) {
  const pl_graph_point *p = call->point;
  const int space = (int)call->constants[0].number;
  float uv[2] = {0.0f, 0.0f}, a[2], b[2];
  if (space == SPACE_OBJECT || space == SPACE_WORLD) {
    pl_value_vector(call->out[0], space == SPACE_OBJECT ? p->object : p->world, p->radius);
    return;
  }
  if (space == SPACE_BOX || space == SPACE_FACE) {
    on_plane(p, space, call->out[0]);
    return;
  }
  if (space == SPACE_LON_LAT) {
    if (p->body != NULL)
      lon_lat_deg(p, call->out[0]);
    else
      pl_value_scalar(call->out[0], 0.0f);
    return;
  }
  pl_graph_point_uv(p, space - SPACE_UV, uv, a, b);
  pl_value_vector(call->out[0], pl_vec3f_make(uv[0], uv[1], 0.0f),
                  isinf(p->radius) ? p->radius : radius_of(a, b));
}

static const pl_constant_row coordinates_constants[] = {
    {"space", PL_CHOICE, SPACE_OBJECT, 0, 0, spaces, 0,
     "object: metres from the object's origin along the model's axes, moving with its parts, or "
     "from a body's centre along its axes (x at longitude 0, z to the north); world: the same "
     "along ICRF axes; uv, uv1: the model's texture coordinates, zeros where it has none, or those "
     "of a body's equirectangular map (u east, v south, 0..1); box: metres along two of the "
     "model's axes, those that the surface faces least; face: metres in the plane of the triangle, "
     "for flat panels that lie aslant; lon_lat_deg: east longitude -180..180 and latitude on a "
     "body "
     "(as its `latitudes` says), zeros elsewhere"}};
static const pl_socket coordinates_outputs[] = {
    {"vector", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "The coordinates"}};

const pl_node_kind pl_node_coordinates = {
    .name = "coordinates",
    .doc = "Coordinates of the point",
    .outputs = coordinates_outputs,
    .output_count = 1,
    .constants = coordinates_constants,
    .constant_count = 1,
    .reads_point = true,
    .evaluate = coordinates,
};

/* Rotates about x, then y, then z, by angles in radians. */
static pl_vec3f turned(pl_vec3f v, const float *angle) {
  const float cx = cosf(angle[0]), sx = sinf(angle[0]);
  const float cy = cosf(angle[1]), sy = sinf(angle[1]);
  const float cz = cosf(angle[2]), sz = sinf(angle[2]);
  v = pl_vec3f_make(v.x, cx * v.y - sx * v.z, sx * v.y + cx * v.z);
  v = pl_vec3f_make(cy * v.x + sy * v.z, v.y, cy * v.z - sy * v.x);
  return pl_vec3f_make(cz * v.x - sz * v.y, sz * v.x + cz * v.y, v.z);
}

static void mapping(const pl_node_call *call) {
  static const float DEG = PL_PI_F / 180.0f;
  const float *v = call->in[0], *rotation = call->in[2], *scale = call->in[3];
  const float angle[3] = {DEG * rotation[0], DEG * rotation[1], DEG * rotation[2]};
  pl_vec3f p = pl_vec3f_mul(pl_value_vec(v), pl_value_vec(scale));
  if (angle[0] != 0.0f || angle[1] != 0.0f || angle[2] != 0.0f)
    p = turned(p, angle);
  const float largest = pl_maxf(fabsf(scale[0]), pl_maxf(fabsf(scale[1]), fabsf(scale[2])));
  /* A scale of zero gives one value, for any footprint. */
  pl_value_vector(call->out[0], pl_vec3f_add(p, pl_value_vec(call->in[1])),
                  largest > 0.0f ? v[3] * largest : 0.0f);
}

static const pl_socket mapping_inputs[] = {
    {"vector", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "Coordinates"},
    {"location", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "Added last"},
    {"rotation_deg", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "About x, then y, then z; after the scale"},
    {"scale", PL_VECTOR, {1.0f, 1.0f, 1.0f}, "Factors, first"},
};

const pl_node_kind pl_node_mapping = {
    .name = "mapping",
    .doc = "Scales, turns and moves coordinates; their footprint grows with the largest factor",
    .inputs = mapping_inputs,
    .input_count = 4,
    .outputs = coordinates_outputs,
    .output_count = 1,
    .evaluate = mapping,
};
