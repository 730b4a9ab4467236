/* A loaded model: one flattened triangle mesh with its materials, textures and part names.
 * Immutable after loading and shared between scenes. The y-up axes of the file are converted to
 * z-up: (x, y, z)_file -> (x, -z, y).
 *
 * The units of a file are arbitrary, from 1e-30 to 1e30 of the model's size, and so is its origin.
 * There are therefore two kinds of lengths. Model units are those of the file, in double; callers
 * use them (offsets, scales, nodes, motions, animations). Positions and bounds are in mesh units,
 * which are about the model's radius, relative to an origin nearby, so that single precision
 * resolves them: a point p of the mesh is at pl_model_point(model, p). The unit is a power of two
 * and the origin a multiple of it: the coordinates of common files lose no bits. */
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

/* 2x3 affine map applied to a uv column vector before the lookup (KHR_texture_transform). */
typedef struct pl_uv_transform {
  float m[2][3]; /* u' = m00 u + m01 v + m02, v' = m10 u + m11 v + m12 */
} pl_uv_transform;
#define PL_UV_IDENTITY ((pl_uv_transform){{{1, 0, 0}, {0, 1, 0}}})

/* Reference of a material to a texture. */
typedef struct pl_texture_slot {
  int texture; /* index into pl_model.textures; -1 for none */
  int uv_set;  /* 0 or 1 */
  pl_uv_transform transform;
} pl_texture_slot;

typedef enum pl_alpha_mode { PL_ALPHA_OPAQUE, PL_ALPHA_MASK, PL_ALPHA_BLEND } pl_alpha_mode;

/* Properties from glTF's material extensions; maps are multiplied by their factor. Initialise with
 * PL_MATERIAL_LAYERS_PLAIN and set the properties that a file has. */
typedef struct pl_material_layers {
  float coat, coat_roughness; /* KHR_materials_clearcoat; 0..1, roughness perceptual */
  float transmission;         /* KHR_materials_transmission, thin-walled; 0..1 */
  /* KHR_materials_anisotropy; 0..1, angle from the tangent */
  float anisotropy, anisotropy_rotation_rad;
  float ior;                          /* KHR_materials_ior; >= 1, or 0 for infinite */
  float specular, specular_color[3];  /* KHR_materials_specular; 0..1; linear, >= 0 */
  pl_texture_slot coat_map;           /* linear: R */
  pl_texture_slot coat_roughness_map; /* linear: G */
  pl_texture_slot transmission_map;   /* linear: R */
  pl_texture_slot anisotropy_map;     /* linear: RG direction, -1..1; B strength */
  pl_texture_slot specular_map;       /* linear: A */
  pl_texture_slot specular_color_map; /* sRGB */
  /* linear; normal map of the coat, which uses the mesh normal if there is none */
  pl_texture_slot coat_normal_map;
  float coat_normal_scale; /* factor on x and y of that map */
  /* KHR_materials_volume. True for a solid: the mesh is closed and its winding is outward. False
   * for thin walls. */
  bool solid;
  float extinction[3]; /* extinction coefficient of the solid, per mesh unit; >= 0 */
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
  bool double_sided; /* rays also hit the back sides of its faces */
  /* emits from the front sides of its faces only, although rays hit the back sides */
  bool dark_behind;
  bool lambert; /* a Lambertian surface of the base colour; the other factors are ignored */
  bool layered; /* `layers` is used: the surface is shaded by the row `principled` */
  pl_texture_slot base_color_map;         /* sRGB encoded */
  pl_texture_slot metallic_roughness_map; /* linear: G roughness, B metallic */
  pl_texture_slot normal_map;             /* linear */
  pl_texture_slot emissive_map;           /* sRGB encoded */
  pl_material_layers layers;              /* read only when `layered` is set */
} pl_material;

/* A part: one primitive of one node. Names are not necessarily unique. */
typedef struct pl_part {
  char *name;          /* node name (or mesh name, or "node N"), owned, never NULL */
  int node;            /* index in the file */
  int mesh, primitive; /* indices in the file */
  int material;        /* index into materials */
} pl_part;

typedef struct pl_model {
  size_t vertex_count, triangle_count;
  double unit;      /* mesh unit in model units; a power of two */
  pl_vec3 origin;   /* origin of the mesh, in model units */
  float *positions; /* 3 per vertex, mesh units, z-up */
  float *normals;   /* 3 per vertex, unit; computed flat/smooth when the file has none */
  /* 4 per vertex (xyz unit, w = handedness), or NULL without normal maps and anisotropy */
  float *tangents;
  float *uvs[2];           /* 2 per vertex or NULL */
  float *colors;           /* linear RGBA per vertex or NULL */
  uint32_t *indices;       /* 3 per triangle, counter-clockwise seen from outside */
  uint32_t *triangle_part; /* per triangle, index into parts */
  /* per triangle: its back is covered by another face (trace/backing.h); or NULL */
  uint8_t *backed;
  float hair; /* largest distance of back-to-back sheets, mesh units */

  size_t part_count, material_count, texture_count;
  pl_part *parts;         /* a triangle's material is parts[triangle_part[t]].material */
  pl_material *materials; /* at least one */
  pl_texture **textures;  /* owned, unless they belong to another model, which then lives as long */
  bool borrows_textures;

  pl_nodes nodes;           /* node hierarchy that placed the parts */
  pl_animation *animations; /* owned; they move nodes of the scene and have at least one track */
  size_t animation_count;

  float bounds_min[3], bounds_max[3]; /* bounding box of the positions */
  char *warnings;                     /* owned, lines separated by '\n', "" without warnings */
} pl_model;

/* Frees the model including the struct; NULL is allowed. */
void pl_model_destroy(pl_model *model);
/* Memory of meshes and textures, bytes. */
size_t pl_model_bytes(const pl_model *model);
/* Recomputes the bounds. */
void pl_model_measure(pl_model *model);
/* Sets unit and origin of the mesh for a model in the box from `low` to `high`, model units, so
 * that mesh coordinates are below 4. The unit is 1 for a box of zero size. */
void pl_model_set_unit(pl_model *model, pl_vec3 low, pl_vec3 high);
/* Converts a point from mesh units to model units, and back. */
static inline pl_vec3 pl_model_point(const pl_model *model, pl_vec3 p) {
  return pl_vec3_madd(model->origin, model->unit, p);
}
static inline pl_vec3 pl_model_mesh_point(const pl_model *model, pl_vec3 p) {
  return pl_vec3_scale(pl_vec3_sub(p, model->origin), 1.0 / model->unit);
}
/* Converts a motion from model units to mesh units. */
static inline pl_affine pl_model_mesh_motion(const pl_model *model, const pl_affine *motion) {
  return (pl_affine){motion->m, pl_model_mesh_point(model, pl_affine_apply(motion, model->origin))};
}

#ifdef __cplusplus
}
#endif
#endif
