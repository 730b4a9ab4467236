/* Finds back-to-back sheets by short rays through each face along its normal. */
#include "trace/backing.h"

#include "base/memory.h"
#include "shade/material_surface.h"
#include "trace/embree.h"

/* Barycentric weights of the test points, those that are most likely to have nothing behind them
 * first. OPPOSITE: the cosine below which two faces look in opposite directions, an angle of more
 * than 120 degrees. */
enum { POINTS = 7 };
static const float WEIGHTS[POINTS][3] = {
    {1.0f / 3.0f, 1.0f / 3.0f, 1.0f / 3.0f},
    {0.9f, 0.05f, 0.05f},
    {0.05f, 0.9f, 0.05f},
    {0.05f, 0.05f, 0.9f},
    {0.48f, 0.48f, 0.04f},
    {0.04f, 0.48f, 0.48f},
    {0.48f, 0.04f, 0.48f},
};
static const float OPPOSITE = -0.5f;

typedef struct search {
  const pl_model *model;
  uint32_t triangle;
  pl_vec3f normal;       /* unit */
  const uint8_t *others; /* if not NULL, only faces with a nonzero mark count */
  bool found;
} search;

static pl_vec3f corner(const pl_model *model, uint32_t triangle, int k) {
  const float *p = model->positions + 3 * (size_t)model->indices[3 * (size_t)triangle + (size_t)k];
  return (pl_vec3f){p[0], p[1], p[2]};
}

static pl_vec3f normal_of(const pl_model *model, uint32_t triangle) {
  const pl_vec3f a = corner(model, triangle, 0);
  const pl_vec3f n = pl_vec3f_cross(pl_vec3f_sub(corner(model, triangle, 1), a),
                                    pl_vec3f_sub(corner(model, triangle, 2), a));
  return pl_vec3f_unit(n);
}

static bool is_there(const pl_model *model, uint32_t triangle, const float w[3]) {
  const pl_triangle_point point = {.triangle = triangle, .w = {w[0], w[1], w[2]}};
  return pl_material_of(model, triangle)->alpha_mode == PL_ALPHA_OPAQUE ||
         pl_material_opacity(model, &point) >= 0.5f;
}

static int node_of(const pl_model *model, uint32_t triangle) {
  return model->parts[model->triangle_part[triangle]].node;
}

/* Examines every candidate and rejects it, so that Embree goes on to report all of them. */
static void look(const struct RTCFilterFunctionNArguments *arguments) {
  search *s =
      (search *)(uintptr_t)((const pl_embree_query *)(const void *)arguments->context)->user;
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; i++) {
    if (arguments->valid[i] == 0)
      continue;
    arguments->valid[i] = 0;
    const uint32_t other = pl_embree_hit_triangle(arguments->hit, n, i);
    if (s->found || other == s->triangle || (s->others != NULL && s->others[other] == 0) ||
        node_of(s->model, other) != node_of(s->model, s->triangle) ||
        !(pl_vec3f_dot(normal_of(s->model, other), s->normal) < OPPOSITE))
      continue;
    const float u = pl_embree_hit_u(arguments->hit, n, i);
    const float v = pl_embree_hit_v(arguments->hit, n, i);
    s->found = is_there(s->model, other, (const float[3]){1.0f - u - v, u, v});
  }
}

static bool point_is_backed(RTCScene scene, search *s, const float w[3]) {
  const float hair = s->model->hair;
  pl_vec3f p = pl_vec3f_scale(corner(s->model, s->triangle, 0), w[0]);
  p = pl_vec3f_madd(p, w[1], corner(s->model, s->triangle, 1));
  p = pl_vec3f_madd(p, w[2], corner(s->model, s->triangle, 2));
  p = pl_vec3f_madd(p, -hair, s->normal);
  struct RTCRayHit query = {.ray = {.org_x = p.x,
                                    .org_y = p.y,
                                    .org_z = p.z,
                                    .dir_x = s->normal.x,
                                    .dir_y = s->normal.y,
                                    .dir_z = s->normal.z,
                                    .tfar = 2.0f * hair,
                                    .mask = UINT32_MAX}};
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  pl_embree_query way = {.filter = look, .user = s};
  s->found = false;
  pl_embree_intersect1(scene, &way, &query);
  return s->found || !is_there(s->model, s->triangle, w);
}

static bool has_two_sides(const pl_material *material) {
  return material->layers.solid && material->layers.transmission > 0.0f;
}

static bool is_backed(RTCScene scene, const pl_model *model, uint32_t triangle) {
  search s = {.model = model, .triangle = triangle, .normal = normal_of(model, triangle)};
  if (has_two_sides(pl_material_of(model, triangle)) || !(pl_vec3f_dot(s.normal, s.normal) > 0.5f))
    return false;
  for (int k = 0; k < POINTS; k++)
    if (!point_is_backed(scene, &s, WEIGHTS[k]))
      return false;
  return true;
}

/* Returns whether the back of a covered face is hidden: always if its material is single-sided,
 * otherwise if the face that covers its centre is covered itself. A decal with a double-sided
 * material thus stays visible, whichever way it is wound. */
static bool is_hidden(RTCScene scene, const pl_model *model, uint32_t triangle,
                      const uint8_t *covered) {
  const pl_material *material = pl_material_of(model, triangle);
  if (!material->double_sided || material->dark_behind)
    return true;
  search s = {.model = model,
              .triangle = triangle,
              .normal = normal_of(model, triangle),
              .others = covered};
  return point_is_backed(scene, &s, WEIGHTS[0]);
}

/* Sets *out to a mark per triangle, or to NULL if no face is backed. */
static pl_status mark(RTCScene scene, const pl_model *model, uint8_t **out) {
  void *memory, *first;
  bool any = false;
  PL_TRY(pl_alloc_or_fail(model->triangle_count, 1, "sheets back to back", &first));
  const pl_status status =
      pl_alloc_or_fail(model->triangle_count, 1, "sheets back to back", &memory);
  uint8_t *covered = first, *marks = memory;
  for (size_t t = 0; status == PL_OK && t < model->triangle_count; t++)
    covered[t] = is_backed(scene, model, (uint32_t)t);
  for (size_t t = 0; status == PL_OK && t < model->triangle_count; t++) {
    marks[t] = covered[t] != 0 && is_hidden(scene, model, (uint32_t)t, covered);
    any |= marks[t] != 0;
  }
  pl_free(first);
  if (status == PL_OK && !any)
    pl_free(memory);
  *out = any ? marks : NULL;
  return status;
}

static RTCScene scene_of(RTCDevice device, const pl_model *model) {
  RTCScene scene = rtcNewScene(device);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | PL_EMBREE_QUERY_FILTERS);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             model->positions, 0, 3 * sizeof(float), model->vertex_count);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, model->indices,
                             0, 3 * sizeof(uint32_t), model->triangle_count);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

pl_status pl_backing_find(pl_model *model) {
  double extent = 0.0;
  for (int axis = 0; axis < 3; axis++)
    extent = fmax(extent, (double)model->bounds_max[axis] - model->bounds_min[axis]);
  model->hair = (float)(PL_HAIR * extent);
  const RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
  if (device == NULL)
    return pl_fail(PL_E_DEVICE, "Embree cannot open a device (error %d)",
                   (int)rtcGetDeviceError(NULL));
  const RTCScene scene = scene_of(device, model);
  const enum RTCError error = rtcGetDeviceError(device);
  const pl_status status =
      error == RTC_ERROR_NONE
          ? mark(scene, model, &model->backed)
          : pl_fail(error == RTC_ERROR_OUT_OF_MEMORY ? PL_E_MEMORY : PL_E_DEVICE,
                    "Embree error %d while looking for sheets back to back", (int)error);
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
  return status;
}
