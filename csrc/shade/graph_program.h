/* Compiled form of a graph. Internal to shade. */
#ifndef PL_SHADE_GRAPH_PROGRAM_H
#define PL_SHADE_GRAPH_PROGRAM_H

#include <stdint.h>

#include "shade/graph_classes.h"

enum {
  PL_GRAPH_NODES = 256,
  PL_GRAPH_REGISTERS =
      256, /* values of one program: 32 kB on the stack, of which it uses what it has */
  PL_GRAPH_LAZY_DEPTH = 3, /* limit of nested lazy inputs: each level multiplies the work */
};

typedef enum pl_bank { PL_BANK_CONSTANT, PL_BANK_PARAMETER, PL_BANK_REGISTER } pl_bank;

typedef struct pl_operand {
  uint16_t bank, index;
} pl_operand;

typedef struct pl_instruction {
  const pl_node_kind *kind;
  const pl_constant *constants;   /* the graph's copy of the node's constants */
  pl_operand in[PL_NODE_SOCKETS]; /* for a lazy input: index of its program, bank unused */
  unsigned given, uniform;        /* as in pl_node_call */
  size_t out;                     /* first output register */
} pl_instruction;

/* Reads no point, and only values that are the same in all lanes, as its own then are. */
static inline bool pl_instruction_is_uniform(const pl_instruction *instruction) {
  const pl_node_kind *kind = instruction->kind;
  return !kind->reads_point && kind->lazy == 0 &&
         instruction->uniform == (1u << kind->input_count) - 1u;
}

typedef struct pl_program {
  pl_instruction *instructions; /* owned */
  size_t count, register_count;
  bool slopes; /* all of its nodes have derivatives */
  pl_operand outputs[PL_NODE_SOCKETS];
} pl_program;

struct pl_graph {
  const pl_node_kind *surface;
  bool wrap;
  /* Bit k: input k of the surface is set by the graph, not by the model's material. */
  unsigned sets;
  unsigned differs; /* bit k: set, and not known to equal its fallback */
  bool cuts;        /* alpha may be below 0.5 */
  bool absent;      /* alpha is below 0.5 everywhere */
  size_t emission;  /* program with only emission_color and emission_strength; 0: no emission */
  size_t color;     /* program with only base_color; 0: the graph does not set it */
  size_t parameter_count;
  pl_program *programs; /* owned; 0 is the surface's, the others are for lazy inputs, emission and
                           colour */
  size_t program_count;
  pl_value *constants; /* owned: all folded values */
  pl_lanes *spread;    /* owned: the same in all lanes */
  size_t constant_count;
  pl_constant *node_constants; /* owned, node by node */
  float *numbers;              /* owned: the number lists of node_constants */
  pl_graph_level *levels;      /* owned: classes by values, see shade/graph_classes.h */
  size_t level_count;
};

/* Extends the bounds by the features of the graph that effects can leave out. */
void pl_graph_summarise_detail(const pl_graph *graph, pl_model_summary *summary);

/* Finds whether a program of a lazy input has derivatives. */
void pl_program_find_slopes(pl_program *program);

/* A value in all lanes. */
static inline void pl_value_spread(const float *value, pl_lanes out) {
  for (size_t k = 0; k < 4; k++)
    for (size_t i = 0; i < PL_LANES; i++)
      out[k][i] = value[k];
}

/* One lane of an operand. */
static inline void pl_operand_value(const pl_graph *graph, const pl_value *params,
                                    const pl_lanes *registers, pl_operand operand, size_t lane,
                                    pl_value out) {
  for (size_t k = 0; k < 4; k++)
    out[k] = operand.bank == PL_BANK_REGISTER    ? registers[operand.index][k][lane]
             : operand.bank == PL_BANK_PARAMETER ? params[operand.index][k]
                                                 : graph->constants[operand.index][k];
}

#endif
