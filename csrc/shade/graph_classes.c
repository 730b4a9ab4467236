#include "shade/graph_classes.h"

#include <string.h>

#include "base/memory.h"
#include "shade/graph_program.h"
#include "shade/node_rows.h"

pl_status pl_graph_add_level(pl_graph *graph, const pl_graph_level *level) {
  void *classes;
  if (pl_graph_parameter_count(level->value) != graph->parameter_count)
    return pl_fail(PL_E_ARGUMENT, "the graph of a value must have the parameters of its material");
  pl_graph_level *levels = pl_realloc(graph->levels, graph->level_count + 1, sizeof *levels);
  if (levels == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the classes of a graph");
  graph->levels = levels;
  PL_TRY(
      pl_alloc_or_fail(level->count, sizeof(pl_graph_class), "the classes of a graph", &classes));
  levels[graph->level_count] = *level;
  levels[graph->level_count++].classes =
      memcpy(classes, level->classes, level->count * sizeof(pl_graph_class));
  return PL_OK;
}

bool pl_graph_has_levels(const pl_graph *graph) { return graph->level_count > 0; }

static uint16_t id_of(const pl_graph_level *level, float value) {
  for (size_t i = 0; i < level->count; i++)
    if (value >= level->classes[i].low && value <= level->classes[i].high)
      return level->classes[i].id;
  return 0;
}

void pl_graph_classify(const pl_graph *graph, const pl_graph_point *point, const pl_value *params,
                       uint16_t *ids) {
  for (size_t i = 0; i < graph->level_count; i++) {
    const pl_graph_level *level = &graph->levels[i];
    pl_value values[PL_NODE_SOCKETS];
    pl_graph_evaluate(level->value, point, params, values);
    ids[level->level] = id_of(level, values[PL_SURFACE_EMISSION_STRENGTH][0]);
  }
}
