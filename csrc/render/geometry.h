/* Kinds of geometry: one table, indexed by pl_surface_kind. Its rows say how rays meet a surface
 * and which pixels it may cover, and how a hit is located, shaded, left and labelled. Each kind has
 * a file of its own. */
#ifndef PL_RENDER_GEOMETRY_H
#define PL_RENDER_GEOMETRY_H

#include "render/coverage_mask.h"
#include "render/patch.h"
#include "render/vertex.h"
#include "trace/intersect.h"

/* What labels say of a surface; arrays are borrowed. */
typedef struct pl_geometry_label {
  pl_vec3 origin;             /* of its own axes, camera-relative, m */
  pl_mat3 rotation;           /* own axes to root axes */
  const pl_object *parts;     /* tells the part of a triangle; NULL: not by triangles */
  const pl_area_map *areas;   /* tells the part of a direction in own axes; NULL: there is one */
  const uint16_t *class_ids;  /* the scene's number of levels per part */
  const int32_t *part_ids;    /* one per part */
  pl_ground_labels on_ground; /* of rocks, or of craters; a class of 0 is that of the part */
  int32_t instance_id;
  bool classified; /* graphs give classes, see pl_geometry_kind.classify */
} pl_geometry_label;

/* Bounding sphere of a surface. */
typedef struct pl_geometry_bounds {
  pl_vec3 center; /* camera-relative, m */
  double radius_m;
  bool in_frame; /* it touches the frustum */
} pl_geometry_bounds;

typedef struct pl_geometry_kind {
  const char *name;
  pl_geometry_bounds (*bounds)(const pl_snapshot *shot, pl_surface_id id);
  const pl_intersect *intersect; /* NULL: rays meet it as part of another kind */
  /* Marks the pixels in which a surface may be visible, or a slice of them; NULL: none, either
   * because it has a closed form, or because those of another kind contain them. */
  void (*cover)(const pl_coverage_job *job, pl_surface_id id, size_t slice);
  /* Sets position, t, edges, weights and geometric normal of a hit; see pl_vertex_locate. */
  void (*locate)(const pl_snapshot *shot, const pl_beam *beam, const pl_hit *hit, bool exact,
                 pl_vertex *out);
  /* Returns the interpolated normal of a located vertex, on the side of its geometric normal; NULL
   * if that is the geometric normal. */
  pl_vec3f (*smooth_normal)(const pl_snapshot *shot, const pl_vertex *vertex);
  /* Fills the surface of a located vertex, before it is turned to the viewer's side. */
  void (*shade)(const pl_snapshot *shot, const pl_beam *beam, pl_detail detail, pl_vertex *vertex);
  /* The same of up to PL_SHADE_RUN vertices, where several together cost less; NULL: `shade`, which
   * is NULL otherwise. */
  void (*shade_run)(const pl_snapshot *shot, pl_detail detail, const pl_vertex_view *run,
                    size_t count);
  /* Replaces the geometric normal of a shaded vertex, on the viewer's side, by the normal of the
   * surface that secondary rays leave; NULL if they leave the surface itself. */
  void (*set_horizon)(const pl_snapshot *shot, pl_vertex *vertex);
  /* Sets the origin of a secondary ray and what it cannot hit. `side`: 1 to the viewer's side, else
   * -1. */
  void (*leave)(const pl_snapshot *shot, const pl_vertex *vertex, float side, pl_ray *ray);
  /* Sets part, point and normal of a patch's location; `point` is where the hit is, camera-relative
   * in root axes. */
  void (*set_spot)(const pl_snapshot *shot, const pl_hit *hit, pl_vec3 point, pl_spot *spot);
  void (*label)(const pl_snapshot *shot, pl_surface_id id, pl_geometry_label *out);
  /* Sets the class ids of a located vertex at the levels where its graph says them (see
   * shade/graph_classes.h); of all others they are left as they are. NULL: no graph does. */
  void (*classify)(const pl_snapshot *shot, const pl_beam *beam, pl_vertex *vertex, uint16_t *ids);
} pl_geometry_kind;

#define PL_KIND(NAME, name, replaces) extern const pl_geometry_kind pl_geometry_##name;
PL_SURFACE_KIND_LIST(PL_KIND)
#undef PL_KIND
extern const pl_geometry_kind *const pl_geometry_kinds[PL_SURFACE_KINDS];

/* Returns the row of a surface; not for PL_NO_SURFACE. */
static inline const pl_geometry_kind *pl_geometry_of(pl_surface_id id) {
  return pl_geometry_kinds[pl_surface_kind_of(id)];
}

/* Builds the tracer of a snapshot with all kinds; see pl_tracer_build. */
pl_status pl_geometry_tracer(pl_accelerators *kept, const pl_snapshot *shot, pl_arena *arena,
                             const pl_tracer **out);

/* What shapes share with other meshes. */
pl_geometry_bounds pl_mesh_bounds(const pl_snapshot *shot, pl_surface_id id);
void pl_mesh_locate(const pl_snapshot *shot, const pl_beam *beam, const pl_hit *hit, bool exact,
                    pl_vertex *out);
pl_vec3f pl_mesh_smooth_normal(const pl_snapshot *shot, const pl_vertex *vertex);
void pl_mesh_leave(const pl_snapshot *shot, const pl_vertex *vertex, float side, pl_ray *ray);
void pl_mesh_set_spot(const pl_snapshot *shot, const pl_hit *hit, pl_vec3 point, pl_spot *spot);
void pl_mesh_label(const pl_snapshot *shot, pl_surface_id id, pl_geometry_label *out);
/* What terrain and its rocks share. */
void pl_height_field_leave(const pl_snapshot *shot, const pl_vertex *vertex, float side,
                           pl_ray *ray);
/* What terrain and its rocks share with ellipsoids. */
pl_geometry_bounds pl_body_bounds(const pl_snapshot *shot, pl_surface_id id);
void pl_body_label(const pl_snapshot *shot, pl_surface_id id, pl_geometry_label *out);
/* What labels say of the surface of a body, wherever it is. */
void pl_body_surface_label(const pl_body *body, pl_geometry_label *out);

#endif
