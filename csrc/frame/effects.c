/* One line per effect; the rows live beside what they describe. */
#include "frame/effects.h"

#include <string.h>

#include "air/effects.h"
#include "io/effects.h"
#include "light/effects.h"
#include "render/effects.h"
#include "rings/effects.h"
#include "scene/effects.h"
#include "sensor/effects.h"
#include "shade/effects.h"
#include "sky/effects.h"

/* A line each, so that a new row is one line of a change. */
/* clang-format off */
const pl_effect *const pl_effects[] = {
    &pl_effect_soft_sun,
    &pl_effect_limb_darkening,
    &pl_effect_cast_shadows,
    &pl_effect_atmosphere,
    &pl_effect_skylight,
    &pl_effect_multiple_scattering,
    &pl_effect_clouds,
    &pl_effect_rings,
    &pl_effect_volumes,
    &pl_effect_emission,
    &pl_effect_emitters,
    &pl_effect_bounces,
    &pl_effect_body_bounces,
    &pl_effect_planetshine,
    &pl_effect_caustics,
    &pl_effect_surface_maps,
    &pl_effect_bump_detail,
    &pl_effect_relief,
    &pl_effect_glint,
    &pl_effect_night_lights,
    &pl_effect_texture_filter,
    &pl_effect_regolith,
    &pl_effect_clear_coat,
    &pl_effect_transmission,
    &pl_effect_distortion,
    &pl_effect_depth_of_field,
    &pl_effect_motion_blur,
    &pl_effect_rolling_shutter,
    &pl_effect_antialiasing,
    &pl_effect_sky_background,
    &pl_effect_stars,
    &pl_effect_filters,
    &pl_effect_vignetting,
    &pl_effect_lens_flare,
    &pl_effect_point_spread,
    &pl_effect_fixed_pattern,
    &pl_effect_smear,
    &pl_effect_dark_current,
    &pl_effect_defects,
    &pl_effect_shot_noise,
    &pl_effect_cosmic_rays,
    &pl_effect_blooming,
    &pl_effect_black_sun,
    &pl_effect_read_noise,
    &pl_effect_compression,
};
/* clang-format on */
const size_t pl_effect_count = sizeof pl_effects / sizeof pl_effects[0];

int pl_effect_find(const char *name) {
  for (size_t i = 0; i < pl_effect_count; i++)
    if (strcmp(pl_effects[i]->name, name) == 0)
      return (int)i;
  return -1;
}
