/* The surfaces that every row of the table of reflectance models is tried with. */
#ifndef PL_TESTS_SURFACES_H
#define PL_TESTS_SURFACES_H

#include "math/sampling.h"
#include "random.h"
#include "shade/reflectance.h"

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static const float roughnesses[] = {0.0f, 0.02f, 0.1f, 0.3f, 0.6f, 1.0f};
static const float metals[] = {0.0f, 0.5f, 1.0f};
static const float cosines[] = {1.0f, 0.7f, 0.3f, 0.05f, 0.005f};

static inline pl_surface white(float alpha, float metallic) {
  return (pl_surface){.t = {1.0f, 0.0f, 0.0f},
                      .b = {0.0f, 1.0f, 0.0f},
                      .n = {0.0f, 0.0f, 1.0f},
                      .color = {1.0f, 1.0f, 1.0f},
                      .alpha = alpha,
                      .metallic = metallic};
}

/* What layered rows are tried with; the others see the first alone. */
typedef struct variant {
  const char *name;
  float anisotropy, coat, coat_alpha, transmission, ior;
  float coat_tilt; /* x of the coat's own normal */
  enum { WALL, SOLID, INSIDE } side;
} variant;
static const variant variants[] = {
    {"plain", 0.0f, 0.0f, 1.0f, 0.0f, 1.5f, 0.0f, WALL},
    {"ior 1", 0.0f, 0.0f, 1.0f, 0.0f, 1.0f, 0.0f, WALL},
    {"ior 1.33", 0.0f, 0.0f, 1.0f, 0.0f, 1.33f, 0.0f, WALL},
    {"ior 2.5", 0.0f, 0.0f, 1.0f, 0.0f, 2.5f, 0.0f, WALL},
    {"anisotropic", 0.6f, 0.0f, 1.0f, 0.0f, 1.5f, 0.0f, WALL},
    {"most anisotropic", 1.0f, 0.0f, 1.0f, 0.0f, 1.5f, 0.0f, WALL},
    {"half a coat", 0.0f, 0.5f, 0.1f, 0.0f, 1.5f, 0.0f, WALL},
    {"smooth coat", 0.0f, 1.0f, 0.0f, 0.0f, 1.5f, 0.0f, WALL},
    {"roughest coat", 0.0f, 1.0f, 1.0f, 0.0f, 1.5f, 0.0f, WALL},
    {"tilted coat", 0.0f, 0.8f, 0.1f, 0.0f, 1.5f, 0.4f, WALL},
    {"tilted coat, clear", 0.0f, 0.5f, 0.3f, 0.6f, 1.5f, -0.7f, WALL},
    {"clear", 0.0f, 0.0f, 1.0f, 1.0f, 1.5f, 0.0f, WALL},
    {"clear, ior 1", 0.0f, 0.0f, 1.0f, 1.0f, 1.0f, 0.0f, WALL},
    {"glass", 0.0f, 0.0f, 1.0f, 1.0f, 1.5f, 0.0f, SOLID},
    {"glass from inside", 0.0f, 0.0f, 1.0f, 1.0f, 1.5f, 0.0f, INSIDE},
    {"coated half diamond", 0.4f, 0.5f, 0.3f, 0.5f, 2.5f, 0.0f, SOLID},
    {"half clear, ior 2.5", 0.0f, 0.0f, 1.0f, 0.5f, 2.5f, 0.0f, WALL},
    {"all", 0.5f, 0.7f, 0.02f, 0.5f, 1.33f, 0.0f, WALL},
};

static inline pl_surface with(pl_surface surface, const variant *v) {
  surface.lobes = (pl_lobes){.anisotropy = v->anisotropy,
                             .coat = v->coat,
                             .coat_alpha = v->coat_alpha,
                             .transmission = v->transmission};
  surface.lobes.ior = v->side == WALL ? 0.0f : v->ior;
  surface.lobes.inside = v->side == INSIDE;
  if (v->coat_tilt != 0.0f)
    surface.lobes.coat_normal = pl_vec3f_unit(pl_vec3f_make(v->coat_tilt, 0.2f, 1.0f));
  pl_lobes_set_dielectric(&surface.lobes, v->ior, 1.0f, (pl_vec3f){1.0f, 1.0f, 1.0f});
  return surface;
}

/* What photometric rows are tried with: isotropic and white; about the Moon (Sato et al. 2014); and
 * a rougher ground that scatters forward. With surges and lobes Hapke's law keeps no energy: white
 * ground like the Moon reflects 1.07 at normal incidence. */
typedef struct ground {
  const char *name;
  float albedo, limb;
  pl_regolith_band band;
} ground;
static const ground grounds[] = {
    {"plain", 1.0f, 0.0f, {0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f}},
    {"Moon", 0.5f, -0.4f, {0.24f, 0.3f, 0.0f, 1.0f, 1.8f, 0.07f, 0.41f, 0.0f}},
    {"rough", 0.8f, 0.2f, {0.5f, -0.5f, 0.4f, 0.1f, 0.5f, 0.1f, 0.7f, 0.3f}},
};

static inline pl_surface ground_of(const ground *g) {
  return (pl_surface){.color = {g->albedo, g->albedo, g->albedo},
                      .regolith = {.band = {g->band, g->band, g->band}, .limb = g->limb}};
}

/* Disc functions are for dark worlds: what they reflect, with a colour of 1, is judged as with
 * this. */
static const double DARK = 0.12;
static inline double shade_of(const pl_reflectance *model) { return model->empirical ? DARK : 1.0; }

static inline pl_vec3f tilted(float cosine, float azimuth) {
  const float sine = sqrtf(fmaxf(0.0f, 1.0f - cosine * cosine));
  return pl_vec3f_make(sine * cosf(azimuth), sine * sinf(azimuth), cosine);
}

static inline pl_vec3f turned_over(pl_vec3f w) { return pl_vec3f_make(w.x, w.y, -w.z); }

/* One surface seen from one direction; `name` for messages. */
typedef struct sight {
  const pl_reflectance *model;
  const char *name;
  pl_surface surface;
  pl_vec3f wo;
} sight;

/* Calls `check` for every row, variant, roughness, metalness and view; gives their number. Half a
 * metal is tried without layers alone; grounds have neither roughness of that kind nor metalness.
 */
typedef void (*check_fn)(const sight *seen);
static inline int for_views(check_fn check, const pl_reflectance *model, const char *name,
                            pl_surface surface) {
  for (size_t c = 0; c < COUNT(cosines); c++) {
    const sight seen = {model, name, surface, tilted(cosines[c], 0.4f)};
    check(&seen);
  }
  return COUNT(cosines);
}
static inline int for_variant(check_fn check, const pl_reflectance *model, const variant *v) {
  int calls = 0;
  for (size_t r = 0; r < COUNT(roughnesses); r++)
    for (size_t k = 0; k < COUNT(metals); k += v == variants ? 1 : 2)
      calls += for_views(check, model, v->name,
                         with(white(roughnesses[r] * roughnesses[r], metals[k]), v));
  return calls;
}
static inline int for_all(check_fn check) {
  int calls = 0;
  for (size_t m = 0; m < pl_reflectance_count; m++) {
    const pl_reflectance *model = pl_reflectances[m];
    if (model->photometric)
      for (size_t g = 0; g < COUNT(grounds); g++)
        calls += for_views(check, model, grounds[g].name, ground_of(&grounds[g]));
    else
      for (size_t v = 0; v < (model->layered ? COUNT(variants) : 1); v++)
        calls += for_variant(check, model, &variants[v]);
  }
  return calls;
}

static inline bool draw(const sight *seen, test_random *random, pl_vec3f *wi, pl_vec3f *weight,
                        float *pdf) {
  const float u[2] = {(float)(0.99999994 * random_unit(random)),
                      (float)(0.99999994 * random_unit(random))};
  return seen->model->sample(&seen->surface, seen->wo, u, wi, weight, pdf);
}

#endif
