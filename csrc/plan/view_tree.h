/* Bounding sphere hierarchy over the objects and bodies of a view. Sums of mutual light and shadow
 * take time that grows about linearly with their number, not quadratically. */
#ifndef PL_PLAN_VIEW_TREE_H
#define PL_PLAN_VIEW_TREE_H

#include "base/memory.h"
#include "base/status.h"
#include "plan/view.h"

/* A sphere that encloses one object or body, without rings, or all nodes up to `after`. */
typedef struct pl_view_node {
  pl_view_entity
      ball;       /* inner node: has the largest albedo and the smallest alpha of its members */
  size_t after;   /* index of the first node that is not inside this one */
  size_t entity;  /* index of the object or body; PL_VIEW_SEVERAL for an inner node */
  double light;   /* sum over the members of squared radius times light from afar */
  double weighed; /* the same with the weights of pl_view_weigh */
  double squares; /* the same with weights of 1 */
} pl_view_node;
#define PL_VIEW_SEVERAL ((size_t)-1)

/* Sums that several rows ask for, by receiver; NAN before the first time. */
typedef enum pl_view_kept {
  PL_VIEW_KEPT_LIGHT, /* pl_view_sum_light */
  PL_VIEW_KEPT_SKY,   /* pl_view_sum_sky */
  PL_VIEW_KEPT_COUNT
} pl_view_kept;

struct pl_view_tree {
  size_t count;
  pl_view_node *nodes; /* each node is followed by its descendants */
  double *kept[PL_VIEW_KEPT_COUNT];
  size_t steps;      /* nodes visited so far, which tests count */
  bool ringed;       /* something has rings */
  double albedo_max; /* of all objects and bodies, at most 1 */
  /* indices of the leaves with the largest `light`, `weighed` and `squares`, whose parts come first
   * in sums */
  size_t first_light, first_weighed, first_square;
};

/* Builds the tree of a view of more than PL_VIEW_FEW objects and bodies in `arena`. Smaller views
 * get none: their pairs are all visited. */
enum { PL_VIEW_FEW = 48 };
pl_status pl_view_tree_build(pl_arena *arena, pl_view *view);

/* Returns the light, or a similar quantity, of a source of which a receiver gets a part; not
 * negative. */
typedef double (*pl_view_weight_fn)(const pl_view_entity *source, const void *context);

/* Call before pl_view_sum: stores the weights of the sources in the tree, if there is one, in place
 * of earlier weights. */
void pl_view_weigh(const pl_view *view, pl_view_weight_fn weight, const void *context);
/* Returns the sum of pl_view_transfer times weight over all sources except the receiver. With a
 * tree it is an upper bound: distant groups of sources count as if all were at the nearest point of
 * their sphere. */
double pl_view_sum(const pl_view *view, const pl_view_entity *receiver, pl_view_weight_fn weight,
                   const void *context);
/* The same with pl_view_light_at as the weight; needs no call of pl_view_weigh. */
double pl_view_sum_light(const pl_view *view, const pl_view_entity *receiver);
/* The same with weights of 1: the part of its sky that others fill, times its albedo. Both take
 * time for a receiver of the view only once, if there is a tree. */
double pl_view_sum_sky(const pl_view *view, const pl_view_entity *receiver);

/* Returns true if a test holds for any object or body. With a tree the test is first called for
 * inner nodes (`several`), which have the extreme values of their members: it must hold there if it
 * holds for a member. */
typedef bool (*pl_view_test_fn)(const pl_view_entity *entity, bool several, void *context);
bool pl_view_any(const pl_view *view, pl_view_test_fn test, void *context);

#endif
