/* The scene: what stays from frame to frame (models, maps, label ids) and what a frame places. */
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
#include "scene/volume.h"
#include "shade/clouds.h"
#include "shade/ground.h"
#include "shade/material_surface.h"
#include "shade/reflectance.h"

enum { PL_LEVELS_MAX = 8 };

/* How a model is cut into parts, and their labels. */
typedef struct pl_part_table {
  size_t count;                  /* parts */
  const uint32_t *triangle_part; /* part of each of the model's triangles; NULL: the model's own,
                                    then count is the model's part_count */
  const int32_t *part_ids;       /* one per part */
  const uint16_t *class_ids;     /* the scene's levels per part */
} pl_part_table;

/* An instance of a model. A mesh point p lies at scale * (p - offset) in the object's frame, where
 * the scale is that of pl_shot_object. A
 * body with a shape has one too, which moves with it and is shaded as it. */
typedef struct pl_object {
  char *name;            /* owned */
  const pl_model *model; /* borrowed; of an articulated object the cut's whole */
  pl_vec3 offset;        /* mesh units */
  int32_t obj_id, instance_id;
  size_t part_count;
  uint32_t *triangle_part;        /* owned, per triangle; NULL: the model's */
  int32_t *part_ids;              /* owned, one per part */
  uint16_t *class_ids;            /* owned, levels per part */
  pl_model_summary model_summary; /* of the model's own materials */
  pl_model_summary summary;       /* of these and the graphs */
  pl_object_materials *materials; /* owned; NULL: the model's own on all triangles */
  const pl_cover *cover;          /* the scene's; NULL of an articulated object */
  const pl_cut *cut;              /* the scene's; NULL when nothing on the object moves */
  int body;                       /* index of the body whose shape it is; -1: none */
  double reach;                   /* of a shape: of its farthest vertex from the body's centre, m */
} pl_object;

/* An ellipsoid with an equirectangular map. Its frame: x at longitude 0, z at the north pole. */
typedef struct pl_body {
  char *name;            /* owned */
  const pl_model *shape; /* borrowed: its surface instead of the ellipsoid's, in metres and
                            body axes; NULL for none */
  bool dressed;          /* its surface is of the shape's own materials, not of the keys below */
  const pl_texture *map; /* borrowed, NULL for none */
  double map_center_lon_rad;         /* longitude of the map's centre column */
  bool geodetic;                     /* maps count by geodetic latitude, not by planetocentric */
  const pl_reflectance *reflectance; /* row of the table */
  const pl_grid *regolith_map;       /* borrowed, NULL for none: three pl_regolith_texel a cell */
  const pl_air *air;                 /* borrowed, NULL for none */
  const pl_texture *cloud_map;       /* borrowed, NULL for none: cover of its clouds */
  bool geodetic_clouds;              /* the same of that map */
  const pl_rings *rings;             /* borrowed, NULL for none: in the plane of x and y */
  pl_ground ground;                  /* of a body without a graph; open water on Lambert's law */
  int32_t instance_id, part_id;
  uint16_t class_ids[PL_LEVELS_MAX];
  const pl_graph *graph; /* borrowed: instead of, or around, the above surface; NULL for none */
  /* Set by pl_scene_add_body: */
  pl_regolith_texel brightest[3]; /* of the map's cells in each band, seen with the sun behind */
  pl_model_summary summary;       /* of the graph */
  float random;                   /* 0..1, of the name */
} pl_body;

typedef struct pl_scene {
  int levels;
  pl_object *objects;  /* owned: those that were added, then the shapes of bodies */
  size_t craft_count;  /* those that were added: they have places and labels of their own */
  size_t object_count; /* all */
  pl_body *bodies;     /* owned */
  size_t body_count;
  pl_cut **cuts; /* owned; shared by objects of the same model and moving nodes */
  size_t cut_count;
  pl_cover **covers; /* owned; one a model of objects that are not articulated */
  size_t cover_count;
} pl_scene;

/* levels: of semantic labels, 1..PL_LEVELS_MAX. */
pl_status pl_scene_init(int levels, pl_scene *out);
void pl_scene_clear(pl_scene *scene);
/* Copies name and what the table points to; its index is the craft_count of before. `offset`: the
 * point of the model, in its units, that is the origin of the object's frame. PL_E_RANGE for a
 * triangle's part that is not in it. */
pl_status pl_scene_add_object(pl_scene *scene, const char *name, const pl_model *model,
                              pl_vec3 offset, int32_t obj_id, int32_t instance_id,
                              const pl_part_table *parts);
/* Puts graphs on an object's triangles (-1: the model's material) in the place of those that are
 * there, also between frames: accelerators do not depend on them. `triangle_graph`: as many as the
 * model's triangles, in the model's order; the graphs stay borrowed. A failure changes nothing. */
pl_status pl_scene_set_materials(pl_scene *scene, size_t object, const pl_graph *const *graphs,
                                 size_t count, const int32_t *triangle_graph);
/* Lets nodes of an object's model move, in every frame by a motion each (pl_object_state). Once an
 * object. Triangles are from then on in the order of the pieces. PL_E_RANGE for bad nodes. */
pl_status pl_scene_articulate(pl_scene *scene, size_t object, const int *nodes, size_t count);
/* Values that each frame gives to an object's graphs. */
static inline size_t pl_object_parameter_count(const pl_object *object) {
  return object->materials != NULL ? object->materials->parameter_count : 0;
}
static inline size_t pl_body_parameter_count(const pl_body *body) {
  return body->graph != NULL ? pl_graph_parameter_count(body->graph) : 0;
}
/* Moving nodes of an object. */
static inline size_t pl_object_mover_count(const pl_object *object) {
  return object->cut != NULL ? object->cut->count - 1 : 0;
}
/* Part of a triangle of the object's model: index into part_ids. */
static inline uint32_t pl_object_part(const pl_object *object, uint32_t triangle) {
  return object->triangle_part != NULL ? object->triangle_part[triangle]
                                       : object->model->triangle_part[triangle];
}
/* Copies *body and its name. A shape becomes an object of one part, behind those that are added. */
pl_status pl_scene_add_body(pl_scene *scene, const pl_body *body);
/* Replaces a body's graph (borrowed; NULL for none), also between frames. */
void pl_body_set_graph(pl_body *body, const pl_graph *graph);

/* Child-to-root poses when the shutter opens on the first row and when it closes on the last; root
 * frame, metres. */
typedef struct pl_motion {
  pl_pose open, close;
  const pl_pose *keys; /* borrowed: evenly in time, from `open` to `close`; NULL: these two */
  int key_count;       /* odd, at least 3; 0 without keys */
} pl_motion;
/* Pose in the middle of that time, the instant of all labels: the middle key. */
pl_pose pl_motion_middle(const pl_motion *motion);
/* Pose at a part u of that time, 0..1, between the keys about it: straight, and by the shorter
 * turn.
 */
pl_pose pl_motion_at(const pl_motion *motion, double u);

typedef struct pl_object_state {
  pl_motion motion;
  double scale;            /* metres per model unit */
  const pl_affine *movers; /* of an articulated object: rest to now of each moving node, model axes
                              and units (geom/articulation.h), in the middle of the exposure */
  const pl_affine *mover_keys; /* the same at the keys, key by key; NULL: they keep their motion */
  int mover_key_count;
  const pl_value *parameters; /* of the object's graphs, one graph after the other */
} pl_object_state;

typedef struct pl_body_state {
  pl_motion motion;
  pl_vec3 radii_m;
  float albedo[3];            /* factor on the map, or the albedo itself */
  float emission[3];          /* W m-2 sr-1 */
  const pl_value *parameters; /* of the body's graph */
  pl_clouds clouds;           /* none by default */
  pl_regolith regolith;       /* for photometric rows; what is NAN is the map's, or 0 without one */
  pl_ground_state ground;
} pl_body_state;

typedef struct pl_sun {
  pl_vec3 position_m; /* root frame, in the middle of the exposure */
  double radius_m;
  double irradiance_au;     /* W m-2 at 1 AU, in every band */
  double wavelengths_um[3]; /* of the bands, for the disc's darkening towards its edge */
  const pl_vec3 *keys;      /* borrowed: its position at the keys; NULL: it stands */
  int key_count;
} pl_sun;

/* p_pixel = K p of what the lens makes of a point, OpenCV axes, integer pixel centres. */
typedef struct pl_camera {
  int width, height;           /* pixels */
  double fx, fy, cx, cy, skew; /* pixels */
  pl_lens lens;                /* a pinhole without a model */
  double aperture_m;           /* diameter of the lens, which focuses; 0: all is sharp */
  double focus_per_m;          /* 1 over the depth that is in focus; 0: infinity */
  pl_motion motion;            /* camera to root */
} pl_camera;
/* Direction of a pixel position in camera axes (not unit); zero where the lens has no ray. */
pl_vec3 pl_camera_ray(const pl_camera *camera, double u, double v);
/* Pixel position of a direction in camera axes; false for none. */
bool pl_camera_project(const pl_camera *camera, pl_vec3 direction, double pixel[2]);
/* With a lens: pixels that the convex hull of points in camera axes may cover, as x0, y0, x1, y1;
 * x0 > x1 for none. All of the plane where the hull may hold the camera. */
void pl_camera_bound(const pl_camera *camera, const pl_vec3 *points, size_t count, double rect[4]);
/* PL_E_RANGE, saying where, if pixels of the image lie beyond what the lens can see. */
pl_status pl_camera_check_lens(const pl_camera *camera);
/* By how many pixels the lens moves the image at most; infinite beyond a right angle. */
double pl_camera_lens_shift(const pl_camera *camera);

/* When rows gather light: row r from r line_s on, for exposure_s. */
typedef struct pl_shutter {
  double exposure_s, line_s; /* both 0: an instant, the middle of what the motions say */
  bool held; /* the keys are too far apart to say what is between them: each is a state that holds
                until halfway to the next */
} pl_shutter;

/* Everything that changes with the frame; arrays are borrowed. */
typedef struct pl_placement {
  const pl_object_state *objects; /* [craft_count] */
  const pl_body_state *bodies;
  pl_sun sun;
  pl_camera camera;
  pl_shutter shutter;
  const pl_volume *volumes; /* as many as it says */
  size_t volume_count;
} pl_placement;
/* The state of the scene's object `index`: the shape of a body has the body's motion. */
pl_object_state pl_placement_object(const pl_placement *placement, const pl_object *object,
                                    size_t index);
/* PL_E_RANGE naming the object or key for non-finite or non-positive values, and where the camera
 * is inside a body's shape in the middle of the exposure. */
pl_status pl_placement_check(const pl_scene *scene, const pl_placement *placement);

#endif
