/* Times the tracer against Embree's own calls, which work in single precision from the camera on
 * and use Embree's instances. */
#include "trace/measure.h"

#include <stdlib.h>
#include <time.h>

#include "base/memory.h"
#include "math/affine.h"
#include "terrain/height_field.h"
#include "trace/accelerator.h"

enum { PACKET = 8, REPEATS_MAX = 64 };

static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t); /* others may run beside it */
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double median(double *values, int count) {
  qsort(values, (size_t)count, sizeof *values, ascending);
  return values[count / 2];
}

/* Packs rays for Embree, eight per packet; the last packet repeats its first ray. */
static void pack(const pl_ray *rays, size_t count, struct RTCRayHit8 *packets) {
  for (size_t i = 0; i < (count + PACKET - 1) / PACKET * PACKET; i++) {
    const pl_ray *ray = &rays[i < count ? i : i / PACKET * PACKET];
    struct RTCRayHit8 *packet = &packets[i / PACKET];
    const size_t k = i % PACKET;
    packet->ray.org_x[k] = (float)ray->origin.x;
    packet->ray.org_y[k] = (float)ray->origin.y;
    packet->ray.org_z[k] = (float)ray->origin.z;
    packet->ray.dir_x[k] = (float)ray->direction.x;
    packet->ray.dir_y[k] = (float)ray->direction.y;
    packet->ray.dir_z[k] = (float)ray->direction.z;
    packet->ray.tnear[k] = 0.0f;
    packet->ray.tfar[k] = (float)ray->t_max;
    packet->ray.mask[k] = UINT32_MAX;
    packet->hit.geomID[k] = packet->hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
  }
}

/* A geometry of points in body axes around an origin, which are placed as rays see them. */
static RTCGeometry points_of(const pl_accelerators *kept, enum RTCGeometryType type,
                             const pl_shot_body *body, pl_vec3 origin, const float (*points)[3],
                             size_t count) {
  RTCGeometry geometry = rtcNewGeometry(kept->device, type);
  float *out = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                       3 * sizeof(float), count);
  for (size_t k = 0; out != NULL && k < count; k++) {
    const pl_vec3 p = {(double)points[k][0], (double)points[k][1], (double)points[k][2]};
    const pl_vec3 at = pl_mat3_mul_vec(body->rotation, pl_vec3_add(origin, p));
    const pl_vec3f placed = pl_vec3_to_float(pl_vec3_add(body->center, at));
    out[3 * k] = placed.x;
    out[3 * k + 1] = placed.y;
    out[3 * k + 2] = placed.z;
  }
  return geometry;
}

static void attach(RTCScene top, RTCGeometry geometry) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(top, geometry);
  rtcReleaseGeometry(geometry);
}

static void attach_rock(const pl_accelerators *kept, const pl_shot_body *body,
                        const pl_ground_rock *rock, RTCScene top) {
  const pl_rock_mesh *mesh = rock->mesh;
  RTCGeometry geometry = rtcNewGeometry(kept->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  float *out = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                       3 * sizeof(float), (size_t)mesh->vertex_count);
  for (int k = 0; out != NULL && k < mesh->vertex_count; k++) {
    const float *p = mesh->positions[k];
    const pl_vec3 own = {(double)p[0], (double)p[1], (double)p[2]};
    const pl_vec3 at = pl_vec3_add(rock->rock.center, pl_ground_rock_out(rock, own));
    const pl_vec3f placed =
        pl_vec3_to_float(pl_vec3_add(body->center, pl_mat3_mul_vec(body->rotation, at)));
    out[3 * k] = placed.x;
    out[3 * k + 1] = placed.y;
    out[3 * k + 2] = placed.z;
  }
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->triangles,
                             0, 3 * sizeof(uint32_t), (size_t)mesh->triangle_count);
  attach(top, geometry);
}

/* Attaches the grid and the rocks of each tile to one scene, without instances. */
static void attach_ground(const pl_accelerators *kept, const pl_shot_body *body, RTCScene top) {
  enum { SIDE = PL_GROUND_TILE_SIDE };
  for (size_t k = 0; k < body->field->count; k++) {
    const pl_ground_tile *tile = body->field->tiles[k];
    RTCGeometry grid = points_of(kept, RTC_GEOMETRY_TYPE_GRID, body, tile->origin, tile->positions,
                                 (size_t)SIDE * SIDE);
    struct RTCGrid *shape =
        rtcSetNewGeometryBuffer(grid, RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID, sizeof *shape, 1);
    if (shape != NULL)
      *shape = (struct RTCGrid){0, SIDE, SIDE, SIDE};
    attach(top, grid);
    for (size_t r = 0; tile->rocks != NULL && r < tile->rocks->count; r++)
      attach_rock(kept, body, &tile->rocks->rocks[r], top);
  }
}

/* Returns a scene of Embree instances, the usual way to place meshes with Embree, and of grids. */
static RTCScene scene_of(const pl_accelerators *kept, const pl_tracer *tracer) {
  RTCScene top = rtcNewScene(kept->device);
  rtcSetSceneFlags(top, RTC_SCENE_FLAG_ROBUST);
  for (size_t i = 0; i < tracer->instance_count; i++) {
    const pl_instance *at = &tracer->instances[i];
    if (at->tiled) {
      attach_ground(kept, pl_shot_body_of(tracer->snapshot, at->surface_id), top);
      continue;
    }
    const pl_affine to_mesh = {at->to_mesh, {0.0, 0.0, 0.0}}, linear = pl_affine_inverse(&to_mesh);
    const pl_vec3 origin = pl_vec3_sub(at->center, pl_mat3_mul_vec(linear.m, at->mesh_center));
    const pl_mat3 columns = pl_mat3_transpose(linear.m);
    const pl_vec3 all[4] = {columns.row[0], columns.row[1], columns.row[2], origin};
    float to_view[12];
    for (int k = 0; k < 4; k++) {
      to_view[3 * k] = (float)all[k].x;
      to_view[3 * k + 1] = (float)all[k].y;
      to_view[3 * k + 2] = (float)all[k].z;
    }
    RTCGeometry geometry = rtcNewGeometry(kept->device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, at->scene);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, to_view);
    attach(top, geometry);
  }
  rtcCommitScene(top);
  return top;
}

static double time_raw(RTCScene top, const struct RTCRayHit8 *packets, size_t count, bool shadow) {
  _Alignas(32) static const int valid[PACKET] = {-1, -1, -1, -1, -1, -1, -1, -1};
  const double start = now_s();
  for (size_t i = 0; i < (count + PACKET - 1) / PACKET; i++) {
    struct RTCRayHit8 packet = packets[i];
    if (shadow)
      pl_embree_occluded8(valid, top, NULL, &packet.ray);
    else
      pl_embree_intersect8(valid, top, NULL, &packet);
  }
  return now_s() - start;
}

static double time_ours(const pl_tracer *tracer, const pl_ray *rays, size_t count, bool shadow,
                        pl_hit *hits, bool *occluded) {
  enum { BATCH = 1024 }; /* as in the renderer: one tile at a time */
  const double start = now_s();
  for (size_t i = 0; i < count; i += BATCH) {
    const size_t n = count - i < BATCH ? count - i : BATCH;
    if (shadow)
      pl_tracer_occluded(tracer, rays + i, occluded, n, true);
    else
      pl_tracer_closest(tracer, rays + i, hits, n, true, true);
  }
  return now_s() - start;
}

pl_status pl_tracer_measure(const pl_accelerators *kept, const pl_tracer *tracer,
                            const pl_ray *rays, size_t count, bool shadow, int repeats,
                            pl_ray_times *out) {
  enum { BATCH = 1024 };
  double ours[REPEATS_MAX], raw[REPEATS_MAX];
  pl_hit hits[BATCH];
  bool occluded[BATCH];
  if (repeats < 1 || repeats > REPEATS_MAX)
    return pl_fail(PL_E_RANGE, "repeats must be in 1..%d, not %d", REPEATS_MAX, repeats);
  pl_arena arena; /* used for its alignment */
  pl_arena_init(&arena);
  struct RTCRayHit8 *packets =
      pl_arena_alloc(&arena, (count + PACKET - 1) / PACKET, sizeof *packets);
  if (packets == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for %zu rays", count);
  pack(rays, count, packets);
  RTCScene top = scene_of(kept, tracer);
  for (int i = 0; i < repeats; i++) {
    raw[i] = time_raw(top, packets, count, shadow);
    ours[i] = time_ours(tracer, rays, count, shadow, hits, occluded);
  }
  rtcReleaseScene(top);
  pl_arena_clear(&arena);
  *out = (pl_ray_times){count, median(ours, repeats), median(raw, repeats)};
  return PL_OK;
}
