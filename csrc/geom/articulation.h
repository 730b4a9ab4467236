/* Moving nodes of a model: joints that the caller sets, and the animations of the model file.
 *
 * A motion maps the model at rest to the moved position of a node, both in model axes and units.
 * The motion of a node is composed of the motion of the moving node above it, its animation, and
 * its joints in their order. All joints are given at rest and move with the nodes above them. */
#ifndef PL_GEOM_ARTICULATION_H
#define PL_GEOM_ARTICULATION_H

#include "geom/model.h"

typedef enum pl_joint_kind {
  PL_JOINT_TURN,  /* rotation about the axis by the value, rad, right-handed */
  PL_JOINT_SLIDE, /* translation along the axis by the value, model units */
  /* rotation about the axis that brings the normal nearest to the target direction */
  PL_JOINT_TOWARDS
} pl_joint_kind;

typedef struct pl_joint {
  int node;
  pl_joint_kind kind;
  pl_vec3 axis;  /* unit vector after pl_articulation_create; any length before */
  pl_vec3 pivot; /* a point on the axis */
  /* PL_JOINT_TOWARDS: normal at angle 0; its component orthogonal to the axis is used */
  pl_vec3 normal;
  /* True: axis, normal and pivot are given in the node's axes at rest, the pivot relative to the
   * node's origin in model units. False: in model axes, the pivot relative to the model's
   * origin. */
  bool in_node_axes;
} pl_joint;

typedef struct pl_articulation pl_articulation;

/* A node's axes at rest as unit columns in model axes, and its origin. The axes are those of its
 * parent rotated by the node's rotation, whatever its scale: rotations of the node are about
 * them. */
typedef struct pl_node_frame {
  pl_mat3 axes;
  pl_vec3 origin;
  double hand; /* -1 below mirrored parents, where the sense of rotation is reversed; else 1 */
} pl_node_frame;
/* Returns PL_E_RANGE when the node's transform at rest is singular. */
pl_status pl_node_frame_find(const pl_model *model, int node, pl_node_frame *out);

/* animations: indices into the model's animations, which play together. Copies the joints; borrows
 * the model. Returns PL_E_RANGE, naming the node, when an axis or normal has no direction, the node
 * has no visible geometry, its transform at rest is singular, or two animations move the same
 * property of it. */
pl_status pl_articulation_create(const pl_model *model, const pl_joint *joints, size_t count,
                                 const int *animations, size_t animation_count,
                                 pl_articulation **out);
void pl_articulation_destroy(pl_articulation *articulation); /* NULL is allowed */

/* Returns the moving nodes that have geometry, parents before children. */
size_t pl_articulation_nodes(const pl_articulation *articulation, const int **nodes);

/* Returns the joints in the form in which they act: all in model axes, axis and normal unit
 * vectors. */
size_t pl_articulation_joints(const pl_articulation *articulation, const pl_joint **joints);

/* Computes the motions of one frame.
 *
 * values: one per joint; for PL_JOINT_TOWARDS it is added to the angle that is found. targets: one
 * point per joint, read for PL_JOINT_TOWARDS alone, in model units and the axes of the object at
 * this instant (not those of a moved parent). play_s, loop: as in pl_animation_time, for each
 * animation. Output: `reached` is the angle or displacement of each joint, `motions` the motion of
 * each moving node. A target on the axis leaves the angle at 0 (plus the value). Allocates nothing;
 * not thread-safe. */
void pl_articulation_pose(pl_articulation *articulation, const double *values,
                          const pl_vec3 *targets, double play_s, pl_loop loop, double *reached,
                          pl_affine *motions);

#endif
