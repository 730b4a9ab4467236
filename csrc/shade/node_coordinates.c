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

static void on_plane(const pl_graph_point *p, int space, pl_lanes out, size_t i) {
  pl_vec3f axis[2];
  plane_of(space, rest_normal(p), axis);
  const pl_vec3f at =
      pl_vec3f_make(pl_vec3f_dot(p->object, axis[0]), pl_vec3f_dot(p->object, axis[1]), 0.0f);
  pl_lane_vector(out, i, at, p->radius);
}

/* Longitude and latitude from a map centred at longitude 0: u spans 360 degrees, v 180. */
static void lon_lat_deg(const pl_graph_point *p, pl_lanes out, size_t i) {
  static const float SIDE = 254.55844f; /* sqrt(360 180) */
  pl_graph_point centered = *p;
  float uv[2], a[2], b[2];
  centered.map_center_lon_rad = 0.0;
  pl_graph_point_uv(&centered, 0, uv, a, b);
  pl_lane_vector(out, i, pl_vec3f_make(360.0f * (uv[0] - 0.5f), 180.0f * (0.5f - uv[1]), 0.0f),
                 isinf(p->radius) ? p->radius : SIDE * radius_of(a, b));
}

static void coordinates_of(const pl_graph_point *p, int space, pl_lanes out, size_t i) {
  float uv[2] = {0.0f, 0.0f}, a[2], b[2];
  if (space == SPACE_OBJECT || space == SPACE_WORLD) {
    pl_lane_vector(out, i, space == SPACE_OBJECT ? p->object : p->world, p->radius);
    return;
  }
  if (space == SPACE_BOX || space == SPACE_FACE) {
    on_plane(p, space, out, i);
    return;
  }
  if (space == SPACE_LON_LAT) {
    if (p->body != NULL)
      lon_lat_deg(p, out, i);
    else
      pl_lane_scalar(out, i, 0.0f);
    return;
  }
  pl_graph_point_uv(p, space - SPACE_UV, uv, a, b);
  pl_lane_vector(out, i, pl_vec3f_make(uv[0], uv[1], 0.0f),
                 isinf(p->radius) ? p->radius : radius_of(a, b));
}

static void coordinates(const pl_node_call *call) {
  for (size_t i = 0; i < call->count; i++)
    coordinates_of(&call->points[i], (int)call->constants[0].number, call->out[0], i);
  pl_lanes_fill(call->out[0], call->count);
}

/* How `object` changes along an axis of the tangent plane. */
static pl_vec3f object_slope(const pl_graph_point *p, pl_vec3f along) {
  if (p->body != NULL)
    return pl_vec3_to_float(pl_mat3_mul_vec_t(*p->body, pl_vec3f_to_double(along)));
  if (p->model == NULL)
    return along;
  pl_graph_point change = *p;
  change.offset = (pl_vec3){0.0, 0.0, 0.0};
  pl_triangle_point_step(&p->triangle, along, change.triangle.w);
  return pl_graph_point_object(&change);
}

static void slopes_at(const pl_graph_point *p, int space, pl_slopes out, size_t i) {
  const pl_vec3f along[2] = {p->t, p->b};
  pl_vec3f axis[2];
  if (space != SPACE_OBJECT && space != SPACE_WORLD)
    plane_of(space, rest_normal(p), axis);
  for (size_t k = 0; k < 2; k++) {
    pl_vec3f slope = space == SPACE_WORLD ? along[k] : object_slope(p, along[k]);
    if (space != SPACE_OBJECT && space != SPACE_WORLD)
      slope = pl_vec3f_make(pl_vec3f_dot(slope, axis[0]), pl_vec3f_dot(slope, axis[1]), 0.0f);
    pl_slope_vector(out, k, i, slope);
  }
}

static void coordinates_slopes(const pl_node_call *call) {
  coordinates(call);
  for (size_t i = 0; i < PL_LANES; i++)
    slopes_at(&call->points[i < call->count ? i : 0], (int)call->constants[0].number,
              call->out_slopes[0], i);
}

/* Maps have seams, and footprints of their own. */
static bool coordinates_have_slopes(const pl_constant *constants, unsigned uniform, unsigned read) {
  const int space = (int)constants[0].number;
  (void)uniform;
  (void)read;
  return space == SPACE_OBJECT || space == SPACE_WORLD || space == SPACE_BOX || space == SPACE_FACE;
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
    .evaluate_slopes = coordinates_slopes,
    .has_slopes = coordinates_have_slopes,
};

/* Cosine and sine of the angles about an axis. */
typedef struct turn {
  float cosine[PL_LANES], sine[PL_LANES];
} turn;

/* False if all angles are 0. */
static bool turns_of(const pl_node_call *call, size_t input, turn out[3]) {
  static const float DEG = PL_PI_F / 180.0f;
  const size_t count = pl_node_lanes(call, 1u << input);
  bool turned = false;
  for (size_t axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < PL_LANES; i++) {
      const float angle = DEG * (*call->in[input])[axis][i];
      out[axis].cosine[i] = i < count ? cosf(angle) : out[axis].cosine[0];
      out[axis].sine[i] = i < count ? sinf(angle) : out[axis].sine[0];
      turned |= angle != 0.0f;
    }
  return turned;
}

/* Rotates about x, then y, then z. */
PL_WIDE_PART pl_vec3f turned(pl_vec3f v, const turn by[3], size_t i) {
  const float cx = by[0].cosine[i], sx = by[0].sine[i], cy = by[1].cosine[i], sy = by[1].sine[i];
  const float cz = by[2].cosine[i], sz = by[2].sine[i];
  v = pl_vec3f_make(v.x, cx * v.y - sx * v.z, sx * v.y + cx * v.z);
  v = pl_vec3f_make(cy * v.x + sy * v.z, v.y, cy * v.z - sy * v.x);
  return pl_vec3f_make(cz * v.x - sz * v.y, sz * v.x + cz * v.y, v.z);
}

PL_WIDE static void mapping(const pl_node_call *call) {
  const float(*v)[PL_LANES] = *call->in[0], (*location)[PL_LANES] = *call->in[1];
  const float(*angle)[PL_LANES] = *call->in[2], (*scale)[PL_LANES] = *call->in[3];
  float(*out)[PL_LANES] = call->out[0];
  turn by[3];
  const bool turns = turns_of(call, 2, by);
  PL_EACH_LANE(i) {
    pl_vec3f p = pl_vec3f_mul(pl_lane_vec(v, i), pl_lane_vec(scale, i));
    if (turns && (angle[0][i] != 0.0f || angle[1][i] != 0.0f || angle[2][i] != 0.0f))
      p = turned(p, by, i);
    const float largest =
        pl_maxf(fabsf(scale[0][i]), pl_maxf(fabsf(scale[1][i]), fabsf(scale[2][i])));
    /* A scale of zero gives one value, for any footprint. */
    pl_lane_vector(out, i, pl_vec3f_add(p, pl_lane_vec(location, i)),
                   largest > 0.0f ? v[3][i] * largest : 0.0f);
  }
}

/* The rotation is the same everywhere. */
PL_WIDE static void mapping_slopes(const pl_node_call *call) {
  const float(*v)[PL_LANES] = *call->in[0], (*scale)[PL_LANES] = *call->in[3];
  const float(*dv)[3][PL_LANES] = *call->in_slopes[0], (*shift)[3][PL_LANES] = *call->in_slopes[1],
        (*dscale)[3][PL_LANES] = *call->in_slopes[3];
  turn by[3];
  mapping(call);
  const bool turns = turns_of(call, 2, by);
  for (size_t axis = 0; axis < 2; axis++)
    PL_EACH_LANE(i) {
      pl_vec3f p = pl_vec3f_add(pl_vec3f_mul(pl_slope_vec(dv, axis, i), pl_lane_vec(scale, i)),
                                pl_vec3f_mul(pl_lane_vec(v, i), pl_slope_vec(dscale, axis, i)));
      if (turns)
        p = turned(p, by, i);
      pl_slope_vector(call->out_slopes[0], axis, i, pl_vec3f_add(p, pl_slope_vec(shift, axis, i)));
    }
}

static bool mapping_has_slopes(const pl_constant *constants, unsigned uniform, unsigned read) {
  (void)constants;
  (void)read;
  return (uniform & 1u << 2) != 0;
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
    .evaluate_slopes = mapping_slopes,
    .has_slopes = mapping_has_slopes,
};
