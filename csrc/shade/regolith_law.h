/* Rows of the photometric laws: a law of one band makes a row. Internal to shade. */
#ifndef PL_SHADE_REGOLITH_LAW_H
#define PL_SHADE_REGOLITH_LAW_H

#include "shade/hapke.h"
#include "shade/reflectance.h"

/* Bidirectional reflectance r of one band, 1/sr; i and e are below 90 degrees. `limb`: see
 * pl_regolith. */
typedef double (*pl_regolith_law)(const pl_hapke *band, double limb, const pl_hapke_angles *angles);

/* The law in each band: `evaluate` of a row. */
pl_vec3f pl_regolith_evaluate(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi,
                              pl_regolith_law law);
/* Density and draws for all laws: a cosine lobe that flattens towards grazing views, as
 * cos(i)/(cos(i) + cos(e)) does, and a lobe back to the viewer. */
float pl_regolith_pdf(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi);
bool pl_regolith_sample(const pl_surface *surface, pl_vec3f wo, const float u[2], float choice,
                        pl_regolith_law law, pl_vec3f *wi, pl_vec3f *weight, float *pdf);

/* (1 + B_S0 B_S(g)) p(g): what single scattering depends on g by; and the same over its value at
 * g = 0, the surface phase function of the laws whose colour is a normal albedo. */
double pl_regolith_single(const pl_hapke *band, const pl_hapke_angles *angles);
double pl_regolith_fall(const pl_hapke *band, const pl_hapke_angles *angles);

/* Inputs as nodes of material graphs; the laws but Hapke's have the first four. */
enum { PL_REGOLITH_PHASE_INPUTS = 4, PL_REGOLITH_INPUTS = 8 };
extern const pl_socket pl_regolith_inputs[PL_REGOLITH_INPUTS];
extern const pl_socket pl_minnaert_inputs[PL_REGOLITH_PHASE_INPUTS + 1];
/* `set` and `summarise` of the rows. What is not given is the Moon's. */
void pl_regolith_set_phase(const pl_surface_inputs *in, pl_surface *surface);
void pl_minnaert_set(const pl_surface_inputs *in, pl_surface *surface);
void pl_hapke_set_smooth(const pl_surface_inputs *in, pl_surface *surface);
void pl_hapke_set(const pl_surface_inputs *in, pl_surface *surface);
void pl_regolith_summarise(const pl_surface_inputs *in, struct pl_model_summary *summary);

/* A row of the table, given `law`, its name and its documentation. */
#define PL_REGOLITH_ROW(row, text, ...)                                                            \
  static pl_vec3f evaluate(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi) {                  \
    return pl_regolith_evaluate(surface, wo, wi, law);                                             \
  }                                                                                                \
  static bool sample(const pl_surface *surface, pl_vec3f wo, const float u[2], float choice,       \
                     pl_vec3f *wi, pl_vec3f *weight, float *pdf) {                                 \
    return pl_regolith_sample(surface, wo, u, choice, law, wi, weight, pdf);                       \
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
