/* A tree of spheres over the things of a view, so that what many things do to each other takes
 * about as many steps as there are things, not their square. */
#ifndef PL_PLAN_VIEW_TREE_H
#define PL_PLAN_VIEW_TREE_H

#include "base/memory.h"
#include "base/status.h"
#include "plan/view.h"

/* A sphere about one thing, without rings, or about all spheres up to `after`. */
typedef struct pl_view_node {
  pl_view_thing ball; /* of several: as a thing of the largest albedo and the least alpha */
  size_t after;       /* index of the first sphere that is not inside this one */
  size_t thing;       /* PL_VIEW_SEVERAL: of several */
  double light;       /* sum of the squared radii of the things, times pl_view_light of each */
  double weighed;     /* the same with the weights of pl_view_weigh */
} pl_view_node;
#define PL_VIEW_SEVERAL ((size_t)-1)

struct pl_view_tree {
  size_t count;
  pl_view_node *nodes; /* each is followed by all that is in it */
  bool ringed;         /* some thing has rings */
  double albedo_max;   /* of all things, at most 1 */
};

/* Gives a view of more than PL_VIEW_FEW things a tree of them, in `arena`; leaves others alone:
 * every pair of a few is looked at. */
enum { PL_VIEW_FEW = 48 };
pl_status pl_view_tree_build(pl_arena *arena, pl_view *view);

/* Light or the like of a source that a receiver gets a part of; not negative. */
typedef double (*pl_view_weight_fn)(const pl_view_thing *source, const void *context);

/* Before pl_view_sum: puts the sources' weights into the tree, if there is one, in the place of
 * those before. */
void pl_view_weigh(const pl_view *view, pl_view_weight_fn weight, const void *context);
/* The sum, over all sources but the receiver, of pl_view_transfer times their weight. With a tree,
 * an upper bound of it: groups of sources that are far away count as near as the nearest place of
 * their sphere. */
double pl_view_sum(const pl_view *view, const pl_view_thing *receiver, pl_view_weight_fn weight,
                   const void *context);
/* The same of pl_view_light, at any time. */
double pl_view_sum_light(const pl_view *view, const pl_view_thing *receiver);

/* Whether a test holds of any thing. With a tree it is asked of the spheres about `several` things
 * first, which are as bright, rough and seen as any of them: it must hold there if it does of one.
 */
typedef bool (*pl_view_test_fn)(const pl_view_thing *thing, bool several, void *context);
bool pl_view_any(const pl_view *view, pl_view_test_fn test, void *context);

#endif
