/* Intersects rays with instances of the meshes of rocks. */
#include "trace/rock_instances.h"

/* Fields of N rays, and of their hits behind them, as arrays of N. */
enum { ORG = 0, NEAR = 3, DIR = 4, FAR = 8, RAY_FIELDS = 12 };
enum { NORMAL = 0, U = 3, V, PRIMITIVE, GEOMETRY, INSTANCE };

static void bounds(const struct RTCBoundsFunctionArguments *arguments) {
  const pl_ground_rocks *rocks = arguments->geometryUserPtr;
  const pl_ground_rock *rock = &rocks->rocks[arguments->primID];
  const pl_rock_mesh *mesh = rock->mesh;
  const pl_vec3 center = pl_vec3_sub(rock->rock.center, rocks->origin);
  const double at[3] = {center.x, center.y, center.z};
  const double stretch[3] = {rock->stretch.x, rock->stretch.y, rock->stretch.z};
  float *low[3] = {&arguments->bounds_o->lower_x, &arguments->bounds_o->lower_y,
                   &arguments->bounds_o->lower_z};
  float *high[3] = {&arguments->bounds_o->upper_x, &arguments->bounds_o->upper_y,
                    &arguments->bounds_o->upper_z};
  for (int c = 0; c < 3; c++) {
    const pl_vec3 row = rock->rock.rotation.row[c];
    const double turn[3] = {row.x, row.y, row.z};
    double from = at[c], to = at[c];
    for (int a = 0; a < 3; a++) {
      const double x = turn[a] * stretch[a] * (double)mesh->low[a];
      const double y = turn[a] * stretch[a] * (double)mesh->high[a];
      from += fmin(x, y);
      to += fmax(x, y);
    }
    /* Wider by more than the rounding of rays to the tile's axes. */
    const double more = 1e-3 * rock->rock.diameter_m;
    *low[c] = (float)(from - more);
    *high[c] = (float)(to + more);
  }
}

/* Ray `i` of n in the units of a rock's mesh. Its direction is not of unit length there, so that
 * distances stay those of the ray. */
static struct RTCRay own_ray(const pl_ground_rocks *rocks, const pl_ground_rock *rock,
                             const float *fields, unsigned n, unsigned i) {
  const float *at = fields + i;
  const pl_vec3 org = {(double)at[ORG * n], (double)at[(ORG + 1) * n], (double)at[(ORG + 2) * n]};
  const pl_vec3 dir = {(double)at[DIR * n], (double)at[(DIR + 1) * n], (double)at[(DIR + 2) * n]};
  const pl_vec3 center = pl_vec3_sub(rock->rock.center, rocks->origin);
  const pl_vec3f o = pl_vec3_to_float(pl_ground_rock_in(rock, pl_vec3_sub(org, center)));
  const pl_vec3f d = pl_vec3_to_float(pl_ground_rock_in(rock, dir));
  return (struct RTCRay){.org_x = o.x,
                         .org_y = o.y,
                         .org_z = o.z,
                         .tnear = at[NEAR * n],
                         .dir_x = d.x,
                         .dir_y = d.y,
                         .dir_z = d.z,
                         .tfar = at[FAR * n],
                         .mask = UINT32_MAX};
}

static void intersect(const struct RTCIntersectFunctionNArguments *arguments) {
  const pl_ground_rocks *rocks = arguments->geometryUserPtr;
  const pl_ground_rock *rock = &rocks->rocks[arguments->primID];
  const unsigned n = arguments->N;
  float *fields = (float *)arguments->rayhit;
  for (unsigned i = 0; i < n; i++) {
    if (arguments->valid[i] == 0)
      continue;
    struct RTCRayHit query = {.ray = own_ray(rocks, rock, fields, n, i)};
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    pl_embree_intersect1(rock->mesh->scene, NULL, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID)
      continue;
    const pl_vec3f normal = pl_vec3_to_float(pl_ground_rock_normal(
        rock, (pl_vec3){(double)query.hit.Ng_x, (double)query.hit.Ng_y, (double)query.hit.Ng_z}));
    float *hit = fields + RAY_FIELDS * n + i;
    unsigned *ids = (unsigned *)(void *)hit;
    fields[FAR * n + i] = query.ray.tfar;
    hit[NORMAL * n] = normal.x;
    hit[(NORMAL + 1) * n] = normal.y;
    hit[(NORMAL + 2) * n] = normal.z;
    hit[U * n] = query.hit.u;
    hit[V * n] = query.hit.v;
    ids[PRIMITIVE * n] = rocks->first[arguments->primID] + query.hit.primID;
    ids[GEOMETRY * n] = arguments->geomID;
    ids[INSTANCE * n] = arguments->context->instID[0];
  }
}

static void occluded(const struct RTCOccludedFunctionNArguments *arguments) {
  const pl_ground_rocks *rocks = arguments->geometryUserPtr;
  const pl_ground_rock *rock = &rocks->rocks[arguments->primID];
  const unsigned n = arguments->N;
  float *fields = (float *)arguments->ray;
  for (unsigned i = 0; i < n; i++) {
    if (arguments->valid[i] == 0)
      continue;
    struct RTCRay query = own_ray(rocks, rock, fields, n, i);
    pl_embree_occluded1(rock->mesh->scene, NULL, &query);
    if (query.tfar < 0.0f)
      fields[FAR * n + i] = -INFINITY;
  }
}

void pl_rock_instances_attach(const pl_accelerators *kept, RTCScene scene,
                              const pl_ground_rocks *rocks) {
  if (rocks == NULL)
    return;
  RTCGeometry geometry = rtcNewGeometry(kept->device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, (unsigned)rocks->count);
  rtcSetGeometryUserData(geometry, (void *)(uintptr_t)rocks);
  rtcSetGeometryBoundsFunction(geometry, bounds, NULL);
  rtcSetGeometryIntersectFunction(geometry, intersect);
  rtcSetGeometryOccludedFunction(geometry, occluded);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, PL_TILE_ROCKS);
  rtcReleaseGeometry(geometry);
}

pl_status pl_rock_instances_build(const pl_accelerators *kept, pl_rock_mesh *mesh) {
  RTCScene scene = rtcNewScene(kept->device);
  RTCGeometry geometry = rtcNewGeometry(kept->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             mesh->positions, 0, 3 * sizeof(float), (size_t)mesh->vertex_count);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->triangles,
                             0, 3 * sizeof(uint32_t), (size_t)mesh->triangle_count);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  mesh->scene = scene;
  return pl_accelerator_check(kept, "building a mesh of rocks");
}

void pl_rock_instances_drop(pl_rock_meshes *meshes, size_t from) {
  for (size_t k = from; k < meshes->count; k++)
    if (meshes->list[k]->scene != NULL)
      rtcReleaseScene(meshes->list[k]->scene);
  pl_rock_meshes_drop(meshes, from);
}
