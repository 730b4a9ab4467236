/* A placed mesh, and the transformation of rays to it.
 *
 * Single precision resolves about 1e-7 of the lengths that are added. A ray that travels a thousand
 * times an object's size would miss the object's edges by a visible amount. Rays are therefore in
 * double, and each is advanced in double to where it enters the bounding sphere of the mesh; from
 * there Embree traces it in single precision and in the mesh's own units. */
#ifndef PL_TRACE_INSTANCE_H
#define PL_TRACE_INSTANCE_H

#include "trace/embree.h"
#include "trace/intersect.h"

enum { PL_PACKET = PL_TRACER_PACKET };

/* Ids of the geometries in the scene of a tile of ground. */
enum { PL_TILE_GRID, PL_TILE_ROCKS };

struct pl_instance {
  const pl_model *model;     /* NULL when absent, and for a height field */
  RTCScene scene;            /* of the model or height field; borrowed */
  const uint8_t *coincident; /* of the model, borrowed; NULL for none */
  pl_surface_id surface_id;  /* of the object */
  uint32_t first;            /* offset of its triangles in the object's model */
  double size_m;             /* bounding radius of the whole object */
  pl_vec3 center;            /* of the bounding sphere, camera-relative, m */
  double radius_m;           /* of the bounding sphere */
  pl_vec3 mesh_center;       /* centre of the bounding sphere, mesh units */
  pl_mat3 to_mesh;           /* from root axes in m to mesh units */
  bool cuts;                 /* graphs may cut holes into it */
  bool one_way;              /* some of its back faces do not exist for rays */
  bool tiled; /* a height field: its scene consists of instances, which are its tiles */
  /* of a height field: number of triangles of rocks in the tiles before each; borrowed, or NULL */
  const uint32_t *first_rocks;
};

/* Sets the transformation: mesh point p lies at linear p + origin, m. `center` and `radius_m`
 * describe a sphere that encloses the mesh. The caller fills in model, scene and id. */
void pl_instance_place(pl_instance *instance, const pl_mat3 *linear, pl_vec3 origin, pl_vec3 center,
                       double radius_m);

/* Rays that are traced together. A limit below 0 marks unused lanes and finished rays. */
typedef struct pl_packet {
  double origin[3][PL_PACKET], direction[3][PL_PACKET];
  double limit[PL_PACKET]; /* m: hits beyond it do not count */
} pl_packet;
void pl_packet_fill(pl_packet *packet, const pl_ray *rays, size_t count);

/* Distances in m along the rays at which they enter a sphere. Returns false if no ray touches it
 * before its limit. */
typedef struct pl_entry {
  double start_m[PL_PACKET];
  _Alignas(32) int32_t valid[PL_PACKET]; /* -1: touches the sphere; aligned as Embree requires */
} pl_entry;
bool pl_packet_enter(const pl_packet *packet, pl_vec3 center, double radius_m, pl_entry *entry);

/* The rays from there on, in mesh units. */
typedef struct pl_approach {
  float origin[3][PL_PACKET], direction[3][PL_PACKET];
  double per_metre[PL_PACKET]; /* mesh units per metre */
} pl_approach;
void pl_packet_approach(const pl_packet *packet, const pl_instance *instance, const pl_entry *entry,
                        pl_approach *out);

/* The same for one ray. */
typedef struct pl_lone_approach {
  pl_vec3f origin, direction;
  double start_m, per_metre;
} pl_lone_approach;
bool pl_ray_enter(const pl_ray *ray, double limit_m, pl_vec3 center, double radius_m,
                  double *start_m);
pl_lone_approach pl_ray_approach(const pl_ray *ray, const pl_instance *instance, double start_m);

#endif
