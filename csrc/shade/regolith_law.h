/* Defines the rows of the photometric models from their formula for one band. Internal to shade. */
#ifndef PL_SHADE_REGOLITH_LAW_H
#define PL_SHADE_REGOLITH_LAW_H

#include "shade/hapke.h"
#include "shade/reflectance.h"

/* Terms of a band that depend on the phase angle alone: the facets of rough ground share them. */
typedef struct pl_regolith_phase {
  bool known;
  pl_hapke_at_phase of;
} pl_regolith_phase;

/* Terms of the band before, if it differs from this one in the albedo alone (`known`); else a law
 * may leave its own there. */
typedef struct pl_regolith_shared {
  bool known;
  pl_hapke_terms terms;
  pl_regolith_phase *phase; /* of this band */
  double roughness_rad;     /* of the last relief; negative for none */
  pl_hapke_relief relief;   /* depends on the roughness alone */
} pl_regolith_shared;

/* Bidirectional reflectance r of one band, 1/sr; i and e are below 90 degrees. `limb`: see
 * pl_regolith. */
typedef double (*pl_regolith_law)(const pl_hapke *band, double limb, const pl_hapke_angles *angles,
                                  pl_regolith_shared *shared);

/* Terms of Hapke's model for a band that starts a run of like ones. */
static inline pl_hapke_terms pl_regolith_terms_of(const pl_hapke *band,
                                                  const pl_hapke_angles *angles,
                                                  const pl_hapke_relief *relief,
                                                  pl_regolith_phase *phase) {
  if (!phase->known)
    *phase = (pl_regolith_phase){true, pl_hapke_at_phase_of(band, angles)};
  return pl_hapke_terms_of(band, angles, relief, &phase->of);
}

/* Evaluates the model in each band: `evaluate` of a row. */
pl_vec3f pl_regolith_evaluate(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi,
                              pl_regolith_law law);
/* Sampling for all photometric models: a cosine lobe that becomes uniform towards grazing views, as
 * cos(i)/(cos(i) + cos(e)) does, and a backscattering lobe about the viewer. */
float pl_regolith_pdf(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi);
bool pl_regolith_sample(const pl_surface *surface, pl_vec3f wo, const float u[2],
                        pl_regolith_law law, pl_vec3f *wi, pl_vec3f *weight, float *pdf);

/* (1 + B_S0 B_S(g)) p(g), the phase-dependent factor of single scattering; and the same normalised
 * to 1 at g = 0, the surface phase function of the models whose colour is a normal albedo. */
double pl_regolith_single(const pl_hapke *band, const pl_hapke_angles *angles);
double pl_regolith_fall(const pl_hapke *band, const pl_hapke_angles *angles);

/* Inputs as nodes of material graphs; models other than Hapke's have the first four. */
enum { PL_REGOLITH_PHASE_INPUTS = 4, PL_REGOLITH_INPUTS = 8 };
extern const pl_socket pl_regolith_inputs[PL_REGOLITH_INPUTS];
extern const pl_socket pl_minnaert_inputs[PL_REGOLITH_PHASE_INPUTS + 1];
/* `set` and `summarise` of the rows. Unset inputs have values of the Moon. */
void pl_regolith_set_phase(const pl_surface_inputs *in, pl_surface *surface);
void pl_minnaert_set(const pl_surface_inputs *in, pl_surface *surface);
void pl_hapke_set_smooth(const pl_surface_inputs *in, pl_surface *surface);
void pl_hapke_set(const pl_surface_inputs *in, pl_surface *surface);
void pl_regolith_summarise(const pl_surface_inputs *in, struct pl_model_summary *summary);

/* Defines a row of the table from `law`, its name and its documentation. */
#define PL_REGOLITH_ROW(row, text, ...)                                                            \
  static pl_vec3f evaluate(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi) {                  \
    return pl_regolith_evaluate(surface, wo, wi, law);                                             \
  }                                                                                                \
  static bool sample(const pl_surface *surface, pl_vec3f wo, const float u[2], pl_vec3f *wi,       \
                     pl_vec3f *weight, float *pdf) {                                               \
    return pl_regolith_sample(surface, wo, u, law, wi, weight, pdf);                               \
  }                                                                                                \
  const pl_reflectance pl_reflectance_##row = {.name = #row,                                       \
                                               .doc = text,                                        \
                                               .photometric = true,                                \
                                               .evaluate = evaluate,                               \
                                               .pdf = pl_regolith_pdf,                             \
                                               .sample = sample,                                   \
                                               .summarise = pl_regolith_summarise,                 \
                                               __VA_ARGS__};

#endif
