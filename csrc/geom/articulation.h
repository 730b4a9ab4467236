/* Moving nodes of a model: joints set by the caller, and the model's own animations.
 *
 * A motion maps the model at rest to where a node has gone, both in the model's axes and units. The
 * motion of a node is that of the moving node above it, after its animation, after its joints in
 * their order: all joints are given at rest and travel with what is above them. */
#ifndef PL_GEOM_ARTICULATION_H
#define PL_GEOM_ARTICULATION_H

#include "geom/model.h"

typedef enum pl_joint_kind {
  PL_JOINT_TURN,   /* about the axis by the value, rad, right-handed */
  PL_JOINT_SLIDE,  /* along the axis by the value, model units */
  PL_JOINT_TOWARDS /* about the axis until the normal comes nearest to the target */
} pl_joint_kind;

typedef struct pl_joint {
  int node;
  pl_joint_kind kind;
  pl_vec3 axis;   /* unit after pl_articulation_create; any length before */
  pl_vec3 pivot;  /* a point of the axis */
  pl_vec3 normal; /* PL_JOINT_TOWARDS: at angle 0; its part across the axis is used */
  /* Axis, normal and pivot are given in the node's axes at rest, the pivot from the node's origin
   * in model units; otherwise in the model's, the pivot from the model's origin. */
  bool in_node_axes;
} pl_joint;

typedef struct pl_articulation pl_articulation;

/* A node's own axes at rest as unit columns in the model's, and its origin. They are those of its
 * parent turned by its rotation: what a rotation of the node turns about, whatever its scale. */
typedef struct pl_node_frame {
  pl_mat3 axes;
  pl_vec3 origin;
  double hand; /* -1 under mirrored parents, where rotations run the other way round; else 1 */
} pl_node_frame;
/* PL_E_RANGE when the node is flattened at rest. */
pl_status pl_node_frame_find(const pl_model *model, int node, pl_node_frame *out);

/* animations: indices of the model's, played together. Copies the joints; borrows the model.
 * PL_E_RANGE, naming the node, when an axis or normal has no direction, or nothing that can be seen
 * hangs on the node, or it is flattened at rest, or two animations move it in the same way. */
pl_status pl_articulation_create(const pl_model *model, const pl_joint *joints, size_t count,
                                 const int *animations, size_t animation_count,
                                 pl_articulation **out);
void pl_articulation_destroy(pl_articulation *articulation); /* NULL is allowed */

/* The moving nodes that something hangs on, parents before children. */
size_t pl_articulation_nodes(const pl_articulation *articulation, const int **nodes);

/* The joints as they act: all in the model's axes, axis and normal unit. */
size_t pl_articulation_joints(const pl_articulation *articulation, const pl_joint **joints);

/* values: one a joint; that of PL_JOINT_TOWARDS is added to the angle found. targets: one point a
 * joint, model units in the object's place at this instant (not that of a moved parent), read for
 * PL_JOINT_TOWARDS alone. play_s, loop: as in pl_animation_time, of each animation. Out: the angle
 * or way of each joint, and the motion of each moving node. A target on the axis leaves the angle
 * at 0 (plus the value). Allocates nothing; not thread-safe. */
void pl_articulation_pose(pl_articulation *articulation, const double *values,
                          const pl_vec3 *targets, double play_s, pl_loop loop, double *reached,
                          pl_affine *motions);

#endif
