/* Names of all effects. Their rows are defined beside the code that they describe, in the folders
 * that depend on this one. */
#ifndef PL_PLAN_EFFECTS_H
#define PL_PLAN_EFFECTS_H

#include "plan/effect.h"
#include "plan/effect_set.h"

/* Plans list the effects in this order. To add an effect, add the file that defines its row,
 * `pl_effect_NAME`, and one line here. */
/* clang-format off */
#define PL_EFFECTS(X) \
  X(soft_sun) \
  X(limb_darkening) \
  X(cast_shadows) \
  X(atmosphere) \
  X(skylight) \
  X(multiple_scattering) \
  X(clouds) \
  X(rings) \
  X(volumes) \
  X(emitted_light) \
  X(emitters) \
  X(bounces) \
  X(body_bounces) \
  X(planetshine) \
  X(caustics) \
  X(surface_maps) \
  X(terrain) \
  X(far_casters) \
  X(sub_cell_normals) \
  X(texture_slopes) \
  X(crater_rays) \
  X(bump_detail) \
  X(relief) \
  X(glint) \
  X(night_lights) \
  X(texture_filter) \
  X(regolith) \
  X(clear_coat) \
  X(transmission) \
  X(distortion) \
  X(depth_of_field) \
  X(motion_blur) \
  X(rolling_shutter) \
  X(antialiasing) \
  X(sky_background) \
  X(stars) \
  X(filters) \
  X(vignetting) \
  X(lens_flare) \
  X(point_spread) \
  X(fixed_pattern) \
  X(smear) \
  X(dark_current) \
  X(defects) \
  X(shot_noise) \
  X(cosmic_rays) \
  X(blooming) \
  X(black_sun) \
  X(read_noise) \
  X(compression)
/* clang-format on */

#define PL_DECLARE(name) extern const pl_effect pl_effect_##name;
PL_EFFECTS(PL_DECLARE)
#undef PL_DECLARE

/* Indices of the table: PL_EFFECT_INDEX_soft_sun, ... */
enum {
#define PL_INDEX(name) PL_EFFECT_INDEX_##name,
  PL_EFFECTS(PL_INDEX)
#undef PL_INDEX
      PL_EFFECT_COUNT
};
_Static_assert((int)PL_EFFECT_COUNT <= (int)PL_PLAN_ROWS_MAX,
               "raise PL_PLAN_ROWS_MAX in plan/effect_set.h");

/* The value of each effect in a plan; 0: it is off. Code that acts on an effect reads its field, in
 * pl_render_settings. */
typedef struct pl_effect_values {
#define PL_FIELD(name) int name;
  PL_EFFECTS(PL_FIELD)
#undef PL_FIELD
} pl_effect_values;

#endif
