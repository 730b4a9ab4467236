/* Inputs of the principled surface as a node of material graphs. Internal to shade. */
#ifndef PL_SHADE_PRINCIPLED_INPUTS_H
#define PL_SHADE_PRINCIPLED_INPUTS_H

#include "shade/reflectance.h"

/* The first two are those of metallic_roughness. */
enum {
  PL_PRINCIPLED_METALLIC,
  PL_PRINCIPLED_ROUGHNESS,
  PL_PRINCIPLED_IOR,
  PL_PRINCIPLED_SPECULAR,
  PL_PRINCIPLED_SPECULAR_TINT,
  PL_PRINCIPLED_ANISOTROPY,
  PL_PRINCIPLED_ANISOTROPY_ROTATION,
  PL_PRINCIPLED_COAT,
  PL_PRINCIPLED_COAT_ROUGHNESS,
  PL_PRINCIPLED_TRANSMISSION,
  PL_PRINCIPLED_INPUTS
};
extern const pl_socket pl_principled_inputs[PL_PRINCIPLED_INPUTS];

/* Callbacks of the model: see reflectance.h. A surface without any layer that differs from the
 * defaults becomes a metallic_roughness one, which costs less. */
void pl_principled_set(const pl_surface_inputs *in, pl_surface *surface);
void pl_principled_summarise(const pl_surface_inputs *in, struct pl_model_summary *summary);

#endif
