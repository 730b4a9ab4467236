/* Common interface to Embree 3.13 and 4: wrappers of the calls whose signatures differ. Included
 * only in trace/. */
#ifndef PL_TRACE_EMBREE_H
#define PL_TRACE_EMBREE_H

#if PL_EMBREE_VERSION >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <math.h>

/* Fields of a candidate hit in a filter function: arrays of N in the order Ng.x, Ng.y, Ng.z, u, v,
 * primID (the accessors of rtcore_ray.h exist only in C++). */
static inline float pl_embree_hit_u(const struct RTCHitN *hit, unsigned n, unsigned i) {
  return ((const float *)hit)[3 * n + i];
}
static inline float pl_embree_hit_v(const struct RTCHitN *hit, unsigned n, unsigned i) {
  return ((const float *)hit)[4 * n + i];
}
/* Returns whether the ray hits the back of the triangle, according to its winding. */
static inline int pl_embree_from_behind(const struct RTCRayN *ray, const struct RTCHitN *hit,
                                        unsigned n, unsigned i) {
  const float *d = (const float *)ray + 4 * n + i, *ng = (const float *)hit + i;
  return d[0] * ng[0] + d[n] * ng[n] + d[2 * n] * ng[2 * n] > 0.0f;
}
static inline unsigned pl_embree_hit_triangle(const struct RTCHitN *hit, unsigned n, unsigned i) {
  return ((const unsigned *)hit)[5 * n + i];
}
/* Distance of a candidate hit. */
static inline float pl_embree_ray_far(const struct RTCRayN *ray, unsigned n, unsigned i) {
  return ((const float *)ray)[8 * n + i];
}
/* Returns the height of the ray's origin above the plane of the triangle that it hits, in the ray's
 * units. */
static inline float pl_embree_height(const struct RTCRayN *ray, const struct RTCHitN *hit,
                                     unsigned n, unsigned i) {
  const float *d = (const float *)ray + 4 * n + i, *ng = (const float *)hit + i;
  const float along = d[0] * ng[0] + d[n] * ng[n] + d[2 * n] * ng[2 * n];
  const float square = ng[0] * ng[0] + ng[n] * ng[n] + ng[2 * n] * ng[2 * n];
  return pl_embree_ray_far(ray, n, i) * fabsf(along) / sqrtf(square);
}
/* The id that the caller gave the ray. */
static inline unsigned pl_embree_ray_id(const struct RTCRayN *ray, unsigned n, unsigned i) {
  return ((const unsigned *)ray)[10 * n + i];
}

#if PL_EMBREE_VERSION >= 4
typedef struct RTCRayQueryContext pl_embree_context;
#else
typedef struct RTCIntersectContext pl_embree_context;
#endif

/* A query with its own filter, which runs after the filter of the geometry and finds this struct in
 * its arguments' context. Functions that take a query accept NULL for a query without a filter. */
typedef struct pl_embree_query {
  pl_embree_context context; /* must be first: Embree passes its address to the filter */
  RTCFilterFunctionN filter; /* NULL for none */
  const void *user;
} pl_embree_query;

#if PL_EMBREE_VERSION >= 4

/* Scene flag that enables the filters of queries. */
#define PL_EMBREE_QUERY_FILTERS RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS

#define PL_EMBREE_ARGUMENTS(Kind, coherence)                                                       \
  struct RTC##Kind##Arguments arguments;                                                           \
  rtcInit##Kind##Arguments(&arguments);                                                            \
  arguments.flags = coherence;                                                                     \
  if (query != NULL) {                                                                             \
    rtcInitRayQueryContext(&query->context);                                                       \
    arguments.context = &query->context;                                                           \
    arguments.filter = query->filter;                                                              \
    if (query->filter != NULL)                                                                     \
      arguments.flags |= RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;                                \
  }

static inline void pl_embree_intersect1(RTCScene scene, pl_embree_query *query,
                                        struct RTCRayHit *ray) {
  PL_EMBREE_ARGUMENTS(Intersect, RTC_RAY_QUERY_FLAG_INCOHERENT)
  rtcIntersect1(scene, ray, &arguments);
}
static inline void pl_embree_occluded1(RTCScene scene, pl_embree_query *query, struct RTCRay *ray) {
  PL_EMBREE_ARGUMENTS(Occluded, RTC_RAY_QUERY_FLAG_INCOHERENT)
  rtcOccluded1(scene, ray, &arguments);
}
static inline void pl_embree_intersect8(const int *valid, RTCScene scene, pl_embree_query *query,
                                        struct RTCRayHit8 *rays) {
  PL_EMBREE_ARGUMENTS(Intersect, RTC_RAY_QUERY_FLAG_COHERENT)
  rtcIntersect8(valid, scene, rays, &arguments);
}
/* Rays to the sun do not share an origin: traversal one by one is faster. */
static inline void pl_embree_occluded8(const int *valid, RTCScene scene, pl_embree_query *query,
                                       struct RTCRay8 *rays) {
  PL_EMBREE_ARGUMENTS(Occluded, RTC_RAY_QUERY_FLAG_INCOHERENT)
  rtcOccluded8(valid, scene, rays, &arguments);
}

#else

#define PL_EMBREE_QUERY_FILTERS RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION

/* Returns the initialised context of a query: its own, or `plain` if there is no query. */
static inline struct RTCIntersectContext *pl_embree_ready(pl_embree_query *query,
                                                          struct RTCIntersectContext *plain,
                                                          enum RTCIntersectContextFlags flags) {
  struct RTCIntersectContext *context = query != NULL ? &query->context : plain;
  rtcInitIntersectContext(context);
  context->flags = flags;
  if (query != NULL)
    context->filter = query->filter;
  return context;
}

static inline void pl_embree_intersect1(RTCScene scene, pl_embree_query *query,
                                        struct RTCRayHit *ray) {
  struct RTCIntersectContext plain;
  rtcIntersect1(scene, pl_embree_ready(query, &plain, RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT), ray);
}
static inline void pl_embree_occluded1(RTCScene scene, pl_embree_query *query, struct RTCRay *ray) {
  struct RTCIntersectContext plain;
  rtcOccluded1(scene, pl_embree_ready(query, &plain, RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT), ray);
}
static inline void pl_embree_intersect8(const int *valid, RTCScene scene, pl_embree_query *query,
                                        struct RTCRayHit8 *rays) {
  struct RTCIntersectContext plain;
  rtcIntersect8(valid, scene, pl_embree_ready(query, &plain, RTC_INTERSECT_CONTEXT_FLAG_COHERENT),
                rays);
}
/* Rays to the sun do not share an origin: traversal one by one is faster. */
static inline void pl_embree_occluded8(const int *valid, RTCScene scene, pl_embree_query *query,
                                       struct RTCRay8 *rays) {
  struct RTCIntersectContext plain;
  rtcOccluded8(valid, scene, pl_embree_ready(query, &plain, RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT),
               rays);
}

#endif
#endif
