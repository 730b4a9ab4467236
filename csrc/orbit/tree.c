/* Builds and evaluates the tree: parents first, for any order of declaration. */
#include "orbit/tree.h"

#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "orbit/attitude.h"

#define SECONDS_PER_DAY 86400.0

struct pl_tree {
  size_t count;
  pl_tree_node *nodes; /* owned, except for what they borrow; rotations prepared */
  size_t *order;       /* owned; parents before children */
  double tdb_day, tdb_fraction;
};

typedef enum mark { MARK_NEW, MARK_OPEN, MARK_DONE } mark;

/* Fails with the names around the cycle, from `start` back to itself: "a -> b -> a", abbreviated if
 * long. */
static pl_status fail_cycle(const pl_tree_node *nodes, size_t start) {
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

/* Topological sort. Follows the parents of each node up to the first one in `order`, then appends
 * the visited nodes, topmost first. `chain` and `marks` are scratch arrays of `count` items. */
static pl_status sort(size_t count, const pl_tree_node *nodes, unsigned char *marks, size_t *chain,
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

/* Prefixes the error message with the name of the node. */
static pl_status fail_at(const pl_tree_node *node, pl_status status) {
  return pl_fail(status, "node '%s': %s", node->name, pl_error_text());
}

static pl_status check_path(const pl_tree_node *node) {
  if (node->path.kind == PL_PATH_FIXED && !pl_vec3_finite(node->path.position_m))
    return pl_fail(PL_E_RANGE, "position_m is not finite");
  if (node->path.kind == PL_PATH_PROPAGATED && node->parent < 0)
    return pl_fail(PL_E_ARGUMENT, "an orbit needs a parent to go around");
  if (node->path.kind == PL_PATH_PROPAGATED && !node->path.propagator)
    return pl_fail(PL_E_ARGUMENT, "no propagator");
  return PL_OK;
}

static pl_status check_node(size_t count, size_t index, pl_tree_node *node) {
  const ptrdiff_t last = (ptrdiff_t)count - 1;
  if (node->parent < -1 || node->parent > last)
    return pl_fail(PL_E_ARGUMENT, "parent %td does not exist; allowed: -1 to %td", node->parent,
                   last);
  PL_TRY(check_path(node));
  PL_TRY(pl_turn_prepare(&node->turn));
  const pl_turn *turn = &node->turn;
  if ((turn->kind->needs & PL_TURN_PARENT) && node->parent < 0)
    return pl_fail(PL_E_ARGUMENT, "the frame %s needs a parent", turn->kind->name);
  if (!(turn->kind->needs & PL_TURN_AIM))
    return PL_OK;
  if (turn->towards > last)
    return pl_fail(PL_E_ARGUMENT, "the node %td to point at does not exist; allowed: 0 to %td",
                   turn->towards, last);
  if (turn->towards == (ptrdiff_t)index)
    return pl_fail(PL_E_ARGUMENT, "it cannot point at itself");
  return PL_OK;
}

static pl_status tree_fill(pl_tree *tree, const pl_tree_node *nodes) {
  const size_t count = tree->count;
  PL_TRY(pl_alloc_or_fail(count, sizeof *tree->nodes, "nodes", (void **)&tree->nodes));
  PL_TRY(pl_alloc_or_fail(count, sizeof *tree->order, "order of nodes", (void **)&tree->order));
  if (count > 0)
    memcpy(tree->nodes, nodes, count * sizeof *nodes);
  pl_status status = PL_OK;
  for (size_t i = 0; i < count; i++)
    if ((status = check_node(count, i, &tree->nodes[i])) != PL_OK)
      return fail_at(&tree->nodes[i], status);
  size_t *chain = NULL;
  unsigned char *marks = NULL;
  status = pl_alloc_or_fail(count, sizeof *chain, "order of nodes", (void **)&chain);
  if (status == PL_OK)
    status = pl_alloc_or_fail(count, sizeof *marks, "order of nodes", (void **)&marks);
  if (status == PL_OK)
    status = sort(count, tree->nodes, marks, chain, tree->order);
  pl_free(marks);
  pl_free(chain);
  return status;
}

pl_status pl_tree_create(size_t count, const pl_tree_node *nodes, double tdb_day,
                         double tdb_fraction, pl_tree **out) {
  if (!isfinite(tdb_day) || !isfinite(tdb_fraction))
    return pl_fail(PL_E_RANGE, "the epoch %g + %g is not finite", tdb_day, tdb_fraction);
  pl_tree *tree = NULL;
  PL_TRY(pl_alloc_or_fail(1, sizeof *tree, "tree of nodes", (void **)&tree));
  tree->count = count;
  tree->tdb_day = tdb_day;
  tree->tdb_fraction = tdb_fraction;
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

static pl_status check_slot(size_t slot, size_t slots, const char *what) {
  if (slot < slots)
    return PL_OK;
  return pl_fail(PL_E_ARGUMENT, "takes slot %zu of the given %s, which have %zu", slot, what,
                 slots);
}

/* States of a node relative to its parent's centre. */
static pl_status relative_states(const pl_path *path, size_t times, const double *t_s,
                                 const pl_tree_given *given, pl_state *out) {
  if (path->kind == PL_PATH_PROPAGATED)
    return pl_propagator_states(path->propagator, times, t_s, out);
  if (path->kind == PL_PATH_GIVEN)
    PL_TRY(check_slot(path->slot, given->state_slots, "states"));
  for (size_t i = 0; i < times; i++) {
    out[i] = path->kind == PL_PATH_GIVEN ? given->states[i * given->state_slots + path->slot]
                                         : (pl_state){.r_m = path->position_m};
    if (!pl_vec3_finite(out[i].r_m) || !pl_vec3_finite(out[i].v_m_s))
      return pl_fail(PL_E_RANGE, "the given state at time %zu is not finite", i);
  }
  return PL_OK;
}

/* Adds a node's relative states to the known states of its parent. */
static void place(const pl_tree *tree, size_t index, size_t times, const pl_tree_states *out) {
  const ptrdiff_t parent = tree->nodes[index].parent;
  for (size_t i = 0; i < times; i++) {
    const pl_state *relative = &out->relative[index * times + i];
    const size_t row = i * tree->count;
    pl_vec3 r = relative->r_m, v = relative->v_m_s;
    if (parent >= 0) {
      r = pl_vec3_add(out->poses[row + (size_t)parent].t, r);
      v = pl_vec3_add(out->velocities[row + (size_t)parent], v);
    }
    out->poses[row + index].t = r;
    out->velocities[row + index] = v;
  }
}

/* Collects the inputs of a node's axes at time number i. */
static pl_status look(const pl_tree *tree, size_t index, size_t i, size_t times, double t_s,
                      const pl_tree_given *given, const pl_tree_states *out, pl_turn_view *view) {
  const pl_tree_node *node = &tree->nodes[index];
  const pl_pose *poses = &out->poses[i * tree->count];
  *view = (pl_turn_view){
      .tdb_day = tree->tdb_day,
      .tdb_fraction = tree->tdb_fraction + t_s / SECONDS_PER_DAY,
      .t_s = t_s,
      .relative = out->relative[index * times + i],
      .parent = node->parent < 0 ? PL_QUAT_IDENTITY : poses[node->parent].q,
      .aim_m = node->turn.direction,
  };
  if ((node->turn.kind->needs & PL_TURN_AIM) && node->turn.towards >= 0)
    view->aim_m = pl_vec3_sub(poses[node->turn.towards].t, poses[index].t);
  if (!(node->turn.kind->needs & PL_TURN_GIVEN))
    return PL_OK;
  PL_TRY(check_slot(node->turn.slot, given->quat_slots, "quaternions"));
  const pl_quat q = given->quats[i * given->quat_slots + node->turn.slot];
  PL_TRY(pl_attitude_check(q, "given"));
  view->given = pl_quat_unit(q);
  return PL_OK;
}

static pl_status turn_node(const pl_tree *tree, size_t index, size_t times, const double *t_s,
                           const pl_tree_given *given, const pl_tree_states *out) {
  for (size_t i = 0; i < times; i++) {
    pl_turn_view view;
    PL_TRY(look(tree, index, i, times, t_s[i], given, out, &view));
    PL_TRY(pl_turn_at(&tree->nodes[index].turn, &view, &out->poses[i * tree->count + index].q));
  }
  return PL_OK;
}

pl_status pl_tree_evaluate(const pl_tree *tree, size_t times, const double *t_s,
                           const pl_tree_given *given, const pl_tree_states *out) {
  static const pl_tree_given nothing = {0};
  given = given ? given : &nothing;
  for (size_t i = 0; i < times; i++)
    if (!isfinite(t_s[i]))
      return pl_fail(PL_E_RANGE, "time %zu is %g, but must be finite", i, t_s[i]);
  for (size_t k = 0; k < tree->count; k++) {
    const size_t index = tree->order[k];
    const pl_tree_node *node = &tree->nodes[index];
    const pl_status status =
        relative_states(&node->path, times, t_s, given, &out->relative[index * times]);
    if (status != PL_OK)
      return fail_at(node, status);
    place(tree, index, times, out);
  }
  for (size_t k = 0; k < tree->count; k++) { /* parents first: children may use their axes */
    const size_t index = tree->order[k];
    const pl_status status = turn_node(tree, index, times, t_s, given, out);
    if (status != PL_OK)
      return fail_at(&tree->nodes[index], status);
  }
  return PL_OK;
}
