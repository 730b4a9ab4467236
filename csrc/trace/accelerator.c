/* Building and moving Embree scenes. */
#include "trace/accelerator.h"

#include "base/memory.h"
#include "scene/graph_point.h"
#include "trace/coincident.h"

pl_status pl_accelerator_check(const pl_tracer *tracer, const char *doing) {
  const enum RTCError error = rtcGetDeviceError(tracer->device);
  if (error == RTC_ERROR_NONE)
    return PL_OK;
  if (error == RTC_ERROR_OUT_OF_MEMORY)
    return pl_fail(PL_E_MEMORY, "Embree is out of memory while %s", doing);
  return pl_fail(PL_E_DEVICE, "Embree error %d while %s", (int)error, doing);
}

/* Whether the surface is there for ray `i`. The back of a single-sided material is not (glTF 2.0,
 * 3.9.6): published models put two such sheets back to back, a hair apart in either order, and rely
 * on it. Light passes where sight does, so that neither sheet shades the other. Below an opacity of
 * one half there is no surface either. */
static bool is_there(const struct RTCFilterFunctionNArguments *arguments, unsigned i) {
  const pl_model *model = arguments->geometryUserPtr;
  const unsigned n = arguments->N;
  const uint32_t triangle = pl_embree_hit_triangle(arguments->hit, n, i);
  const pl_material *material = pl_material_of(model, triangle);
  if (!material->double_sided && pl_embree_from_behind(arguments->ray, arguments->hit, n, i))
    return false;
  if (material->alpha_mode == PL_ALPHA_OPAQUE)
    return true;
  const float u = pl_embree_hit_u(arguments->hit, n, i);
  const float v = pl_embree_hit_v(arguments->hit, n, i);
  const pl_triangle_point point = {.triangle = triangle, .w = {1.0f - u - v, u, v}};
  return pl_material_opacity(model, &point) >= 0.5f;
}

static void presence_filter(const struct RTCFilterFunctionNArguments *arguments) {
  for (unsigned i = 0; i < arguments->N; i++)
    if (arguments->valid[i] != 0 && !is_there(arguments, i))
      arguments->valid[i] = 0;
}

/* Models that are opaque and double-sided throughout are traced without a filter. */
static void set_filter(RTCGeometry geometry, const pl_model *model) {
  bool always_there = true;
  for (size_t i = 0; i < model->material_count; i++)
    always_there &=
        model->materials[i].double_sided && model->materials[i].alpha_mode == PL_ALPHA_OPAQUE;
  if (always_there)
    return;
  rtcSetGeometryUserData(geometry, (void *)(uintptr_t)model);
  rtcSetGeometryIntersectFilterFunction(geometry, presence_filter);
  rtcSetGeometryOccludedFilterFunction(geometry, presence_filter);
}

static void share_buffers(RTCGeometry geometry, const pl_model *model) {
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             model->positions, 0, 3 * sizeof(float), model->vertex_count);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, model->indices,
                             0, 3 * sizeof(uint32_t), model->triangle_count);
}

static pl_status build_model(pl_tracer *tracer, const pl_model *model, RTCScene *out) {
  RTCScene scene = rtcNewScene(tracer->device);
  RTCGeometry geometry = rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | PL_EMBREE_QUERY_FILTERS);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
  share_buffers(geometry, model);
  set_filter(geometry, model);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  const pl_status status = pl_accelerator_check(tracer, "building a model's accelerator");
  if (status != PL_OK)
    rtcReleaseScene(scene);
  else
    *out = scene;
  return status;
}

pl_status pl_accelerator_of_model(pl_tracer *tracer, const pl_model *model,
                                  const pl_model_accelerator **out) {
  for (size_t i = 0; i < tracer->model_count; i++) {
    if (tracer->models[i].model == model) {
      *out = &tracer->models[i];
      return PL_OK;
    }
  }
  pl_model_accelerator *grown = pl_realloc(tracer->models, tracer->model_count + 1, sizeof *grown);
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for accelerators");
  tracer->models = grown;
  pl_model_accelerator *made = &tracer->models[tracer->model_count];
  *made = (pl_model_accelerator){.model = model};
  PL_TRY(pl_coincident_find(model, &made->coincident));
  const pl_status status = build_model(tracer, model, &made->scene);
  if (status != PL_OK) {
    pl_free(made->coincident);
    return status;
  }
  tracer->model_count++;
  *out = made;
  return PL_OK;
}

static void remove_instance(pl_tracer *tracer, size_t index) {
  pl_instance *instance = &tracer->instances[index];
  if (instance->model == NULL)
    return;
  rtcDetachGeometry(tracer->top, (unsigned)index);
  rtcReleaseGeometry(instance->geometry);
  *instance = (pl_instance){0};
}

static pl_status place_instance(pl_tracer *tracer, size_t index, const pl_model *model,
                                const float to_view[12], double radius_m) {
  pl_instance *instance = &tracer->instances[index];
  if (instance->model != model) {
    const pl_model_accelerator *kept = NULL;
    remove_instance(tracer, index);
    PL_TRY(pl_accelerator_of_model(tracer, model, &kept));
    instance->geometry = rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_INSTANCE);
    instance->model = model;
    instance->coincident = kept->coincident;
    rtcSetGeometryInstancedScene(instance->geometry, kept->scene);
    rtcAttachGeometryByID(tracer->top, instance->geometry, (unsigned)index);
  }
  instance->radius_m = radius_m;
  rtcSetGeometryTransform(instance->geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, to_view);
  rtcCommitGeometry(instance->geometry);
  tracer->has_meshes = true;
  tracer->has_coincident |= instance->coincident != NULL;
  return PL_OK;
}

static pl_status grow(pl_tracer *tracer, size_t count) {
  if (count <= tracer->instance_count)
    return PL_OK;
  pl_instance *instances = pl_realloc(tracer->instances, count, sizeof *instances);
  if (instances != NULL)
    tracer->instances = instances;
  pl_piece_owner *owners = pl_realloc(tracer->owners, count, sizeof *owners);
  if (owners != NULL)
    tracer->owners = owners;
  if (instances == NULL || owners == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for instances");
  for (size_t i = tracer->instance_count; i < count; i++)
    instances[i] = (pl_instance){0};
  tracer->instance_count = count;
  return PL_OK;
}

/* Piece 0 takes the object's own instance, the others those from `next` on. */
static pl_status place_pieces(pl_tracer *tracer, size_t index, const pl_shot_object *object,
                              size_t next) {
  for (size_t k = 0; k < object->piece_count; k++) {
    const pl_shot_piece *piece = &object->pieces[k];
    const size_t at = k == 0 ? index : next + k - 1;
    tracer->owners[at] = (pl_piece_owner){(uint32_t)index, (uint32_t)object->object->cut->first[k]};
    if (object->kept && piece->present)
      PL_TRY(place_instance(tracer, at, piece->model, piece->to_view, object->radius_m));
    else
      remove_instance(tracer, at);
  }
  return PL_OK;
}

/* Instances of objects that have later ones within their spheres: only there may faces of two
 * objects lie in one place. */
static void find_overlaps(pl_tracer *tracer, const pl_snapshot *shot) {
  for (size_t i = 0; i < shot->object_count; i++) {
    const pl_shot_object *a = &shot->objects[i];
    bool overlapped = false;
    for (size_t j = i + 1; a->kept && !overlapped && j < shot->object_count; j++) {
      const pl_shot_object *b = &shot->objects[j];
      const double reach = (1.0 + 1e-6) * (a->radius_m + b->radius_m);
      overlapped = b->kept && pl_vec3_norm(pl_vec3_sub(a->center, b->center)) <= reach;
    }
    tracer->instances[i].overlapped = overlapped;
    tracer->has_coincident |= overlapped;
  }
}

pl_status pl_accelerator_update(pl_tracer *tracer, const pl_snapshot *snapshot) {
  size_t used = snapshot->object_count;
  for (size_t i = 0; i < snapshot->object_count; i++)
    used += pl_object_mover_count(snapshot->objects[i].object);
  PL_TRY(grow(tracer, used));
  for (size_t i = used; i < tracer->instance_count; i++)
    remove_instance(tracer, i);
  tracer->has_meshes = tracer->has_cuts = tracer->has_coincident = false;
  tracer->has_pieces = used > snapshot->object_count;
  tracer->object_count = used = snapshot->object_count;
  for (size_t i = 0; i < snapshot->object_count; i++) {
    const pl_shot_object *object = &snapshot->objects[i];
    tracer->has_cuts |= object->kept && pl_object_cuts(object->object);
    if (object->pieces != NULL) {
      PL_TRY(place_pieces(tracer, i, object, used));
      used += pl_object_mover_count(object->object);
    } else if (object->kept) {
      PL_TRY(place_instance(tracer, i, object->object->model, object->to_view, object->radius_m));
    } else {
      remove_instance(tracer, i);
    }
  }
  find_overlaps(tracer, snapshot);
  rtcCommitScene(tracer->top);
  return pl_accelerator_check(tracer, "placing instances");
}
