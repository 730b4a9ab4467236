/* The principled surface in material graphs: converts input sockets to lobe parameters. */
#include "shade/principled_inputs.h"

#include <math.h>

#include "shade/material_surface.h"

const pl_socket pl_principled_inputs[PL_PRINCIPLED_INPUTS] = {
    [PL_PRINCIPLED_METALLIC] = {"metallic", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "0..1"},
    [PL_PRINCIPLED_ROUGHNESS] = {"roughness",
                                 PL_SCALAR,
                                 {0.5f, 0.5f, 0.5f},
                                 "0..1; GGX alpha is its square"},
    [PL_PRINCIPLED_IOR] = {"ior",
                           PL_SCALAR,
                           {1.5f, 1.5f, 1.5f},
                           "Index of refraction of what is no metal, >= 0; 1 mirrors nothing, 0 "
                           "counts as infinite. Of ior, specular and specular_tint giving one "
                           "gives all, where a material is wrapped"},
    [PL_PRINCIPLED_SPECULAR] = {"specular",
                                PL_SCALAR,
                                {1.0f, 1.0f, 1.0f},
                                "Weight of the light that what is no metal mirrors, 0..1"},
    [PL_PRINCIPLED_SPECULAR_TINT] = {"specular_tint",
                                     PL_COLOR,
                                     {1.0f, 1.0f, 1.0f},
                                     "Its colour at normal incidence, linear RGB, >= 0"},
    [PL_PRINCIPLED_ANISOTROPY] = {"anisotropy",
                                  PL_SCALAR,
                                  {0.0f, 0.0f, 0.0f},
                                  "0..1: how far highlights stretch along the tangent"},
    [PL_PRINCIPLED_ANISOTROPY_ROTATION] = {"anisotropy_rotation_deg",
                                           PL_SCALAR,
                                           {0.0f, 0.0f, 0.0f},
                                           "Turns the tangent about the normal, anticlockwise"},
    [PL_PRINCIPLED_COAT] = {"coat",
                            PL_SCALAR,
                            {0.0f, 0.0f, 0.0f},
                            "Weight of a clear coat of index 1.5, 0..1"},
    [PL_PRINCIPLED_COAT_ROUGHNESS] = {"coat_roughness", PL_SCALAR, {0.03f, 0.03f, 0.03f}, "0..1"},
    [PL_PRINCIPLED_TRANSMISSION] = {"transmission",
                                    PL_SCALAR,
                                    {0.0f, 0.0f, 0.0f},
                                    "0..1: part of the light that passes a thin wall of what is "
                                    "no metal, instead of being scattered back"},
};

static const unsigned DIELECTRIC =
    1u << PL_PRINCIPLED_IOR | 1u << PL_PRINCIPLED_SPECULAR | 1u << PL_PRINCIPLED_SPECULAR_TINT;
/* Inputs that require the principled model. If none is set, metallic_roughness gives the same; the
 * roughness of an absent coat and the rotation without anisotropy have no effect. */
static const unsigned LAYERS = 1u << PL_PRINCIPLED_IOR | 1u << PL_PRINCIPLED_SPECULAR |
                               1u << PL_PRINCIPLED_SPECULAR_TINT | 1u << PL_PRINCIPLED_ANISOTROPY |
                               1u << PL_PRINCIPLED_COAT | 1u << PL_PRINCIPLED_TRANSMISSION;

/* Indices are clamped to this, so that their square is finite. */
static const float IOR_MAX = 1e6f;

static float unit_of(const pl_surface_inputs *in, size_t k) {
  return pl_clipped(in->value[k][0], 1.0f);
}

static void set_dielectric(const pl_surface_inputs *in, pl_lobes *lobes) {
  const float ior = in->value[PL_PRINCIPLED_IOR][0];
  const float *tint = in->value[PL_PRINCIPLED_SPECULAR_TINT];
  /* An invalid index (negative or NaN) reflects nothing. */
  pl_lobes_set_dielectric(lobes, ior >= 0.0f ? pl_minf(ior, IOR_MAX) : 1.0f,
                          unit_of(in, PL_PRINCIPLED_SPECULAR),
                          pl_vec3f_make(pl_clipped(tint[0], IOR_MAX), pl_clipped(tint[1], IOR_MAX),
                                        pl_clipped(tint[2], IOR_MAX)));
}

static void rotate(const pl_surface_inputs *in, pl_surface *surface) {
  const float angle = in->value[PL_PRINCIPLED_ANISOTROPY_ROTATION][0] * (PL_PI_F / 180.0f);
  if (angle != 0.0f && isfinite(angle))
    pl_surface_turn(surface, cosf(angle), sinf(angle));
}

void pl_principled_set(const pl_surface_inputs *in, pl_surface *surface) {
  pl_lobes *lobes = &surface->lobes;
  pl_reflectance_metallic_roughness.set(in, surface);
  if ((in->differs & LAYERS) == 0 && !in->had_lobes) {
    surface->reflectance = &pl_reflectance_metallic_roughness;
    return;
  }
  if (!in->had_lobes)
    *lobes = pl_lobes_plain();
  if ((in->set & DIELECTRIC) != 0)
    set_dielectric(in, lobes);
  if (pl_input_is_set(in, PL_PRINCIPLED_ANISOTROPY))
    lobes->anisotropy = unit_of(in, PL_PRINCIPLED_ANISOTROPY);
  if (pl_input_is_set(in, PL_PRINCIPLED_ANISOTROPY_ROTATION) && lobes->anisotropy > 0.0f)
    rotate(in, surface);
  if (pl_input_is_set(in, PL_PRINCIPLED_COAT))
    lobes->coat = unit_of(in, PL_PRINCIPLED_COAT);
  if (pl_input_is_set(in, PL_PRINCIPLED_COAT_ROUGHNESS)) {
    const float roughness = unit_of(in, PL_PRINCIPLED_COAT_ROUGHNESS);
    lobes->coat_alpha = roughness * roughness;
  }
  if (pl_input_is_set(in, PL_PRINCIPLED_TRANSMISSION))
    lobes->transmission = unit_of(in, PL_PRINCIPLED_TRANSMISSION);
}

/* Largest possible value of input k, 0..1. */
static double largest(const pl_surface_inputs *in, size_t k) {
  if (!pl_input_is_set(in, k))
    return 0.0;
  return in->value[k] != NULL ? (double)unit_of(in, k) : 1.0;
}

void pl_principled_summarise(const pl_surface_inputs *in, pl_model_summary *summary) {
  const double coat = largest(in, PL_PRINCIPLED_COAT);
  pl_reflectance_metallic_roughness.summarise(in, summary);
  summary->transmission_max =
      fmax(summary->transmission_max, largest(in, PL_PRINCIPLED_TRANSMISSION));
  /* A coat of the model's own material may get another roughness. */
  const bool alters = (in->differs >> PL_PRINCIPLED_COAT_ROUGHNESS & 1u) != 0;
  if (!(coat > 0.0) && !(summary->coat_max > 0.0 && alters))
    return;
  const bool known = in->value[PL_PRINCIPLED_COAT_ROUGHNESS] != NULL;
  const double roughness = known ? (double)unit_of(in, PL_PRINCIPLED_COAT_ROUGHNESS) : 0.0;
  summary->coat_max = fmax(summary->coat_max, coat);
  summary->ggx_alpha_min =
      fmin(summary->ggx_alpha_min, roughness * roughness) * cbrt(0.5); /* see summarise_layers */
}
