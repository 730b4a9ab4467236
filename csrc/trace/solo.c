/* Traces one object or body alone: only its instances are placed. */
#include "trace/solo.h"

#include <string.h>

#include "base/memory.h"
#include "geom/ellipsoid.h"
#include "scene/graph_point.h"
#include "trace/accelerator.h"

struct pl_solo {
  pl_accelerators *kept;  /* borrowed */
  pl_instance *instances; /* owned; room for the largest number so far */
  size_t room, count;
  const pl_shot_object *object; /* the object that is placed; NULL if it has no holes by graphs */
  const pl_shot_body *body;     /* NULL for an object */
  double inner_m; /* rays that meet this sphere about the centre of the terrain meet it; 0: none */
};

pl_status pl_solo_create(pl_accelerators *kept, pl_solo **out) {
  void *memory;
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_solo), "a tracer of single objects", &memory));
  pl_solo *solo = memory;
  *solo = (pl_solo){.kept = kept};
  *out = solo;
  return PL_OK;
}

void pl_solo_destroy(pl_solo *solo) {
  if (solo == NULL)
    return;
  pl_free(solo->instances);
  pl_free(solo);
}

static pl_status make_room(pl_solo *solo, size_t count) {
  if (count > solo->room) {
    pl_instance *grown = pl_realloc(solo->instances, count, sizeof *grown);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for instances");
    solo->instances = grown;
    solo->room = count;
  }
  return PL_OK;
}

pl_status pl_solo_set(pl_solo *solo, const pl_shot_object *object) {
  PL_TRY(make_room(solo, pl_accelerator_count(object)));
  solo->body = NULL;
  solo->object = pl_object_cuts(object->object) ? object : NULL;
  return pl_accelerator_place(solo->kept, object, solo->instances, &solo->count);
}

/* Radius of a sphere that lies below all ground. */
static double inner_m(const pl_shot_body *body) {
  const pl_vec3 r = body->state->radii_m;
  double low_m, high_m;
  pl_terrain_bounds(body->body->terrain, &low_m, &high_m);
  return fmax(fmin(r.x, fmin(r.y, r.z)) + fmin(low_m, 0.0), 0.0);
}

pl_status pl_solo_set_body(pl_solo *solo, const pl_shot_body *body) {
  const bool ground = body->field != NULL;
  PL_TRY(make_room(solo, 1));
  solo->object = NULL;
  solo->body = body;
  solo->count = ground ? 1 : 0;
  solo->inner_m = ground ? inner_m(body) : 0.0;
  if (ground)
    pl_accelerator_place_field(body, 0, &solo->instances[0]);
  return PL_OK;
}

/* What filters of hits need. */
typedef struct hit_query {
  const pl_shot_object *object;
  const pl_instance *instance;
  const pl_vec3 *directions; /* indexed by ray id */
  uint64_t *sets;            /* of parts, by ray id; see pl_solo_find_parts */
  size_t words;              /* of each of them */
} hit_query;

/* Whether a hit is on the surface, and not where a graph leaves none; its triangle is that of the
 * object. */
static bool is_there(const struct RTCFilterFunctionNArguments *arguments, unsigned i,
                     uint32_t *triangle) {
  const hit_query *query = ((const pl_embree_query *)(const void *)arguments->context)->user;
  const unsigned n = arguments->N;
  const pl_vec3 direction = query->directions[pl_embree_ray_id(arguments->ray, n, i)];
  *triangle = query->instance->first + pl_embree_hit_triangle(arguments->hit, n, i);
  return !pl_object_cuts(query->object->object) ||
         pl_shot_is_there(query->object, *triangle, pl_embree_hit_u(arguments->hit, n, i),
                          pl_embree_hit_v(arguments->hit, n, i), pl_vec3_to_float(direction));
}

/* Rejects hits where a graph leaves no surface. */
static void pass_holes(const struct RTCFilterFunctionNArguments *arguments) {
  uint32_t triangle;
  for (unsigned i = 0; i < arguments->N; i++)
    if (arguments->valid[i] != 0 && !is_there(arguments, i, &triangle))
      arguments->valid[i] = 0;
}

/* Notes the parts of all hits, and rejects them, so that rays go on to the end. */
static void note_parts(const struct RTCFilterFunctionNArguments *arguments) {
  const hit_query *query = ((const pl_embree_query *)(const void *)arguments->context)->user;
  uint32_t triangle;
  for (unsigned i = 0; i < arguments->N; i++) {
    if (arguments->valid[i] == 0)
      continue;
    if (is_there(arguments, i, &triangle)) {
      const uint32_t part = pl_object_part(query->object->object, triangle);
      const size_t ray = pl_embree_ray_id(arguments->ray, arguments->N, i);
      query->sets[ray * query->words + part / 64] |= UINT64_C(1) << part % 64;
    }
    arguments->valid[i] = 0;
  }
}

/* Sets met[] for valid rays that hit anything. Meshes with missing back faces are tested with a
 * closest-hit query, since the filter of Embree's occlusion query is made for shadow rays. */
static void meet(const pl_instance *instance, const int32_t *valid, pl_embree_query *way,
                 struct RTCRayHit8 *query, bool met[PL_PACKET]) {
  for (int i = 0; i < PL_PACKET; i++)
    query->hit.geomID[i] = query->hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  if (instance->one_way)
    pl_embree_intersect8(valid, instance->scene, way, query);
  else
    pl_embree_occluded8(valid, instance->scene, way, &query->ray);
  for (int i = 0; i < PL_PACKET; i++) /* Embree sets -inf on an occlusion */
    met[i] = instance->one_way ? query->hit.geomID[i] != RTC_INVALID_GEOMETRY_ID
                               : query->ray.tfar[i] < 0.0f;
}

static void fill_query(const pl_packet *packet, const pl_instance *instance, const pl_entry *entry,
                       size_t count, struct RTCRay8 *ray) {
  pl_approach at;
  pl_packet_approach(packet, instance, entry, &at);
  for (size_t i = 0; i < PL_PACKET; i++) {
    ray->org_x[i] = at.origin[0][i];
    ray->org_y[i] = at.origin[1][i];
    ray->org_z[i] = at.origin[2][i];
    ray->dir_x[i] = at.direction[0][i];
    ray->dir_y[i] = at.direction[1][i];
    ray->dir_z[i] = at.direction[2][i];
    ray->tnear[i] = ray->time[i] = 0.0f;
    ray->tfar[i] = INFINITY;
    ray->mask[i] = UINT32_MAX;
    ray->id[i] = (unsigned)(i < count ? i : 0);
    ray->flags[i] = 0;
  }
}

static void cast_at(const pl_solo *solo, const pl_instance *instance, const pl_vec3 *directions,
                    bool *hits, size_t count, pl_packet *packet, const pl_entry *entry) {
  struct RTCRayHit8 query;
  bool met[PL_PACKET];
  fill_query(packet, instance, entry, count, &query.ray);
  const hit_query holes = {.object = solo->object, .instance = instance, .directions = directions};
  pl_embree_query way = {.user = &holes, .filter = pass_holes};
  meet(instance, entry->valid, solo->object != NULL ? &way : NULL, &query, met);
  for (size_t i = 0; i < count; i++)
    if (entry->valid[i] != 0 && met[i]) {
      hits[i] = true;
      packet->limit[i] = -1.0;
    }
}

/* Whether a ray from the camera meets the ellipsoid, or a sphere below all ground. */
static bool meets_body(const pl_solo *solo, pl_vec3 direction) {
  const pl_shot_body *body = solo->body;
  double t;
  if (solo->count == 0)
    return pl_unit_sphere_intersect(body->camera_unit, pl_mat3_mul_vec(body->to_unit, direction),
                                    0.0, &t);
  const double along = pl_vec3_dot(body->center, direction);
  const double square = pl_vec3_dot(body->center, body->center);
  return along > 0.0 && square - along * along < solo->inner_m * solo->inner_m;
}

static void fill_packet(const pl_vec3 *directions, size_t count, pl_packet *packet) {
  pl_ray rays[PL_PACKET] = {0};
  for (size_t i = 0; i < count; i++)
    rays[i] = (pl_ray){.direction = directions[i], .t_max = INFINITY};
  pl_packet_fill(packet, rays, count);
}

static void cast_packet(const pl_solo *solo, const pl_vec3 *directions, bool *hits, size_t count) {
  pl_packet packet;
  fill_packet(directions, count, &packet);
  for (size_t i = 0; i < count; i++)
    hits[i] = false;
  for (size_t i = 0; i < count && solo->body != NULL; i++)
    if (meets_body(solo, directions[i])) {
      hits[i] = true;
      packet.limit[i] = -1.0;
    }
  for (size_t k = 0; k < solo->count; k++) {
    const pl_instance *instance = &solo->instances[k];
    pl_entry entry;
    if (pl_packet_enter(&packet, instance->center, instance->radius_m, &entry))
      cast_at(solo, instance, directions, hits, count, &packet, &entry);
  }
}

void pl_solo_cast(const pl_solo *solo, const pl_vec3 *directions, bool *hits, size_t count) {
  for (size_t i = 0; i < count; i += PL_PACKET)
    cast_packet(solo, directions + i, hits + i, count - i < PL_PACKET ? count - i : PL_PACKET);
}

static void find_in_packet(const pl_solo *solo, const pl_shot_object *object,
                           const pl_vec3 *directions, size_t count, uint64_t *sets, size_t words) {
  pl_packet packet;
  fill_packet(directions, count, &packet);
  for (size_t k = 0; k < solo->count; k++) {
    const pl_instance *instance = &solo->instances[k];
    struct RTCRayHit8 query;
    bool met[PL_PACKET];
    pl_entry entry;
    if (!pl_packet_enter(&packet, instance->center, instance->radius_m, &entry))
      continue;
    fill_query(&packet, instance, &entry, count, &query.ray);
    const hit_query all = {object, instance, directions, sets, words};
    pl_embree_query way = {.user = &all, .filter = note_parts};
    meet(instance, entry.valid, &way, &query, met);
  }
}

void pl_solo_find_parts(const pl_solo *solo, const pl_shot_object *object,
                        const pl_vec3 *directions, size_t count, uint64_t *sets, size_t words) {
  memset(sets, 0, count * words * sizeof *sets);
  for (size_t i = 0; i < count; i += PL_PACKET)
    find_in_packet(solo, object, directions + i, count - i < PL_PACKET ? count - i : PL_PACKET,
                   sets + i * words, words);
}
