/* Finds rays that have slipped through the ground, and traces them again. */
#include "trace/ground_leak.h"

#include <stdbool.h>

#include "math/vec.h"

/* Tangent of the angle to the ray: two hundred times the rounding of a direction, and a thousandth
 * of a pixel or less. */
static const float HAIR = 0x1p-19f;
enum { TRIES = 4 };

static bool from_below(const struct RTCRayHit *ray) {
  return ray->ray.dir_x * ray->hit.Ng_x + ray->ray.dir_y * ray->hit.Ng_y +
             ray->ray.dir_z * ray->hit.Ng_z >
         0.0f;
}

/* Two directions across a ray, each of length HAIR. */
static void across(pl_vec3f along, pl_vec3f out[2]) {
  const float x = fabsf(along.x), y = fabsf(along.y), z = fabsf(along.z);
  const pl_vec3f axis = {x <= y && x <= z, y < x && y <= z, z < x && z < y};
  const pl_vec3f side = pl_vec3f_unit(pl_vec3f_cross(axis, along));
  out[0] = pl_vec3f_scale(side, HAIR);
  out[1] = pl_vec3f_scale(pl_vec3f_cross(along, side), HAIR);
}

void pl_ground_mend(RTCScene scene, pl_embree_query *query, struct RTCRayHit *ray) {
  if (ray->hit.geomID == RTC_INVALID_GEOMETRY_ID || !from_below(ray))
    return;
  const pl_vec3f along = {ray->ray.dir_x, ray->ray.dir_y, ray->ray.dir_z};
  pl_vec3f sides[2];
  across(along, sides);
  for (int k = 0; k < TRIES; k++) {
    const float way = k & 1 ? -1.0f : 1.0f;
    const pl_vec3f side = sides[k / 2];
    struct RTCRayHit again = *ray;
    again.ray.dir_x = along.x + way * side.x;
    again.ray.dir_y = along.y + way * side.y;
    again.ray.dir_z = along.z + way * side.z;
    again.ray.tfar *= 1.0f + 4.0f * HAIR;
    again.hit.geomID = again.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    pl_embree_intersect1(scene, query, &again);
    if (again.hit.geomID == RTC_INVALID_GEOMETRY_ID || from_below(&again))
      continue;
    ray->hit = again.hit;
    ray->ray.tfar = again.ray.tfar;
    return;
  }
}

void pl_ground_mend_lane(RTCScene scene, pl_embree_query *query, struct RTCRayHit8 *rays,
                         unsigned lane) {
  struct RTCRay8 *of = &rays->ray;
  struct RTCHit8 *hit = &rays->hit;
  struct RTCRayHit ray = {.ray = {.org_x = of->org_x[lane],
                                  .org_y = of->org_y[lane],
                                  .org_z = of->org_z[lane],
                                  .tnear = of->tnear[lane],
                                  .dir_x = of->dir_x[lane],
                                  .dir_y = of->dir_y[lane],
                                  .dir_z = of->dir_z[lane],
                                  .tfar = of->tfar[lane],
                                  .mask = of->mask[lane],
                                  .id = of->id[lane]},
                          .hit = {.Ng_x = hit->Ng_x[lane],
                                  .Ng_y = hit->Ng_y[lane],
                                  .Ng_z = hit->Ng_z[lane],
                                  .geomID = hit->geomID[lane]}};
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID || !from_below(&ray))
    return;
  pl_ground_mend(scene, query, &ray);
  of->tfar[lane] = ray.ray.tfar;
  hit->u[lane] = ray.hit.u;
  hit->v[lane] = ray.hit.v;
  hit->primID[lane] = ray.hit.primID;
  hit->geomID[lane] = ray.hit.geomID;
  hit->instID[0][lane] = ray.hit.instID[0];
}
