/* One object alone: an Embree scene of one instance a piece, moved from object to object. */
#include "trace/solo.h"

#include "base/memory.h"
#include "scene/graph_point.h"
#include "trace/accelerator.h"

enum { PACKET = 8 };

typedef struct slot {
  RTCGeometry instance; /* owned */
  bool attached;        /* under the slot's number */
} slot;

struct pl_solo {
  pl_tracer *tracer; /* borrowed */
  RTCScene scene;    /* owned; holds the attached instances */
  slot *slots;       /* owned; as many as any object has had pieces */
  size_t count;
  const pl_shot_object *object; /* that is placed; NULL if nothing cuts holes into it */
};

pl_status pl_solo_create(pl_tracer *tracer, pl_solo **out) {
  void *memory;
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_solo), "a tracer of single objects", &memory));
  pl_solo *solo = memory;
  *solo = (pl_solo){
      .tracer = tracer,
      .scene = rtcNewScene(tracer->device),
  };
  pl_status status = pl_accelerator_check(tracer, "opening a scene of one object");
  if (status != PL_OK) {
    pl_solo_destroy(solo);
    return status;
  }
  rtcSetSceneFlags(solo->scene,
                   RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC | PL_EMBREE_QUERY_FILTERS);
  *out = solo;
  return PL_OK;
}

void pl_solo_destroy(pl_solo *solo) {
  if (solo == NULL)
    return;
  for (size_t i = 0; i < solo->count; i++)
    rtcReleaseGeometry(solo->slots[i].instance);
  pl_free(solo->slots);
  if (solo->scene != NULL)
    rtcReleaseScene(solo->scene);
  pl_free(solo);
}

static pl_status grow(pl_solo *solo, size_t count) {
  if (count <= solo->count)
    return PL_OK;
  slot *grown = pl_realloc(solo->slots, count, sizeof *grown);
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for instances");
  solo->slots = grown;
  for (; solo->count < count; solo->count++)
    grown[solo->count] =
        (slot){rtcNewGeometry(solo->tracer->device, RTC_GEOMETRY_TYPE_INSTANCE), false};
  return pl_accelerator_check(solo->tracer, "opening a scene of one object");
}

static void detach(pl_solo *solo, size_t index) {
  if (solo->slots[index].attached)
    rtcDetachGeometry(solo->scene, (unsigned)index);
  solo->slots[index].attached = false;
}

static pl_status place(pl_solo *solo, size_t index, const pl_model *model,
                       const float to_view[12]) {
  slot *slot = &solo->slots[index];
  const pl_model_accelerator *kept = NULL;
  PL_TRY(pl_accelerator_of_model(solo->tracer, model, &kept));
  rtcSetGeometryInstancedScene(slot->instance, kept->scene);
  rtcSetGeometryTransform(slot->instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, to_view);
  rtcCommitGeometry(slot->instance);
  if (!slot->attached)
    rtcAttachGeometryByID(solo->scene, slot->instance, (unsigned)index);
  slot->attached = true;
  return PL_OK;
}

pl_status pl_solo_set(pl_solo *solo, const pl_shot_object *object) {
  const size_t count = object->pieces != NULL ? object->piece_count : 1;
  PL_TRY(grow(solo, count));
  solo->object = pl_object_cuts(object->object) ? object : NULL;
  for (size_t i = 0; i < solo->count; i++) {
    if (i >= count || (object->pieces != NULL && !object->pieces[i].present))
      detach(solo, i);
    else if (object->pieces != NULL)
      PL_TRY(place(solo, i, object->pieces[i].model, object->pieces[i].to_view));
    else
      PL_TRY(place(solo, i, object->object->model, object->to_view));
  }
  rtcCommitScene(solo->scene);
  return pl_accelerator_check(solo->tracer, "placing one object");
}

typedef struct looks {
  const pl_shot_object *object;
  const pl_vec3f *directions; /* by the number of the ray */
} looks;

/* Lets rays pass where a graph leaves no surface. */
static void pass_holes(const struct RTCFilterFunctionNArguments *arguments) {
  const looks *looks = ((const pl_embree_query *)(const void *)arguments->context)->user;
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; i++) {
    if (arguments->valid[i] == 0)
      continue;
    uint32_t triangle = pl_embree_hit_triangle(arguments->hit, n, i);
    if (looks->object->pieces != NULL)
      triangle +=
          (uint32_t)looks->object->object->cut->first[pl_embree_hit_instance(arguments->hit, n, i)];
    if (!pl_shot_is_there(looks->object, triangle, pl_embree_hit_u(arguments->hit, n, i),
                          pl_embree_hit_v(arguments->hit, n, i),
                          looks->directions[pl_embree_ray_id(arguments->ray, n, i)]))
      arguments->valid[i] = 0;
  }
}

static void cast_packet(const pl_solo *solo, const pl_vec3f *directions, bool *hits, size_t count) {
  struct RTCRay8 packet;
  _Alignas(32) int valid[PACKET];
  for (size_t i = 0; i < PACKET; i++) {
    const pl_vec3f d = directions[i < count ? i : 0];
    valid[i] = i < count ? -1 : 0;
    packet.org_x[i] = packet.org_y[i] = packet.org_z[i] = 0.0f;
    packet.dir_x[i] = d.x;
    packet.dir_y[i] = d.y;
    packet.dir_z[i] = d.z;
    packet.tnear[i] = packet.time[i] = 0.0f;
    packet.tfar[i] = INFINITY;
    packet.mask[i] = UINT32_MAX;
    packet.id[i] = (unsigned)(i < count ? i : 0);
    packet.flags[i] = 0;
  }
  const looks looks = {solo->object, directions};
  pl_embree_query query = {.user = &looks, .filter = pass_holes};
  pl_embree_occluded8(valid, solo->scene, solo->object != NULL ? &query : NULL, &packet);
  for (size_t i = 0; i < count; i++)
    hits[i] = packet.tfar[i] < 0.0f; /* Embree sets -inf on a hit */
}

void pl_solo_cast(const pl_solo *solo, const pl_vec3f *directions, bool *hits, size_t count) {
  for (size_t i = 0; i < count; i += PACKET)
    cast_packet(solo, directions + i, hits + i, count - i < PACKET ? count - i : PACKET);
}
