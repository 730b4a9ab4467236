/* Descriptions of graphs in a few lines, for tests. */
#ifndef PL_TESTS_GRAPHS_H
#define PL_TESTS_GRAPHS_H

#include "harness.h"

#include <stdio.h>
#include <string.h>

#include "shade/graph.h"

enum { TEST_NODES = 300 };

typedef struct test_graph {
  pl_graph_node nodes[TEST_NODES];
  pl_graph_input inputs[TEST_NODES][PL_NODE_SOCKETS];
  pl_constant constants[TEST_NODES][PL_NODE_CONSTANTS];
  char names[TEST_NODES][12];
  size_t count, surface, parameters;
  bool wrap;
} test_graph;

/* Adds a node of a kind with nothing set; its constants are the rows' defaults. */
static inline size_t graph_add(test_graph *g, const char *kind_name) {
  const size_t i = g->count++;
  const pl_node_kind *kind = pl_node_kind_find(kind_name);
  assert_non_null(kind);
  for (size_t k = 0; k < kind->constant_count; k++)
    g->constants[i][k].number = kind->constants[k].fallback;
  snprintf(g->names[i], sizeof g->names[i], "n%d", (int)i);
  g->nodes[i] = (pl_graph_node){g->names[i], kind, g->inputs[i], g->constants[i]};
  if (kind->evaluate == NULL)
    g->surface = i;
  return i;
}

static inline pl_graph_input *graph_input(test_graph *g, size_t node, const char *name) {
  const pl_node_kind *kind = g->nodes[node].kind;
  for (size_t k = 0; k < pl_node_input_count(kind); k++)
    if (strcmp(pl_node_input(kind, k)->name, name) == 0)
      return &g->inputs[node][k];
  fail_msg("%s has no input %s", kind->name, name);
  return NULL;
}

static inline void graph_set(test_graph *g, size_t node, const char *name, float x, float y,
                             float z) {
  *graph_input(g, node, name) = (pl_graph_input){.source = PL_INPUT_CONSTANT, .value = {x, y, z}};
}

static inline void graph_link(test_graph *g, size_t node, const char *name, size_t from,
                              size_t output) {
  *graph_input(g, node, name) =
      (pl_graph_input){.source = PL_INPUT_LINK, .index = from, .output = output};
}

static inline void graph_drive(test_graph *g, size_t node, const char *name, size_t parameter) {
  *graph_input(g, node, name) = (pl_graph_input){.source = PL_INPUT_PARAMETER, .index = parameter};
}

static inline pl_constant *graph_constant(test_graph *g, size_t node, const char *name) {
  const pl_node_kind *kind = g->nodes[node].kind;
  for (size_t k = 0; k < kind->constant_count; k++)
    if (strcmp(kind->constants[k].name, name) == 0)
      return &g->constants[node][k];
  fail_msg("%s has no constant %s", kind->name, name);
  return NULL;
}

/* Sets a choice by its name. */
static inline void graph_choose(test_graph *g, size_t node, const char *name, const char *choice) {
  pl_constant *constant = graph_constant(g, node, name);
  const pl_node_kind *kind = g->nodes[node].kind;
  const pl_constant_row *row = &kind->constants[constant - g->constants[node]];
  for (size_t k = 0; row->choices[k] != NULL; k++)
    if (strcmp(row->choices[k], choice) == 0) {
      constant->number = (double)k;
      return;
    }
  fail_msg("no choice %s", choice);
}

static inline pl_status graph_make(const test_graph *g, pl_graph **out) {
  const pl_graph_description d = {.nodes = g->nodes,
                                  .count = g->count,
                                  .surface = g->surface,
                                  .parameter_count = g->parameters,
                                  .wrap = g->wrap};
  return pl_graph_create(&d, out);
}

/* A point at a place in object axes, with the frame of the axes. */
static inline pl_graph_point graph_point(float x, float y, float z, float radius) {
  return (pl_graph_point){.object = {x, y, z},
                          .world = {x, y, z},
                          .t = {1.0f, 0.0f, 0.0f},
                          .b = {0.0f, 1.0f, 0.0f},
                          .n = {0.0f, 0.0f, 1.0f},
                          .ng = {0.0f, 0.0f, 1.0f},
                          .view = {0.0f, 0.0f, 1.0f},
                          .radius = radius,
                          .filter = PL_FILTER_FINEST,
                          .bumps = true,
                          .scale = 1.0f};
}

/* Value of a node's output at a point, through the base colour of a surface that is made for it. */
static inline void graph_value_at(test_graph g, size_t node, size_t output,
                                  const pl_graph_point *point, pl_value out) {
  pl_graph *graph;
  pl_value sockets[PL_NODE_SOCKETS];
  const size_t surface = graph_add(&g, "lambert");
  for (size_t i = 0; i < g.count; i++) { /* the copy's own rows */
    g.nodes[i].inputs = g.inputs[i];
    g.nodes[i].constants = g.constants[i];
  }
  graph_link(&g, surface, "base_color", node, output);
  if (graph_make(&g, &graph) != PL_OK)
    fail_msg("%s", pl_error_text());
  pl_graph_evaluate(graph, point, NULL, sockets);
  memcpy(out, sockets[0], sizeof sockets[0]);
  pl_graph_destroy(graph);
}

#endif
