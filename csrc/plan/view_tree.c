/* Builds the tree of bounding spheres and traverses it. */
#include "plan/view_tree.h"

#include <math.h>
#include <stdlib.h>

/* A group counts as far away from this many of its radii on. Its members are at most two radii
 * farther, so that their solid angles are overestimated at most three times. */
static const double FAR = 3.0;
/* A group of which the bound, at any distance, is at most this part of the sum so far is not
 * divided either: moons of a planet that fills the sky. */
static const double NEGLIGIBLE = 0.01;
static const double PI = 3.14159265358979323846;

static pl_view_node leaf_of(const pl_view *view, size_t index) {
  const pl_view_entity *entity = &view->entities[index];
  pl_view_node out = {.entity = index, .ball = *entity};
  return out;
}

static void bounds_of(const pl_view_node *nodes, size_t count, double low[3], double high[3]) {
  for (int k = 0; k < 3; k++) {
    low[k] = INFINITY;
    high[k] = -INFINITY;
    for (size_t i = 0; i < count; i++) {
      low[k] = fmin(low[k], nodes[i].ball.center_m[k] - nodes[i].ball.radius_m);
      high[k] = fmax(high[k], nodes[i].ball.center_m[k] + nodes[i].ball.radius_m);
    }
  }
}

/* Returns the sphere around the bounding box of some nodes, large enough to enclose each node's
 * sphere. */
static pl_view_node node_about(const pl_view_node *nodes, size_t count) {
  pl_view_node out = {.entity = PL_VIEW_SEVERAL, .ball = {.ggx_alpha_min = 1.0}};
  double low[3], high[3];
  bounds_of(nodes, count, low, high);
  for (int k = 0; k < 3; k++)
    out.ball.center_m[k] = 0.5 * (low[k] + high[k]);
  for (size_t i = 0; i < count; i++) {
    double square = 0.0;
    for (int k = 0; k < 3; k++)
      square += pow(nodes[i].ball.center_m[k] - out.ball.center_m[k], 2.0);
    out.ball.radius_m = fmax(out.ball.radius_m, sqrt(square) + nodes[i].ball.radius_m);
    out.ball.albedo_max = fmax(out.ball.albedo_max, nodes[i].ball.albedo_max);
    out.ball.ggx_alpha_min = fmin(out.ball.ggx_alpha_min, nodes[i].ball.ggx_alpha_min);
    out.ball.in_frame |= nodes[i].ball.in_frame;
    out.ball.is_body |= nodes[i].ball.is_body;
  }
  out.ball.radius_m *= 1.0 + 1e-9;
  return out;
}

static int by_axis(const void *a, const void *b, int axis) {
  const pl_view_node *x = a, *y = b;
  const double p = x->ball.center_m[axis], q = y->ball.center_m[axis];
  if (p < q || p > q)
    return p < q ? -1 : 1;
  return x->entity < y->entity ? -1 : x->entity > y->entity;
}
static int by_x(const void *a, const void *b) { return by_axis(a, b, 0); }
static int by_y(const void *a, const void *b) { return by_axis(a, b, 1); }
static int by_z(const void *a, const void *b) { return by_axis(a, b, 2); }

/* Appends the tree of some leaves and sorts them on the way. The largest leaf becomes a child of
 * its own where it alone determines the size of the sphere, like a planet among spacecraft. */
static void add_tree(pl_view_tree *tree, pl_view_node *leaves, size_t count) {
  const size_t own = tree->count++;
  if (count == 1) {
    tree->nodes[own] = leaves[0];
    tree->nodes[own].after = tree->count;
    return;
  }
  tree->nodes[own] = node_about(leaves, count);
  size_t largest = 0, half = count / 2;
  for (size_t i = 1; i < count; i++)
    largest = leaves[i].ball.radius_m > leaves[largest].ball.radius_m ? i : largest;
  if (leaves[largest].ball.radius_m > 0.1 * tree->nodes[own].ball.radius_m && count > 2) {
    const pl_view_node swap = leaves[0];
    leaves[0] = leaves[largest];
    leaves[largest] = swap;
    half = 1;
  } else {
    double low[3], high[3];
    bounds_of(leaves, count, low, high);
    const double wide[3] = {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
    const bool on_x = wide[0] >= wide[1] && wide[0] >= wide[2];
    qsort(leaves, count, sizeof *leaves, on_x ? by_x : wide[1] >= wide[2] ? by_y : by_z);
  }
  add_tree(tree, leaves, half);
  add_tree(tree, leaves + half, count - half);
  tree->nodes[own].after = tree->count;
}

static double square_of(const pl_view_entity *entity) {
  return entity->radius_m * entity->radius_m;
}

/* Sums each inner node from its two children. Children follow their parent, so the loop runs
 * backwards. */
static void add_up(pl_view_tree *tree) {
  for (size_t n = tree->count; n-- > 0;) {
    pl_view_node *node = &tree->nodes[n];
    if (node->entity != PL_VIEW_SEVERAL)
      continue;
    const pl_view_node *first = node + 1, *second = &tree->nodes[first->after];
    node->weighed = first->weighed + second->weighed;
  }
}

void pl_view_weigh(const pl_view *view, pl_view_weight_fn weight, const void *context) {
  pl_view_tree *tree = view->tree;
  double most = -1.0;
  for (size_t n = 0; tree != NULL && n < tree->count; n++) {
    pl_view_node *node = &tree->nodes[n];
    if (node->entity == PL_VIEW_SEVERAL)
      continue;
    const pl_view_entity *entity = &view->entities[node->entity];
    node->weighed = square_of(entity) * weight(entity, context);
    if (node->weighed > most) {
      most = node->weighed;
      tree->first_weighed = n;
    }
  }
  if (tree != NULL)
    add_up(tree);
}

/* From afar: a node's distance is that of its sphere, so no facet is nearer. */
static double light_of(const pl_view_entity *source, const void *context) {
  const pl_view *view = context;
  const double most = pl_view_light_most(view, source);
  const double sent = source->albedo_max * source->sent_gain * source->irradiance / PI;
  return source->sent_gain > 0.0 ? fmin(most, sent + source->emission_max) : most;
}

static double one(const pl_view_entity *source, const void *context) {
  (void)source;
  (void)context;
  return 1.0;
}

pl_status pl_view_tree_build(pl_arena *arena, pl_view *view) {
  const size_t count = view->entity_count;
  view->tree = NULL;
  if (count <= PL_VIEW_FEW)
    return PL_OK;
  pl_view_tree *tree = pl_arena_alloc(arena, 1, sizeof *tree);
  pl_view_node *nodes = pl_arena_alloc(arena, 3 * count, sizeof *nodes);
  if (tree == NULL || nodes == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the view");
  *tree = (pl_view_tree){.nodes = nodes};
  for (int k = 0; k < PL_VIEW_KEPT_COUNT; k++) {
    tree->kept[k] = pl_arena_alloc(arena, count, sizeof *tree->kept[k]);
    if (tree->kept[k] == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for the view");
    for (size_t i = 0; i < count; i++)
      tree->kept[k][i] = NAN;
  }
  pl_view_node *leaves = nodes + 2 * count; /* a tree has fewer inner nodes than leaves */
  for (size_t i = 0; i < count; i++) {
    leaves[i] = leaf_of(view, i);
    tree->ringed |= view->entities[i].rings != NULL;
    tree->albedo_max = fmax(tree->albedo_max, fmin(1.0, view->entities[i].albedo_max));
  }
  add_tree(tree, leaves, count);
  view->tree = tree;
  pl_view_weigh(view, light_of, view);
  for (size_t n = 0; n < tree->count; n++)
    nodes[n].light = nodes[n].weighed;
  tree->first_light = tree->first_weighed;
  pl_view_weigh(view, one, NULL);
  for (size_t n = 0; n < tree->count; n++)
    nodes[n].squares = nodes[n].weighed;
  tree->first_square = tree->first_weighed;
  return PL_OK;
}

/* Distance from the receiver's sphere to the node's, m. */
static double gap_m(const pl_view_entity *receiver, const pl_view_node *node) {
  double square = 0.0;
  for (int k = 0; k < 3; k++)
    square += pow(receiver->center_m[k] - node->ball.center_m[k], 2.0);
  return sqrt(square) - receiver->radius_m - node->ball.radius_m;
}

/* What is summed: light, 1, or the present weights. */
typedef struct summand {
  double (*of_node)(const pl_view_node *node);
  pl_view_weight_fn weight; /* NULL: pl_view_light_at */
  const void *context;
  size_t first; /* leaf that comes first */
} summand;

static double node_light(const pl_view_node *node) { return node->light; }
static double node_squares(const pl_view_node *node) { return node->squares; }
static double node_weighed(const pl_view_node *node) { return node->weighed; }

/* The part of one source in a sum. */
static double part_of(const pl_view *view, const pl_view_entity *receiver,
                      const pl_view_entity *source, const summand *what) {
  if (source == receiver)
    return 0.0;
  return pl_view_transfer(receiver, source) * (what->weight == NULL
                                                   ? pl_view_light_at(view, receiver, source)
                                                   : what->weight(source, what->context));
}

static double sum_of(const pl_view *view, const pl_view_entity *receiver, const summand *what) {
  pl_view_tree *tree = view->tree;
  double sum = part_of(view, receiver, &view->entities[tree->nodes[what->first].entity], what);
  for (size_t n = 0; n < tree->count;) {
    const pl_view_node *node = &tree->nodes[n];
    const double weighed = what->of_node(node);
    tree->steps++;
    if (!(weighed > 0.0) || n == what->first) {
      n = node->after;
      continue;
    }
    const bool one = node->entity != PL_VIEW_SEVERAL;
    const double gap = gap_m(receiver, node);
    const double most =
        gap > 0.0 ? pl_view_transfer_most(receiver, weighed / (gap * gap)) : INFINITY;
    const bool far = most <= NEGLIGIBLE * sum || (!one && gap > FAR * node->ball.radius_m);
    if (far)
      sum += most;
    else if (one)
      sum += part_of(view, receiver, &view->entities[node->entity], what);
    n = far ? node->after : n + 1;
  }
  return sum;
}

/* The sum for a receiver, which is kept if it is one of the view's. */
static double kept_sum(const pl_view *view, const pl_view_entity *receiver, const summand *what,
                       pl_view_kept kind) {
  const bool own = receiver >= view->entities && receiver < view->entities + view->entity_count;
  if (!own)
    return sum_of(view, receiver, what);
  double *kept = &view->tree->kept[kind][receiver - view->entities];
  if (isnan(*kept))
    *kept = sum_of(view, receiver, what);
  return *kept;
}

/* For few objects: sums over every pair. */
static double sum_all(const pl_view *view, const pl_view_entity *receiver, pl_view_weight_fn weight,
                      const void *context) {
  double sum = 0.0;
  for (size_t k = 0; k < view->entity_count; k++)
    if (&view->entities[k] != receiver)
      sum += pl_view_transfer(receiver, &view->entities[k]) * weight(&view->entities[k], context);
  return sum;
}

static double sum_pairs(const pl_view *view, const pl_view_entity *receiver) {
  double sum = 0.0;
  for (size_t k = 0; k < view->entity_count; k++)
    if (&view->entities[k] != receiver)
      sum += pl_view_transfer(receiver, &view->entities[k]) *
             pl_view_light_at(view, receiver, &view->entities[k]);
  return sum;
}

double pl_view_sum(const pl_view *view, const pl_view_entity *receiver, pl_view_weight_fn weight,
                   const void *context) {
  if (view->tree == NULL)
    return sum_all(view, receiver, weight, context);
  const summand what = {node_weighed, weight, context, view->tree->first_weighed};
  return sum_of(view, receiver, &what);
}

double pl_view_sum_light(const pl_view *view, const pl_view_entity *receiver) {
  if (view->tree == NULL)
    return sum_pairs(view, receiver);
  const summand what = {node_light, NULL, NULL, view->tree->first_light};
  return kept_sum(view, receiver, &what, PL_VIEW_KEPT_LIGHT);
}

double pl_view_sum_sky(const pl_view *view, const pl_view_entity *receiver) {
  if (view->tree == NULL)
    return sum_all(view, receiver, one, NULL);
  const summand what = {node_squares, one, NULL, view->tree->first_square};
  return kept_sum(view, receiver, &what, PL_VIEW_KEPT_SKY);
}

bool pl_view_any(const pl_view *view, pl_view_test_fn test, void *context) {
  pl_view_tree *tree = view->tree;
  for (size_t k = 0; tree == NULL && k < view->entity_count; k++)
    if (test(&view->entities[k], false, context))
      return true;
  for (size_t n = 0; tree != NULL && n < tree->count;) {
    const pl_view_node *node = &tree->nodes[n];
    const bool several = node->entity == PL_VIEW_SEVERAL;
    tree->steps++;
    const bool holds =
        test(several ? &node->ball : &view->entities[node->entity], several, context);
    if (holds && !several)
      return true;
    n = holds ? n + 1 : node->after;
  }
  return false;
}
