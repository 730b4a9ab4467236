/* The camera-relative scene of one instant: what ray tracing and shading read. Nothing changes it
 * once it is made. Axes are the root's, the origin is the camera at mid-exposure. */
#ifndef PL_SCENE_SNAPSHOT_H
#define PL_SCENE_SNAPSHOT_H

#include <stdbool.h>

#include "base/memory.h"
#include "plan/view.h"
#include "scene/scene.h"

/* What moves by itself on an articulated object. */
typedef struct pl_shot_piece {
  const pl_model *model; /* borrowed: its own triangles */
  const pl_cover *cover; /* borrowed */
  bool present;          /* has triangles, and its motion does not flatten it */
  pl_mat3 linear;        /* model axes to root axes, m per mesh unit */
  pl_vec3 origin;        /* of the mesh's coordinates, camera-relative, m */
  pl_mat3 normal;        /* turns normals, not to unit length */
  float side;            /* -1 where the motion mirrors: triangles wind the other way round */
  float to_view[12];     /* as in pl_shot_object */
} pl_shot_piece;

typedef struct pl_shot_object {
  const pl_object *object;    /* borrowed */
  const pl_value *parameters; /* of its graphs; borrowed */
  double scale;               /* metres per mesh unit */
  pl_mat3 rotation;           /* object axes to root axes */
  pl_vec3 position;           /* of the object's origin, camera-relative, m */
  float to_view[12];          /* mesh units to view, 3x4 column-major (x, y, z axes, translation) */
  pl_vec3 center;             /* of the bounding sphere, camera-relative, m */
  double radius_m;            /* of the bounding sphere */
  bool in_frame;              /* the sphere touches the frustum */
  bool kept;                  /* part of the accelerator; culled ones cannot touch the image */
  bool eclipsed;              /* a body's shadow may fall on it; found by pl_snapshot_cull */
  bool dark;                  /* it lies wholly in a body's umbra; found by pl_snapshot_cull */
  bool subpixel; /* as of bodies: of the shape of one, too small for the samples of pixels */
  /* Of an articulated object: every triangle is in one of these and placed by it, not by to_view;
   * pose and scale are still the object's. */
  const pl_shot_piece *pieces; /* in the order of the cut; NULL of others */
  size_t piece_count;
} pl_shot_object;

typedef struct pl_shot_body {
  const pl_body *body;         /* borrowed */
  const pl_body_state *state;  /* borrowed */
  const pl_shot_object *shape; /* what rays meet instead of the ellipsoid; NULL: that */
  pl_mat3 rotation;            /* body axes to root axes */
  pl_vec3 center;              /* camera-relative, m */
  pl_vec3 camera;              /* the camera in body axes, from the body's centre, m */
  pl_mat3 to_unit;             /* root axes to body axes scaled by the radii: a unit sphere there */
  pl_vec3 camera_unit;         /* the camera in those */
  double radius_m;             /* largest semi-axis */
  bool in_frame;               /* camera rays may meet the ellipsoid; never of one with a shape */
  bool air_in_frame;           /* its air, if it has any, touches the frustum */
  bool clouds_in_frame;        /* likewise */
  bool rings_in_frame;         /* likewise */
  bool subpixel;               /* too small for the samples of pixels; see pl_culling */
  bool shadowed;    /* something may cast a noticeable shadow on it; found by pl_snapshot_cull */
  bool bounced;     /* others may noticeably light it by reflection; found by pl_snapshot_cull */
  bool near_meshes; /* objects may, or hide what others send it; found by pl_snapshot_cull */
  /* Factors on the light with which cheaper laws come nearest to its own where it is seen; NULL
   * where they may not stand for it. Those of pl_culling's view. */
  const pl_view_lods *lods;
} pl_shot_body;

typedef struct pl_shot_volume {
  const pl_volume *volume; /* borrowed */
  pl_mat3 rotation;        /* axes of the bound to root axes */
  pl_vec3 origin;          /* of the bound, camera-relative, m */
  pl_bound_ball ball;      /* that holds it, in its own axes */
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
  size_t craft_count;      /* as the scene's: objects with labels of their own */
  pl_camera camera;        /* intrinsics; its motion is not used any more */
  pl_mat3 camera_to_root;  /* rotation at mid-exposure */
  pl_vec3 camera_position; /* root frame, m */
  const pl_shot_object *objects;
  size_t object_count;
  const pl_shot_body *bodies;
  size_t body_count;
  const pl_shot_volume *volumes;
  size_t volume_count;
  pl_shot_sun sun;
} pl_snapshot;

/* The sun's light at the point of a sphere that is nearest to it, W m-2 per band. */
double pl_shot_irradiance_max(const pl_snapshot *shot, pl_vec3 center, double radius_m);

/* The piece of a triangle of the object's model; NULL when the object has none. */
static inline const pl_shot_piece *pl_shot_piece_of(const pl_shot_object *object,
                                                    uint32_t triangle) {
  return object->pieces == NULL ? NULL
                                : &object->pieces[pl_cut_piece(object->object->cut, triangle)];
}

/* Built in `arena`; borrows scene and placement for as long as it is used. PL_E_RANGE when the
 * camera is inside a body. */
pl_status pl_snapshot_build(const pl_scene *scene, const pl_placement *placement, pl_arena *arena,
                            pl_snapshot *out);

/* The view of a snapshot; things are objects, then bodies, built in `arena`. Exposure and the
 * user's ceilings are filled in by the caller. */
pl_status pl_snapshot_view(const pl_snapshot *snapshot, pl_arena *arena, pl_view *out);

/* What decides how much of a snapshot a frame needs. */
typedef struct pl_culling {
  const pl_view *view; /* of the snapshot */
  double tolerance_dn;
  const bool *subpixel; /* [body_count]: too small for the samples of pixels; NULL: none */
} pl_culling;

/* A snapshot without the objects that can neither be seen nor, by shadow or reflection, change what
 * is seen by more than the tolerance; of its bodies it tells which ones shadows of more than that
 * may fall on. In one that was only placed everything is kept and every body counts as shadowed.
 * In `arena`; borrows what `placed` does, and its volumes. */
pl_status pl_snapshot_cull(const pl_snapshot *placed, const pl_culling *culling, pl_arena *arena,
                           pl_snapshot *out);

/* Unit direction in root axes through pixel position (u, v); zero where the lens has no ray. */
pl_vec3 pl_snapshot_ray(const pl_snapshot *snapshot, double u, double v);
/* Those of `count` pixels from (u0, v) on along a row, to the last bit; into three arrays. */
void pl_snapshot_rays(const pl_snapshot *snapshot, int u0, int v, size_t count, double *x,
                      double *y, double *z);

/* The cone about the middle of a rectangle of the image (x0, y0, x1, y1; pixel positions) that
 * holds all its rays. */
void pl_snapshot_cone(const pl_snapshot *snapshot, const double rect[4], pl_vec3 *axis,
                      double *half_angle_rad);

/* Whether camera rays of a cone about a unit axis, by whatever point of the lens, can touch a
 * sphere (camera-relative, root axes). */
bool pl_snapshot_sees(const pl_snapshot *snapshot, pl_vec3 center, double radius_m, pl_vec3 axis,
                      double half_angle_rad);

/* Whether a sphere (camera-relative, root axes) can touch the cone about a unit axis. A camera
 * inside the sphere always does. */
bool pl_sphere_in_cone(pl_vec3 center, double radius_m, pl_vec3 axis, double half_angle_rad);

/* Irradiance of the unshadowed sun at a camera-relative point, W m-2. */
double pl_shot_sun_irradiance(const pl_shot_sun *sun, pl_vec3 point);

#endif
