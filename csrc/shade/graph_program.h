/* The compiled form of a graph. Internal to shade. */
#ifndef PL_SHADE_GRAPH_PROGRAM_H
#define PL_SHADE_GRAPH_PROGRAM_H

#include <stdint.h>

#include "shade/graph.h"

enum {
  PL_GRAPH_NODES = 256,
  PL_GRAPH_REGISTERS = 256, /* values of one program: 4 kB on the stack */
  PL_GRAPH_LAZY_DEPTH = 3,  /* of lazy inputs inside lazy inputs: each multiplies the work */
};

typedef enum pl_bank { PL_BANK_CONSTANT, PL_BANK_PARAMETER, PL_BANK_REGISTER } pl_bank;

typedef struct pl_operand {
  uint16_t bank, index;
} pl_operand;

typedef struct pl_instruction {
  const pl_node_kind *kind;
  const pl_constant *constants;   /* of the graph's copy of the node */
  pl_operand in[PL_NODE_SOCKETS]; /* of a lazy input: index of its program, bank unused */
  unsigned given;                 /* as in pl_node_call */
  size_t out;                     /* first register */
} pl_instruction;

typedef struct pl_program {
  pl_instruction *instructions; /* owned */
  size_t count, register_count;
  pl_operand outputs[PL_NODE_SOCKETS];
} pl_program;

struct pl_graph {
  const pl_node_kind *surface;
  bool wrap;
  unsigned sets;    /* bit k: input k of the surface is not left to the model's material */
  unsigned differs; /* bit k: nor is it known to be its fallback */
  bool cuts;        /* alpha may fall below one half */
  bool absent;      /* it is below one half everywhere */
  size_t emission;  /* program of emission_color and emission_strength alone; 0: it emits nothing */
  size_t parameter_count;
  pl_program *programs; /* owned; 0 is the surface's, the others are lazy inputs' */
  size_t program_count;
  pl_value *constants; /* owned: all folded values */
  size_t constant_count;
  pl_constant *node_constants; /* owned, node by node */
  float *numbers;              /* owned: what those point to */
};

/* Widens the bounds by what rows of effects can leave out of the graph. */
void pl_graph_summarise_detail(const pl_graph *graph, pl_model_summary *summary);

/* The value of an operand. */
static inline const float *pl_operand_value(const pl_graph *graph, const pl_value *params,
                                            const pl_value *registers, pl_operand operand) {
  const pl_value *const banks[] = {graph->constants, params, registers};
  return banks[operand.bank][operand.index];
}

#endif
