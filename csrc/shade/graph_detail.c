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

/* Outputs of instruction `n` that the program reads, a bit each. */
static unsigned outputs_read(const pl_program *program, size_t n) {
  const pl_instruction *from = &program->instructions[n];
  unsigned read = 0;
  for (size_t k = 0; k < from->kind->output_count; k++) {
    const size_t made = from->out + k;
    bool is_read =
        program->outputs[0].bank == PL_BANK_REGISTER && program->outputs[0].index == made;
    for (size_t later = n + 1; later < program->count; later++) {
      const pl_instruction *by = &program->instructions[later];
      for (size_t i = 0; i < by->kind->input_count; i++)
        is_read |= (by->kind->lazy >> i & 1u) == 0 && by->in[i].bank == PL_BANK_REGISTER &&
                   by->in[i].index == made;
    }
    read |= (unsigned)is_read << k;
  }
  return read;
}

static bool has_slopes(const pl_program *program, size_t n) {
  const pl_instruction *at = &program->instructions[n];
  const pl_node_kind *kind = at->kind;
  return kind->evaluate_slopes != NULL &&
         (kind->has_slopes == NULL ||
          kind->has_slopes(at->constants, at->uniform, outputs_read(program, n)));
}

void pl_program_find_slopes(pl_program *program) {
  bool varies = false;
  program->slopes = true;
  for (size_t n = 0; n < program->count; n++) {
    const pl_instruction *at = &program->instructions[n];
    if (pl_instruction_is_uniform(at))
      continue;
    varies |= program->outputs[0].bank == PL_BANK_REGISTER &&
              program->outputs[0].index >= at->out &&
              program->outputs[0].index < at->out + at->kind->output_count;
    program->slopes &= has_slopes(program, n);
  }
  program->slopes &= varies;
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
