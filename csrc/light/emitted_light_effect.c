/* The effect row `emitted_light`: emitted light that the camera sees directly. */
#include "plan/effects.h"

/* Largest emitted radiance along a ray: of a surface plus all volumes in front of it. */
static double seen(const pl_view *view) {
  double sum = pl_view_emission_max(view);
  for (size_t i = 0; i < view->volume_count; i++)
    sum += view->volumes[i].in_frame ? view->volumes[i].emitted : 0.0;
  return sum;
}

static const char *absent(const pl_view *view) {
  return seen(view) > 0.0 ? NULL : "nothing in the frame emits light";
}

/* Emission adds to reflected light; the difference is largest on a black surface. Light that
 * emitters give to other objects belongs to the row `emitters`, that of volumes to the row
 * `volumes`. */
static double bound_dn(const pl_view *view, int value) {
  return value > 0 ? 0.0 : pl_view_dn(view, seen(view));
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 1e-6 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_emitted_light = {
    .name = "emitted_light",
    .doc = "Emitted light of surfaces, bodies and volumes as seen by the camera; off: they "
           "appear unlit, but may still light other things",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
