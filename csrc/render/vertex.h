/* A point where a ray meets the scene: exact position, normals and surface. */
#ifndef PL_RENDER_VERTEX_H
#define PL_RENDER_VERTEX_H

#include "shade/surface.h"
#include "trace/tracer.h"

/* The ray in double, with the cone that it stands for. */
typedef struct pl_beam {
  pl_vec3 origin;    /* camera-relative, root axes, m */
  pl_vec3 direction; /* unit */
  float width_m;     /* of the cone at the origin */
  float spread;      /* growth of the width per metre */
} pl_beam;

/* Width of its cone at a distance along it. */
static inline float pl_beam_width(const pl_beam *beam, double t) {
  return beam->width_m + beam->spread * (float)t;
}

typedef struct pl_vertex {
  pl_vec3 position; /* camera-relative, root axes, m */
  double t;         /* along the beam, m */
  uint32_t thing;
  uint32_t triangle;
  float w[3];            /* barycentric weights */
  pl_vec3f edge1, edge2; /* of a mesh triangle: corner 1 - corner 0, corner 2 - corner 0, m */
  pl_vec3f ng;           /* outward geometric normal (of the file's winding), unit */
  pl_surface surface;    /* frame and colours, turned to the viewer's side */
} pl_vertex;

/* Position, geometric normal and weights only: what labels need. With `exact` the hit is
 * re-intersected in double with the winning triangle's own equation; bodies always are. */
void pl_vertex_locate(const pl_snapshot *shot, const pl_beam *beam, const pl_hit *hit, bool exact,
                      pl_vertex *out);
/* The nearest ellipsoid of a body that a beam from the camera meets, located; false for none. */
bool pl_vertex_meet_bodies(const pl_snapshot *shot, const pl_beam *beam, pl_vertex *out);
/* The interpolated shading normal, less than 90 degrees from the viewer, and the geometric one on
 * the viewer's side: into surface.n and surface.ng alone. */
void pl_vertex_orient(const pl_snapshot *shot, const pl_beam *beam, pl_vertex *vertex);
/* Shading frame and material at a located vertex. As detailed as asked for. */
void pl_vertex_shade(const pl_snapshot *shot, const pl_beam *beam, pl_detail detail,
                     pl_vertex *vertex);

/* The cone's ellipse on the tangent plane of a located vertex: its axes across, and along the view
 * direction's projection, m, root axes. */
void pl_vertex_footprint(const pl_vertex *vertex, const pl_beam *beam, pl_vec3f *across,
                         pl_vec3f *along);

/* Turns the layers of a shaded vertex, whose row is layered, to the viewer's side too. */
void pl_vertex_face_layers(pl_vertex *vertex);

/* Start of a secondary ray from the vertex towards `direction`: off the surface by a millionth of
 * the object's radius, for the neighbours in its plane; the triangle itself cannot be hit again. On
 * shapes of bodies from the smooth surface of their normals. */
pl_ray pl_vertex_ray(const pl_vertex *vertex, const pl_snapshot *shot, pl_vec3f direction,
                     double t_max);

#endif
