/* Material graphs: compiled once from a description to a flat program, evaluated without
 * allocation. Only what the surface needs is in the program, and what is constant has been
 * computed. */
#ifndef PL_SHADE_GRAPH_H
#define PL_SHADE_GRAPH_H

#include "shade/node.h"

typedef enum pl_input_source {
  PL_INPUT_UNSET,    /* the socket's fallback */
  PL_INPUT_CONSTANT, /* `value` */
  PL_INPUT_LINK,     /* output `output` of node `index` */
  PL_INPUT_PARAMETER /* parameter `index`: a value that each frame gives */
} pl_input_source;

typedef struct pl_graph_input {
  pl_input_source source;
  size_t index, output;
  float value[3]; /* a scalar stands in all three */
} pl_graph_input;

typedef struct pl_graph_node {
  const char *name; /* for errors */
  const pl_node_kind *kind;
  const pl_graph_input *inputs; /* as many as the kind's */
  const pl_constant *constants; /* as many as the kind's */
} pl_graph_node;

typedef struct pl_graph_description {
  const pl_graph_node *nodes;
  size_t count;
  size_t surface;         /* node whose kind is a surface */
  size_t parameter_count; /* of the values that each frame gives */
  bool wrap;              /* inputs of the surface that are unset stay the model's material's */
} pl_graph_description;

typedef struct pl_graph pl_graph;

/* Copies what it needs; textures stay borrowed. PL_E_RANGE naming the node for links to nothing,
 * constants out of range, cycles (printed) and graphs that are too large. */
pl_status pl_graph_create(const pl_graph_description *description, pl_graph **out);
void pl_graph_destroy(pl_graph *graph);

/* The surface's inputs at a point. params: parameter_count values. Thread-safe. */
void pl_graph_evaluate(const pl_graph *graph, const pl_graph_point *point, const pl_value *params,
                       pl_value out[PL_NODE_SOCKETS]);

/* Fills colours, lobes, emission and the bent frame of `surface`, whose frame is the point's on
 * input. With pl_graph_wraps the material's own values must be there. Colours, metalness and
 * roughness are cut off at 0 and 1, emission at 0 and PL_EMISSION_MAX; what is not a number is 0.
 */
void pl_graph_surface(const pl_graph *graph, const pl_graph_point *point, const pl_value *params,
                      pl_surface *surface);
bool pl_graph_wraps(const pl_graph *graph);
/* Whether the graph says what the surface emits, rather than the model's material. */
bool pl_graph_sets_emission(const pl_graph *graph);
/* Whether anything in it comes from the thing's own material. */
bool pl_graph_uses_own(const pl_graph *graph);
/* Where a graph gives what the thing's own material emits, times a fixed strength: that; else 0. */
double pl_graph_own_emission(const pl_graph *graph);
const pl_reflectance *pl_graph_reflectance(const pl_graph *graph);
/* Whether the graph gives the same at all points of a frame, and no normal. */
bool pl_graph_is_uniform(const pl_graph *graph);
/* Whether it may emit light; if so, the light that it emits at a point, W m-2 sr-1. */
bool pl_graph_emits(const pl_graph *graph);
pl_vec3f pl_graph_emission(const pl_graph *graph, const pl_graph_point *point,
                           const pl_value *params);
/* Whether that is the same at all points of a frame. */
bool pl_graph_emits_evenly(const pl_graph *graph);
/* Whether there may be no surface somewhere. */
bool pl_graph_cuts(const pl_graph *graph);
/* Whether there is none anywhere, in any frame. */
bool pl_graph_absent(const pl_graph *graph);
/* Whether there is a surface at a point: its alpha is PL_ALPHA_CUT or more. */
#define PL_ALPHA_CUT 0.5f
bool pl_graph_is_there(const pl_graph *graph, const pl_graph_point *point, const pl_value *params);
/* Its alpha as it is. */
float pl_graph_alpha(const pl_graph *graph, const pl_graph_point *point, const pl_value *params);
size_t pl_graph_parameter_count(const pl_graph *graph);
/* Nodes evaluated a hit, conversions included; those that lazy inputs evaluate not. */
size_t pl_graph_instruction_count(const pl_graph *graph);

#define PL_EMISSION_MAX 1e30 /* W m-2 sr-1: stands for no bound known, too */
/* Widens a model's bounds by those of a graph on it. */
void pl_graph_summarise(const pl_graph *graph, pl_model_summary *summary);

#endif
