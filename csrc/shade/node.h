/* The kinds of nodes of material graphs: one row and one file (or a file for a family) a kind. */
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
  PL_CHOICE,  /* the index of one of the names of `choices` */
  PL_NUMBERS, /* rows of `columns` numbers */
  PL_IMAGE    /* a texture */
} pl_constant_type;

/* What is fixed when the graph is made. */
typedef struct pl_constant_row {
  const char *name;
  pl_constant_type type;
  double fallback, low, high; /* PL_NUMBER, PL_CHOICE (fallback alone); NaN: must be given */
  const char *const *choices; /* NULL-terminated */
  size_t columns;             /* PL_NUMBERS */
  const char *doc;
} pl_constant_row;

typedef struct pl_constant {
  double number;             /* PL_NUMBER, and the index of a PL_CHOICE */
  const float *numbers;      /* PL_NUMBERS; borrowed until the graph is made, which copies it */
  size_t count;              /* of numbers */
  const pl_texture *texture; /* PL_IMAGE; borrowed for the graph's life. NULL reads as white */
} pl_constant;

/* Where a graph is evaluated. World axes are the root's; metres. */
typedef struct pl_graph_point {
  pl_vec3f object;       /* model axes at rest, from the object's origin: patterns move with parts;
                            of a body its axes, from its centre */
  pl_vec3f world;        /* root axes, from the object's origin */
  pl_vec3f t, b, n, ng;  /* shading frame before any bump, and geometric normal, root axes;
                            the normals are on the side that the mesh calls outside */
  pl_vec3f view;         /* unit, towards the viewer, root axes */
  float radius;          /* of the footprint, m */
  pl_filter filter;      /* of images */
  bool bumps;            /* otherwise bumps and normal maps give n */
  float random;          /* of the object, 0..1 */
  const pl_model *model; /* NULL: no texture coordinates */
  pl_triangle_point triangle; /* on the model */
  pl_vec3 offset;             /* of the object: model units, see pl_object */
  float scale;                /* metres per model unit */
  const pl_mat3 *body;        /* body axes to root axes; NULL: not on a body. Then also: */
  pl_vec3 place;              /* `object` in double */
  pl_vec3 across, along;      /* extent of the footprint on the surface, body axes, m */
  double map_center_lon_rad;
  double map_oblate;                        /* as of pl_body_place */
  const pl_texture *body_map;               /* its own surface: NULL for none */
  const float *body_albedo, *body_emission; /* three each, see pl_body_state */
} pl_graph_point;
/* The point `along_t`, `along_b` metres farther on the tangent plane: its position, and with a
 * model its weights. The frame stays. */
pl_graph_point pl_graph_point_move(const pl_graph_point *point, float along_t, float along_b);
/* Texture coordinates of set 0 or 1 and the footprint in them; zeros where the model has none.
 * On a body those of its map. */
void pl_graph_point_uv(const pl_graph_point *point, int set, float uv[2], float a[2], float b[2]);
/* Object position of the weights on the model. */
pl_vec3f pl_graph_point_object(const pl_graph_point *point);

enum { PL_NODE_CONSTANTS = 8, PL_NODE_OUTPUTS = 8 };

/* What a node is given when it is evaluated. */
typedef struct pl_node_call {
  const pl_graph_point *point;
  const float *in[PL_NODE_SOCKETS]; /* pl_value each, NULL of lazy inputs */
  const pl_constant *constants;
  unsigned given; /* bit k: input k has a value or a link of its own */
  pl_value *out;  /* one an output; all four numbers must be set */
  /* For pl_node_input_at. */
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
  bool reads_own;   /* reads the thing's own material */
  bool reads_point; /* false: a function of inputs and constants alone, which may be folded */
  bool bends;       /* gives a normal other than the mesh's, unless the point has no bumps */
  bool hidden;      /* used by the compiler; not in descriptions */
  unsigned lazy;    /* bit k: input k is not evaluated before; the node asks pl_node_input_at */
  /* Checks beyond the rows' types; may be NULL. The text names the constant and what is allowed. */
  pl_status (*check)(const pl_constant *constants);
  /* NULL for a surface: its inputs are what the graph gives. */
  void (*evaluate)(const pl_node_call *call);
  const pl_reflectance *reflectance; /* of a surface, whose inputs follow `inputs` */
} pl_node_kind;
/* Inputs of a node: of a surface those of all surfaces (pl_surface_socket), then its row's. */
static inline size_t pl_node_input_count(const pl_node_kind *kind) {
  return kind->input_count + (kind->reflectance != NULL ? kind->reflectance->input_count : 0);
}
static inline const pl_socket *pl_node_input(const pl_node_kind *kind, size_t k) {
  return k < kind->input_count ? &kind->inputs[k]
                               : &kind->reflectance->inputs[k - kind->input_count];
}

/* Value of a lazy input at another point. */
void pl_node_input_at(const pl_node_call *call, size_t input, const pl_graph_point *point,
                      pl_value out);

/* The table, in a fixed order. */
extern const pl_node_kind *const pl_node_kinds[];
extern const size_t pl_node_kind_count;
/* Row by name, or NULL. */
const pl_node_kind *pl_node_kind_find(const char *name);

/* For outputs. */
static inline void pl_value_scalar(pl_value out, float x) {
  out[0] = out[1] = out[2] = x;
  out[3] = 0.0f;
}
static inline void pl_value_vector(pl_value out, pl_vec3f v, float radius) {
  out[0] = v.x;
  out[1] = v.y;
  out[2] = v.z;
  out[3] = radius;
}
static inline pl_vec3f pl_value_vec(const float *v) { return pl_vec3f_make(v[0], v[1], v[2]); }

#endif
