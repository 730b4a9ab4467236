/* The scene: what is constant between frames (models, maps, label ids), and the placement that each
 * frame supplies. */
#ifndef PL_SCENE_SCENE_H
#define PL_SCENE_SCENE_H

#include <stddef.h>
#include <stdint.h>

#include "air/air.h"
#include "base/status.h"
#include "geom/cover.h"
#include "geom/cut.h"
#include "geom/grid.h"
#include "geom/model.h"
#include "math/rotation.h"
#include "rings/rings.h"
#include "scene/lens.h"
#include "scene/materials.h"
#include "scene/sent_light.h"
#include "scene/volume.h"
#include "shade/clouds.h"
#include "shade/ground.h"
#include "shade/material_surface.h"
#include "shade/reflectance.h"
#include "terrain/area_map.h"
#include "terrain/crater_marks.h"

enum { PL_LEVELS_MAX = 32 };

/* Assignment of a model's triangles to parts, and the labels of the parts. */
typedef struct pl_part_table {
  size_t count; /* number of parts */
  /* part of each triangle; NULL for the parts of the model: then count is its part_count */
  const uint32_t *triangle_part;
  const int32_t *part_ids;   /* one per part */
  const uint16_t *class_ids; /* the scene's number of levels per part */
} pl_part_table;

/* Instance of a model. A mesh point p lies at scale * (p - offset) in the object's frame, with the
 * scale of pl_shot_object. A body with a shape also has such an object, which moves and is shaded
 * with the body. */
typedef struct pl_object {
  char *name;            /* owned */
  const pl_model *model; /* borrowed; for an articulated object the whole of its cut */
  pl_vec3 offset;        /* mesh units */
  int32_t obj_id, instance_id;
  size_t part_count;
  uint32_t *triangle_part;        /* owned, per triangle; NULL for the parts of the model */
  int32_t *part_ids;              /* owned, one per part */
  uint16_t *class_ids;            /* owned, the scene's number of levels per part */
  pl_model_summary model_summary; /* of the model's own materials */
  pl_model_summary summary;       /* of the model's materials and the graphs */
  pl_sent_light sent;             /* of the model with its materials and graphs */
  pl_object_materials *materials; /* owned; NULL: all triangles have the model's materials */
  const pl_cover *cover;          /* owned by the scene; NULL for an articulated object */
  const pl_cut *cut;              /* owned by the scene; NULL if no part of the object moves */
  int body;     /* index of the body that this object is the shape of; -1 for none */
  double reach; /* for a shape: distance of its farthest vertex from the body's centre, m */
} pl_object;

/* Classes that rocks and craters of a terrain have at one level, in place of their body's. */
typedef struct pl_ground_labels {
  bool apart; /* whether they have */
  int level;
  uint16_t rock, crater;
} pl_ground_labels;

/* Ellipsoid with equirectangular maps. Body axes: x at longitude 0, z at the north pole. */
typedef struct pl_body {
  char *name; /* owned */
  /* borrowed: mesh that replaces the ellipsoid, in metres and body axes; NULL for none */
  const pl_model *shape;
  const pl_terrain *terrain; /* borrowed: heights over the ellipsoid; NULL for a smooth body */
  double cells_per_pixel;    /* resolution of the terrain's mesh, > 0 */
  double finest_cell_m;      /* its cells are never smaller, > 0 */
  bool dressed; /* its surface has the shape's own materials and ignores the fields below */
  const pl_texture *map;     /* borrowed, NULL for none */
  double map_center_lon_rad; /* longitude of the map's centre column */
  bool geodetic;             /* maps use geodetic latitude instead of planetocentric latitude */
  const pl_reflectance *reflectance; /* entry of the table of reflectance models */
  const pl_grid *regolith_map;       /* borrowed, NULL for none: three pl_regolith_texel per cell */
  const pl_air *air;                 /* borrowed, NULL for none */
  const pl_texture *cloud_map;       /* borrowed, NULL for none: coverage of its clouds */
  bool geodetic_clouds;              /* cloud_map uses geodetic latitude */
  const pl_rings *rings;             /* borrowed, NULL for none: in the body's xy plane */
  pl_ground ground; /* for a body without a graph; open water only with Lambert reflectance */
  int32_t instance_id, part_id;
  int32_t obj_id; /* of its model; 0: the body has no object label */
  uint16_t class_ids[PL_LEVELS_MAX];
  /* Areas of the surface with parts of their own, as the map numbers them from 1 on; what is in
   * none has part_id and class_ids. The arrays of `areas` are copied into `parts`. */
  pl_area_map area_map;
  pl_part_table areas;
  pl_ground_labels ground_labels;
  pl_crater_criteria craters; /* that labels show; least_px of 0: PL_CRATER_CRITERIA */
  const pl_graph *graph; /* borrowed: in place of or on top of the surface above; NULL for none */
  /* Set by pl_scene_add_body: */
  pl_part_table parts;            /* owned: the surface, then its areas */
  pl_regolith_texel brightest[3]; /* brightest cell of the map in each band at zero phase angle */
  pl_model_summary summary;       /* of the graph */
  float random;                   /* 0..1, derived from the name */
} pl_body;

typedef struct pl_scene {
  int levels;
  pl_object *objects;  /* owned: the objects that were added, then the shapes of bodies */
  size_t craft_count;  /* number of objects that were added; they have placements of their own */
  size_t object_count; /* including shapes of bodies */
  pl_body *bodies;     /* owned */
  size_t body_count;
  pl_cut **cuts; /* owned; shared by objects with the same model and moving nodes */
  size_t cut_count;
  pl_cover **covers; /* owned; one per model of objects that are not articulated */
  size_t cover_count;
} pl_scene;

/* levels: number of semantic label levels, 1..PL_LEVELS_MAX. */
pl_status pl_scene_init(int levels, pl_scene *out);
void pl_scene_clear(pl_scene *scene);
/* Adds an object with the index craft_count (before the call). Copies the name and the arrays of
 * the table. `offset`: the point of the model, in model units, that becomes the origin of the
 * object's frame. Returns PL_E_RANGE if a triangle's part is not in the table. */
pl_status pl_scene_add_object(pl_scene *scene, const char *name, const pl_model *model,
                              pl_vec3 offset, int32_t obj_id, int32_t instance_id,
                              const pl_part_table *parts);
/* Replaces the material assignment of an object: graphs on its triangles (-1: the model's
 * material). May be called between frames, since accelerators do not depend on it.
 * `triangle_graph`: one per triangle of the model, in the model's order; the graphs stay borrowed.
 * On failure nothing changes. */
pl_status pl_scene_set_materials(pl_scene *scene, size_t object, const pl_graph *const *graphs,
                                 size_t count, const int32_t *triangle_graph);
/* Makes nodes of an object's model movable; each frame supplies their motions (pl_object_state).
 * Call it at most once per object. The triangles are reordered by piece. Returns PL_E_RANGE for
 * invalid nodes. */
pl_status pl_scene_articulate(pl_scene *scene, size_t object, const int *nodes, size_t count);
/* Number of parameters that each frame supplies for an object's graphs. */
static inline size_t pl_object_parameter_count(const pl_object *object) {
  return object->materials != NULL ? object->materials->parameter_count : 0;
}
static inline size_t pl_body_parameter_count(const pl_body *body) {
  return body->graph != NULL ? pl_graph_parameter_count(body->graph) : 0;
}
/* Number of object labels: of all objects that were added, then of the bodies with an obj_id. */
size_t pl_scene_label_count(const pl_scene *scene);
/* Number of moving nodes of an object. */
static inline size_t pl_object_mover_count(const pl_object *object) {
  return object->cut != NULL ? object->cut->count - 1 : 0;
}
/* Returns the part of a triangle of the object's model, an index into part_ids. */
static inline uint32_t pl_object_part(const pl_object *object, uint32_t triangle) {
  return object->triangle_part != NULL ? object->triangle_part[triangle]
                                       : object->model->triangle_part[triangle];
}
/* Copies *body and its name. A shape is added as an object of one part, behind the objects that
 * were added. */
pl_status pl_scene_add_body(pl_scene *scene, const pl_body *body);
/* Replaces a body's graph (borrowed; NULL for none); may be called between frames. */
void pl_body_set_graph(pl_body *body, const pl_graph *graph);

/* Child-to-root poses, when the shutter opens on the first row and when it closes on the last; root
 * frame, metres. */
typedef struct pl_motion {
  pl_pose open, close;
  /* borrowed: poses at equal time steps from `open` to `close`; NULL: only these two */
  const pl_pose *keys;
  int key_count; /* odd, at least 3; 0 if there are no keys */
} pl_motion;
/* Pose in the middle of the frame's time, for which labels are valid: the middle key. */
pl_pose pl_motion_middle(const pl_motion *motion);
/* Pose at the fraction u (0..1) of the frame's time, interpolated between adjacent keys: linear in
 * position, the shorter rotation in attitude. */
pl_pose pl_motion_at(const pl_motion *motion, double u);

typedef struct pl_object_state {
  pl_motion motion;
  double scale; /* metres per model unit */
  /* for an articulated object: transform of each moving node from its rest pose to its pose in the
   * middle of the exposure, in model axes and units (geom/articulation.h) */
  const pl_affine *movers;
  /* the same at each key, key by key; NULL: the nodes do not move during the exposure */
  const pl_affine *mover_keys;
  int mover_key_count;
  const pl_value *parameters; /* of the object's graphs, one graph after the other */
} pl_object_state;

typedef struct pl_body_state {
  pl_motion motion;
  pl_vec3 radii_m;
  float albedo[3];            /* factor on the map, or the albedo if there is no map */
  float contrast;             /* of the maps of albedo about their mean, less 1 */
  float emission[3];          /* W m-2 sr-1 */
  const pl_value *parameters; /* of the body's graph */
  pl_clouds clouds;           /* none by default */
  /* for photometric reflectance models; NAN: value of the map, or 0 without a map */
  pl_regolith regolith;
  pl_ground_state ground;
} pl_body_state;

typedef struct pl_sun {
  pl_vec3 position_m; /* root frame, in the middle of the exposure */
  double radius_m;
  double irradiance_au;     /* W m-2 at 1 AU, in every band */
  double wavelengths_um[3]; /* of the bands, for limb darkening */
  const pl_vec3 *keys;      /* borrowed: position at each key; NULL: constant */
  int key_count;
} pl_sun;

/* p_pixel = K p, with p the image of a point on the image plane of the lens; OpenCV axes, pixel
 * centres at integers. */
typedef struct pl_camera {
  int width, height;           /* pixels */
  double fx, fy, cx, cy, skew; /* pixels */
  pl_lens lens;                /* without a model: a pinhole */
  double aperture_m;           /* aperture diameter of a thin lens; 0: everything is in focus */
  double focus_per_m; /* inverse of the focus distance along the optical axis; 0: infinity */
  pl_motion motion;   /* camera to root */
} pl_camera;
/* Returns the direction of a pixel position in camera axes (not unit); zero if no ray of the lens
 * goes there. */
pl_vec3 pl_camera_ray(const pl_camera *camera, double u, double v);
/* Finds the pixel position of a direction in camera axes; returns false if it has none. */
bool pl_camera_project(const pl_camera *camera, pl_vec3 direction, double pixel[2]);
/* Bounds the pixels that the convex hull of points in camera axes may cover, with the lens: x0, y0,
 * x1, y1; x0 > x1 for none; the whole plane if the hull may contain the camera. */
void pl_camera_bound(const pl_camera *camera, const pl_vec3 *points, size_t count, double rect[4]);
/* Returns PL_E_RANGE, with the position, if pixels of the image lie outside the lens's field of
 * view. */
pl_status pl_camera_check_lens(const pl_camera *camera);
/* Returns the largest displacement in pixels that the distortion causes in the image; infinite for
 * half angles of 90 degrees or more. */
double pl_camera_lens_shift(const pl_camera *camera);

/* Exposure of rows: row r is exposed from r line_s on, for exposure_s. */
typedef struct pl_shutter {
  double exposure_s, line_s; /* both 0: a single instant, in the middle of the motions */
  /* the keys are too far apart for interpolation: each state holds until halfway to the next key */
  bool held;
} pl_shutter;
/* Returns the middle of a row's exposure, s since the start of the first row's. */
static inline double pl_shutter_row_s(const pl_shutter *shutter, double row) {
  return row * shutter->line_s + 0.5 * shutter->exposure_s;
}

/* Everything that varies between frames; arrays are borrowed. */
typedef struct pl_placement {
  const pl_object_state *objects; /* craft_count elements */
  const pl_body_state *bodies;
  pl_sun sun;
  pl_camera camera;
  pl_shutter shutter;
  const pl_volume *volumes; /* volume_count elements */
  size_t volume_count;
} pl_placement;
/* Returns the state of the scene's object `index`; the shape of a body has the body's motion. */
pl_object_state pl_placement_object(const pl_placement *placement, const pl_object *object,
                                    size_t index);
/* Returns PL_E_RANGE, naming the object or key, for values that are not finite or not positive, and
 * if the camera is inside a body's shape in the middle of the exposure. */
pl_status pl_placement_check(const pl_scene *scene, const pl_placement *placement);

#endif
