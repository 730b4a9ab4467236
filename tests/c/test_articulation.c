/* Motions of nodes: joints, targets, animation, nesting, scales. */
#include "geom/articulation.h"

#include <stdlib.h>

#include "jointed.h"

#define near(a, b) assert_true(fabs((a) - (b)) < 1e-12)

static const pl_quat QUARTER_Z = {0.70710678118654752440, 0, 0, 0.70710678118654752440};

/* A boom at (2, 0, 0), turned by 90 degrees about z; a panel 3 along the boom's own x. */
static const cube_node BOOM[2] = {
    {-1, {{2, 0, 0}, {0.70710678118654752440, 0, 0, 0.70710678118654752440}, {1, 1, 1}}, false},
    {0, {{3, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}}, false}};

static pl_articulation *create(const pl_model *model, const pl_joint *joints, size_t count,
                               int animation) {
  pl_articulation *out;
  if (pl_articulation_create(model, joints, count, &animation, animation >= 0, &out) != PL_OK)
    fail_msg("%s", pl_error_text());
  return out;
}

static void refuse(const pl_model *model, pl_joint joint, const char *fault) {
  pl_articulation *out;
  assert_int_equal(pl_articulation_create(model, &joint, 1, NULL, 0, &out), PL_E_RANGE);
  if (strstr(pl_error_text(), fault) == NULL)
    fail_msg("%s (expected \"%s\")", pl_error_text(), fault);
}

/* The panel turns about its own x, which is the model's y through (2, 3, 0). */
static void joints_turn_about_the_nodes_axes(void **state) {
  (void)state;
  pl_model *model = jointed_create(BOOM, 2, 1);
  const pl_joint joint = {.node = 1, .axis = {5, 0, 0}, .in_node_axes = true};
  pl_articulation *a = create(model, &joint, 1, -1);
  const int *nodes;
  assert_int_equal(pl_articulation_nodes(a, &nodes), 1);
  assert_int_equal(nodes[0], 1);
  const double value = PL_PI / 2;
  double reached;
  pl_affine motion;
  pl_articulation_pose(a, &value, NULL, 0, PL_LOOP_CLAMP, &reached, &motion);
  near(reached, value);
  vec_near(pl_affine_apply(&motion, (pl_vec3){2, 3, 0}), 2, 3, 0);
  vec_near(pl_affine_apply(&motion, (pl_vec3){2, 4, 0}), 2, 4, 0);
  vec_near(pl_affine_apply(&motion, (pl_vec3){3, 3, 0}), 2, 3, -1); /* x -> -z about y */
  pl_articulation_destroy(a);
  pl_model_destroy(model);
}

/* The outer joint carries the inner one, pivot and axis. */
static void nested_joints_compose(void **state) {
  (void)state;
  pl_model *model = jointed_create(BOOM, 2, 1);
  const pl_joint joints[2] = {
      {.node = 1, .kind = PL_JOINT_SLIDE, .axis = {1, 0, 0}, .in_node_axes = true},
      {.node = 0, .axis = {0, 0, 1}, .pivot = {2, 0, 0}}};
  pl_articulation *a = create(model, joints, 2, -1);
  const double values[2] = {0.5, PL_PI / 2};
  double reached[2];
  pl_affine motion[2]; /* parents first: node 0, node 1 */
  pl_articulation_pose(a, values, NULL, 0, PL_LOOP_CLAMP, reached, motion);
  vec_near(pl_affine_apply(&motion[0], (pl_vec3){2, 3, 0}), -1, 0, 0);
  vec_near(pl_affine_apply(&motion[1], (pl_vec3){2, 3, 0}), -1.5, 0, 0);
  pl_articulation_destroy(a);
  pl_model_destroy(model);
}

/* science: atan2(u.(d x n), u.n). Whatever the target, the turned normal leans on it as far as the
 * axis lets it: the part of the target across the axis lies along it. */
static void normals_turn_to_their_target(void **state) {
  (void)state;
  test_random random = {7, 0};
  pl_model *model = jointed_create(BOOM, 2, 1);
  for (int i = 0; i < 200; i++) {
    const pl_vec3 axis = {random_range(&random, -1, 1), random_range(&random, -1, 1), 1.5};
    const pl_joint joints[2] = {{.node = 0, .axis = {0, 1, 0.3}, .pivot = {1, 1, 0}},
                                {.node = 1,
                                 .kind = PL_JOINT_TOWARDS,
                                 .axis = axis,
                                 .pivot = {2, 3, 1},
                                 .normal = {1, 0, 0}}};
    pl_articulation *a = create(model, joints, 2, -1);
    const double values[2] = {random_range(&random, -3, 3), 0};
    const double far = i % 2 == 0 ? 20 : 1.5e11;
    const pl_vec3 target = {random_range(&random, -far, far), random_range(&random, -far, far),
                            random_range(&random, -far, far)};
    const pl_vec3 targets[2] = {{0, 0, 0}, target};
    double reached[2];
    pl_affine motion[2];
    pl_articulation_pose(a, values, targets, 0, PL_LOOP_CLAMP, reached, motion);
    const pl_vec3 d = pl_vec3_unit(axis), pivot = {2, 3, 1};
    const pl_vec3 n = pl_vec3_unit(pl_vec3_madd((pl_vec3){1, 0, 0}, -d.x, d));
    const pl_vec3 at = pl_affine_apply(&motion[1], pivot);
    const pl_vec3 turned = pl_mat3_mul_vec(motion[1].m, n), axle = pl_mat3_mul_vec(motion[0].m, d);
    const pl_vec3 u = pl_vec3_sub(target, at);
    const pl_vec3 across = pl_vec3_unit(pl_vec3_madd(u, -pl_vec3_dot(u, axle), axle));
    assert_true(pl_vec3_norm(pl_vec3_sub(across, turned)) < 1e-9);
    assert_true(pl_vec3_norm(pl_vec3_sub(pl_mat3_mul_vec(motion[1].m, d), axle)) < 1e-12);
    pl_articulation_destroy(a);
  }
  pl_model_destroy(model);
}

/* A target on the axis has no angle: 0 is kept, and the offset. */
static void targets_on_the_axis_leave_the_angle(void **state) {
  (void)state;
  pl_model *model = jointed_create(BOOM, 2, 1);
  const pl_joint joint = {.node = 1,
                          .kind = PL_JOINT_TOWARDS,
                          .axis = {0, 1, 0},
                          .pivot = {2, 3, 0},
                          .normal = {0, 0, 1}};
  pl_articulation *a = create(model, &joint, 1, -1);
  const pl_vec3 targets[3] = {{2, 9, 0}, {2, 3, 0}, {2, -1e12, 0}};
  for (int i = 0; i < 3; i++) {
    const double value = 0.25;
    double reached;
    pl_affine motion;
    pl_articulation_pose(a, &value, &targets[i], 0, PL_LOOP_CLAMP, &reached, &motion);
    assert_true(reached == 0.25);
  }
  pl_articulation_destroy(a);
  pl_model_destroy(model);
}

static void set_animation(pl_model *model, int node, pl_track_path path, const float *values,
                          size_t size) {
  const float times[2] = {0, 1};
  model->animations = pl_alloc(1, sizeof(pl_animation));
  model->animation_count = 1;
  model->animations[0] = (pl_animation){.name = pl_strdup("turn"), .stop_s = 1, .count = 1};
  pl_track *track = model->animations[0].tracks = pl_alloc(1, sizeof(pl_track));
  *track = (pl_track){node, path, PL_LINEAR, 2, pl_alloc(2, 4), pl_alloc(2 * size, 4)};
  memcpy(track->times, times, sizeof times);
  memcpy(track->values, values, 2 * size * sizeof(float));
}

/* The motion takes the rest pose to what the hierarchy gives with the animated transform, and a
 * joint may sit on the node that is animated. */
static void animations_move_nodes(void **state) {
  (void)state;
  const cube_node nodes[2] = {{-1, {{1, 2, 3}, QUARTER_Z, {2, -3, 4}}, false},
                              {0, {{4, 0, 1}, {0.8, 0, 0.6, 0}, {1, 2, 0.5}}, false}};
  pl_model *model = jointed_create(nodes, 2, 0.5);
  const float values[8] = {1, 0, 0, 0, 0.6f, 0, 0.8f, 0};
  set_animation(model, 1, PL_TRACK_ROTATION, values, 4);
  const pl_joint joint = {.node = 1, .kind = PL_JOINT_SLIDE, .axis = {0, 0, 1}};
  pl_articulation *a = create(model, &joint, 1, 0);
  const double value = 0.5;
  double reached;
  pl_affine motion, globals[2], locals[2], rest[2];
  pl_articulation_pose(a, &value, NULL, 1, PL_LOOP_CLAMP, &reached, &motion);
  pl_trs moved = nodes[1].trs;
  moved.q = pl_quat_unit((pl_quat){(double)0.6f, 0, (double)0.8f, 0});
  locals[0] = model->nodes.items[0].local;
  locals[1] = pl_trs_affine(&moved);
  node_globals(&model->nodes, locals, globals);
  node_globals(&model->nodes, NULL, rest);
  const pl_vec3 p = {0.3, -0.2, 0.1};
  const pl_affine inverse = pl_affine_inverse(&rest[1]);
  const pl_vec3 slid = pl_vec3_add(pl_affine_apply(&rest[1], p), (pl_vec3){0, 0, 0.5});
  const pl_vec3 expected = pl_affine_apply(&globals[1], pl_affine_apply(&inverse, slid));
  const pl_vec3 found = pl_affine_apply(&motion, pl_affine_apply(&rest[1], p));
  assert_true(pl_vec3_norm(pl_vec3_sub(found, expected)) < 1e-9);
  pl_articulation_destroy(a);
  pl_model_destroy(model);
}

/* Two animations play together, each at its own time; not two of the same property of a node. */
static void animations_play_together(void **state) {
  (void)state;
  pl_model *model = jointed_create(BOOM, 2, 1), *other = jointed_create(BOOM, 2, 1);
  const float slide[6] = {2, 0, 0, 2, 0, 4}, rise[6] = {3, 0, 0, 3, 0, 1};
  set_animation(model, 0, PL_TRACK_TRANSLATION, slide, 3);
  set_animation(other, 1, PL_TRACK_TRANSLATION, rise, 3);
  other->animations[0].stop_s = 2;
  other->animations[0].tracks[0].times[1] = 2;
  model->animations = pl_realloc(model->animations, 2, sizeof(pl_animation));
  model->animations[1] = other->animations[0];
  model->animation_count = 2;
  other->animation_count = 0;
  const int both[2] = {0, 1}, twice[2] = {1, 1};
  pl_articulation *a;
  assert_int_equal(pl_articulation_create(model, NULL, 0, both, 2, &a), PL_OK);
  pl_affine motion[2];
  pl_articulation_pose(a, NULL, NULL, 1.5, PL_LOOP_REPEAT, NULL, motion);
  near(motion[0].t.z, 2);        /* half of its second, again */
  near(motion[1].t.z, 2 + 0.75); /* three quarters of its two */
  pl_articulation_destroy(a);
  assert_int_equal(pl_articulation_create(model, NULL, 0, twice, 2, &a), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "'cube 1' is moved by two"));
  pl_model_destroy(other);
  pl_model_destroy(model);
}

/* A joint about the node's own axis does what a rotation of the node does: under a mirrored parent
 * too, and whatever the node's own scale. */
static void joints_turn_as_the_nodes_rotation_would(void **state) {
  (void)state;
  const pl_vec3 scales[4] = {{1, 1, 1}, {-1, 1, 1}, {2, 2, -2}, {-1, -1, -1}};
  for (int i = 0; i < 16; i++) {
    const cube_node nodes[2] = {{-1, {{1, 2, 3}, QUARTER_Z, scales[i % 4]}, false},
                                {0, {{4, 0, 1}, {0.8, 0, 0.6, 0}, scales[i / 4]}, false}};
    pl_model *model = jointed_create(nodes, 2, 0.5);
    const pl_joint joint = {.node = 1, .axis = {0, 0, 1}, .in_node_axes = true};
    pl_articulation *a = create(model, &joint, 1, -1);
    const double value = 0.7;
    double reached;
    pl_affine motion, globals[2], locals[2], rest[2];
    pl_articulation_pose(a, &value, NULL, 0, PL_LOOP_CLAMP, &reached, &motion);
    pl_trs moved = nodes[1].trs;
    moved.q = pl_quat_mul(moved.q, pl_quat_axis_angle((pl_vec3){0, 0, 1}, value));
    locals[0] = model->nodes.items[0].local;
    locals[1] = pl_trs_affine(&moved);
    node_globals(&model->nodes, locals, globals);
    node_globals(&model->nodes, NULL, rest);
    const pl_vec3 p = {0.3, -0.2, 0.1};
    const pl_vec3 found = pl_affine_apply(&motion, pl_affine_apply(&rest[1], p));
    const pl_vec3 expected = pl_affine_apply(&globals[1], p);
    assert_true(pl_vec3_norm(pl_vec3_sub(found, expected)) < 1e-12);
    pl_articulation_destroy(a);
    pl_model_destroy(model);
  }
}

static void what_cannot_move_is_refused(void **state) {
  (void)state;
  const cube_node nodes[3] = {{-1, {{0, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}}, false},
                              {-1, {{4, 0, 0}, {1, 0, 0, 0}, {1, 1, 0}}, false},
                              {-1, {{4, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}}, true}};
  pl_model *model = jointed_create(nodes, 3, 1);
  const pl_vec3 x = {1, 0, 0}, none = {0, 0, 0}, bad = {NAN, 0, 0};
  refuse(model, (pl_joint){.node = 3, .axis = x}, "node 3: the model has 3");
  refuse(model, (pl_joint){.node = 0, .axis = none}, "'cube 0': axis");
  refuse(model, (pl_joint){.node = 0, .axis = bad}, "'cube 0': axis");
  refuse(model, (pl_joint){.node = 0, .axis = x, .pivot = bad}, "pivot");
  refuse(model, (pl_joint){.node = 1, .axis = x}, "'cube 1' is flattened");
  refuse(model, (pl_joint){.node = 2, .axis = x}, "'cube 2' has nothing");
  refuse(model, (pl_joint){.node = 0, .kind = PL_JOINT_TOWARDS, .axis = x, .normal = {2, 0, 0}},
         "normal");
  const int animation = 0;
  pl_articulation *out;
  assert_int_equal(pl_articulation_create(model, NULL, 0, &animation, 1, &out), PL_E_RANGE);
  pl_model_destroy(model);
}

static void *fail_at(void *context, size_t size) {
  int *left = context;
  return (*left)-- == 0 ? NULL : malloc(size);
}

static void poses_allocate_nothing(void **state) {
  (void)state;
  pl_model *model = jointed_create(BOOM, 2, 1);
  const pl_joint joint = {.node = 1, .axis = {0, 1, 0}};
  pl_articulation *a = NULL;
  for (int n = 0;; n++) {
    int left = n;
    pl_memory_hook(fail_at, &left);
    const pl_status status = pl_articulation_create(model, &joint, 1, NULL, 0, &a);
    pl_memory_hook(NULL, NULL);
    if (status == PL_OK)
      break;
    assert_int_equal(status, PL_E_MEMORY);
  }
  const uint64_t before = pl_memory_allocations();
  const double value = 1;
  double reached;
  pl_affine motion;
  pl_articulation_pose(a, &value, NULL, 0, PL_LOOP_CLAMP, &reached, &motion);
  assert_true(pl_memory_allocations() == before);
  pl_articulation_destroy(a);
  pl_model_destroy(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(joints_turn_about_the_nodes_axes),
      cmocka_unit_test(nested_joints_compose),
      cmocka_unit_test(normals_turn_to_their_target),
      cmocka_unit_test(targets_on_the_axis_leave_the_angle),
      cmocka_unit_test(animations_move_nodes),
      cmocka_unit_test(animations_play_together),
      cmocka_unit_test(joints_turn_as_the_nodes_rotation_would),
      cmocka_unit_test(what_cannot_move_is_refused),
      cmocka_unit_test(poses_allocate_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
