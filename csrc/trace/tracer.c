/* Casts rays: first at the instances whose bounding spheres they enter, then at the kinds of
 * geometry with a closed form. The nearest hit is returned. */
#include "trace/tracer.h"

#include "base/work.h"
#include "scene/graph_point.h"
#include "scene/shot_frame.h"
#include "trace/accelerator.h"
#include "trace/coincident.h"
#include "trace/ground_leak.h"

#define PL_TEXT_OF(x) #x
#define PL_TEXT(x) PL_TEXT_OF(x)

const char *pl_tracer_version(void) {
  return PL_TEXT(RTC_VERSION_MAJOR) "." PL_TEXT(RTC_VERSION_MINOR) "." PL_TEXT(RTC_VERSION_PATCH);
}

/* Context of a query's filter: the rays in metres, and the transformation to their current
 * distances. */
typedef struct visit {
  const pl_tracer *tracer;
  const pl_instance *instance;
  const pl_ray *rays; /* indexed by ray id */
  const double *start_m, *per_metre;
} visit;

/* Returns whether ray `i`, which starts on this mesh, ignores this hit because it is about to leave
 * the surface: it meets the facet from behind, or has an outward direction by the interpolated
 * shading normal. */
static bool is_left(const visit *visit, const struct RTCFilterFunctionNArguments *arguments,
                    unsigned i, uint32_t triangle) {
  const unsigned n = arguments->N, id = pl_embree_ray_id(arguments->ray, n, i);
  const pl_ray *ray = &visit->rays[id];
  const double far = (double)pl_embree_ray_far(arguments->ray, n, i);
  if (!(visit->start_m[id] + far / visit->per_metre[id] < (double)ray->leaves))
    return false;
  if (pl_embree_from_behind(arguments->ray, arguments->hit, n, i))
    return true;
  const pl_shot_object *object = pl_shot_object_of(visit->tracer->snapshot, ray->from_surface);
  const pl_model *model = object->object->model;
  const float u = pl_embree_hit_u(arguments->hit, n, i), v = pl_embree_hit_v(arguments->hit, n, i);
  const float w[3] = {1.0f - u - v, u, v};
  const pl_vec3f normal = pl_shot_mix3(model->normals, 3, model->indices + 3 * (size_t)triangle, w);
  return pl_vec3f_dot(pl_shot_rotate(&object->rotation, normal), pl_vec3_to_float(ray->direction)) >
         0.0f;
}

/* Returns whether ray `i` starts on one of two back-to-back sheets and meets the other. Rounding
 * may put that in front of the first, by up to `hair`. */
static bool is_between(const pl_instance *instance, const pl_ray *ray,
                       const struct RTCFilterFunctionNArguments *arguments, unsigned i,
                       uint32_t triangle) {
  const pl_model *model = instance->model;
  /* out of range for another piece */
  const uint32_t from = ray->from_triangle - 1 - instance->first;
  if (model->backed == NULL || model->backed[triangle] == 0 || from >= model->triangle_count ||
      model->backed[from] == 0)
    return false;
  return pl_embree_height(arguments->ray, arguments->hit, arguments->N, i) <= model->hair;
}

/* Returns whether candidate `i` is a valid hit. Excluded are the triangle that the ray starts on
 * (rounding in the units of a long mesh can put the origin behind it again, however far it was
 * offset) and points where a graph leaves no surface. */
static bool counts(const void *context, const struct RTCFilterFunctionNArguments *arguments,
                   unsigned i) {
  const visit *visit = context;
  const pl_instance *instance = visit->instance;
  const unsigned n = arguments->N;
  const pl_ray *ray = &visit->rays[pl_embree_ray_id(arguments->ray, n, i)];
  const uint32_t triangle = instance->first + pl_embree_hit_triangle(arguments->hit, n, i);
  if (pl_surface_same(instance->surface_id, ray->from_surface) &&
      (triangle + 1 == ray->from_triangle || is_left(visit, arguments, i, triangle) ||
       is_between(instance, ray, arguments, i, triangle - instance->first)))
    return false;
  return !instance->cuts ||
         pl_shot_is_there(pl_shot_object_of(visit->tracer->snapshot, instance->surface_id),
                          triangle, pl_embree_hit_u(arguments->hit, n, i),
                          pl_embree_hit_v(arguments->hit, n, i), pl_vec3_to_float(ray->direction));
}

static void sort_out(const struct RTCFilterFunctionNArguments *arguments) {
  const visit *visit = ((const pl_embree_query *)(const void *)arguments->context)->user;
  for (unsigned i = 0; i < arguments->N; i++)
    if (arguments->valid[i] != 0 && !counts(visit, arguments, i))
      arguments->valid[i] = 0;
}

/* Returns a query over `count` rays. It has no filter if there are no holes and no ray starts on a
 * triangle of the instance. */
static pl_embree_query query_of(const visit *visit, size_t count) {
  pl_embree_query query = {.user = visit, .filter = visit->instance->cuts ? sort_out : NULL};
  for (size_t i = 0; i < count; i++)
    if (visit->rays[i].from_triangle != 0 &&
        pl_surface_same(visit->rays[i].from_surface, visit->instance->surface_id))
      query.filter = sort_out;
  return query;
}

/* Faces of two objects that differ by less than this fraction of their sizes along a ray count as
 * coincident. */
#define ONE_PLACE 0x1p-19
/* A ray that starts on an object may also start on a coincident face of another one: it ignores
 * hits nearer than this, in mesh units. */
static const float TOUCHING = 0x1p-20f;

/* Returns the distance in m up to which a hit on an instance replaces the best one so far. A later
 * object that coincides with it may even be slightly farther away. */
static double limit_of(const pl_tracer *tracer, const pl_instance *instance, const pl_hit *best,
                       double t_max) {
  if (pl_surface_is_none(best->surface_id))
    return t_max;
  if (instance->tiled || !pl_surface_is_mesh(best->surface_id))
    return best->t;
  const bool same = pl_surface_same(best->surface_id, instance->surface_id);
  const double size =
      instance->size_m + pl_shot_object_of(tracer->snapshot, best->surface_id)->radius_m;
  const bool later =
      same ? instance->first > best->triangle
           : pl_surface_index(instance->surface_id) > pl_surface_index(best->surface_id);
  return best->t + (later ? size : -size) * (same ? 0.5 * ONE_PLACE : ONE_PLACE);
}

static float near_of(const pl_ray *ray, const pl_instance *instance, double start_m) {
  const bool touches = start_m == 0.0 && ray->from_triangle != 0 &&
                       !pl_surface_same(ray->from_surface, instance->surface_id);
  return touches ? TOUCHING : 0.0f;
}

static void fill_ray8(struct RTCRay8 *packet, const pl_approach *at, const pl_entry *entry,
                      const double *limit_m, const pl_ray *rays, size_t count,
                      const pl_instance *instance) {
  for (size_t i = 0; i < PL_PACKET; i++) {
    const double way_m = limit_m[i] - entry->start_m[i];
    packet->org_x[i] = at->origin[0][i];
    packet->org_y[i] = at->origin[1][i];
    packet->org_z[i] = at->origin[2][i];
    packet->dir_x[i] = at->direction[0][i];
    packet->dir_y[i] = at->direction[1][i];
    packet->dir_z[i] = at->direction[2][i];
    packet->tnear[i] = near_of(&rays[i < count ? i : 0], instance, entry->start_m[i]);
    packet->tfar[i] = (float)(way_m * at->per_metre[i]);
    packet->time[i] = 0.0f;
    packet->mask[i] = UINT32_MAX;
    packet->id[i] = (unsigned)(i < count ? i : 0);
    packet->flags[i] = 0;
  }
}

/* Returns the surface that was hit, by Embree's ids; `triangle` becomes the tile for the ground of
 * a height field, and the triangle among those of all tiles for its rocks. */
static pl_surface_id surface_of(const pl_instance *instance, unsigned geometry, unsigned tile,
                                uint32_t *triangle) {
  if (!instance->tiled)
    return instance->surface_id;
  if (geometry != PL_TILE_ROCKS) {
    *triangle = tile;
    return instance->surface_id;
  }
  *triangle += instance->first_rocks[tile];
  return pl_surface_make(PL_SURFACE_ROCKS, pl_surface_index(instance->surface_id));
}

/* Stores a hit on a surface of an instance as the ray's best, if it lies within the limit. hit->t
 * is relative to the start of the approach. */
static void take(const pl_tracer *tracer, const pl_instance *instance, pl_surface_id id,
                 const pl_ray *ray, const pl_lone_approach *at, double limit_m, pl_mesh_hit *hit,
                 pl_hit *best) {
  if (instance->coincident != NULL) {
    const visit visit = {tracer, instance, ray, &at->start_m, &at->per_metre};
    pl_coincident_choose(instance, at, counts, &visit, hit);
  }
  const double t = at->start_m + (double)hit->t / at->per_metre;
  if (t <= limit_m)
    *best = (pl_hit){.surface_id = id,
                     .triangle = instance->first + hit->triangle,
                     .u = hit->u,
                     .v = hit->v,
                     .t = t};
}

static void closest_packet_in(const pl_tracer *tracer, const pl_instance *instance,
                              const pl_ray *rays, pl_hit *hits, size_t count, pl_packet *packet,
                              const pl_entry *entry) {
  struct RTCRayHit8 query;
  pl_approach at;
  double limit_m[PL_PACKET];
  pl_packet_approach(packet, instance, entry, &at);
  for (size_t i = 0; i < PL_PACKET; i++)
    limit_m[i] = i < count ? limit_of(tracer, instance, &hits[i], rays[i].t_max) : -1.0;
  fill_ray8(&query.ray, &at, entry, limit_m, rays, count, instance);
  for (int i = 0; i < PL_PACKET; i++)
    query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  const visit visit = {tracer, instance, rays, entry->start_m, at.per_metre};
  pl_embree_query way = query_of(&visit, count);
  pl_embree_intersect8(entry->valid, instance->scene, &way, &query);
  for (size_t i = 0; i < count; i++) {
    if (entry->valid[i] == 0 || query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID)
      continue;
    if (instance->tiled)
      pl_ground_mend_lane(instance->scene, &way, &query, (unsigned)i);
    const pl_lone_approach lone = {
        {at.origin[0][i], at.origin[1][i], at.origin[2][i]},
        {at.direction[0][i], at.direction[1][i], at.direction[2][i]},
        entry->start_m[i],
        at.per_metre[i],
    };
    pl_mesh_hit hit = {query.hit.primID[i], query.ray.tfar[i], query.hit.u[i], query.hit.v[i]};
    const pl_surface_id id =
        surface_of(instance, query.hit.geomID[i], query.hit.instID[0][i], &hit.triangle);
    take(tracer, instance, id, &rays[i], &lone, limit_m[i], &hit, &hits[i]);
    packet->limit[i] = hits[i].t;
  }
}

/* Returns the next instance, from sphere *k on, whose bounding sphere a ray of the packet enters,
 * or NULL. */
static const pl_instance *next_of_packet(const pl_tracer *tracer, const pl_packet *packet,
                                         size_t *k, pl_entry *entry) {
  while (*k < tracer->tree.count) {
    const pl_sphere *sphere = &tracer->tree.nodes[*k];
    const bool entered = pl_packet_enter(packet, sphere->center, sphere->radius_m, entry);
    *k = pl_sphere_next(&tracer->tree, *k, entered);
    if (entered && sphere->item != PL_INNER_NODE)
      return &tracer->instances[sphere->item];
  }
  return NULL;
}

static void closest_packet(const pl_tracer *tracer, const pl_ray *rays, pl_hit *hits,
                           size_t count) {
  pl_packet packet;
  pl_entry entry;
  const pl_instance *instance;
  size_t entered[2] = {0, 0};
  pl_packet_fill(&packet, rays, count);
  for (size_t k = 0; (instance = next_of_packet(tracer, &packet, &k, &entry)) != NULL;) {
    closest_packet_in(tracer, instance, rays, hits, count, &packet, &entry);
    entered[instance->tiled] += count;
  }
  pl_work_add(PL_WORK_packet_rays, entered[0]);
  pl_work_add(PL_WORK_ground_rays, entered[1]);
}

/* The same for one ray, up to a limit. */
static const pl_instance *next_of_ray(const pl_tracer *tracer, const pl_ray *ray, double limit_m,
                                      size_t *k, double *start_m) {
  while (*k < tracer->tree.count) {
    const pl_sphere *sphere = &tracer->tree.nodes[*k];
    const bool entered = pl_ray_enter(ray, limit_m, sphere->center, sphere->radius_m, start_m);
    *k = pl_sphere_next(&tracer->tree, *k, entered);
    if (entered && sphere->item != PL_INNER_NODE)
      return &tracer->instances[sphere->item];
  }
  return NULL;
}

static struct RTCRay single_ray(const pl_lone_approach *at, float near, double limit_m) {
  return (struct RTCRay){
      .org_x = at->origin.x,
      .org_y = at->origin.y,
      .org_z = at->origin.z,
      .dir_x = at->direction.x,
      .dir_y = at->direction.y,
      .dir_z = at->direction.z,
      .tnear = near,
      .tfar = (float)((limit_m - at->start_m) * at->per_metre),
      .mask = UINT32_MAX,
  };
}

static void closest_single_in(const pl_tracer *tracer, const pl_instance *instance,
                              const pl_ray *ray, double start_m, pl_hit *best) {
  const pl_lone_approach at = pl_ray_approach(ray, instance, start_m);
  const double limit_m = limit_of(tracer, instance, best, ray->t_max);
  struct RTCRayHit query = {.ray = single_ray(&at, near_of(ray, instance, start_m), limit_m)};
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  const visit visit = {tracer, instance, ray, &at.start_m, &at.per_metre};
  pl_embree_query way = query_of(&visit, 1);
  pl_embree_intersect1(instance->scene, &way, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID)
    return;
  if (instance->tiled)
    pl_ground_mend(instance->scene, &way, &query);
  pl_mesh_hit hit = {query.hit.primID, query.ray.tfar, query.hit.u, query.hit.v};
  const pl_surface_id id =
      surface_of(instance, query.hit.geomID, query.hit.instID[0], &hit.triangle);
  take(tracer, instance, id, ray, &at, limit_m, &hit, best);
}

static void closest_single(const pl_tracer *tracer, const pl_ray *ray, pl_hit *hit) {
  const pl_instance *instance;
  size_t entered[2] = {0, 0};
  double start_m;
  double limit_m = ray->t_max;
  for (size_t k = 0; (instance = next_of_ray(tracer, ray, limit_m, &k, &start_m)) != NULL;) {
    closest_single_in(tracer, instance, ray, start_m, hit);
    limit_m = !pl_surface_is_none(hit->surface_id) ? hit->t : ray->t_max;
    entered[instance->tiled]++;
  }
  pl_work_add(PL_WORK_single_rays, entered[0]);
  pl_work_add(PL_WORK_single_ground_rays, entered[1]);
}

void pl_tracer_closest(const pl_tracer *tracer, const pl_ray *rays, pl_hit *hits, size_t count,
                       bool coherent, bool meshes) {
  meshes = meshes && tracer->instance_count > 0;
  if (meshes && tracer->log != NULL)
    pl_ray_log_add(tracer->log, PL_LOG_CLOSEST, rays, count);
  for (size_t i = 0; i < count; i++)
    hits[i].surface_id = PL_NO_SURFACE;
  if (meshes && coherent)
    for (size_t i = 0; i < count; i += PL_PACKET)
      closest_packet(tracer, rays + i, hits + i, count - i < PL_PACKET ? count - i : PL_PACKET);
  else if (meshes)
    for (size_t i = 0; i < count; i++)
      if (!rays[i].no_meshes)
        closest_single(tracer, &rays[i], &hits[i]);
  pl_work_add(PL_WORK_body_rays, count * tracer->closed_count);
  for (size_t k = 0; k < tracer->closed_count; k++)
    tracer->closed[k]->closest(tracer->snapshot, rays, hits, count);
}

static void occluded_packet_in(const pl_tracer *tracer, const pl_instance *instance,
                               const pl_ray *rays, bool *occluded, size_t count, pl_packet *packet,
                               const pl_entry *entry) {
  struct RTCRay8 query;
  pl_approach at;
  pl_packet_approach(packet, instance, entry, &at);
  fill_ray8(&query, &at, entry, packet->limit, rays, count, instance);
  const visit visit = {tracer, instance, rays, entry->start_m, at.per_metre};
  pl_embree_query way = query_of(&visit, count);
  pl_embree_occluded8(entry->valid, instance->scene, &way, &query);
  for (size_t i = 0; i < count; i++)
    if (entry->valid[i] != 0 && query.tfar[i] < 0.0f) { /* Embree sets -inf on a hit */
      occluded[i] = true;
      packet->limit[i] = -1.0;
    }
}

static void occluded_packet(const pl_tracer *tracer, const pl_ray *rays, bool *occluded,
                            size_t count) {
  pl_packet packet;
  pl_entry entry;
  const pl_instance *instance;
  size_t entered[2] = {0, 0};
  pl_packet_fill(&packet, rays, count);
  for (size_t k = 0; (instance = next_of_packet(tracer, &packet, &k, &entry)) != NULL;) {
    occluded_packet_in(tracer, instance, rays, occluded, count, &packet, &entry);
    entered[instance->tiled] += count;
  }
  pl_work_add(PL_WORK_shadow_rays, entered[0]);
  pl_work_add(PL_WORK_shadow_ground_rays, entered[1]);
}

static bool occluded_single_in(const pl_tracer *tracer, const pl_instance *instance,
                               const pl_ray *ray, double start_m) {
  const pl_lone_approach at = pl_ray_approach(ray, instance, start_m);
  struct RTCRay query = single_ray(&at, near_of(ray, instance, start_m), ray->t_max);
  const visit visit = {tracer, instance, ray, &at.start_m, &at.per_metre};
  pl_embree_query way = query_of(&visit, 1);
  pl_embree_occluded1(instance->scene, &way, &query);
  return query.tfar < 0.0f;
}

static bool occluded_single(const pl_tracer *tracer, const pl_ray *ray) {
  const pl_instance *instance;
  double start_m;
  for (size_t k = 0; (instance = next_of_ray(tracer, ray, ray->t_max, &k, &start_m)) != NULL;) {
    pl_work_add(instance->tiled ? PL_WORK_shadow_ground_rays : PL_WORK_shadow_rays, 1);
    if (occluded_single_in(tracer, instance, ray, start_m))
      return true;
  }
  return false;
}

void pl_tracer_occluded(const pl_tracer *tracer, const pl_ray *rays, bool *occluded, size_t count,
                        bool coherent) {
  if (tracer->instance_count > 0 && tracer->log != NULL)
    pl_ray_log_add(tracer->log, PL_LOG_SHADOW, rays, count);
  for (size_t i = 0; i < count; i++)
    occluded[i] = false;
  if (tracer->instance_count > 0 && coherent)
    for (size_t i = 0; i < count; i += PL_PACKET)
      occluded_packet(tracer, rays + i, occluded + i,
                      count - i < PL_PACKET ? count - i : PL_PACKET);
  else if (tracer->instance_count > 0)
    for (size_t i = 0; i < count; i++)
      occluded[i] = occluded_single(tracer, &rays[i]);
  pl_work_add(PL_WORK_body_rays, count * tracer->closed_count);
  for (size_t k = 0; k < tracer->closed_count; k++)
    tracer->closed[k]->occluded(tracer->snapshot, rays, occluded, count);
}
