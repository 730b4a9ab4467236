/* Scenes of a few entities with their placement, built in memory. */
#ifndef PL_TESTS_SCENES_H
#define PL_TESTS_SCENES_H

#include "models.h"
#include "scene/scene.h"

/* A point of a posed frame, in the frame of its pose. */
static inline pl_vec3 pose_apply(pl_pose pose, pl_vec3 p) {
  return pl_vec3_add(pl_quat_rotate(pose.q, p), pose.t);
}

enum { STAGE_THINGS = 16 };

/* A scene and what a frame places in it. Ids are 1, 2, ... in order of adding, objects and bodies
 * alike; classes are 100 + id at level 0 and 200 + id at level 1. */
typedef struct stage {
  pl_scene scene;
  pl_object_state objects[STAGE_THINGS];
  pl_body_state bodies[STAGE_THINGS];
  pl_placement placement;
} stage;

static inline pl_motion still(pl_vec3 position, pl_quat rotation) {
  const pl_pose pose = {position, rotation};
  return (pl_motion){.open = pose, .close = pose};
}

/* A camera at the root's origin looking along +z with x right and y down (root axes), and a sun one
 * astronomical unit behind it. */
static inline void stage_init(stage *s, int width, int height, double focal_px) {
  memset(s, 0, sizeof *s);
  assert_int_equal(pl_scene_init(2, &s->scene), PL_OK);
  s->placement = (pl_placement){
      .objects = s->objects,
      .bodies = s->bodies,
      .sun = {{0, 0, -149597870700.0}, 695700e3, 1361.0},
      .camera = {.width = width,
                 .height = height,
                 .fx = focal_px,
                 .fy = focal_px,
                 .cx = 0.5 * (width - 1),
                 .cy = 0.5 * (height - 1),
                 .motion = still((pl_vec3){0, 0, 0}, PL_QUAT_IDENTITY)},
  };
}
static inline void stage_clear(stage *s) { pl_scene_clear(&s->scene); }

static inline int32_t stage_next_id(const stage *s) {
  return (int32_t)(s->scene.craft_count + s->scene.body_count + 1);
}

/* The model's parts all get the object's id; models live longer than the stage. */
static inline size_t stage_add_object(stage *s, const pl_model *model, pl_vec3 position,
                                      pl_quat rotation, double scale) {
  const size_t index = s->scene.craft_count;
  const int32_t id = stage_next_id(s);
  int32_t parts[8];
  uint16_t classes[16];
  assert_true(model->part_count <= 8 && index < STAGE_THINGS);
  for (size_t i = 0; i < model->part_count; i++) {
    parts[i] = id;
    classes[2 * i] = (uint16_t)(100 + id);
    classes[2 * i + 1] = (uint16_t)(200 + id);
  }
  const pl_part_table table = {.count = model->part_count, .part_ids = parts, .class_ids = classes};
  assert_int_equal(
      pl_scene_add_object(&s->scene, "object", model, (pl_vec3){0, 0, 0}, id, id, &table), PL_OK);
  s->objects[index] = (pl_object_state){.motion = still(position, rotation), .scale = scale};
  return index;
}

static inline size_t stage_add_body(stage *s, pl_vec3 position, pl_vec3 radii_m, float albedo) {
  const size_t index = s->scene.body_count;
  const int32_t id = stage_next_id(s);
  const pl_body body = {
      .name = (char *)(uintptr_t) "body",
      .reflectance = &pl_reflectance_lambert,
      .instance_id = id,
      .part_id = id,
      .class_ids = {(uint16_t)(100 + id), (uint16_t)(200 + id)},
  };
  assert_true(index < STAGE_THINGS);
  assert_int_equal(pl_scene_add_body(&s->scene, &body), PL_OK);
  s->bodies[index] = (pl_body_state){.motion = still(position, PL_QUAT_IDENTITY),
                                     .radii_m = radii_m,
                                     .albedo = {albedo, albedo, albedo}};
  return index;
}

#endif
