/* From a hit on a model or body to a surface: materials, textures, normal maps. */
#ifndef PL_SHADE_MATERIAL_SURFACE_H
#define PL_SHADE_MATERIAL_SURFACE_H

#include <stdbool.h>
#include <stdint.h>

#include "geom/model.h"
#include "shade/surface.h"

/* How much of pictures and patterns is read. */
typedef struct pl_detail {
  bool maps;        /* otherwise each counts as its mean */
  bool bumps;       /* otherwise normal maps and bumps count as flat */
  bool relief;      /* of bodies; otherwise they are smooth */
  bool glint;       /* of open water; otherwise it is as ground is */
  bool lights;      /* of the night on bodies; otherwise dark */
  pl_filter filter; /* of pictures */
  bool box;         /* colours of bodies are the only reads of their pixel: see pl_texture_box */
} pl_detail;
#define PL_DETAIL_FULL                                                                             \
  ((pl_detail){.maps = true,                                                                       \
               .bumps = true,                                                                      \
               .relief = true,                                                                     \
               .glint = true,                                                                      \
               .lights = true,                                                                     \
               .filter = PL_FILTER_FINEST})

/* A point of a triangle, in the axes of the view. */
typedef struct pl_triangle_point {
  uint32_t triangle;
  float w[3];            /* barycentric weights of the three corners */
  pl_vec3f edge1, edge2; /* corner 1 - corner 0, corner 2 - corner 0, metres */
  pl_vec3f footprint_a,
      footprint_b; /* half axes doubled: a pixel's extent on the surface, metres */
} pl_triangle_point;

/* How the weights of the three corners change along a vector: least squares in the triangle's
 * plane. Degenerate triangles give zeros. */
void pl_triangle_point_step(const pl_triangle_point *point, pl_vec3f step, float out[3]);

/* uv of set `set` and the footprint in it; zeros when the model has no such set. */
void pl_material_uv(const pl_model *model, const pl_triangle_point *point, int set, float uv[2],
                    float a[2], float b[2]);

/* Value of a texture slot at the point, its mean without `maps`; white when there is none. */
void pl_material_slot(const pl_model *model, const pl_triangle_point *point,
                      const pl_texture_slot *slot, pl_detail detail, float out[4]);
/* The normal that a normal map gives at the point, unit, in the axes of the surface's frame. */
pl_vec3f pl_material_bent_normal(const pl_model *model, const pl_triangle_point *point,
                                 const pl_texture_slot *slot, float scale, pl_detail detail,
                                 const pl_surface *surface);
/* Makes the surface a principled one with the material's layers, turns t and b by the anisotropy's
 * rotation. `coat_normal`: see pl_lobes. Materials that are not layered are left alone. */
void pl_material_layers_surface(const pl_model *model, const pl_triangle_point *point,
                                pl_detail detail, pl_vec3f coat_normal, pl_surface *surface);

/* Fills colour, lobe parameters and emission of `surface` from the material of the triangle.
 * Without maps no texture is read. `t`, `b`, `n` hold the
 * geometric shading frame on input (n interpolated, t along the tangent) and are bent by the
 * normal map. */
void pl_material_surface(const pl_model *model, const pl_triangle_point *point, pl_detail detail,
                         pl_surface *surface);

/* Light that the material emits there, W m-2 sr-1 in each band: glTF's emissive factor (times its
 * emissive strength) counts as that, times the map. */
pl_vec3f pl_material_emission(const pl_model *model, const pl_triangle_point *point,
                              pl_detail detail);
/* Opacity of the material there, 0..1: MASK is thresholded to 0 or 1, BLEND is the alpha itself.
 * Always of the finest filter: outlines do not depend on the plan. */
float pl_material_opacity(const pl_model *model, const pl_triangle_point *point);
/* Material of a triangle; borrowed. */
const pl_material *pl_material_of(const pl_model *model, uint32_t triangle);
/* Whether rays meet the back of a triangle: not of a single-sided material (glTF 2.0, 3.9.6), nor
 * where another face covers it. */
bool pl_back_is_there(const pl_model *model, uint32_t triangle);

/* Bounds for the plan: largest reflectance, smallest GGX alpha, largest emission, any texture, the
 * heaviest coat, the clearest wall. */
typedef struct pl_model_summary {
  double albedo_max, ggx_alpha_min, emission_max;
  bool textured;                     /* has maps or patterns */
  bool pictured;                     /* has textures that are not of one colour */
  bool bumped;                       /* normals are bent */
  bool diffuse;                      /* nothing but Lambert surfaces */
  double coat_max, transmission_max; /* 0..1 */
} pl_model_summary;
pl_model_summary pl_model_summarise(const pl_model *model);

#endif
