/* Material graphs: compiled once from a description to a flat program, evaluated without
 * allocation. The program has only the nodes that the surface needs, after constant folding. */
#ifndef PL_SHADE_GRAPH_H
#define PL_SHADE_GRAPH_H

#include "shade/node.h"

typedef enum pl_input_source {
  PL_INPUT_UNSET,    /* the socket's fallback */
  PL_INPUT_CONSTANT, /* `value` */
  PL_INPUT_LINK,     /* output `output` of node `index` */
  PL_INPUT_PARAMETER /* parameter `index`: a value that may differ from frame to frame */
} pl_input_source;

typedef struct pl_graph_input {
  pl_input_source source;
  size_t index, output;
  float value[3]; /* a scalar is stored in all three */
} pl_graph_input;

typedef struct pl_graph_node {
  const char *name; /* for error messages */
  const pl_node_kind *kind;
  const pl_graph_input *inputs; /* as many as the kind has */
  const pl_constant *constants; /* as many as the kind has */
} pl_graph_node;

typedef struct pl_graph_description {
  const pl_graph_node *nodes;
  size_t count;
  size_t surface;         /* index of the node that is a surface */
  size_t parameter_count; /* number of values set per frame */
  bool wrap;              /* unset inputs of the surface keep the values of the model's material */
} pl_graph_description;

typedef struct pl_graph pl_graph;

/* Compiles a graph. The description is copied, except that textures are borrowed. PL_E_RANGE with
 * the node's name for invalid links, constants out of range, cycles (listed) and graphs that are
 * too large. */
pl_status pl_graph_create(const pl_graph_description *description, pl_graph **out);
void pl_graph_destroy(pl_graph *graph);

/* Evaluates the inputs of the surface at a point. params: parameter_count values. Thread-safe. */
void pl_graph_evaluate(const pl_graph *graph, const pl_graph_point *point, const pl_value *params,
                       pl_value out[PL_NODE_SOCKETS]);

/* Fills colours, lobes, emission and the bumped frame of `surface`; on input it has the frame of
 * the point. With pl_graph_wraps it must already have the values of the model's material. Colours,
 * metalness and roughness are clamped to 0..1, emission to 0..PL_EMISSION_MAX; NaN becomes 0. */
void pl_graph_surface(const pl_graph *graph, const pl_graph_point *point, const pl_value *params,
                      pl_surface *surface);
/* The same at `count` points, at most PL_LANES, and faster than one by one. */
void pl_graph_surfaces(const pl_graph *graph, const pl_graph_point *points, size_t count,
                       const pl_value *params, pl_surface *const *surfaces);
/* Sets only the colours, of the same bits: see pl_graph_surfaces. A colour that the graph does not
 * set stays as it is. */
void pl_graph_colors(const pl_graph *graph, const pl_graph_point *points, size_t count,
                     const pl_value *params, pl_surface *const *surfaces);
bool pl_graph_wraps(const pl_graph *graph);
/* True if the graph, rather than the model's material, sets the surface's emission. */
bool pl_graph_sets_emission(const pl_graph *graph);
/* True if any node reads the object's own material. */
bool pl_graph_uses_own(const pl_graph *graph);
/* If the emission is that of the object's own material times a constant strength: that strength;
 * otherwise 0. */
double pl_graph_own_emission(const pl_graph *graph);
const pl_reflectance *pl_graph_reflectance(const pl_graph *graph);
/* True if the surface is the same at all points of a frame and the graph sets no normal. */
bool pl_graph_is_uniform(const pl_graph *graph);
/* True if the surface may emit light; pl_graph_emission is its radiance at a point, W m-2 sr-1. */
bool pl_graph_emits(const pl_graph *graph);
pl_vec3f pl_graph_emission(const pl_graph *graph, const pl_graph_point *point,
                           const pl_value *params);
/* True if the emission is the same at all points of a frame. */
bool pl_graph_emits_evenly(const pl_graph *graph);
/* True if the surface may be absent at some points. */
bool pl_graph_cuts(const pl_graph *graph);
/* True if the surface is absent everywhere, in all frames. */
bool pl_graph_absent(const pl_graph *graph);
/* True if there is a surface at a point: its alpha is at least PL_ALPHA_CUT. */
#define PL_ALPHA_CUT 0.5f
bool pl_graph_is_there(const pl_graph *graph, const pl_graph_point *point, const pl_value *params);
/* Alpha at a point, without threshold. */
float pl_graph_alpha(const pl_graph *graph, const pl_graph_point *point, const pl_value *params);
size_t pl_graph_parameter_count(const pl_graph *graph);
/* Number of nodes evaluated per hit, including conversions but not the nodes of lazy inputs. */
size_t pl_graph_instruction_count(const pl_graph *graph);

#define PL_EMISSION_MAX 1e30 /* W m-2 sr-1: also stands for an unknown bound */
/* Extends a model's bounds by the bounds of a graph that is assigned to it. */
void pl_graph_summarise(const pl_graph *graph, pl_model_summary *summary);

#endif
