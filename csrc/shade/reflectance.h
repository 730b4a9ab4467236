/* Interface and table of the reflectance models: each evaluates, samples and gives the pdf. */
#ifndef PL_SHADE_REFLECTANCE_H
#define PL_SHADE_REFLECTANCE_H

#include <stdbool.h>
#include <stddef.h>

#include "math/vec.h"
#include "shade/socket.h"
#include "shade/surface.h"

/* Inputs of a model at a point, as given to `set`, or what is known of them in advance. */
typedef struct pl_surface_inputs {
  const float *value[PL_NODE_SOCKETS]; /* in the order of the model's inputs; NULL: unknown */
  /* Bit k: input k is set. The others keep the value of the surface. */
  unsigned set;
  unsigned differs;  /* the inputs among these that may differ from the fallback */
  bool had_lobes;    /* the surface's `lobes` are valid */
  bool had_regolith; /* the surface's `regolith` is valid */
} pl_surface_inputs;
static inline bool pl_input_is_set(const pl_surface_inputs *in, size_t k) {
  return (in->set >> k & 1u) != 0;
}
struct pl_model_summary;

/* A reflectance model. wo, wi: unit, local frame (z = shading normal), wo.z > 0. */
struct pl_reflectance {
  const char *name;
  const char *doc; /* source of the formula and range of validity */
  /* Reads surface->lobes; then wi.z < 0 (transmission) is possible, if lobes.transmission > 0. */
  bool layered;
  bool photometric; /* reads surface->regolith */
  /* A disc function fitted to dark bodies: with a bright colour it may reflect more than the
   * incident light. */
  bool empirical;
  /* BSDF times |cos(wi)|, 1/sr; zero for wi.z <= 0 unless light is transmitted. */
  pl_vec3f (*evaluate)(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi);
  /* Density of `sample` per solid angle at wi; 0 where it cannot be sampled. */
  float (*pdf)(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi);
  /* Upper bound of pdf over all wi, 1/sr; NULL: unknown. */
  float (*pdf_most)(const pl_surface *surface, pl_vec3f wo);
  /* Samples wi from u in [0,1)^2; false if the sample is below the horizon. *weight = evaluate /
   * pdf. u[0] also chooses among lobes, see pl_sample_choose. */
  bool (*sample)(const pl_surface *surface, pl_vec3f wo, const float u[2], pl_vec3f *wi,
                 pl_vec3f *weight, float *pdf);
  /* Directional albedo towards wo under a uniform sky: radiance over pi times the sky's radiance.
   * NULL: light from the sky is treated as if it came from one direction. */
  pl_vec3f (*under_sky)(const pl_surface *surface, pl_vec3f wo);
  /* Inputs other than colour, normal and emission, as sockets of its node in material graphs. */
  const pl_socket *inputs;
  size_t input_count;
  /* Sets the inputs, clamped to their ranges, in a surface with this model and the bumped frame;
   * NULL without inputs. It may choose a simpler model of the same appearance. */
  void (*set)(const pl_surface_inputs *in, pl_surface *surface);
  /* Extends a model's bounds by a surface of this reflectance; NULL: GGX alpha, coat and
   * transmission do not change. Unknown inputs may have any value. */
  void (*summarise)(const pl_surface_inputs *in, struct pl_model_summary *summary);
};

/* All models, in the order of the table; each is also a node of material graphs. To add one: write
 * its file and add its line here. */
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

/* True if light from the unit `direction` (world axes) can be scattered to the viewer: both are on
 * one side of the shading and of the geometric normal, or the surface transmits it from behind. */
static inline bool pl_surface_admits(const pl_surface *s, pl_vec3f direction) {
  const float ng = pl_vec3f_dot(direction, s->ng), n = pl_vec3f_dot(direction, s->n);
  return (ng > 0.0f && n > 0.0f) ||
         (s->reflectance->layered && s->lobes.transmission > 0.0f && ng < 0.0f && n < 0.0f);
}

/* pdf_most of the surface's model; infinite if unknown. */
static inline float pl_surface_pdf_most(const pl_surface *s, pl_vec3f wo) {
  return s->reflectance->pdf_most != NULL ? s->reflectance->pdf_most(s, wo) : INFINITY;
}

/* Upper bound of pi times the ratio of radiance to a light's irradiance, for a surface with a
 * photometric model, in any band and at any angles: the maximum over sampled angles plus a tenth.
 */
double pl_regolith_peak(const pl_surface *surface);

/* Model by name, or NULL. */
const pl_reflectance *pl_reflectance_find(const char *name);

#endif
