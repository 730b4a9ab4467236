/* The effect row `soft_sun`: the sun as a disc instead of a point. */
#include "plan/effects.h"
#include "plan/view_tree.h"

#include <math.h>

#include "light/penumbra.h"

/* Largest difference between the irradiance factor cos+ under a point sun and under a uniform disc
 * of angular radius a. It occurs at the terminator and is 2/(3 pi) a: the mean height above the
 * horizon of a disc that the horizon bisects (first moment of a half disc). */
static const double TERMINATOR = 0.21220659;

static const char *absent(const pl_view *view) {
  for (size_t i = 0; i < view->entity_count; i++)
    if (view->entities[i].in_frame && view->entities[i].irradiance > 0.0)
      return NULL;
  return "nothing in the frame is lit by the sun";
}

typedef struct penumbra {
  const pl_view *view;
  const pl_view_entity *receiver;
  double pixel_m;
  double widest; /* so far */
} penumbra;

/* Test for pl_view_any: raises `widest` to the caster's penumbra. Casters, and groups of them
 * (`several`), whose penumbra cannot exceed the widest so far are skipped. */
static bool widen(const pl_view_entity *caster, bool several, void *context) {
  penumbra *p = context;
  const pl_view_entity *receiver = p->receiver;
  double square = 0.0;
  if (!several && caster == receiver && caster->is_body)
    return false;
  for (int axis = 0; axis < 3; axis++)
    square += pow(receiver->center_m[axis] - caster->center_m[axis], 2.0);
  const double reach = sqrt(square) + receiver->radius_m + caster->radius_m;
  const double width_m = 2.0 * tan(p->view->sun_radius_rad) * reach;
  const double width = p->pixel_m > 0.0 ? width_m / p->pixel_m : INFINITY;
  if (!(width > p->widest) || !pl_view_shadow_reaches(p->view, caster, receiver))
    return false;
  p->widest = several ? p->widest : width;
  return several || isinf(width);
}

double pl_penumbra_px(const pl_view *view) {
  penumbra p = {.view = view};
  for (size_t i = 0; i < view->entity_count && !isinf(p.widest); i++) {
    p.receiver = &view->entities[i];
    if (!p.receiver->in_frame)
      continue;
    p.pixel_m = fmax(p.receiver->distance_m - p.receiver->radius_m, 0.0) * view->pixel_rad;
    pl_view_any(view, widen, &p);
  }
  return p.widest;
}

/* Upper bound of the reduction of a lobe's peak by convolution with the sun's disc. A disc of
 * radius a averages f to f + a^2/8 laplacian(f). GGX has the peak 1/(4 pi alpha^2), and by the half
 * vector its Laplacian is -2/alpha^2 of that, so the reduction is a^2/(16 pi alpha^4). It is
 * doubled for oblique views. */
static double lobe_loss(const pl_view *view) {
  const double alpha = pl_view_alpha_min(view);
  const double ratio = view->sun_radius_rad / (alpha * alpha);
  return alpha < 1.0 ? ratio * ratio / 8.0 : 0.0;
}

static double bound_dn(const pl_view *view, int value) {
  if (value > 0)
    return 0.0;
  if (pl_view_alpha_min(view) < PL_SUN_LOBE_RATIO * view->sun_radius_rad)
    return pl_view_dn(view, view->white_radiance);
  const double fraction =
      fmin(1.0, TERMINATOR * view->sun_radius_rad + pl_penumbra_px(view)) + lobe_loss(view);
  return pl_view_dn(view, fraction * pl_view_radiance_max(view));
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 2e-5 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_soft_sun = {
    .name = "soft_sun",
    .doc = "The sun as a disc: penumbrae, soft terminators, round glints; off: a point source",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
