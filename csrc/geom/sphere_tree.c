/* Builds trees of bounding spheres from the top down. */
#include "geom/sphere_tree.h"

#include <math.h>
#include <stdlib.h>

/* At most this many spheres are tested one by one: a common bounding sphere would be one test more.
 */
enum { SPHERES_IN_LINE = 4 };

/* Returns a sphere about the centre of the bounding box of several spheres that encloses them all
 * with their radii. */
static pl_sphere sphere_about(const pl_sphere *spheres, size_t count) {
  pl_vec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t i = 0; i < count; i++) {
    const pl_vec3 c = spheres[i].center;
    const double r = spheres[i].radius_m;
    low = (pl_vec3){fmin(low.x, c.x - r), fmin(low.y, c.y - r), fmin(low.z, c.z - r)};
    high = (pl_vec3){fmax(high.x, c.x + r), fmax(high.y, c.y + r), fmax(high.z, c.z + r)};
  }
  pl_sphere out = {.center = pl_vec3_scale(pl_vec3_add(low, high), 0.5), .item = PL_INNER_NODE};
  for (size_t i = 0; i < count; i++) {
    const double away = pl_vec3_norm(pl_vec3_sub(spheres[i].center, out.center));
    out.radius_m = fmax(out.radius_m, away + spheres[i].radius_m);
  }
  out.radius_m *= 1.0 + 1e-9;
  return out;
}

static int order(double a, double b, const pl_sphere *x, const pl_sphere *y) {
  if (a < b || a > b)
    return a < b ? -1 : 1;
  return x->item < y->item ? -1 : x->item > y->item;
}

static int by_x(const void *a, const void *b) {
  const pl_sphere *s = a, *t = b;
  return order(s->center.x, t->center.x, s, t);
}

static int by_y(const void *a, const void *b) {
  const pl_sphere *s = a, *t = b;
  return order(s->center.y, t->center.y, s, t);
}

static int by_z(const void *a, const void *b) {
  const pl_sphere *s = a, *t = b;
  return order(s->center.z, t->center.z, s, t);
}

/* Sorts along the axis on which the centres span the widest range. */
static void sort_spheres(pl_sphere *spheres, size_t count) {
  pl_vec3 low = spheres[0].center, high = low;
  for (size_t i = 1; i < count; i++) {
    const pl_vec3 c = spheres[i].center;
    low = (pl_vec3){fmin(low.x, c.x), fmin(low.y, c.y), fmin(low.z, c.z)};
    high = (pl_vec3){fmax(high.x, c.x), fmax(high.y, c.y), fmax(high.z, c.z)};
  }
  const pl_vec3 wide = pl_vec3_sub(high, low);
  const bool on_x = wide.x >= wide.y && wide.x >= wide.z;
  qsort(spheres, count, sizeof *spheres, on_x ? by_x : wide.y >= wide.z ? by_y : by_z);
}

/* Appends the tree over some spheres to `nodes`; sorts the spheres on the way. */
static void add_tree(pl_sphere *nodes, size_t *next, pl_sphere *spheres, size_t count) {
  const size_t own = *next;
  if (count <= SPHERES_IN_LINE) {
    for (size_t i = 0; i < count; i++) {
      nodes[*next] = spheres[i];
      nodes[*next].after = (uint32_t)*next + 1;
      (*next)++;
    }
    return;
  }
  nodes[(*next)++] = sphere_about(spheres, count);
  sort_spheres(spheres, count);
  add_tree(nodes, next, spheres, count / 2);
  add_tree(nodes, next, spheres + count / 2, count - count / 2);
  nodes[own].after = (uint32_t)*next;
}

pl_status pl_sphere_tree_build(pl_arena *arena, pl_sphere *leaves, size_t count,
                               pl_sphere_tree *out) {
  pl_sphere *nodes = pl_arena_alloc(arena, 2 * count, sizeof *nodes); /* fewer inner than leaves */
  if (nodes == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for a tree of %zu spheres", count);
  for (size_t i = 0; i < count; i++)
    leaves[i].item = (uint32_t)i;
  *out = (pl_sphere_tree){.nodes = nodes};
  add_tree(nodes, &out->count, leaves, count);
  return PL_OK;
}
