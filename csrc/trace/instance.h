/* A mesh in its place, and how rays come to it.
 *
 * Single precision resolves a ten-millionth of the lengths that it adds up: rays that cross a
 * thousand times an object's size on their way would miss its edges by a hair that is seen. So
 * rays are in double, and each is brought, in double, to where it enters the sphere about the mesh;
 * from there Embree follows it in single precision and the mesh's own units. */
#ifndef PL_TRACE_INSTANCE_H
#define PL_TRACE_INSTANCE_H

#include "trace/embree.h"
#include "trace/tracer.h"

enum { PL_PACKET = PL_TRACER_PACKET };

typedef struct pl_instance {
  const pl_model *model;     /* NULL when absent */
  RTCScene scene;            /* of the model; borrowed */
  const uint8_t *coincident; /* of the model, borrowed; NULL for none */
  uint32_t object, first;    /* its triangles are those from `first` on of the object's model */
  double size_m;             /* radius of the object */
  pl_vec3 center;            /* of the sphere, camera-relative, m */
  double radius_m;           /* of the sphere */
  pl_vec3 mesh_center;       /* of the sphere, mesh units */
  pl_mat3 to_mesh;           /* root axes, m, to mesh units */
  bool cuts;                 /* graphs may cut holes into it */
  bool one_way;              /* some of its backs are not there */
} pl_instance;

/* Where the mesh with these triangles is: a point p of it at linear p + origin, m. `center` and
 * `radius_m`: of a sphere about it. Model, scene and owner are the caller's. */
void pl_instance_place(pl_instance *instance, const pl_mat3 *linear, pl_vec3 origin, pl_vec3 center,
                       double radius_m);

/* Rays abreast; those that are none, or are done, have a limit below 0. */
typedef struct pl_packet {
  double origin[3][PL_PACKET], direction[3][PL_PACKET];
  double limit[PL_PACKET]; /* m: what lies beyond does not count */
} pl_packet;
void pl_packet_fill(pl_packet *packet, const pl_ray *rays, size_t count);

/* Where rays enter a sphere, m along them. False if none touches it before its limit. */
typedef struct pl_entry {
  double start_m[PL_PACKET];
  _Alignas(32) int32_t valid[PL_PACKET]; /* -1: touches; aligned as Embree asks */
} pl_entry;
bool pl_packet_enter(const pl_packet *packet, pl_vec3 center, double radius_m, pl_entry *entry);

/* Rays from there on, in mesh units. */
typedef struct pl_approach {
  float origin[3][PL_PACKET], direction[3][PL_PACKET];
  double per_metre[PL_PACKET]; /* mesh units */
} pl_approach;
void pl_packet_approach(const pl_packet *packet, const pl_instance *instance, const pl_entry *entry,
                        pl_approach *out);

/* The same of one ray. */
typedef struct pl_lone_approach {
  pl_vec3f origin, direction;
  double start_m, per_metre;
} pl_lone_approach;
bool pl_ray_enter(const pl_ray *ray, double limit_m, pl_vec3 center, double radius_m,
                  double *start_m);
pl_lone_approach pl_ray_approach(const pl_ray *ray, const pl_instance *instance, double start_m);

#endif
