/* Features of a graph that effects can leave out. */
#include <math.h>

#include "shade/graph_program.h"
#include "shade/node_rows.h"

static bool has_picture(const pl_node_kind *kind) {
  for (size_t k = 0; k < kind->constant_count; k++)
    if (kind->constants[k].type == PL_IMAGE)
      return true;
  return false;
}

bool pl_graph_uses_own(const pl_graph *graph) {
  bool uses = graph->wrap;
  for (size_t p = 0; p < graph->program_count; p++)
    for (size_t i = 0; i < graph->programs[p].count; i++)
      uses |= graph->programs[p].instructions[i].kind->reads_own;
  return uses;
}

double pl_graph_own_emission(const pl_graph *graph) {
  const pl_program *program = &graph->programs[0];
  const pl_operand color = program->outputs[PL_SURFACE_EMISSION_COLOR],
                   strength = program->outputs[PL_SURFACE_EMISSION_STRENGTH];
  if (color.bank != PL_BANK_REGISTER || strength.bank != PL_BANK_CONSTANT)
    return 0.0;
  for (size_t i = 0; i < program->count; i++)
    if (program->instructions[i].kind == &pl_node_model_material &&
        program->instructions[i].out + PL_OWN_EMISSION == color.index)
      return fmax(0.0, (double)graph->constants[strength.index][0]);
  return 0.0;
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
