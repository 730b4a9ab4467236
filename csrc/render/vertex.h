/* A point where a ray hits the scene: exact position, normals and surface. */
#ifndef PL_RENDER_VERTEX_H
#define PL_RENDER_VERTEX_H

#include "shade/surface.h"
#include "trace/tracer.h"

/* A ray in double precision, with its cone. */
typedef struct pl_beam {
  pl_vec3 origin;    /* camera-relative, root axes, m */
  pl_vec3 direction; /* unit */
  float width_m;     /* width of the cone at the origin */
  float spread;      /* growth of the width, m per m */
} pl_beam;

/* Width of the cone at distance t along the beam. */
static inline float pl_beam_width(const pl_beam *beam, double t) {
  return beam->width_m + beam->spread * (float)t;
}

typedef struct pl_vertex {
  pl_vec3 position; /* camera-relative, root axes, m */
  double t;         /* along the beam, m */
  pl_surface_id surface_id;
  uint32_t triangle;
  float w[3];            /* barycentric weights */
  pl_vec3f edge1, edge2; /* of a mesh's triangle: corner 1 - corner 0, corner 2 - corner 0, m */
  pl_vec3f ng;           /* outward geometric normal (by the file's winding), unit */
  pl_surface surface;    /* shading frame and colours, on the viewer's side */
} pl_vertex;

/* What the ray through a pixel's centre meets: a vertex without the surface's colours and lobes,
 * which fills the geometry buffer and is what labels are made of. */
typedef struct pl_point {
  pl_vec3 position; /* as in pl_vertex, up to `ng` */
  double t;
  pl_surface_id surface_id;
  uint32_t triangle;
  float w[3];
  pl_vec3f edge1, edge2, ng;
  pl_vec3f n, facet;    /* shading and geometric normal, unit, on the viewer's side */
  bool in_shadow;       /* set only by pl_shadow_mask */
  uint8_t shadow_cause; /* a pl_shadow_cause; likewise, and only if settings ask for it */
} pl_point;

/* The point of a located and oriented vertex. */
static inline pl_point pl_point_of(const pl_vertex *v) {
  return (pl_point){.position = v->position,
                    .t = v->t,
                    .surface_id = v->surface_id,
                    .triangle = v->triangle,
                    .w = {v->w[0], v->w[1], v->w[2]},
                    .edge1 = v->edge1,
                    .edge2 = v->edge2,
                    .ng = v->ng,
                    .n = v->surface.n,
                    .facet = v->surface.ng};
}
/* The vertex of a point, to be shaded. */
static inline pl_vertex pl_point_vertex(const pl_point *p) {
  return (pl_vertex){.position = p->position,
                     .t = p->t,
                     .surface_id = p->surface_id,
                     .triangle = p->triangle,
                     .w = {p->w[0], p->w[1], p->w[2]},
                     .edge1 = p->edge1,
                     .edge2 = p->edge2,
                     .ng = p->ng,
                     .surface = {.n = p->n, .ng = p->facet}};
}

/* Sets position, geometric normal and weights only, which is what labels need. With `exact` the hit
 * is recomputed in double precision from the triangle that was hit; hits on bodies always are
 * exact. */
void pl_vertex_locate(const pl_snapshot *shot, const pl_beam *beam, const pl_hit *hit, bool exact,
                      pl_vertex *out);
/* Locates the nearest hit of a camera beam on the ellipsoids of bodies; false if there is none. */
bool pl_vertex_meet_bodies(const pl_snapshot *shot, const pl_beam *beam, pl_vertex *out);
/* Sets only surface.n and surface.ng: the interpolated shading normal, less than 90 degrees from
 * the viewer, and the geometric normal on the viewer's side. */
void pl_vertex_orient(const pl_snapshot *shot, const pl_beam *beam, pl_vertex *vertex);
/* Sets the shading frame and material of a located vertex, with the given detail. */
void pl_vertex_shade(const pl_snapshot *shot, const pl_beam *beam, pl_detail detail,
                     pl_vertex *vertex);

/* A located vertex to shade, and the beam that met it. */
typedef struct pl_vertex_view {
  const pl_beam *beam;
  pl_vertex *vertex;
} pl_vertex_view;
enum { PL_SHADE_RUN = 2 * PL_LANES };
/* pl_vertex_shade of up to PL_SHADE_RUN vertices: material graphs cost less for several points. */
void pl_vertex_shade_run(const pl_snapshot *shot, pl_detail detail, const pl_vertex_view *run,
                         size_t count);

/* The ellipse of the cone on the tangent plane of a located vertex: its axes (full lengths) across
 * and along the projection of the view direction, m, root axes. */
void pl_vertex_footprint(const pl_vertex *vertex, const pl_beam *beam, pl_vec3f *across,
                         pl_vec3f *along);

/* Turns the layers of a shaded vertex with a layered reflectance to the viewer's side too. */
void pl_vertex_face_layers(pl_vertex *vertex);

/* The secondary ray from the vertex in `direction`. Its origin is offset from the surface by a
 * millionth of the object's radius, to clear neighbours in the same plane; the triangle itself
 * cannot be hit again. On shapes of bodies it starts at the smooth surface that the normals
 * describe. */
pl_ray pl_vertex_ray(const pl_vertex *vertex, const pl_snapshot *shot, pl_vec3f direction,
                     double t_max);

#endif
