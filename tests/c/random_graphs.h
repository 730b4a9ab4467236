/* Random numbers and random nodes of graphs, for tests. */
#ifndef PL_TESTS_RANDOM_GRAPHS_H
#define PL_TESTS_RANDOM_GRAPHS_H

#include "graphs.h"

#include "math/sampler.h"

/* Random numbers of a test, from its own seed. */
typedef struct draws {
  uint32_t state;
} draws;

static inline uint32_t draw(draws *d, uint32_t below) {
  d->state = pl_sampler_mix(d->state + 0x9e3779b9u);
  return (uint32_t)(((uint64_t)d->state * below) >> 32);
}

static inline float draw_within(draws *d, float low, float high) {
  return low + (high - low) * (float)draw(d, 1u << 24) * 0x1p-24f;
}

/* Mostly ordinary, at times what breaks arithmetic. */
static inline float draw_number(draws *d) {
  static const float ODD[] = {0.0f, -0.0f, 1.0f, -1.0f, 1e30f, -3e38f, 1e-40f, INFINITY, NAN};
  return draw(d, 12) == 0 ? ODD[draw(d, 9)] : draw_within(d, -3.0f, 3.0f);
}

static const float STOPS[] = {-1.0f, 0.0f, 0.2f, 1.0f, 0.4f, 1.0f,
                              0.4f,  0.0f, 1.5f, 0.3f, 0.9f, 0.1f};

static inline void draw_constants(test_graph *g, size_t node, draws *d) {
  const pl_node_kind *kind = g->nodes[node].kind;
  for (size_t k = 0; k < kind->constant_count; k++) {
    const pl_constant_row *row = &kind->constants[k];
    pl_constant *constant = &g->constants[node][k];
    uint32_t choices = 0;
    while (row->type == PL_CHOICE && row->choices[choices] != NULL)
      choices++;
    if (row->type == PL_CHOICE)
      constant->number = draw(d, choices);
    else if (row->type == PL_NUMBER)
      constant->number = row->high < 2.0 ? draw(d, 2) : draw(d, 1000);
    else if (row->type == PL_NUMBERS)
      *constant = (pl_constant){.numbers = STOPS, .count = sizeof STOPS / sizeof STOPS[0]};
    else
      *constant = (pl_constant){0};
  }
}

enum { PARAMETERS = 3 };

/* Sets an input from an earlier node, a parameter, a number, or not. */
static inline void draw_input(test_graph *g, size_t node, size_t k, draws *d) {
  pl_graph_input *input = &g->inputs[node][k];
  const uint32_t how = draw(d, 6);
  if (how < 3 && node > 0) {
    const size_t from = draw(d, (uint32_t)node);
    const size_t outputs = g->nodes[from].kind->output_count;
    *input = (pl_graph_input){
        .source = PL_INPUT_LINK, .index = from, .output = draw(d, (uint32_t)outputs)};
  } else if (how == 3) {
    *input = (pl_graph_input){.source = PL_INPUT_PARAMETER, .index = draw(d, PARAMETERS)};
  } else if (how == 4) {
    *input = (pl_graph_input){.source = PL_INPUT_CONSTANT,
                              .value = {draw_within(d, -2.0f, 4.0f), draw_within(d, -2.0f, 4.0f),
                                        draw_within(d, -2.0f, 4.0f)}};
  }
}

#endif
