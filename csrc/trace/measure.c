/* The tracer against Embree's own calls. */
#include "trace/measure.h"

#include <stdlib.h>
#include <time.h>

#include "base/memory.h"
#include "trace/accelerator.h"

enum { PACKET = 8, REPEATS_MAX = 64 };

static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
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

/* Rays packed for Embree, eight a packet; the last packet repeats its first ray. */
static void pack(const pl_ray *rays, size_t count, struct RTCRayHit8 *packets) {
  for (size_t i = 0; i < (count + PACKET - 1) / PACKET * PACKET; i++) {
    const pl_ray *ray = &rays[i < count ? i : i / PACKET * PACKET];
    struct RTCRayHit8 *packet = &packets[i / PACKET];
    const size_t k = i % PACKET;
    packet->ray.org_x[k] = ray->origin.x;
    packet->ray.org_y[k] = ray->origin.y;
    packet->ray.org_z[k] = ray->origin.z;
    packet->ray.dir_x[k] = ray->direction.x;
    packet->ray.dir_y[k] = ray->direction.y;
    packet->ray.dir_z[k] = ray->direction.z;
    packet->ray.tnear[k] = 0.0f;
    packet->ray.tfar[k] = ray->t_max;
    packet->ray.mask[k] = UINT32_MAX;
    packet->hit.geomID[k] = packet->hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
  }
}

static double time_raw(const pl_tracer *tracer, const struct RTCRayHit8 *packets, size_t count,
                       bool shadow) {
  _Alignas(32) static const int valid[PACKET] = {-1, -1, -1, -1, -1, -1, -1, -1};
  const double start = now_s();
  for (size_t i = 0; i < (count + PACKET - 1) / PACKET; i++) {
    struct RTCRayHit8 packet = packets[i];
    if (shadow)
      pl_embree_occluded8(valid, tracer->top, NULL, &packet.ray);
    else
      pl_embree_intersect8(valid, tracer->top, NULL, &packet);
  }
  return now_s() - start;
}

static double time_ours(const pl_tracer *tracer, const pl_ray *rays, size_t count, bool shadow,
                        pl_hit *hits, bool *occluded) {
  enum { BATCH = 1024 }; /* as the renderer does: a tile at a time */
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

pl_status pl_tracer_measure(const pl_tracer *tracer, const pl_ray *rays, size_t count, bool shadow,
                            int repeats, pl_ray_times *out) {
  enum { BATCH = 1024 };
  double ours[REPEATS_MAX], raw[REPEATS_MAX];
  pl_hit hits[BATCH];
  bool occluded[BATCH];
  if (repeats < 1 || repeats > REPEATS_MAX)
    return pl_fail(PL_E_RANGE, "repeats must be in 1..%d, not %d", REPEATS_MAX, repeats);
  pl_arena arena; /* for its alignment */
  pl_arena_init(&arena);
  struct RTCRayHit8 *packets =
      pl_arena_alloc(&arena, (count + PACKET - 1) / PACKET, sizeof *packets);
  if (packets == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for %zu rays", count);
  pack(rays, count, packets);
  for (int i = 0; i < repeats; i++) {
    raw[i] = time_raw(tracer, packets, count, shadow);
    ours[i] = time_ours(tracer, rays, count, shadow, hits, occluded);
  }
  pl_arena_clear(&arena);
  *out = (pl_ray_times){count, median(ours, repeats), median(raw, repeats)};
  return PL_OK;
}
