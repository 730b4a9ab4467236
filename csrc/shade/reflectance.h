/* Reflectance models behind one table: evaluate, pdf and sample, never sample alone. */
#ifndef PL_SHADE_REFLECTANCE_H
#define PL_SHADE_REFLECTANCE_H

#include <stdbool.h>
#include <stddef.h>

#include "math/vec.h"
#include "shade/socket.h"
#include "shade/surface.h"

/* Inputs of a model at a point, as given to `set`, or what is known of them beforehand. */
typedef struct pl_surface_inputs {
  const float *value[PL_NODE_SOCKETS]; /* in the order of the model's inputs; NULL: not known */
  /* Bit k: input k. Those that are not set stay what the surface has. */
  unsigned set;
  unsigned differs;  /* of those: may be other than the fallback */
  bool had_lobes;    /* the surface's lobes are valid */
  bool had_regolith; /* likewise */
} pl_surface_inputs;
static inline bool pl_input_is_set(const pl_surface_inputs *in, size_t k) {
  return (in->set >> k & 1u) != 0;
}
struct pl_model_summary;

/* wo, wi: unit, local frame (z = shading normal), wo.z > 0. */
struct pl_reflectance {
  const char *name;
  const char *doc; /* formula's source and range */
  /* Reads surface->lobes; light may then pass to wi.z < 0, if lobes.transmission > 0. */
  bool layered;
  bool photometric; /* reads surface->regolith */
  /* A disc function fitted to dark worlds: where its colour is bright it may reflect more light
   * than there is. */
  bool empirical;
  /* BSDF times |cos(wi)|, 1/sr; zero when wi.z <= 0 unless light passes. */
  pl_vec3f (*evaluate)(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi);
  /* Density of `sample` per solid angle at wi; 0 when it cannot come. */
  float (*pdf)(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi);
  /* Upper bound of that over all wi, 1/sr; NULL: none is known. */
  float (*pdf_most)(const pl_surface *surface, pl_vec3f wo);
  /* Draws wi from u in [0,1)^2 and a lobe choice in [0,1); false if the draw falls below the
   * horizon. *weight = evaluate / pdf. */
  bool (*sample)(const pl_surface *surface, pl_vec3f wo, const float u[2], float choice,
                 pl_vec3f *wi, pl_vec3f *weight, float *pdf);
  /* What it sends to wo of light that comes evenly from above, over that light's pi times radiance:
   * its albedo. NULL: light from the sky counts as coming from one direction. */
  pl_vec3f (*under_sky)(const pl_surface *surface, pl_vec3f wo);
  /* What it reads beside colour, normal and emission, as sockets of its node in material graphs. */
  const pl_socket *inputs;
  size_t input_count;
  /* Sets them, cut off at their ranges, in a surface that has this row and its bent frame; NULL
   * without inputs. It may choose a simpler row that looks the same. */
  void (*set)(const pl_surface_inputs *in, pl_surface *surface);
  /* Widens a model's bounds by a surface of this row; NULL: GGX alpha, coat and transmission stay.
   * What is not known may be anything. */
  void (*summarise)(const pl_surface_inputs *in, struct pl_model_summary *summary);
};

/* All models, in the order of the table; each is a node of material graphs, too. To add one: its
 * file and its line here. */
#define PL_REFLECTANCES(X)                                                                         \
  X(lambert)                                                                                       \
  X(metallic_roughness)                                                                            \
  X(principled)                                                                                    \
  X(lommel_seeliger)                                                                               \
  X(lunar_lambert)                                                                                 \
  X(minnaert)                                                                                      \
  X(hapke_smooth)                                                                                  \
  X(hapke)

#define PL_DECLARE(row) extern const pl_reflectance pl_reflectance_##row;
PL_REFLECTANCES(PL_DECLARE)
#undef PL_DECLARE

/* The table, in a fixed order. */
extern const pl_reflectance *const pl_reflectances[];
extern const size_t pl_reflectance_count;

/* Whether light from a unit `direction` (world axes) can be sent to the viewer: it comes from his
 * side, by the shading and by the geometric normal, or passes from behind. */
static inline bool pl_surface_admits(const pl_surface *s, pl_vec3f direction) {
  const float ng = pl_vec3f_dot(direction, s->ng), n = pl_vec3f_dot(direction, s->n);
  return (ng > 0.0f && n > 0.0f) ||
         (s->reflectance->layered && s->lobes.transmission > 0.0f && ng < 0.0f && n < 0.0f);
}

/* The same of any row. */
static inline float pl_surface_pdf_most(const pl_surface *s, pl_vec3f wo) {
  return s->reflectance->pdf_most != NULL ? s->reflectance->pdf_most(s, wo) : INFINITY;
}

/* Upper bound of pi times what a surface of a photometric row makes of a light's irradiance, in any
 * band, at any angles: sampled, and a tenth more. */
double pl_regolith_peak(const pl_surface *surface);

/* Row by name, or NULL. */
const pl_reflectance *pl_reflectance_find(const char *name);

#endif
