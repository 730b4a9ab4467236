/* Evaluates materials, textures and normal maps at a hit on a model or body. */
#ifndef PL_SHADE_MATERIAL_SURFACE_H
#define PL_SHADE_MATERIAL_SURFACE_H

#include <stdbool.h>
#include <stdint.h>

#include "geom/model.h"
#include "shade/surface.h"

/* Level of detail of textures and patterns. */
typedef struct pl_detail {
  bool maps;           /* false: textures are replaced by their mean */
  bool bumps;          /* false: normal maps and bumps are ignored */
  bool relief;         /* of bodies; false: they are smooth */
  bool sub_cell;       /* of terrain; false: slopes finer than the cells of its mesh are left out */
  bool texture_slopes; /* of textures of heights on terrain, among those of sub_cell */
  bool glint;          /* of open water; false: it is shaded like ground */
  bool lights;         /* of bodies at night; false: dark */
  bool rays;           /* of craters on terrain; false: ground without them */
  pl_filter filter;    /* of textures */
  bool color_only;     /* of surfaces only their colour is asked for; all else may stay unset */
  bool box;            /* the body's colours are read only once per pixel: see pl_texture_box */
} pl_detail;
#define PL_DETAIL_FULL                                                                             \
  ((pl_detail){.maps = true,                                                                       \
               .bumps = true,                                                                      \
               .relief = true,                                                                     \
               .sub_cell = true,                                                                   \
               .texture_slopes = true,                                                             \
               .glint = true,                                                                      \
               .lights = true,                                                                     \
               .rays = true,                                                                       \
               .filter = PL_FILTER_FINEST})

/* A point of a triangle, in the axes of the view. */
typedef struct pl_triangle_point {
  uint32_t triangle;
  float w[3];            /* barycentric weights of the three corners */
  pl_vec3f edge1, edge2; /* corner 1 - corner 0, corner 2 - corner 0, metres */
  /* Full axes of a pixel's footprint on the surface, metres. */
  pl_vec3f footprint_a, footprint_b;
} pl_triangle_point;

/* Change of the barycentric weights along a vector: least squares in the triangle's plane. Zeros
 * for degenerate triangles. */
void pl_triangle_point_step(const pl_triangle_point *point, pl_vec3f step, float out[3]);

/* Coordinates of uv set `set` and the footprint in them; zeros if the model has no such set. */
void pl_material_uv(const pl_model *model, const pl_triangle_point *point, int set, float uv[2],
                    float a[2], float b[2]);

/* Value of a texture slot at the point; the texture's mean without `maps`, white without a texture.
 */
void pl_material_slot(const pl_model *model, const pl_triangle_point *point,
                      const pl_texture_slot *slot, pl_detail detail, float out[4]);
/* Sets the principled model with the material's layers, and rotates t and b by the anisotropy's
 * rotation. `coat_normal`: see pl_lobes. Does nothing for materials without layers. */
void pl_material_layers_surface(const pl_model *model, const pl_triangle_point *point,
                                pl_detail detail, pl_vec3f coat_normal, pl_surface *surface);

/* Fills colour, lobe parameters and emission of `surface` from the material of the triangle.
 * Without maps no texture is read. On input `t`, `b`, `n` are the geometric shading frame (n
 * interpolated, t along the tangent); on output the normal map has been applied. */
void pl_material_surface(const pl_model *model, const pl_triangle_point *point, pl_detail detail,
                         pl_surface *surface);

/* Radiance that the material emits at the point, W m-2 sr-1 in each band: glTF's emissive factor
 * times emissive strength is taken in this unit, times the map. */
pl_vec3f pl_material_emission(const pl_model *model, const pl_triangle_point *point,
                              pl_detail detail);
/* Opacity of the material at the point, 0..1: MASK is thresholded to 0 or 1, BLEND is alpha itself.
 * Always uses the finest filter, so that outlines do not depend on the plan. */
float pl_material_opacity(const pl_model *model, const pl_triangle_point *point);
/* Material of a triangle; borrowed. */
const pl_material *pl_material_of(const pl_model *model, uint32_t triangle);
/* True if rays hit the back of a triangle: not for a single-sided material (glTF 2.0, 3.9.6), nor
 * where another face covers it. */
bool pl_back_is_there(const pl_model *model, uint32_t triangle);

/* Bounds of a model for the plan: maximum reflectance, emission, coat weight and transmission,
 * minimum GGX alpha. */
typedef struct pl_model_summary {
  double albedo_max, ggx_alpha_min, emission_max;
  bool textured;                     /* has maps or patterns */
  bool pictured;                     /* has textures with more than one colour */
  bool bumped;                       /* has bumps or normal maps */
  bool diffuse;                      /* all surfaces are Lambertian */
  double coat_max, transmission_max; /* 0..1 */
} pl_model_summary;
pl_model_summary pl_model_summarise(const pl_model *model);
/* The same for one material of the model. */
pl_model_summary pl_material_summarise(const pl_model *model, const pl_material *material);

#endif
