/* Builds and evaluates the tree: parents first, whatever the order of declaration. */
#include "orbit/tree.h"

#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "orbit/attitude.h"
#include "orbit/orientation.h"

#define SECONDS_PER_DAY 86400.0

struct pl_tree {
  size_t count;
  pl_node *nodes; /* owned but for the names; quaternions and axes unit */
  size_t *order;  /* owned; parents before children */
};

typedef enum mark { MARK_NEW, MARK_OPEN, MARK_DONE } mark;

static bool vec_finite(pl_vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

/* Names around the cycle, from `start` back to itself: "a -> b -> a", shortened when long. */
static pl_status fail_cycle(const pl_node *nodes, size_t start) {
  char text[600] = "";
  size_t used = 0, at = start;
  do {
    const int wrote = snprintf(text + used, sizeof text - used, "%s -> ", nodes[at].name);
    if (wrote < 0 || (size_t)wrote >= sizeof text - used) {
      snprintf(text + used, sizeof text - used, "... -> ");
      break;
    }
    used += (size_t)wrote;
    at = (size_t)nodes[at].parent;
  } while (at != start && used < sizeof text - 64);
  return pl_fail(PL_E_ARGUMENT, "cycle of parents: %s%s%s", text, at != start ? "... -> " : "",
                 nodes[start].name);
}

/* Walks up from each node to the first one that is placed; then places the walked, topmost first.
 * `chain` and `marks` are scratch of `count` items. */
static pl_status sort(size_t count, const pl_node *nodes, unsigned char *marks, size_t *chain,
                      size_t *order) {
  size_t placed = 0;
  for (size_t i = 0; i < count; i++) {
    size_t length = 0;
    for (ptrdiff_t at = (ptrdiff_t)i; at >= 0 && marks[at] != MARK_DONE; at = nodes[at].parent) {
      if (marks[at] == MARK_OPEN)
        return fail_cycle(nodes, (size_t)at);
      marks[at] = MARK_OPEN;
      chain[length++] = (size_t)at;
    }
    while (length > 0) {
      const size_t top = chain[--length];
      marks[top] = MARK_DONE;
      order[placed++] = top;
    }
  }
  return PL_OK;
}

static pl_status check_turn(pl_node *node) {
  pl_turn *turn = &node->turn;
  const pl_quat q = turn->q;
  switch (turn->kind) {
  case PL_TURN_SPIN:
    if (!vec_finite(turn->axis) || !(pl_vec3_norm(turn->axis) > 0.0))
      return pl_fail(PL_E_RANGE, "node '%s': the spin axis must be finite and not zero",
                     node->name);
    if (!isfinite(turn->rate_rad_s))
      return pl_fail(PL_E_RANGE, "node '%s': rate_rad_s is not finite", node->name);
    turn->axis = pl_vec3_unit(turn->axis);
    /* fall through */
  case PL_TURN_FIXED: {
    const double n2 = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
    if (!isfinite(n2) || !(n2 > 0.0))
      return pl_fail(PL_E_RANGE, "node '%s': the quaternion q must be finite and not zero",
                     node->name);
    turn->q = pl_quat_unit(q);
    return PL_OK;
  }
  case PL_TURN_BODY:
    return turn->body ? PL_OK : pl_fail(PL_E_ARGUMENT, "node '%s': no body to turn", node->name);
  case PL_TURN_LVLH:
    if (node->parent < 0)
      return pl_fail(PL_E_ARGUMENT, "node '%s': lvlh needs a parent to face", node->name);
    return PL_OK;
  }
  return pl_fail(PL_E_ARGUMENT, "node '%s': unknown kind of rotation", node->name);
}

static pl_status check_node(size_t count, pl_node *node) {
  if (node->parent < -1 || node->parent >= (ptrdiff_t)count)
    return pl_fail(PL_E_ARGUMENT, "node '%s': parent %td does not exist; allowed: -1 to %td",
                   node->name, node->parent, (ptrdiff_t)count - 1);
  if (node->motion.kind == PL_MOTION_FIXED && !vec_finite(node->motion.position_m))
    return pl_fail(PL_E_RANGE, "node '%s': position_m is not finite", node->name);
  if (node->motion.kind == PL_MOTION_KEPLER && node->parent < 0)
    return pl_fail(PL_E_ARGUMENT, "node '%s': an orbit needs a parent to go around", node->name);
  return check_turn(node);
}

static pl_status tree_fill(pl_tree *tree, const pl_node *nodes) {
  const size_t count = tree->count;
  PL_TRY(pl_alloc_or_fail(count, sizeof *tree->nodes, "nodes", (void **)&tree->nodes));
  PL_TRY(pl_alloc_or_fail(count, sizeof *tree->order, "order of nodes", (void **)&tree->order));
  if (count > 0)
    memcpy(tree->nodes, nodes, count * sizeof *nodes);
  for (size_t i = 0; i < count; i++)
    PL_TRY(check_node(count, &tree->nodes[i]));
  size_t *chain = NULL;
  unsigned char *marks = NULL;
  pl_status status = pl_alloc_or_fail(count, sizeof *chain, "order of nodes", (void **)&chain);
  if (status == PL_OK)
    status = pl_alloc_or_fail(count, sizeof *marks, "order of nodes", (void **)&marks);
  if (status == PL_OK)
    status = sort(count, tree->nodes, marks, chain, tree->order);
  pl_free(marks);
  pl_free(chain);
  return status;
}

pl_status pl_tree_create(size_t count, const pl_node *nodes, pl_tree **out) {
  pl_tree *tree = NULL;
  PL_TRY(pl_alloc_or_fail(1, sizeof *tree, "tree of nodes", (void **)&tree));
  tree->count = count;
  const pl_status status = tree_fill(tree, nodes);
  if (status != PL_OK) {
    pl_tree_destroy(tree);
    return status;
  }
  *out = tree;
  return PL_OK;
}

void pl_tree_destroy(pl_tree *tree) {
  if (!tree)
    return;
  pl_free(tree->nodes);
  pl_free(tree->order);
  pl_free(tree);
}

/* State of a node relative to its parent, ICRF axes. `equator` turns its orbit's frame to ICRF. */
static pl_status relative_state(const pl_node *node, pl_quat equator, double t_s, pl_state *out) {
  if (node->motion.kind == PL_MOTION_FIXED) {
    *out = (pl_state){node->motion.position_m, {0.0, 0.0, 0.0}};
    return PL_OK;
  }
  PL_TRY(pl_orbit_states(&node->motion.orbit, 1, &t_s, out));
  if (node->motion.equator) {
    out->r_m = pl_quat_rotate(equator, out->r_m);
    out->v_m_s = pl_quat_rotate(equator, out->v_m_s);
  }
  return PL_OK;
}

static pl_status rotation_at(const pl_turn *turn, const pl_state *state, double tdb_day,
                             double tdb_fraction, double t_s, pl_quat *out) {
  switch (turn->kind) {
  case PL_TURN_SPIN:
    *out = pl_attitude_spin(turn->q, turn->axis, turn->rate_rad_s, t_s);
    return PL_OK;
  case PL_TURN_BODY:
    *out = pl_body_orientation(turn->body, tdb_day, tdb_fraction + t_s / SECONDS_PER_DAY);
    return PL_OK;
  case PL_TURN_LVLH:
    return pl_attitude_lvlh(state, out);
  case PL_TURN_FIXED:
    break;
  }
  *out = turn->q;
  return PL_OK;
}

pl_status pl_tree_poses(const pl_tree *tree, double tdb_day, double tdb_fraction, size_t time_count,
                        const double *t_s, pl_pose *out) {
  if (!isfinite(tdb_day) || !isfinite(tdb_fraction))
    return pl_fail(PL_E_RANGE, "the epoch %g + %g is not finite", tdb_day, tdb_fraction);
  for (size_t i = 0; i < time_count; i++)
    if (!isfinite(t_s[i]))
      return pl_fail(PL_E_RANGE, "time %zu is not finite", i);
  for (size_t k = 0; k < tree->count; k++) { /* parents first, all times of a node together */
    const size_t index = tree->order[k];
    const pl_node *node = &tree->nodes[index];
    const pl_quat equator = node->motion.equator
                                ? pl_body_equator(node->motion.equator, tdb_day, tdb_fraction)
                                : PL_QUAT_IDENTITY;
    for (size_t i = 0; i < time_count; i++) {
      pl_pose *poses = out + i * tree->count;
      pl_state state;
      pl_status status = relative_state(node, equator, t_s[i], &state);
      if (status == PL_OK)
        status = rotation_at(&node->turn, &state, tdb_day, tdb_fraction, t_s[i], &poses[index].q);
      if (status != PL_OK)
        return pl_fail(status, "node '%s': %s", node->name, pl_error_text());
      poses[index].t = node->parent < 0 ? state.r_m : pl_vec3_add(poses[node->parent].t, state.r_m);
    }
  }
  return PL_OK;
}
