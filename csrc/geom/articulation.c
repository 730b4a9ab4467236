/* Motion of articulated nodes: forward kinematics of joints and animations. */
#include "geom/articulation.h"

#include "base/memory.h"

/* A target direction nearer to the joint axis than this (rad) defines no angle. */
#define ON_AXIS 1e-9

/* A moving node. */
typedef struct mover {
  int above;                /* index of the nearest moving node above it, or -1 */
  bool animated;            /* has a track */
  pl_affine parent_to_root; /* transform of the parent at rest */
  pl_affine from_root;      /* root to node axes, at rest */
  pl_trs trs;               /* in this frame, when animated */
} mover;

/* A track that is being played. */
typedef struct played {
  const pl_animation *animation; /* animation of the model */
  const pl_track *track;         /* a track of that animation */
  int mover;                     /* mover of its node; -1: the node has no geometry */
} played;

struct pl_articulation {
  const pl_model *model; /* borrowed */
  pl_joint *joints;      /* owned; all in model axes */
  size_t joint_count;
  int *nodes;    /* owned: node indices of the movers */
  mover *movers; /* owned, one per entry of `nodes` */
  size_t count;
  played *tracks; /* owned: the tracks of all animations */
  size_t track_count;
};

/* --- transforms of nodes ---------------------------------------------------------------------- */

static pl_affine parent_global(const pl_model *model, int node) {
  pl_affine out = PL_AFFINE_IDENTITY;
  for (int i = model->nodes.items[node].parent; i >= 0; i = model->nodes.items[i].parent)
    out = pl_affine_compose(&model->nodes.items[i].local, &out);
  const pl_affine base = pl_nodes_base(&model->nodes);
  return pl_affine_compose(&base, &out);
}

pl_status pl_node_frame_find(const pl_model *model, int node, pl_node_frame *out) {
  const pl_node *item = &model->nodes.items[node];
  const pl_affine above = parent_global(model, node);
  const pl_affine global = pl_affine_compose(&above, &item->local);
  if (!pl_mat3_is_regular(global.m))
    return pl_fail(PL_E_RANGE, "node '%s' is flattened by its scale and cannot move", item->name);
  const pl_mat3 turn = item->has_matrix ? item->local.m : pl_mat3_from_quat(item->trs.q);
  const pl_mat3 columns = pl_mat3_transpose(pl_mat3_mul(above.m, turn));
  for (int k = 0; k < 3; k++)
    out->axes.row[k] = pl_vec3_unit(columns.row[k]);
  out->axes = pl_mat3_transpose(out->axes);
  out->origin = global.t;
  out->hand = pl_mat3_determinant(above.m) < 0.0 ? -1.0 : 1.0;
  return PL_OK;
}

/* --- building --------------------------------------------------------------------------------- */

static bool has_direction(pl_vec3 v) {
  const double length = pl_vec3_norm(v);
  return length > 1e-150 && isfinite(length);
}

/* State of each node while the moving nodes are collected. */
typedef struct mark {
  bool animated, jointed;
  bool paths[3]; /* indexed by pl_track_path: the property has a track */
  bool bears;    /* the node or a descendant has a part with triangles */
  int mover;     /* nearest moving node at or above it, or -1 */
} mark;

static void mark_parts(const pl_model *model, mark *marks) {
  for (size_t i = 0; i < model->part_count; i++)
    for (int n = model->parts[i].node; n >= 0 && !marks[n].bears; n = model->nodes.items[n].parent)
      marks[n].bears = true;
}

static pl_status prefilter_joint(const pl_model *model, mark *marks, pl_joint *joint) {
  if (joint->node < 0 || (size_t)joint->node >= model->nodes.count)
    return pl_fail(PL_E_RANGE, "node %d: the model has %zu", joint->node, model->nodes.count);
  const char *name = model->nodes.items[joint->node].name;
  pl_node_frame frame;
  PL_TRY(pl_node_frame_find(model, joint->node, &frame));
  if (!marks[joint->node].bears)
    return pl_fail(PL_E_RANGE, "node '%s' has nothing on it that can be seen to move", name);
  marks[joint->node].jointed = true;
  const pl_vec3 p = joint->pivot;
  if (!has_direction(joint->axis) || !isfinite(p.x) || !isfinite(p.y) || !isfinite(p.z))
    return pl_fail(PL_E_RANGE, "node '%s': axis must have a length, pivot must be finite", name);
  joint->axis = pl_vec3_unit(joint->axis);
  if (joint->kind == PL_JOINT_TOWARDS) {
    const pl_vec3 across =
        pl_vec3_madd(joint->normal, -pl_vec3_dot(joint->normal, joint->axis), joint->axis);
    if (!has_direction(joint->normal) ||
        !(pl_vec3_norm(across) > ON_AXIS * pl_vec3_norm(joint->normal)))
      return pl_fail(PL_E_RANGE, "node '%s': normal must not lie along the axis", name);
    joint->normal = pl_vec3_unit(across);
  }
  if (!joint->in_node_axes)
    return PL_OK;
  /* The columns of a sheared frame are not orthogonal, so the normal is orthogonalised again. */
  joint->axis = pl_vec3_unit(pl_mat3_mul_vec(frame.axes, joint->axis));
  joint->pivot = pl_vec3_add(frame.origin, pl_mat3_mul_vec(frame.axes, joint->pivot));
  const pl_vec3 n = pl_mat3_mul_vec(frame.axes, joint->normal);
  joint->normal = pl_vec3_unit(pl_vec3_madd(n, -pl_vec3_dot(n, joint->axis), joint->axis));
  if (joint->kind != PL_JOINT_SLIDE)
    joint->axis = pl_vec3_scale(joint->axis, frame.hand);
  joint->in_node_axes = false;
  return PL_OK;
}

static pl_status find_movers(pl_articulation *self, mark *marks) {
  const pl_nodes *nodes = &self->model->nodes;
  for (size_t i = 0; i < nodes->order_count; i++) {
    const int node = nodes->order[i], parent = nodes->items[node].parent;
    mark *mark = &marks[node];
    mark->mover = parent >= 0 ? marks[parent].mover : -1;
    if ((!mark->animated && !mark->jointed) || !mark->bears)
      continue;
    pl_node_frame frame;
    PL_TRY(pl_node_frame_find(self->model, node, &frame));
    mover *mover = &self->movers[self->count];
    mover->above = mark->mover;
    mover->animated = mark->animated;
    mover->parent_to_root = parent_global(self->model, node);
    const pl_affine global = pl_affine_compose(&mover->parent_to_root, &nodes->items[node].local);
    mover->from_root = pl_affine_inverse(&global);
    self->nodes[self->count] = node;
    mark->mover = (int)self->count++;
  }
  for (size_t i = 0; i < self->track_count; i++) {
    const mark *mark = &marks[self->tracks[i].track->node];
    self->tracks[i].mover = mark->bears ? mark->mover : -1;
  }
  return PL_OK;
}

static pl_status allocate(pl_articulation *self, const pl_joint *joints) {
  void *memory[4] = {NULL};
  const size_t most = self->joint_count + self->track_count;
  PL_TRY(pl_alloc_or_fail(self->joint_count, sizeof(pl_joint), "joints", &memory[0]));
  self->joints = memory[0];
  for (size_t i = 0; i < self->joint_count; i++)
    self->joints[i] = joints[i];
  PL_TRY(pl_alloc_or_fail(most, sizeof(int), "moving nodes", &memory[1]));
  self->nodes = memory[1];
  PL_TRY(pl_alloc_or_fail(most, sizeof(mover), "moving nodes", &memory[2]));
  self->movers = memory[2];
  PL_TRY(pl_alloc_or_fail(self->track_count, sizeof(played), "moving nodes", &memory[3]));
  self->tracks = memory[3];
  return PL_OK;
}

static pl_status mark_track(const pl_model *model, mark *marks, const pl_track *track) {
  mark *mark = &marks[track->node];
  if (mark->paths[track->path])
    return pl_fail(PL_E_RANGE, "node '%s' is moved by two of the animations",
                   model->nodes.items[track->node].name);
  mark->animated = mark->paths[track->path] = true;
  return PL_OK;
}

static pl_status fill(pl_articulation *self, mark *marks, const int *animations, size_t count) {
  size_t used = 0;
  mark_parts(self->model, marks);
  for (size_t i = 0; i < self->joint_count; i++)
    PL_TRY(prefilter_joint(self->model, marks, &self->joints[i]));
  for (size_t i = 0; i < count; i++) {
    const pl_animation *animation = &self->model->animations[animations[i]];
    for (size_t k = 0; k < animation->count; k++) {
      PL_TRY(mark_track(self->model, marks, &animation->tracks[k]));
      self->tracks[used++] = (played){animation, &animation->tracks[k], -1};
    }
  }
  return find_movers(self, marks);
}

/* Counts the tracks of the animations. */
static pl_status count_tracks(const pl_model *model, const int *animations, size_t count,
                              size_t *tracks) {
  *tracks = 0;
  for (size_t i = 0; i < count; i++) {
    if (animations[i] < 0 || (size_t)animations[i] >= model->animation_count)
      return pl_fail(PL_E_RANGE, "animation %d: the model has %zu", animations[i],
                     model->animation_count);
    *tracks += model->animations[animations[i]].count;
  }
  return PL_OK;
}

pl_status pl_articulation_create(const pl_model *model, const pl_joint *joints, size_t count,
                                 const int *animations, size_t animation_count,
                                 pl_articulation **out) {
  void *memory;
  size_t tracks;
  PL_TRY(count_tracks(model, animations, animation_count, &tracks));
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_articulation), "an articulation", &memory));
  pl_articulation *self = memory;
  self->model = model;
  self->joint_count = count;
  self->track_count = tracks;
  pl_status status = allocate(self, joints);
  if (status == PL_OK)
    status = pl_alloc_or_fail(model->nodes.count, sizeof(mark), "the nodes of a model", &memory);
  if (status == PL_OK) {
    status = fill(self, memory, animations, animation_count);
    pl_free(memory);
  }
  if (status != PL_OK)
    pl_articulation_destroy(self);
  else
    *out = self;
  return status;
}

void pl_articulation_destroy(pl_articulation *self) {
  if (self == NULL)
    return;
  pl_free(self->joints);
  pl_free(self->nodes);
  pl_free(self->movers);
  pl_free(self->tracks);
  pl_free(self);
}

size_t pl_articulation_nodes(const pl_articulation *self, const int **nodes) {
  *nodes = self->nodes;
  return self->count;
}

size_t pl_articulation_joints(const pl_articulation *self, const pl_joint **joints) {
  *joints = self->joints;
  return self->joint_count;
}

/* --- evaluation of one frame ------------------------------------------------------------------ */

/* Sets the local transforms of the nodes at the times of the animations. */
static void animate(pl_articulation *self, double play_s, pl_loop loop) {
  for (size_t k = 0; k < self->count; k++)
    self->movers[k].trs = self->model->nodes.items[self->nodes[k]].trs;
  for (size_t i = 0; i < self->track_count; i++) {
    const played *played = &self->tracks[i];
    if (played->mover >= 0)
      pl_track_sample(played->track, pl_animation_time(played->animation, loop, play_s),
                      &self->movers[played->mover].trs);
  }
}

/* Motion from rest to the animated pose, with all ancestors at rest. */
static pl_affine animated_motion(const mover *mover) {
  const pl_affine local = pl_trs_affine(&mover->trs);
  const pl_affine global = pl_affine_compose(&mover->parent_to_root, &local);
  return pl_affine_compose(&global, &mover->from_root);
}

/* Angle of a solar array drive, atan2(u.(d x n), u.n): u is the direction of the target, d the
 * axis, n the normal, orthogonal to d. */
static double angle_towards(const pl_joint *joint, const pl_affine *motion, pl_vec3 target) {
  if (!pl_mat3_is_regular(motion->m))
    return 0.0;
  const pl_affine back = pl_affine_inverse(motion);
  const pl_vec3 u = pl_vec3_sub(pl_affine_apply(&back, target), joint->pivot);
  const double y = pl_vec3_dot(u, pl_vec3_cross(joint->axis, joint->normal));
  const double x = pl_vec3_dot(u, joint->normal);
  return hypot(x, y) > ON_AXIS * pl_vec3_norm(u) ? atan2(y, x) : 0.0;
}

static pl_affine joint_motion(const pl_joint *joint, double value) {
  if (joint->kind == PL_JOINT_SLIDE) {
    pl_affine out = PL_AFFINE_IDENTITY;
    out.t = pl_vec3_scale(joint->axis, value);
    return out;
  }
  pl_affine out = {pl_mat3_from_quat(pl_quat_axis_angle(joint->axis, value)), {0.0, 0.0, 0.0}};
  out.t = pl_vec3_sub(joint->pivot, pl_mat3_mul_vec(out.m, joint->pivot));
  return out;
}

void pl_articulation_pose(pl_articulation *self, const double *values, const pl_vec3 *targets,
                          double play_s, pl_loop loop, double *reached, pl_affine *motions) {
  animate(self, play_s, loop);
  for (size_t k = 0; k < self->count; k++) {
    const mover *mover = &self->movers[k];
    pl_affine motion = mover->above >= 0 ? motions[mover->above] : PL_AFFINE_IDENTITY;
    if (mover->animated) {
      const pl_affine own = animated_motion(mover);
      motion = pl_affine_compose(&motion, &own);
    }
    for (size_t i = 0; i < self->joint_count; i++) {
      const pl_joint *joint = &self->joints[i];
      if (joint->node != self->nodes[k])
        continue;
      reached[i] = values[i];
      if (joint->kind == PL_JOINT_TOWARDS)
        reached[i] += angle_towards(joint, &motion, targets[i]);
      const pl_affine own = joint_motion(joint, reached[i]);
      motion = pl_affine_compose(&motion, &own);
    }
    motions[k] = motion;
  }
}
