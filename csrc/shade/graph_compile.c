/* Compiles the description of a graph to programs. */
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "shade/graph_program.h"
#include "shade/node_rows.h"

/* State of the compiler for one program. */
typedef struct builder {
  const pl_graph_description *description;
  pl_graph *graph;
  const pl_constant *const *node_constants; /* of the graph's copy, per node */
  size_t program;                           /* index of the current program */
  int depth;                                /* nesting depth of lazy inputs */
  pl_operand (*made)[PL_NODE_OUTPUTS]; /* per node: operands of its outputs, valid if is_made */
  bool *is_made;                       /* per node: already compiled */
  bool is_uniform[PL_GRAPH_REGISTERS]; /* per register: the same in all lanes */
} builder;

/* --- checks ----------------------------------------------------------------------------------- */

static pl_status check_constant(const pl_constant_row *row, const pl_constant *value) {
  if (row->type == PL_NUMBER && !(value->number >= row->low && value->number <= row->high))
    return pl_fail(PL_E_RANGE, "%s: %g is outside %g to %g", row->name, value->number, row->low,
                   row->high);
  if (row->type == PL_CHOICE) {
    size_t count = 0;
    while (row->choices[count] != NULL)
      count++;
    if (!(value->number >= 0.0 && value->number < (double)count))
      return pl_fail(PL_E_RANGE, "%s: no choice %g", row->name, value->number);
  }
  if (row->type == PL_NUMBERS &&
      (value->count % row->columns != 0 || (value->count > 0 && value->numbers == NULL)))
    return pl_fail(PL_E_RANGE, "%s: rows of %zu numbers, not %zu numbers", row->name, row->columns,
                   value->count);
  return PL_OK;
}

static pl_status check_constants(const pl_graph_node *node) {
  for (size_t k = 0; k < node->kind->constant_count; k++)
    PL_TRY(check_constant(&node->kind->constants[k], &node->constants[k]));
  return node->kind->check != NULL ? node->kind->check(node->constants) : PL_OK;
}

static pl_status check_input(const pl_graph_description *d, const pl_graph_node *node, size_t k) {
  const pl_graph_input *input = &node->inputs[k];
  const char *name = pl_node_input(node->kind, k)->name;
  if (input->source == PL_INPUT_LINK) {
    const pl_graph_node *from = input->index < d->count ? &d->nodes[input->index] : NULL;
    if (from == NULL || input->output >= from->kind->output_count)
      return pl_fail(PL_E_RANGE, "%s: linked to an output that is not there", name);
  }
  if (input->source == PL_INPUT_PARAMETER && input->index >= d->parameter_count)
    return pl_fail(PL_E_RANGE, "%s: parameter %zu of %zu", name, input->index, d->parameter_count);
  for (int i = 0; i < 3; i++)
    if (input->source == PL_INPUT_CONSTANT && !(input->value[i] - input->value[i] == 0.0f))
      return pl_fail(PL_E_RANGE, "%s: not a finite number", name);
  return PL_OK;
}

/* Prefixes the current error text with the node's name. */
static pl_status at_node(pl_status status, const char *name) {
  char text[512];
  if (status == PL_OK || status == PL_E_MEMORY)
    return status;
  snprintf(text, sizeof text, "%s", pl_error_text());
  return pl_fail(status, "%s.%s", name, text);
}

static pl_status check_nodes(const pl_graph_description *d) {
  if (d->count > PL_GRAPH_NODES)
    return pl_fail(PL_E_RANGE, "%zu nodes: at most %d", d->count, PL_GRAPH_NODES);
  if (d->parameter_count > UINT16_MAX)
    return pl_fail(PL_E_RANGE, "%zu parameters: at most %d", d->parameter_count, UINT16_MAX);
  if (d->surface >= d->count || d->nodes[d->surface].kind->evaluate != NULL)
    return pl_fail(PL_E_RANGE, "surface: not a node that is a surface");
  for (size_t i = 0; i < d->count; i++) {
    const pl_graph_node *node = &d->nodes[i];
    PL_TRY(at_node(check_constants(node), node->name));
    for (size_t k = 0; k < pl_node_input_count(node->kind); k++)
      PL_TRY(at_node(check_input(d, node, k), node->name));
  }
  return PL_OK;
}

/* Fails with the names of the nodes from path[from] on. */
static pl_status report_cycle(const pl_graph_description *d, const size_t *path, size_t from,
                              size_t depth) {
  char text[512] = "";
  size_t used = 0;
  for (size_t i = from; i < depth && used + 1 < sizeof text; i++)
    used += (size_t)snprintf(text + used, sizeof text - used, "%s -> ", d->nodes[path[i]].name);
  return pl_fail(PL_E_RANGE, "nodes form a cycle: %s%s", text, d->nodes[path[from]].name);
}

/* Depth-first search along the links; `path`: nodes from the start to the current one. */
static pl_status find_cycle(const pl_graph_description *d, size_t node, size_t *path, size_t depth,
                            bool *done) {
  for (size_t i = 0; i < depth; i++)
    if (path[i] == node)
      return report_cycle(d, path, i, depth);
  if (done[node])
    return PL_OK;
  path[depth] = node;
  for (size_t k = 0; k < pl_node_input_count(d->nodes[node].kind); k++)
    if (d->nodes[node].inputs[k].source == PL_INPUT_LINK)
      PL_TRY(find_cycle(d, d->nodes[node].inputs[k].index, path, depth + 1, done));
  done[node] = true;
  return PL_OK;
}

static pl_status check_cycles(const pl_graph_description *d) {
  size_t path[PL_GRAPH_NODES + 1];
  bool done[PL_GRAPH_NODES] = {false};
  for (size_t i = 0; i < d->count; i++)
    PL_TRY(find_cycle(d, i, path, 0, done));
  return PL_OK;
}

/* --- building --------------------------------------------------------------------------------- */

static pl_status too_large(void) {
  return pl_fail(PL_E_RANGE, "more than %d values in one graph", PL_GRAPH_REGISTERS);
}

static pl_status add_constant(pl_graph *graph, const float value[3], pl_operand *out) {
  if (graph->constant_count >= UINT16_MAX)
    return too_large();
  pl_value *grown = pl_realloc(graph->constants, graph->constant_count + 1, sizeof *grown);
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for a graph");
  graph->constants = grown;
  memcpy(grown[graph->constant_count], value, 3 * sizeof(float));
  grown[graph->constant_count][3] = 0.0f;
  *out = (pl_operand){PL_BANK_CONSTANT, (uint16_t)graph->constant_count++};
  return PL_OK;
}

/* Constant folding: evaluates a node whose inputs are all constants. */
static pl_status fold(builder *b, const pl_instruction *instruction, pl_operand *outputs) {
  pl_lanes in[PL_NODE_SOCKETS], out[PL_NODE_OUTPUTS];
  pl_node_call call = {
      .count = 1, .uniform = instruction->uniform, .constants = instruction->constants, .out = out};
  for (size_t k = 0; k < instruction->kind->input_count; k++) {
    pl_value_spread(b->graph->constants[instruction->in[k].index], in[k]);
    call.in[k] = (const pl_lanes *)&in[k];
  }
  instruction->kind->evaluate(&call);
  for (size_t k = 0; k < instruction->kind->output_count; k++) {
    const float value[3] = {out[k][0][0], out[k][1][0], out[k][2][0]};
    PL_TRY(add_constant(b->graph, value, &outputs[k]));
  }
  return PL_OK;
}

/* Appends the instruction to the program, or folds it. */
static pl_status emit(builder *b, pl_instruction *instruction, pl_operand *outputs) {
  const pl_node_kind *kind = instruction->kind;
  bool folds = !kind->reads_point && kind->lazy == 0;
  for (size_t k = 0; k < kind->input_count; k++) {
    const pl_operand in = instruction->in[k];
    folds &= in.bank == PL_BANK_CONSTANT;
    const bool lazy = (kind->lazy >> k & 1u) != 0;
    const bool uniform = in.bank != PL_BANK_REGISTER || (!lazy && b->is_uniform[in.index]);
    instruction->uniform |= (unsigned)uniform << k;
  }
  if (folds)
    return fold(b, instruction, outputs);
  pl_program *program = &b->graph->programs[b->program];
  if (program->register_count + kind->output_count > PL_GRAPH_REGISTERS)
    return too_large();
  pl_instruction *grown = pl_realloc(program->instructions, program->count + 1, sizeof *grown);
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for a graph");
  program->instructions = grown;
  instruction->out = program->register_count;
  grown[program->count++] = *instruction;
  for (size_t k = 0; k < kind->output_count; k++) {
    b->is_uniform[program->register_count] = pl_instruction_is_uniform(instruction);
    outputs[k] = (pl_operand){PL_BANK_REGISTER, (uint16_t)program->register_count++};
  }
  return PL_OK;
}

static pl_status build_node(builder *b, size_t index);

/* Inserts a conversion if a vector or colour is linked to a scalar input. */
static pl_status convert(builder *b, pl_socket_type from, pl_socket_type to, pl_operand *operand) {
  if (to != PL_SCALAR || from == PL_SCALAR)
    return PL_OK;
  pl_instruction conversion = {.kind = from == PL_COLOR ? &pl_node_luminance : &pl_node_mean};
  conversion.in[0] = *operand;
  return emit(b, &conversion, operand);
}

static pl_status build_input(builder *b, const pl_graph_node *node, size_t k, pl_operand *out) {
  const pl_graph_input *input = &node->inputs[k];
  const pl_socket *socket = pl_node_input(node->kind, k);
  switch (input->source) {
  case PL_INPUT_UNSET:
    return add_constant(b->graph, socket->fallback, out);
  case PL_INPUT_CONSTANT:
    return add_constant(b->graph, input->value, out);
  case PL_INPUT_PARAMETER:
    *out = (pl_operand){PL_BANK_PARAMETER, (uint16_t)input->index};
    return PL_OK;
  case PL_INPUT_LINK:
    break;
  }
  PL_TRY(build_node(b, input->index));
  *out = b->made[input->index][input->output];
  const pl_node_kind *from = b->description->nodes[input->index].kind;
  return convert(b, from->outputs[input->output].type, socket->type, out);
}

static pl_status add_program(pl_graph *graph, size_t *index) {
  if (graph->program_count >= UINT16_MAX)
    return too_large();
  pl_program *grown = pl_realloc(graph->programs, graph->program_count + 1, sizeof *grown);
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for a graph");
  graph->programs = grown;
  *index = graph->program_count++;
  grown[*index] = (pl_program){0};
  return PL_OK;
}

static pl_status start(builder *b) {
  void *memory;
  PL_TRY(pl_alloc_or_fail(b->description->count, sizeof *b->made, "a graph", &memory));
  b->made = memory;
  PL_TRY(pl_alloc_or_fail(b->description->count, sizeof *b->is_made, "a graph", &memory));
  b->is_made = memory;
  return add_program(b->graph, &b->program);
}

static void finish(builder *b) {
  pl_free(b->made);
  pl_free(b->is_made);
}

/* Compiles one lazy input to a separate program. */
static pl_status build_lazy(const builder *outer, const pl_graph_node *node, size_t k,
                            pl_operand *out) {
  builder inner = {.description = outer->description,
                   .graph = outer->graph,
                   .node_constants = outer->node_constants,
                   .depth = outer->depth + 1};
  if (inner.depth > PL_GRAPH_LAZY_DEPTH)
    return pl_fail(PL_E_RANGE, "%s.%s: bumps within bumps, more than %d deep", node->name,
                   pl_node_input(node->kind, k)->name, PL_GRAPH_LAZY_DEPTH);
  pl_operand output = {0};
  pl_status status = start(&inner);
  if (status == PL_OK)
    status = build_input(&inner, node, k, &output);
  if (status == PL_OK) {
    inner.graph->programs[inner.program].outputs[0] = output;
    pl_program_find_slopes(&inner.graph->programs[inner.program]);
    *out = (pl_operand){PL_BANK_REGISTER, (uint16_t)inner.program};
  }
  finish(&inner);
  return status;
}

static pl_status build_inputs(builder *b, const pl_graph_node *node, pl_operand *out) {
  for (size_t k = 0; k < pl_node_input_count(node->kind); k++) {
    const bool lazy = (node->kind->lazy >> k & 1u) != 0;
    PL_TRY(lazy ? build_lazy(b, node, k, &out[k]) : build_input(b, node, k, &out[k]));
  }
  return PL_OK;
}

static pl_status build_node(builder *b, size_t index) {
  const pl_graph_node *node = &b->description->nodes[index];
  pl_instruction instruction = {.kind = node->kind, .constants = b->node_constants[index]};
  if (b->is_made[index])
    return PL_OK;
  for (size_t k = 0; k < node->kind->input_count; k++)
    instruction.given |= (unsigned)(node->inputs[k].source != PL_INPUT_UNSET) << k;
  PL_TRY(build_inputs(b, node, instruction.in));
  PL_TRY(emit(b, &instruction, b->made[index]));
  b->is_made[index] = true;
  return PL_OK;
}

/* Copies the constants of all nodes into the graph; of_node[i] points to those of node i. */
static pl_status copy_constants(const pl_graph_description *d, pl_graph *graph,
                                const pl_constant **of_node) {
  size_t count = 0, numbers = 0;
  for (size_t i = 0; i < d->count; i++)
    for (size_t k = 0; k < d->nodes[i].kind->constant_count; k++, count++)
      numbers += d->nodes[i].constants[k].count;
  void *memory;
  PL_TRY(pl_alloc_or_fail(count, sizeof(pl_constant), "a graph", &memory));
  graph->node_constants = memory;
  PL_TRY(pl_alloc_or_fail(numbers, sizeof(float), "a graph", &memory));
  graph->numbers = memory;
  pl_constant *next = graph->node_constants;
  float *number = graph->numbers;
  for (size_t i = 0; i < d->count; i++) {
    of_node[i] = next;
    for (size_t k = 0; k < d->nodes[i].kind->constant_count; k++, next++) {
      *next = d->nodes[i].constants[k];
      if (next->count > 0)
        memcpy(number, next->numbers, next->count * sizeof *number);
      next->numbers = number;
      number += next->count;
    }
  }
  return PL_OK;
}

/* Value of an input of the surface if it is a folded constant, or NULL; lazy inputs included. */
static const float *folded(const pl_graph *graph, size_t k) {
  pl_operand operand = graph->programs[0].outputs[k];
  if ((graph->surface->lazy >> k & 1u) != 0)
    operand = graph->programs[operand.index].outputs[0];
  return operand.bank == PL_BANK_CONSTANT ? graph->constants[operand.index] : NULL;
}

/* Finds the inputs of the surface that the graph sets, and whether alpha may make it absent. */
static void find_set(const pl_graph_node *surface, pl_graph *graph) {
  for (size_t k = 0; k < pl_node_input_count(surface->kind); k++) {
    const float *value = folded(graph, k), *fallback = pl_node_input(surface->kind, k)->fallback;
    const bool set = !graph->wrap || surface->inputs[k].source != PL_INPUT_UNSET;
    const bool plain = value != NULL && memcmp(value, fallback, 3 * sizeof *fallback) == 0;
    graph->sets |= (unsigned)set << k;
    graph->differs |= (unsigned)(set && !plain) << k;
  }
  const float *alpha = folded(graph, PL_SURFACE_ALPHA);
  graph->cuts = alpha == NULL || !(alpha[0] >= PL_ALPHA_CUT);
  graph->absent = alpha != NULL && graph->cuts;
}

/* Compiles a separate program for the emission, if there may be any: light sources evaluate only
 * that. */
static pl_status build_emission(const builder *outer, const pl_graph_node *surface) {
  pl_graph *graph = outer->graph;
  builder inner = {
      .description = outer->description, .graph = graph, .node_constants = outer->node_constants};
  const float *strength = folded(graph, PL_SURFACE_EMISSION_STRENGTH);
  if (!pl_graph_sets_emission(graph) || (strength != NULL && !(strength[0] > 0.0f)))
    return PL_OK;
  pl_operand color = {0}, factor = {0};
  pl_status status = start(&inner);
  if (status == PL_OK)
    status = build_input(&inner, surface, PL_SURFACE_EMISSION_COLOR, &color);
  if (status == PL_OK)
    status = build_input(&inner, surface, PL_SURFACE_EMISSION_STRENGTH, &factor);
  if (status == PL_OK) {
    graph->emission = inner.program;
    graph->programs[inner.program].outputs[0] = color;
    graph->programs[inner.program].outputs[1] = factor;
  }
  finish(&inner);
  return status;
}

/* The same for the colour, of which labels tell the albedo. */
static pl_status build_color(const builder *outer, const pl_graph_node *surface) {
  pl_graph *graph = outer->graph;
  builder inner = {
      .description = outer->description, .graph = graph, .node_constants = outer->node_constants};
  if ((graph->sets >> PL_SURFACE_BASE_COLOR & 1u) == 0)
    return PL_OK;
  pl_operand color = {0};
  pl_status status = start(&inner);
  if (status == PL_OK)
    status = build_input(&inner, surface, PL_SURFACE_BASE_COLOR, &color);
  if (status == PL_OK) {
    graph->color = inner.program;
    graph->programs[inner.program].outputs[0] = color;
  }
  finish(&inner);
  return status;
}

static pl_status spread_constants(pl_graph *graph) {
  void *memory;
  PL_TRY(pl_alloc_or_fail(graph->constant_count, sizeof(pl_lanes), "a graph", &memory));
  graph->spread = memory;
  for (size_t i = 0; i < graph->constant_count; i++)
    pl_value_spread(graph->constants[i], graph->spread[i]);
  return PL_OK;
}

static pl_status build(const pl_graph_description *d, pl_graph *graph) {
  const pl_constant *of_node[PL_GRAPH_NODES];
  const pl_graph_node *surface = &d->nodes[d->surface];
  pl_operand outputs[PL_NODE_SOCKETS] = {{0}};
  PL_TRY(copy_constants(d, graph, of_node));
  builder b = {.description = d, .graph = graph, .node_constants = of_node};
  pl_status status = start(&b);
  if (status == PL_OK)
    status = build_inputs(&b, surface, outputs);
  if (status == PL_OK)
    memcpy(graph->programs[b.program].outputs, outputs, sizeof outputs);
  if (status == PL_OK) {
    find_set(surface, graph);
    status = build_emission(&b, surface);
  }
  if (status == PL_OK)
    status = build_color(&b, surface);
  finish(&b);
  return status == PL_OK ? spread_constants(graph) : status;
}

pl_status pl_graph_create(const pl_graph_description *description, pl_graph **out) {
  *out = NULL;
  PL_TRY(check_nodes(description));
  PL_TRY(check_cycles(description));
  void *memory;
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_graph), "a graph", &memory));
  pl_graph *graph = memory;
  graph->surface = description->nodes[description->surface].kind;
  graph->wrap = description->wrap;
  graph->parameter_count = description->parameter_count;
  const pl_status status = build(description, graph);
  if (status != PL_OK) {
    pl_graph_destroy(graph);
    return status;
  }
  *out = graph;
  return PL_OK;
}

void pl_graph_destroy(pl_graph *graph) {
  if (graph == NULL)
    return;
  for (size_t i = 0; i < graph->program_count; i++)
    pl_free(graph->programs[i].instructions);
  pl_free(graph->programs);
  pl_free(graph->constants);
  pl_free(graph->spread);
  pl_free(graph->node_constants);
  pl_free(graph->numbers);
  for (size_t i = 0; i < graph->level_count; i++)
    pl_free(graph->levels[i].classes);
  pl_free(graph->levels);
  pl_free(graph);
}
