/* One face of Embree 3.13 and 4: the calls whose signatures differ. Included only in trace/. */
#ifndef PL_TRACE_EMBREE_H
#define PL_TRACE_EMBREE_H

#if PL_EMBREE_VERSION >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

/* Fields of a candidate hit in a filter function: arrays of N in the order Ng.x, Ng.y, Ng.z, u, v,
 * primID (the accessors of rtcore_ray.h exist in C++ alone). */
static inline float pl_embree_hit_u(const struct RTCHitN *hit, unsigned n, unsigned i) {
  return ((const float *)hit)[3 * n + i];
}
static inline float pl_embree_hit_v(const struct RTCHitN *hit, unsigned n, unsigned i) {
  return ((const float *)hit)[4 * n + i];
}
/* Whether the ray meets the triangle from the side that its winding calls the back. */
static inline int pl_embree_from_behind(const struct RTCRayN *ray, const struct RTCHitN *hit,
                                        unsigned n, unsigned i) {
  const float *d = (const float *)ray + 4 * n + i, *ng = (const float *)hit + i;
  return d[0] * ng[0] + d[n] * ng[n] + d[2 * n] * ng[2 * n] > 0.0f;
}
static inline unsigned pl_embree_hit_triangle(const struct RTCHitN *hit, unsigned n, unsigned i) {
  return ((const unsigned *)hit)[5 * n + i];
}

#if PL_EMBREE_VERSION >= 4

static inline void pl_embree_intersect1(RTCScene scene, struct RTCRayHit *ray) {
  rtcIntersect1(scene, ray, NULL);
}
static inline void pl_embree_occluded1(RTCScene scene, struct RTCRay *ray) {
  rtcOccluded1(scene, ray, NULL);
}
static inline void pl_embree_intersect8(const int *valid, RTCScene scene, struct RTCRayHit8 *rays) {
  struct RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect8(valid, scene, rays, &arguments);
}
static inline void pl_embree_occluded8(const int *valid, RTCScene scene, struct RTCRay8 *rays) {
  struct RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcOccluded8(valid, scene, rays, &arguments);
}

#else

static inline void pl_embree_intersect1(RTCScene scene, struct RTCRayHit *ray) {
  struct RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, ray);
}
static inline void pl_embree_occluded1(RTCScene scene, struct RTCRay *ray) {
  struct RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, ray);
}
static inline void pl_embree_intersect8(const int *valid, RTCScene scene, struct RTCRayHit8 *rays) {
  struct RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(valid, scene, &context, rays);
}
static inline void pl_embree_occluded8(const int *valid, RTCScene scene, struct RTCRay8 *rays) {
  struct RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded8(valid, scene, &context, rays);
}

#endif
#endif
