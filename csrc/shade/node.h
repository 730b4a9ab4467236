/* Kinds of nodes of material graphs: one table row per kind, one file per kind or family of kinds.
 */
#ifndef PL_SHADE_NODE_H
#define PL_SHADE_NODE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "geom/texture.h"
#include "shade/material_surface.h"
#include "shade/reflectance.h"

typedef enum pl_constant_type {
  PL_NUMBER,  /* one number within [low, high] */
  PL_CHOICE,  /* index into `choices` */
  PL_NUMBERS, /* rows of `columns` numbers */
  PL_IMAGE    /* a texture */
} pl_constant_type;

/* A constant of a node: fixed when the graph is compiled. */
typedef struct pl_constant_row {
  const char *name;
  pl_constant_type type;
  /* PL_NUMBER; PL_CHOICE uses the fallback only; NaN: required. */
  double fallback, low, high;
  const char *const *choices; /* NULL-terminated */
  size_t columns;             /* PL_NUMBERS */
  const char *doc;
} pl_constant_row;

typedef struct pl_constant {
  double number;        /* PL_NUMBER, and the index of a PL_CHOICE */
  const float *numbers; /* PL_NUMBERS; borrowed until the graph is compiled, which copies it */
  size_t count;         /* length of `numbers` */
  /* PL_IMAGE; borrowed for the lifetime of the graph. NULL reads as white. */
  const pl_texture *texture;
} pl_constant;

/* Point at which a graph is evaluated. World axes are those of the root frame; lengths in metres.
 */
typedef struct pl_graph_point {
  /* Model axes at rest, from the object's origin, so that patterns move with parts; on a body its
   * axes, from its centre. */
  pl_vec3f object;
  pl_vec3f world; /* root axes, from the object's origin */
  /* Shading frame before bump mapping, and geometric normal, root axes; the normals are on the
   * outer side of the mesh. */
  pl_vec3f t, b, n, ng;
  pl_vec3f view;              /* unit, towards the viewer, root axes */
  float radius;               /* of the footprint, m */
  pl_filter filter;           /* of images */
  bool bumps;                 /* false: bump and normal maps give n */
  float random;               /* random number of the object, 0..1 */
  const pl_model *model;      /* NULL: no texture coordinates */
  pl_triangle_point triangle; /* on the model */
  pl_vec3 offset;             /* of the object: model units, see pl_object */
  float scale;                /* metres per model unit */
  /* Body axes to root axes; NULL: not on a body. The fields below are for bodies. */
  const pl_mat3 *body;
  pl_vec3 place;         /* `object` in double precision */
  pl_vec3 across, along; /* extent of the footprint on the surface, body axes, m */
  double map_center_lon_rad;
  double map_oblate;                        /* as in pl_body_place */
  const pl_texture *body_map;               /* the body's own surface map: NULL for none */
  const float *body_albedo, *body_emission; /* three each, see pl_body_state */
} pl_graph_point;
/* The point moved by `along_t`, `along_b` metres in the tangent plane: updates the positions and,
 * on a model, the barycentric weights. The frame is unchanged. */
pl_graph_point pl_graph_point_move(const pl_graph_point *point, float along_t, float along_b);
/* Texture coordinates of set 0 or 1 and the footprint in them; zeros if the model has none. On a
 * body the coordinates of its map. */
void pl_graph_point_uv(const pl_graph_point *point, int set, float uv[2], float a[2], float b[2]);
/* Object position for the point's barycentric weights on the model. */
pl_vec3f pl_graph_point_object(const pl_graph_point *point);

enum { PL_NODE_CONSTANTS = 8, PL_NODE_OUTPUTS = 8 };

/* Arguments of a node's evaluation, at up to PL_LANES points. Nodes set all lanes of all outputs.
 * Those from `count` on are read by nobody, but must be numbers that are not slow: vectors compute
 * them from the lanes of inputs, other loops copy lane 0 (pl_lanes_fill). */
typedef struct pl_node_call {
  size_t count;                        /* lanes in use, at least 1 */
  const pl_graph_point *points;        /* `count` */
  const pl_lanes *in[PL_NODE_SOCKETS]; /* NULL for lazy inputs */
  unsigned uniform;                    /* bit k: input k is the same in all lanes */
  const pl_constant *constants;
  unsigned given; /* bit k: input k is set by a value or a link */
  pl_lanes *out;  /* one per output; all four numbers must be set */
  /* For evaluate_slopes alone. */
  const pl_slopes *in_slopes[PL_NODE_SOCKETS]; /* zeros where an input is the same everywhere */
  pl_slopes *out_slopes;                       /* one per output; finite */
  /* Used by pl_node_input_at. */
  const struct pl_graph *graph;
  const struct pl_instruction *instruction;
  const pl_value *params;
} pl_node_call;

typedef struct pl_node_kind {
  const char *name, *doc;
  const pl_socket *inputs, *outputs;
  size_t input_count, output_count;
  const pl_constant_row *constants;
  size_t constant_count;
  bool reads_own;   /* reads the object's own material */
  bool reads_point; /* false: a function of inputs and constants only, which may be folded */
  bool bends;       /* outputs a normal other than the mesh's, unless the point has no bumps */
  bool hidden;      /* inserted by the compiler only; not allowed in descriptions */
  unsigned lazy; /* bit k: input k is not evaluated in advance; the node calls pl_node_input_at */
  /* Checks constants beyond their types and ranges; may be NULL. The error text names the constant
   * and what is allowed. */
  pl_status (*check)(const pl_constant *constants);
  /* NULL for a surface: its inputs are the outputs of the graph. */
  void (*evaluate)(const pl_node_call *call);
  /* The same, and the slopes of all outputs along t and b of the points (forward-mode
   * differentiation), per metre; footprints are the same nearby. NULL for nodes with steps, or
   * which read what has no derivative: heights that need one are differences (shade/node_bump.c).
   */
  void (*evaluate_slopes)(const pl_node_call *call);
  /* Whether evaluate_slopes holds for a node: by its constants, inputs that are the same everywhere
   * and outputs that are read, a bit each. NULL: always. */
  bool (*has_slopes)(const pl_constant *constants, unsigned uniform, unsigned read);
  const pl_reflectance *reflectance; /* of a surface: its inputs are appended to `inputs` */
} pl_node_kind;
/* Inputs of a node; for a surface those common to all surfaces (pl_surface_socket), then those of
 * its reflectance model. */
static inline size_t pl_node_input_count(const pl_node_kind *kind) {
  return kind->input_count + (kind->reflectance != NULL ? kind->reflectance->input_count : 0);
}
static inline const pl_socket *pl_node_input(const pl_node_kind *kind, size_t k) {
  return k < kind->input_count ? &kind->inputs[k]
                               : &kind->reflectance->inputs[k - kind->input_count];
}

/* Evaluates a lazy input at other points: `count` of them, at most PL_LANES. */
void pl_node_input_at(const pl_node_call *call, size_t input, const pl_graph_point *points,
                      size_t count, pl_lanes out);
/* Whether the derivatives of a lazy input are known, and those of a scalar one along t and b, at
 * points as above. */
bool pl_node_input_has_slopes(const pl_node_call *call, size_t input);
void pl_node_input_slopes(const pl_node_call *call, size_t input, const pl_graph_point *points,
                          size_t count, float out[2][PL_LANES]);

/* The table, in a fixed order. */
extern const pl_node_kind *const pl_node_kinds[];
extern const size_t pl_node_kind_count;
/* Kind by name, or NULL. */
const pl_node_kind *pl_node_kind_find(const char *name);

/* Set one lane of outputs of nodes, and read it. */
PL_WIDE_PART void pl_lane_scalar(pl_lanes out, size_t i, float x) {
  out[0][i] = out[1][i] = out[2][i] = x;
  out[3][i] = 0.0f;
}
PL_WIDE_PART void pl_lane_vector(pl_lanes out, size_t i, pl_vec3f v, float radius) {
  out[0][i] = v.x;
  out[1][i] = v.y;
  out[2][i] = v.z;
  out[3][i] = radius;
}
PL_WIDE_PART pl_vec3f pl_lane_vec(const pl_lanes v, size_t i) {
  return pl_vec3f_make(v[0][i], v[1][i], v[2][i]);
}
/* A scalar input in one lane. */
PL_WIDE_PART float pl_node_number(const pl_node_call *call, size_t input, size_t i) {
  return (*call->in[input])[0][i];
}
PL_WIDE_PART void pl_slope_scalar(pl_slopes out, size_t axis, size_t i, float x) {
  out[axis][0][i] = out[axis][1][i] = out[axis][2][i] = isfinite(x) ? x : 0.0f;
}
PL_WIDE_PART void pl_slope_vector(pl_slopes out, size_t axis, size_t i, pl_vec3f v) {
  out[axis][0][i] = isfinite(v.x) ? v.x : 0.0f;
  out[axis][1][i] = isfinite(v.y) ? v.y : 0.0f;
  out[axis][2][i] = isfinite(v.z) ? v.z : 0.0f;
}
PL_WIDE_PART pl_vec3f pl_slope_vec(const pl_slopes v, size_t axis, size_t i) {
  return pl_vec3f_make(v[axis][0][i], v[axis][1][i], v[axis][2][i]);
}
/* Copies lane 0 to those from `count` on. */
static inline void pl_lanes_fill(pl_lanes out, size_t count) {
  for (size_t k = 0; k < 4; k++)
    for (size_t i = count; i < PL_LANES; i++)
      out[k][i] = out[k][0];
}
/* The lanes of which a node needs results: one if all of its inputs in `needed` are uniform. */
static inline size_t pl_node_lanes(const pl_node_call *call, unsigned needed) {
  return (call->uniform & needed) == needed ? 1 : call->count;
}
static inline pl_vec3f pl_value_vec(const float *v) { return pl_vec3f_make(v[0], v[1], v[2]); }

#endif
