/* Camera-relative scene of one instant, read by ray tracing and shading. Immutable once it is made.
 * The axes are those of the root frame; the origin is the camera at mid-exposure. */
#ifndef PL_SCENE_SNAPSHOT_H
#define PL_SCENE_SNAPSHOT_H

#include <stdbool.h>

#include "base/memory.h"
#include "geom/sphere_tree.h"
#include "plan/view.h"
#include "scene/ray_source.h"
#include "scene/scene.h"
#include "scene/senders.h"
#include "scene/surface_id.h"

/* Piece of an articulated object that moves on its own. */
typedef struct pl_shot_piece {
  const pl_model *model; /* borrowed: only the triangles of the piece */
  const pl_cover *cover; /* borrowed */
  bool present;          /* it has triangles, and its motion does not flatten it */
  pl_mat3 linear;        /* model axes to root axes, m per mesh unit */
  pl_vec3 origin;        /* origin of the mesh coordinates, camera-relative, m */
  pl_mat3 normal;        /* transforms normals; the result is not of unit length */
  float side;            /* -1 if the motion mirrors, which reverses the winding of triangles */
  float to_view[12];     /* as in pl_shot_object */
} pl_shot_piece;

typedef struct pl_shot_object {
  pl_surface_id id;           /* a mesh or a shape */
  const pl_object *object;    /* borrowed */
  const pl_value *parameters; /* of the object's graphs; borrowed */
  double scale;               /* metres per mesh unit */
  pl_mat3 rotation;           /* object axes to root axes */
  pl_vec3 position;           /* of the object's origin, camera-relative, m */
  float to_view[12]; /* mesh units to view axes, 3x4 column-major (x, y, z axes, translation) */
  pl_vec3 center;    /* of the bounding sphere, camera-relative, m */
  double radius_m;   /* of the bounding sphere */
  bool in_frame;     /* the bounding sphere touches the frustum */
  bool kept;         /* in the tracer; culled objects cannot change the image */
  bool eclipsed;     /* a body's shadow may fall on it; set by pl_snapshot_cull */
  bool dark;         /* it lies entirely in a body's umbra; set by pl_snapshot_cull */
  bool subpixel;     /* shape of a sub-pixel body, see pl_shot_body */
  /* For an articulated object: every triangle belongs to one of these pieces, which places it
   * instead of to_view; pose and scale are still those of the object. */
  const pl_shot_piece *pieces; /* in the order of the cut; NULL if the object is not articulated */
  size_t piece_count;
} pl_shot_object;

struct pl_height_field;

typedef struct pl_shot_body {
  const pl_body *body;         /* borrowed */
  const pl_body_state *state;  /* borrowed */
  const pl_shot_object *shape; /* mesh that rays meet in place of the ellipsoid; NULL for none */
  /* terrain that rays meet in place of the ellipsoid; made after culling, borrowed; NULL before,
   * and for other bodies */
  const struct pl_height_field *field;
  bool has_terrain; /* rays meet its terrain; false also where the plan leaves terrain out */
  pl_mat3 rotation; /* body axes to root axes */
  pl_vec3 center;   /* camera-relative, m */
  pl_vec3 camera;   /* camera position in body axes relative to the body's centre, m */
  /* root axes to body axes divided by the radii, where the ellipsoid is a unit sphere */
  pl_mat3 to_unit;
  pl_vec3 camera_unit;  /* camera position in these coordinates */
  double radius_m;      /* largest semi-axis */
  double outer_m;       /* no point of the surface is farther from the centre */
  bool in_frame;        /* camera rays may meet the surface; always false for a body with a shape */
  bool air_in_frame;    /* its atmosphere, if any, touches the frustum */
  bool clouds_in_frame; /* the same for clouds */
  bool rings_in_frame;  /* the same for rings */
  bool subpixel;        /* sub-pixel body, see pl_culling */
  bool shadowed; /* a shadow of more than the tolerance may fall on it; set by pl_snapshot_cull */
  bool bounced;  /* light reflected by others may exceed the tolerance; set by pl_snapshot_cull */
  /* where on it that is, if only light of meshes may; NULL: anywhere. Set by pl_snapshot_cull */
  const pl_senders *senders;
  bool near_meshes; /* objects may contribute to or block that light; set by pl_snapshot_cull */
  /* Reflectance levels of detail: factors on the radiance with which cheaper models best
   * approximate its own over the visible surface; NULL if they may not replace it. Taken from
   * pl_culling's view. */
  const pl_view_lods *lods;
} pl_shot_body;

/* The kind of the surface that rays meet on a body without a shape. */
static inline pl_surface_kind pl_shot_kind_of(const pl_shot_body *body) {
  pl_surface_kind kind = PL_SURFACE_ELLIPSOID;
#define PL_KIND(NAME, name, replaces)                                                              \
  if (replaces)                                                                                    \
    kind = PL_SURFACE_##NAME;
  PL_SURFACE_KIND_LIST(PL_KIND)
#undef PL_KIND
  return kind;
}

/* Whether rays meet the ellipsoid itself: neither a shape nor another kind of surface replaces it.
 */
static inline bool pl_shot_is_smooth(const pl_shot_body *body) {
  return body->shape == NULL && pl_shot_kind_of(body) == PL_SURFACE_ELLIPSOID;
}

/* Returns the id of the surface that rays meet on body `index`, which has no shape. */
static inline pl_surface_id pl_shot_surface_of(const pl_shot_body *body, size_t index) {
  return pl_surface_make(pl_shot_kind_of(body), index);
}

typedef struct pl_shot_volume {
  const pl_volume *volume; /* borrowed */
  pl_mat3 rotation;        /* axes of the bound to root axes */
  pl_vec3 origin;          /* origin of the bound, camera-relative, m */
  pl_bound_ball ball;      /* bounding sphere in the bound's axes */
  pl_vec3 center;          /* of the bounding sphere, camera-relative, m */
  double radius_m;         /* of the bounding sphere */
  bool in_frame;           /* the sphere touches the frustum */
} pl_shot_volume;

typedef struct pl_shot_sun {
  pl_vec3 position; /* camera-relative, m */
  double radius_m;
  double irradiance_au;     /* W m-2 at 1 AU */
  double wavelengths_um[3]; /* of the bands */
  bool in_frame;            /* the disc touches the frustum */
} pl_shot_sun;

typedef struct pl_snapshot {
  int levels;
  size_t craft_count; /* as in the scene: number of objects with labels of their own */
  /* Rays of the image, in camera axes; motion and shutter are no longer used. */
  pl_ray_source rays;
  pl_mat3 camera_to_root;  /* rotation at mid-exposure */
  pl_vec3 camera_position; /* root frame, m */
  const pl_shot_object *objects;
  size_t object_count;
  const pl_shot_body *bodies;
  size_t body_count;
  /* Of the bounding spheres of all objects, and of all bodies (radius_m), to find those on a line.
   */
  pl_sphere_tree object_tree, body_tree;
  const pl_shot_volume *volumes;
  size_t volume_count;
  pl_shot_sun sun;
} pl_snapshot;

/* Returns the sun's irradiance at the point of a sphere that is nearest to the sun, W m-2 per band.
 */
double pl_shot_irradiance_max(const pl_snapshot *shot, pl_vec3 center, double radius_m);

/* Returns the piece that a triangle of the object's model belongs to; NULL if the object is not
 * articulated. */
static inline const pl_shot_piece *pl_shot_piece_of(const pl_shot_object *object,
                                                    uint32_t triangle) {
  return object->pieces == NULL ? NULL
                                : &object->pieces[pl_cut_piece(object->object->cut, triangle)];
}

/* Returns the object of a surface with a mesh. */
static inline const pl_shot_object *pl_shot_object_of(const pl_snapshot *shot, pl_surface_id id) {
  return &shot->objects[pl_surface_index(id)];
}

/* Returns the body of an ellipsoid, a height field or rocks. */
static inline const pl_shot_body *pl_shot_body_of(const pl_snapshot *shot, pl_surface_id id) {
  return &shot->bodies[pl_surface_index(id)];
}

/* Returns the index of a surface where objects are numbered first, then bodies, as in a view. */
static inline size_t pl_shot_slot(const pl_snapshot *shot, pl_surface_id id) {
  return (pl_surface_is_mesh(id) ? 0 : shot->object_count) + pl_surface_index(id);
}

/* Builds a snapshot in `arena`; borrows scene and placement for its lifetime. Returns PL_E_RANGE if
 * the camera is inside a body. */
pl_status pl_snapshot_build(const pl_scene *scene, const pl_placement *placement, pl_arena *arena,
                            pl_snapshot *out);

/* Returns PL_E_RANGE if the camera is inside a body that is a smooth ellipsoid. */
pl_status pl_shot_check_outside(const pl_shot_body *body);

/* Makes the view of a snapshot, in `arena`; its entities are the objects, then the bodies. The
 * caller fills in the exposure and the user's limits. */
pl_status pl_snapshot_view(const pl_snapshot *snapshot, pl_arena *arena, pl_view *out);

/* Input of culling: what the frame needs of a snapshot. */
typedef struct pl_culling {
  const pl_view *view; /* of the snapshot */
  double tolerance_dn;
  const bool *subpixel; /* body_count elements: sub-pixel bodies; NULL for none */
} pl_culling;

/* Makes a copy of a snapshot without the objects that are neither visible nor change a pixel by
 * more than the tolerance through shadows or reflections, and sets the flags of bodies (e.g.
 * shadowed) by the same tolerance. In a snapshot that was only placed, all objects are kept and all
 * bodies count as shadowed. Allocated in `arena`; borrows what `placed` borrows, and its volumes.
 */
pl_status pl_snapshot_cull(const pl_snapshot *placed, const pl_culling *culling, pl_arena *arena,
                           pl_snapshot *out);

/* Returns the unit direction in root axes through pixel position (u, v); zero if no ray of the lens
 * goes there. */
pl_vec3 pl_snapshot_ray(const pl_snapshot *snapshot, double u, double v);
/* The same for `count` pixels of a row from (u0, v) on, bit-identical; written to three arrays. */
void pl_snapshot_rays(const pl_snapshot *snapshot, int u0, int v, size_t count, double *x,
                      double *y, double *z);

/* Finds a cone, about the centre ray of a rectangle of the image (x0, y0, x1, y1; pixel positions),
 * that contains all its rays. */
void pl_snapshot_cone(const pl_snapshot *snapshot, const double rect[4], pl_vec3 *axis,
                      double *half_angle_rad);

/* Returns whether camera rays of a cone about a unit axis, through any point of the aperture, can
 * touch a sphere (camera-relative, root axes). */
bool pl_snapshot_sees(const pl_snapshot *snapshot, pl_vec3 center, double radius_m, pl_vec3 axis,
                      double half_angle_rad);

/* Returns whether a sphere (camera-relative, root axes) can touch the cone about a unit axis;
 * always true if the camera is inside the sphere. */
bool pl_sphere_in_cone(pl_vec3 center, double radius_m, pl_vec3 axis, double half_angle_rad);

/* Returns the irradiance of the unoccluded sun at a camera-relative point, W m-2. */
double pl_shot_sun_irradiance(const pl_shot_sun *sun, pl_vec3 point);

#endif
