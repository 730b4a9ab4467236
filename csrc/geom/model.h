/* A model as loaded: one flattened triangle mesh, its materials, textures and part names.
 * Immutable after loading and shared between scenes; the file's y-up axes are already turned to
 * z-up: (x, y, z)_file -> (x, -z, y).
 *
 * A file's units may be anything, from 1e-30 to 1e30 of the model's size, and its origin anywhere.
 * So there are two kinds of lengths: model units are the file's, in double, and what callers speak
 * of (offsets, scales, nodes, motions, animations). Positions and bounds are in mesh units, of
 * about the model's radius, and near their origin, so that single precision resolves them: a point
 * p of the mesh is at pl_model_point(model, p). Both are powers of two and multiples of them: the
 * numbers of usual files lose nothing. */
#ifndef PL_GEOM_MODEL_H
#define PL_GEOM_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "geom/animation.h"
#include "geom/image.h"
#include "geom/node.h"
#include "geom/texture.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Row-vector-free 2x3 map applied to a uv pair before the lookup (KHR_texture_transform). */
typedef struct pl_uv_transform {
  float m[2][3]; /* u' = m00 u + m01 v + m02, v' = m10 u + m11 v + m12 */
} pl_uv_transform;
#define PL_UV_IDENTITY ((pl_uv_transform){{{1, 0, 0}, {0, 1, 0}}})

/* A use of a texture by a material. */
typedef struct pl_texture_slot {
  int texture; /* index into pl_model.textures; -1: none */
  int uv_set;  /* 0 or 1 */
  pl_uv_transform transform;
} pl_texture_slot;

typedef enum pl_alpha_mode { PL_ALPHA_OPAQUE, PL_ALPHA_MASK, PL_ALPHA_BLEND } pl_alpha_mode;

/* What glTF's material extensions add to a material; maps count times their factor. Start from
 * PL_MATERIAL_LAYERS_PLAIN and set what a file gives. */
typedef struct pl_material_layers {
  float coat, coat_roughness; /* KHR_materials_clearcoat; 0..1, roughness perceptual */
  float transmission;         /* KHR_materials_transmission, thin-walled; 0..1 */
  float anisotropy, anisotropy_rotation_rad; /* KHR_materials_anisotropy; 0..1, from the tangent */
  float ior;                                 /* KHR_materials_ior; >= 1, or 0 for infinite */
  float specular, specular_color[3];         /* KHR_materials_specular; 0..1; linear, >= 0 */
  pl_texture_slot coat_map;                  /* linear: R */
  pl_texture_slot coat_roughness_map;        /* linear: G */
  pl_texture_slot transmission_map;          /* linear: R */
  pl_texture_slot anisotropy_map;            /* linear: RG direction, -1..1; B strength */
  pl_texture_slot specular_map;              /* linear: A */
  pl_texture_slot specular_color_map;        /* sRGB */
  pl_texture_slot coat_normal_map;           /* linear; the coat's own, none: the mesh's normal */
  float coat_normal_scale;                   /* factor on x and y of that map */
  /* KHR_materials_volume. A solid: the mesh is closed and wound outwards. Otherwise walls are thin.
   */
  bool solid;
  float extinction[3]; /* of the solid, per mesh unit; >= 0 */
} pl_material_layers;
#define PL_NO_TEXTURE ((pl_texture_slot){-1, 0, PL_UV_IDENTITY})
#define PL_MATERIAL_LAYERS_PLAIN                                                                   \
  ((pl_material_layers){0,                                                                         \
                        0,                                                                         \
                        0,                                                                         \
                        0,                                                                         \
                        0,                                                                         \
                        1.5f,                                                                      \
                        1,                                                                         \
                        {1, 1, 1},                                                                 \
                        PL_NO_TEXTURE,                                                             \
                        PL_NO_TEXTURE,                                                             \
                        PL_NO_TEXTURE,                                                             \
                        PL_NO_TEXTURE,                                                             \
                        PL_NO_TEXTURE,                                                             \
                        PL_NO_TEXTURE,                                                             \
                        PL_NO_TEXTURE,                                                             \
                        1,                                                                         \
                        false,                                                                     \
                        {0, 0, 0}})

/* glTF 2.0 metallic-roughness material; colours linear. */
typedef struct pl_material {
  char *name;          /* owned, never NULL */
  float base_color[4]; /* linear RGBA factor */
  float metallic;      /* factor, 0..1 */
  float roughness;     /* perceptual factor, 0..1; alpha = roughness^2 */
  float emissive[3];   /* linear factor */
  float normal_scale;  /* factor on x and y of the normal map */
  float alpha_cutoff;  /* for PL_ALPHA_MASK */
  pl_alpha_mode alpha_mode;
  bool double_sided; /* rays meet the backs of its faces, too */
  bool dark_behind;  /* emits from the fronts of its faces alone, though rays meet their backs */
  bool lambert;      /* a Lambert surface of the base colour, with none of the other factors */
  bool layered;      /* `layers` counts: the surface is shaded as the row `principled` */
  pl_texture_slot base_color_map;         /* sRGB */
  pl_texture_slot metallic_roughness_map; /* linear: G roughness, B metallic */
  pl_texture_slot normal_map;             /* linear */
  pl_texture_slot emissive_map;           /* sRGB */
  pl_material_layers layers;              /* read only where `layered` is set */
} pl_material;

/* A part: one primitive of one node. Names need not be unique. */
typedef struct pl_part {
  char *name;          /* node name (or mesh name, or "node N"), owned, never NULL */
  int node;            /* index in the file */
  int mesh, primitive; /* indices in the file */
  int material;        /* index into materials */
} pl_part;

typedef struct pl_model {
  size_t vertex_count, triangle_count;
  double unit;       /* of the mesh, in model units; a power of two */
  pl_vec3 origin;    /* of the mesh, in model units */
  float *positions;  /* 3 per vertex, mesh units, z-up */
  float *normals;    /* 3 per vertex, unit; computed flat/smooth when the file has none */
  float *tangents;   /* 4 per vertex (xyz unit, w = handedness) or NULL: no map of normals, nothing
                        anisotropic */
  float *uvs[2];     /* 2 per vertex or NULL */
  float *colors;     /* linear RGBA per vertex or NULL */
  uint32_t *indices; /* 3 per triangle, counter-clockwise seen from outside */
  uint32_t *triangle_part; /* per triangle, index into parts */
  uint8_t *backed; /* per triangle: another face hides its back (trace/backing.h); or NULL */
  float hair;      /* mesh units: so far apart are sheets back to back, at most */

  size_t part_count, material_count, texture_count;
  pl_part *parts;         /* material of a triangle: parts[triangle_part[t]].material */
  pl_material *materials; /* at least one */
  pl_texture **textures;  /* owned, unless they are another model's, which is kept as long */
  bool borrows_textures;

  pl_nodes nodes;           /* what placed the parts */
  pl_animation *animations; /* owned; moving nodes of the scene, with at least one track */
  size_t animation_count;

  float bounds_min[3], bounds_max[3]; /* of positions */
  char *warnings;                     /* owned, lines separated by '\n', "" when there are none */
} pl_model;

/* Frees everything, including the struct; NULL is allowed. */
void pl_model_destroy(pl_model *model);
/* Recomputes the bounds. */
void pl_model_measure(pl_model *model);
/* Sets unit and origin of the mesh for a model within the box from `low` to `high`, model units:
 * coordinates are below 4. Unit 1 of a box without a size. */
void pl_model_set_unit(pl_model *model, pl_vec3 low, pl_vec3 high);
/* Model units of a point in mesh units, and the other way round. */
static inline pl_vec3 pl_model_point(const pl_model *model, pl_vec3 p) {
  return pl_vec3_madd(model->origin, model->unit, p);
}
static inline pl_vec3 pl_model_mesh_point(const pl_model *model, pl_vec3 p) {
  return pl_vec3_scale(pl_vec3_sub(p, model->origin), 1.0 / model->unit);
}
/* A motion in model units as one of mesh units. */
static inline pl_affine pl_model_mesh_motion(const pl_model *model, const pl_affine *motion) {
  return (pl_affine){motion->m, pl_model_mesh_point(model, pl_affine_apply(motion, model->origin))};
}

#ifdef __cplusplus
}
#endif
#endif
