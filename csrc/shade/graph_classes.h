/* Classes of a surface by values of its graph, for semantic labels: a point has the class of the
 * first range that holds the value there. */
#ifndef PL_SHADE_GRAPH_CLASSES_H
#define PL_SHADE_GRAPH_CLASSES_H

#include "shade/graph.h"

/* A class of a level. */
typedef struct pl_graph_class {
  float low, high; /* both included */
  uint16_t id;
} pl_graph_class;

/* The classes of one level. */
typedef struct pl_graph_level {
  size_t level;
  /* borrowed: a graph with the same parameters, whose surface has the value as the strength of its
   * emission */
  const pl_graph *value;
  size_t count;
  pl_graph_class *classes; /* owned by the graph that has the level */
} pl_graph_level;

/* Adds the classes of a level, which are copied. */
pl_status pl_graph_add_level(pl_graph *graph, const pl_graph_level *level);
/* True if a point's classes at any level follow from the graph. */
bool pl_graph_has_levels(const pl_graph *graph);
/* Sets the ids of a point at the levels that the graph has classes of; 0 where its value is in none
 * of them. */
void pl_graph_classify(const pl_graph *graph, const pl_graph_point *point, const pl_value *params,
                       uint16_t *ids);

#endif
