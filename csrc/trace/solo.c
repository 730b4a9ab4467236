/* One object alone: an Embree scene of a single instance, moved from object to object. */
#include "trace/solo.h"

#include "base/memory.h"
#include "trace/accelerator.h"

enum { PACKET = 8 };

struct pl_solo {
  pl_tracer *tracer;    /* borrowed */
  RTCScene scene;       /* owned; holds `instance` alone */
  RTCGeometry instance; /* owned */
};

pl_status pl_solo_create(pl_tracer *tracer, pl_solo **out) {
  void *memory;
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_solo), "a tracer of single objects", &memory));
  pl_solo *solo = memory;
  *solo = (pl_solo){
      .tracer = tracer,
      .scene = rtcNewScene(tracer->device),
      .instance = rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_INSTANCE),
  };
  pl_status status = pl_accelerator_check(tracer, "opening a scene of one object");
  if (status != PL_OK) {
    pl_solo_destroy(solo);
    return status;
  }
  rtcSetSceneFlags(solo->scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC);
  rtcAttachGeometryByID(solo->scene, solo->instance, 0);
  *out = solo;
  return PL_OK;
}

void pl_solo_destroy(pl_solo *solo) {
  if (solo == NULL)
    return;
  if (solo->instance != NULL)
    rtcReleaseGeometry(solo->instance);
  if (solo->scene != NULL)
    rtcReleaseScene(solo->scene);
  pl_free(solo);
}

pl_status pl_solo_set(pl_solo *solo, const pl_shot_object *object) {
  RTCScene model = NULL;
  PL_TRY(pl_accelerator_of_model(solo->tracer, object->object->model, &model));
  rtcSetGeometryInstancedScene(solo->instance, model);
  rtcSetGeometryTransform(solo->instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, object->to_view);
  rtcCommitGeometry(solo->instance);
  rtcCommitScene(solo->scene);
  return pl_accelerator_check(solo->tracer, "placing one object");
}

static void cast_packet(RTCScene scene, const pl_vec3f *directions, bool *hits, size_t count) {
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
    packet.id[i] = packet.flags[i] = 0;
  }
  pl_embree_occluded8(valid, scene, &packet);
  for (size_t i = 0; i < count; i++)
    hits[i] = packet.tfar[i] < 0.0f; /* Embree sets -inf on a hit */
}

void pl_solo_cast(const pl_solo *solo, const pl_vec3f *directions, bool *hits, size_t count) {
  for (size_t i = 0; i < count; i += PACKET)
    cast_packet(solo->scene, directions + i, hits + i, count - i < PACKET ? count - i : PACKET);
}
