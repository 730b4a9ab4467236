/* Points that move with a surface (an object, its moving node, a body), seen in a frame: where the
 * camera, lens and shutter put them, and what hides them. Directions likewise. */
#ifndef PL_ANNOTATE_SIGHT_H
#define PL_ANNOTATE_SIGHT_H

#include "math/affine.h"
#include "render/coverage_mask.h"
#include "render/vertex.h"
#include "scene/scene.h"

/* A frame that they are seen in. */
typedef struct pl_sight_frame {
  const pl_placement *placement; /* borrowed */
  /* borrowed, one per body: whether its shape or terrain is another one than where the points are
   * from, so that they do not exist; NULL: none */
  const bool *changed;
  bool rows;               /* its rows are exposed one after the other */
  const pl_snapshot *shot; /* in the middle of its exposure; borrowed */
  const pl_tracer *tracer; /* of this snapshot; borrowed */
  /* borrowed; where meshes may be in the picture of the snapshot; NULL: anywhere */
  const pl_coverage *meshes;
} pl_sight_frame;

typedef struct pl_sight {
  bool is_point;            /* false: a direction */
  pl_surface_id surface_id; /* of a point */
  uint32_t triangle;        /* that hides nothing of it, and its number + 1; 0: none */
  pl_vec3 local;            /* mesh units, body axes, or for a direction root axes */
  /* of the geometric normal on the side that is seen, in the same axes, any length; zero: the point
   * is seen from all sides */
  pl_vec3 normal;
  const pl_object *object; /* NULL: on a body, or a direction */
  size_t index;            /* of the object or body */
  size_t piece;            /* of an articulated object */
  pl_vec3 radii;           /* of a body, where the point is from */
  double cell_m;           /* width of the ground's cells there */
  double deep_m;           /* how far it may lie behind its own surface */
} pl_sight;

/* Turns coordinates of sights on one surface into coordinates of a frame in the middle of its
 * exposure. */
typedef struct pl_carrier {
  pl_affine place; /* to camera-relative coordinates, root axes */
  pl_mat3 camera;  /* camera axes to root axes */
} pl_carrier;

/* Transforms of the surface that was met last: neighbouring pixels mostly see the same. It changes
 * no bits. Initialise with zeros, for one frame that points are from, and one that they lead to. */
typedef struct pl_sight_memo {
  bool has_place, has_carrier;
  pl_surface_id surface_id, carried_id;
  size_t piece, carried_piece;
  pl_affine place, back; /* from the coordinates of sights to camera-relative ones, and back */
  pl_carrier carrier;
  pl_mat3 carried_back; /* inverse of the carrier's matrix */
} pl_sight_memo;

/* What a ray through a pixel's centre hit. */
pl_sight pl_sight_of(const pl_snapshot *shot, const pl_point *point, pl_sight_memo *memo);
static inline pl_sight pl_sight_towards(pl_vec3 direction) {
  return (pl_sight){.local = direction, .surface_id = PL_NO_SURFACE};
}

/* Whether the surface is there in the frame. */
bool pl_sight_is_there(const pl_sight_frame *frame, const pl_sight *sight);

/* Projects; with a rolling shutter at the time of the row that sees the point. *point receives its
 * place in camera axes, m. Returns false if it has no image. */
bool pl_sight_project(const pl_sight_frame *frame, const pl_sight *sight, pl_sight_memo *memo,
                      pl_vec3 *point, double pixel[2]);
bool pl_pixel_in_image(const pl_camera *camera, const double pixel[2]);

/* The ray from the camera to a sight, in the middle of the exposure. */
typedef struct pl_sight_query {
  pl_ray ray;
  double distance_m, cosine; /* between the way to the camera and the normal */
} pl_sight_query;

/* Returns false if the surface turns its other side, which hides the sight without a ray. */
bool pl_sight_look(const pl_sight_frame *frame, const pl_sight *sight, pl_sight_memo *memo,
                   pl_sight_query *out);
/* What hides the sight if the closest hit of its ray is `hit`; PL_NO_SURFACE: nothing. */
pl_surface_id pl_sight_hider(const pl_sight_frame *frame, const pl_sight *sight,
                             const pl_sight_query *query, const pl_hit *hit);

/* Returns what hides a sight from the camera, in the middle of the exposure: its own surface also
 * if that turns its other side; PL_NO_SURFACE: nothing. */
pl_surface_id pl_sight_hidden_by(const pl_sight_frame *frame, const pl_sight *sight,
                                 pl_sight_memo *memo);

#endif
