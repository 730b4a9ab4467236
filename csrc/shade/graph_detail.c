/* What a graph has that rows of effects can leave out. */
#include "shade/graph_program.h"

static bool has_picture(const pl_node_kind *kind) {
  for (size_t k = 0; k < kind->constant_count; k++)
    if (kind->constants[k].type == PL_IMAGE)
      return true;
  return false;
}

void pl_graph_summarise_detail(const pl_graph *graph, pl_model_summary *summary) {
  summary->textured |= graph->programs[0].count > 0;
  summary->diffuse &= graph->surface->reflectance == &pl_reflectance_lambert;
  for (size_t p = 0; p < graph->program_count; p++)
    for (size_t i = 0; i < graph->programs[p].count; i++) {
      const pl_node_kind *kind = graph->programs[p].instructions[i].kind;
      summary->pictured |= has_picture(kind);
      summary->bumped |= kind->bends;
    }
}
