/* Casting rays: meshes first, then the few bodies, nearest wins. */
#include "trace/tracer.h"

#include <stdio.h>

#include "base/memory.h"
#include "geom/ellipsoid.h"
#include "scene/graph_point.h"
#include "scene/shot_frame.h"
#include "trace/accelerator.h"
#include "trace/coincident.h"

enum { PACKET = 8 };

#define PL_TEXT_OF(x) #x
#define PL_TEXT(x) PL_TEXT_OF(x)

const char *pl_tracer_version(void) {
  return PL_TEXT(RTC_VERSION_MAJOR) "." PL_TEXT(RTC_VERSION_MINOR) "." PL_TEXT(RTC_VERSION_PATCH);
}

pl_status pl_tracer_create(pl_tracer **out) {
  pl_tracer *tracer = pl_alloc(1, sizeof *tracer);
  if (tracer == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for a tracer");
  tracer->device = rtcNewDevice("threads=1,set_affinity=0");
  if (tracer->device == NULL) {
    const int error = (int)rtcGetDeviceError(NULL);
    pl_free(tracer);
    return pl_fail(PL_E_DEVICE, "Embree cannot open a device (error %d)", error);
  }
  tracer->top = rtcNewScene(tracer->device);
  rtcSetSceneFlags(tracer->top,
                   RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC | PL_EMBREE_QUERY_FILTERS);
  const pl_status status = pl_accelerator_check(tracer, "opening a scene");
  if (status != PL_OK)
    pl_tracer_destroy(tracer);
  else
    *out = tracer;
  return status;
}

static void free_model(pl_model_accelerator *model) {
  rtcReleaseScene(model->scene);
  pl_free(model->coincident);
}

void pl_tracer_destroy(pl_tracer *tracer) {
  if (tracer == NULL)
    return;
  for (size_t i = 0; i < tracer->instance_count; i++)
    if (tracer->instances[i].model != NULL)
      rtcReleaseGeometry(tracer->instances[i].geometry);
  if (tracer->top != NULL)
    rtcReleaseScene(tracer->top);
  for (size_t i = 0; i < tracer->model_count; i++)
    free_model(&tracer->models[i]);
  rtcReleaseDevice(tracer->device);
  pl_free(tracer->instances);
  pl_free(tracer->owners);
  pl_free(tracer->models);
  pl_free(tracer);
}

pl_status pl_tracer_set(pl_tracer *tracer, const pl_snapshot *snapshot) {
  tracer->snapshot = NULL;
  PL_TRY(pl_accelerator_update(tracer, snapshot));
  tracer->snapshot = snapshot;
  return PL_OK;
}

/* The rays of a query: what its filter needs to know. */
typedef struct origins {
  const pl_tracer *tracer;
  const pl_ray *rays; /* by the number that each has in the query */
} origins;

/* Whether ray `i`, which leaves the mesh that it meets, passes that here: it comes out of the
 * facet, or would of the smooth surface of the normals. */
static bool is_left(const origins *origins, const struct RTCFilterFunctionNArguments *arguments,
                    unsigned i, uint32_t triangle) {
  const unsigned n = arguments->N;
  const pl_ray *ray = &origins->rays[pl_embree_ray_id(arguments->ray, n, i)];
  if (!(pl_embree_ray_far(arguments->ray, n, i) < ray->leaves))
    return false;
  if (pl_embree_from_behind(arguments->ray, arguments->hit, n, i))
    return true;
  const pl_shot_object *object = &origins->tracer->snapshot->objects[ray->from_thing];
  const pl_model *model = object->object->model;
  const float u = pl_embree_hit_u(arguments->hit, n, i), v = pl_embree_hit_v(arguments->hit, n, i);
  const float w[3] = {1.0f - u - v, u, v};
  const pl_vec3f normal = pl_shot_mix3(model->normals, 3, model->indices + 3 * (size_t)triangle, w);
  return pl_vec3f_dot(pl_shot_rotate(&object->rotation, normal), ray->direction) > 0.0f;
}

/* Whether ray `i` meets what it can. Not the triangle that it starts on: however far the origin is
 * put off the surface, rounding in large coordinates, or in those of a scaled instance, can put it
 * behind again. Nor where a graph leaves no surface. */
static bool counts(const void *context, const struct RTCFilterFunctionNArguments *arguments,
                   unsigned i) {
  const origins *origins = context;
  const pl_tracer *tracer = origins->tracer;
  const unsigned n = arguments->N;
  const pl_ray *ray = &origins->rays[pl_embree_ray_id(arguments->ray, n, i)];
  uint32_t thing = pl_embree_hit_instance(arguments->hit, n, i);
  uint32_t triangle = pl_embree_hit_triangle(arguments->hit, n, i);
  pl_tracer_name_owner(tracer, &thing, &triangle);
  if (thing == ray->from_thing &&
      (triangle + 1 == ray->from_triangle || is_left(origins, arguments, i, triangle)))
    return false;
  return !tracer->has_cuts ||
         pl_shot_is_there(&tracer->snapshot->objects[thing], triangle,
                          pl_embree_hit_u(arguments->hit, n, i),
                          pl_embree_hit_v(arguments->hit, n, i), ray->direction);
}

static void sort_out(const struct RTCFilterFunctionNArguments *arguments) {
  const origins *origins = ((const pl_embree_query *)(const void *)arguments->context)->user;
  for (unsigned i = 0; i < arguments->N; i++)
    if (arguments->valid[i] != 0 && !counts(origins, arguments, i))
      arguments->valid[i] = 0;
}

/* A query over `count` rays; without a filter where there are no holes and no ray starts on a
 * triangle. */
static pl_embree_query query_of(const origins *origins, size_t count) {
  pl_embree_query query = {.user = origins, .filter = origins->tracer->has_cuts ? sort_out : NULL};
  for (size_t i = 0; i < count; i++)
    if (origins->rays[i].from_triangle != 0)
      query.filter = sort_out;
  return query;
}

static void fill_ray8(struct RTCRay8 *packet, const pl_ray *rays, size_t count, int *valid) {
  for (size_t i = 0; i < PACKET; i++) {
    const pl_ray *ray = &rays[i < count ? i : 0];
    valid[i] = i < count ? -1 : 0;
    packet->org_x[i] = ray->origin.x;
    packet->org_y[i] = ray->origin.y;
    packet->org_z[i] = ray->origin.z;
    packet->dir_x[i] = ray->direction.x;
    packet->dir_y[i] = ray->direction.y;
    packet->dir_z[i] = ray->direction.z;
    packet->tnear[i] = 0.0f;
    packet->tfar[i] = ray->t_max;
    packet->time[i] = 0.0f;
    packet->mask[i] = UINT32_MAX;
    packet->id[i] = (unsigned)(i < count ? i : 0);
    packet->flags[i] = 0;
  }
}

static void closest_packet(const pl_tracer *tracer, const pl_ray *rays, pl_hit *hits,
                           size_t count) {
  struct RTCRayHit8 packet;
  _Alignas(32) int valid[PACKET];
  fill_ray8(&packet.ray, rays, count, valid);
  for (int i = 0; i < PACKET; i++)
    packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  const origins origins = {tracer, rays};
  pl_embree_query query = query_of(&origins, count);
  pl_embree_intersect8(valid, tracer->top, &query, &packet);
  for (size_t i = 0; i < count; i++) {
    if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID)
      continue;
    hits[i] = (pl_hit){packet.hit.instID[0][i], packet.hit.primID[i], packet.ray.tfar[i],
                       packet.hit.u[i], packet.hit.v[i]};
  }
}

static struct RTCRay single_ray(const pl_ray *ray) {
  return (struct RTCRay){
      .org_x = ray->origin.x,
      .org_y = ray->origin.y,
      .org_z = ray->origin.z,
      .dir_x = ray->direction.x,
      .dir_y = ray->direction.y,
      .dir_z = ray->direction.z,
      .tnear = 0.0f,
      .tfar = ray->t_max,
      .mask = UINT32_MAX,
  };
}

static void closest_single(const pl_tracer *tracer, const pl_ray *ray, pl_hit *hit) {
  struct RTCRayHit query = {.ray = single_ray(ray)};
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  const origins origins = {tracer, ray};
  pl_embree_query way = query_of(&origins, 1);
  pl_embree_intersect1(tracer->top, &way, &query);
  if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID)
    *hit =
        (pl_hit){query.hit.instID[0], query.hit.primID, query.ray.tfar, query.hit.u, query.hit.v};
}

/* Distance to a body, or infinity. The bounding sphere is tried first, with room for the rounding
 * of a direction that is unit in float. */
static double body_distance(const pl_shot_body *body, const pl_ray *ray) {
  if (body->shape != NULL)
    return INFINITY;
  const pl_vec3 o = pl_vec3f_to_double(ray->origin), d = pl_vec3f_to_double(ray->direction);
  const pl_vec3 to_center = pl_vec3_sub(body->center, o);
  const double along = pl_vec3_dot(to_center, d), square = pl_vec3_dot(to_center, to_center);
  const double reach = body->radius_m * body->radius_m * (1.0 + 1e-6) + 1e-6 * square;
  if (square - along * along > reach || (along < 0.0 && square > reach))
    return INFINITY;
  const pl_vec3 origin = pl_vec3_add(body->camera_unit, pl_mat3_mul_vec(body->to_unit, o));
  double t;
  return pl_unit_sphere_intersect(origin, pl_mat3_mul_vec(body->to_unit, d), 0.0, &t) ? t
                                                                                      : INFINITY;
}

static void closest_body(const pl_snapshot *shot, const pl_ray *ray, pl_hit *hit) {
  if (ray->skip_body == PL_EVERY_BODY)
    return;
  for (size_t b = 0; b < shot->body_count; b++) {
    if (ray->skip_body == b)
      continue;
    const double t = body_distance(&shot->bodies[b], ray);
    const double limit = hit->thing != PL_NOTHING ? hit->t : ray->t_max;
    if (t < limit)
      *hit = (pl_hit){.thing = (uint32_t)(shot->object_count + b), .t = (float)t};
  }
}

/* Of coincident faces the last is hit, whatever rounding says. */
static void settle_coincident(const pl_tracer *tracer, const pl_ray *rays, pl_hit *hits,
                              size_t count) {
  for (size_t i = 0; i < count; i++) {
    const origins origins = {tracer, &rays[i]};
    if (hits[i].thing != PL_NOTHING)
      pl_coincident_settle(tracer, &rays[i], counts, &origins, &hits[i]);
  }
}

/* Hits of moving pieces become hits of their objects. */
static void name_owners(const pl_tracer *tracer, pl_hit *hits, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (hits[i].thing != PL_NOTHING)
      pl_tracer_name_owner(tracer, &hits[i].thing, &hits[i].triangle);
}

void pl_tracer_closest(const pl_tracer *tracer, const pl_ray *rays, pl_hit *hits, size_t count,
                       bool coherent, bool meshes) {
  meshes = meshes && tracer->has_meshes;
  for (size_t i = 0; i < count; i++)
    hits[i].thing = PL_NOTHING;
  if (meshes && coherent)
    for (size_t i = 0; i < count; i += PACKET)
      closest_packet(tracer, rays + i, hits + i, count - i < PACKET ? count - i : PACKET);
  else if (meshes)
    for (size_t i = 0; i < count; i++)
      if (!rays[i].no_meshes)
        closest_single(tracer, &rays[i], &hits[i]);
  if (meshes && tracer->has_coincident)
    settle_coincident(tracer, rays, hits, count);
  if (meshes && tracer->has_pieces)
    name_owners(tracer, hits, count);
  for (size_t i = 0; i < count; i++)
    closest_body(tracer->snapshot, &rays[i], &hits[i]);
}

static void occluded_packet(const pl_tracer *tracer, const pl_ray *rays, bool *occluded,
                            size_t count) {
  struct RTCRay8 packet;
  _Alignas(32) int valid[PACKET];
  fill_ray8(&packet, rays, count, valid);
  const origins origins = {tracer, rays};
  pl_embree_query query = query_of(&origins, count);
  pl_embree_occluded8(valid, tracer->top, &query, &packet);
  for (size_t i = 0; i < count; i++)
    occluded[i] = packet.tfar[i] < 0.0f; /* Embree sets -inf on a hit */
}

static bool occluded_single(const pl_tracer *tracer, const pl_ray *ray) {
  struct RTCRay query = single_ray(ray);
  const origins origins = {tracer, ray};
  pl_embree_query way = query_of(&origins, 1);
  pl_embree_occluded1(tracer->top, &way, &query);
  return query.tfar < 0.0f;
}

static bool occluded_by_body(const pl_snapshot *shot, const pl_ray *ray) {
  if (ray->skip_body == PL_EVERY_BODY)
    return false;
  for (size_t b = 0; b < shot->body_count; b++)
    if (ray->skip_body != b && body_distance(&shot->bodies[b], ray) < ray->t_max)
      return true;
  return false;
}

void pl_tracer_occluded(const pl_tracer *tracer, const pl_ray *rays, bool *occluded, size_t count,
                        bool coherent) {
  for (size_t i = 0; i < count; i++)
    occluded[i] = false;
  if (tracer->has_meshes && coherent)
    for (size_t i = 0; i < count; i += PACKET)
      occluded_packet(tracer, rays + i, occluded + i, count - i < PACKET ? count - i : PACKET);
  else if (tracer->has_meshes)
    for (size_t i = 0; i < count; i++)
      occluded[i] = occluded_single(tracer, &rays[i]);
  for (size_t i = 0; i < count; i++)
    occluded[i] = occluded[i] || occluded_by_body(tracer->snapshot, &rays[i]);
}
