/* Quantities that the bounds of several effects have in common. */
#include "plan/view.h"

#include <math.h>

#include "plan/view_tree.h"

static const double PI = 3.14159265358979323846;
/* Smallest GGX alpha that pl_view_light assumes. This is an assumption, not a bound: a flat mirror
 * reflects the sun as a spot that is as bright as sunlight up to some 200 mirror sizes away, where
 * the spot becomes wider than the mirror, and falls beyond as (200 sizes / distance)^2. The rows
 * that decide whether such spots are rendered (`body_bounces`, `planetshine`) use
 * pl_view_light_most. */
static const double LIGHT_ALPHA_MIN = 0.3;
/* Relative slack of the shadow test for rounding errors at the scale of the solar system. */
static const double SLACK = 1e-9;

/* IEC 61966-2-1 */
static double encode(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
}

double pl_view_dn(const pl_view *view, double radiance) {
  const double linear = radiance / view->white_radiance;
  if (!(linear > 0.0))
    return 0.0;
  return linear >= 1.0 ? 255.0 : 255.0 * encode(linear);
}

double pl_view_dn_dimming(double fraction) {
  /* The encoding changes most under x -> (1 - f) x at x = 1, where its slope is 1.055/2.4. */
  return fraction >= 1.0 ? 255.0 : 255.0 * (1.0 - encode(1.0 - fraction));
}

double pl_view_radiance_max(const pl_view *view) {
  double largest = 0.0;
  for (size_t i = 0; i < view->entity_count; i++) {
    const pl_view_entity *entity = &view->entities[i];
    if (entity->in_frame)
      largest = fmax(largest, entity->albedo_max * entity->irradiance / PI);
  }
  return largest;
}

double pl_view_media_max(const pl_view *view) {
  double sum = 0.0;
  for (size_t i = 0; i < view->entity_count; i++)
    sum += pl_view_shows_rings(&view->entities[i]) ? view->entities[i].rings->light : 0.0;
  for (size_t i = 0; i < view->volume_count; i++)
    if (view->volumes[i].in_frame)
      sum += view->volumes[i].scattered + view->volumes[i].emitted;
  return sum;
}

double pl_view_emission_max(const pl_view *view) {
  double largest = 0.0;
  for (size_t i = 0; i < view->entity_count; i++)
    if (view->entities[i].in_frame)
      largest = fmax(largest, view->entities[i].emission_max);
  return largest;
}

double pl_view_step(const pl_view *view) {
  double step = pl_view_radiance_max(view);
  /* a surface that emits lights others to at most its own radiance */
  for (size_t i = 0; i < view->entity_count; i++)
    step = fmax(step, view->entities[i].emission_max);
  step += pl_view_media_max(view);
  if (pl_view_alpha_min(view) < 1.0 || view->sun_in_frame)
    step = view->white_radiance;
  return fmax(step, view->sky.background_max);
}

double pl_view_dn_shift(const pl_view *view, double shift_px) {
  const double part = fmin(1.0, sqrt(2.0) * shift_px);
  /* All light of a star may fall into one pixel. star_left spreads it over four pixels, hence the
   * factor. */
  const double stars = view->sky.star_count > 0 ? 4.0 * (double)view->sky.star_left[0] : 0.0;
  return fmax(pl_view_dn(view, pl_view_step(view) * part), pl_view_sky_dn(view, stars * part));
}

double pl_view_sky_max(const pl_view *view) {
  const pl_view_sky *sky = &view->sky;
  return sky->background_max + (sky->star_count > 0 ? (double)sky->star_left[0] : 0.0);
}

double pl_view_sky_dn(const pl_view *view, double radiance) {
  return pl_view_dn(view, radiance * (view->white_radiance / view->sky.white_radiance));
}

double pl_view_alpha_min(const pl_view *view) {
  double smallest = 1.0;
  for (size_t i = 0; i < view->entity_count; i++)
    if (view->entities[i].in_frame)
      smallest = fmin(smallest, view->entities[i].ggx_alpha_min);
  return smallest;
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The penumbra is the inside of the cone of internal tangents of the sun and the caster. Its apex
 * lies between them, radius / sine of the half angle before the caster's centre. */
bool pl_view_shadow_reaches(const pl_view *view, const pl_view_entity *caster,
                            const pl_view_entity *receiver) {
  double axis[3], from_apex[3], offset[3];
  for (int k = 0; k < 3; k++) {
    axis[k] = caster->center_m[k] - view->sun_position_m[k];
    offset[k] = receiver->center_m[k] - caster->center_m[k];
  }
  const double distance = sqrt(dot(axis, axis));
  const double sine = (view->sun_radius_m + caster->radius_m) / distance;
  const double reach = (caster->radius_m + receiver->radius_m) * (1.0 + SLACK);
  if (!(sine < 1.0) || dot(offset, offset) <= reach * reach)
    return true; /* the caster encloses the sun, or the receiver may touch the caster */
  for (int k = 0; k < 3; k++) {
    axis[k] /= distance;
    from_apex[k] = offset[k] + axis[k] * caster->radius_m / sine;
  }
  if (dot(offset, axis) < -reach)
    return false; /* on the sunward side of the caster */
  const double gap = sqrt(dot(from_apex, from_apex));
  if (gap <= receiver->radius_m)
    return true;
  const double cosine = fmin(1.0, fmax(-1.0, dot(from_apex, axis) / gap));
  return acos(cosine) <= asin(sine) + asin(receiver->radius_m / gap) + SLACK;
}

typedef struct shade_query {
  const pl_view *view;
  const pl_view_entity *receiver;
} shade_query;

static bool shades(const pl_view_entity *caster, bool several, void *context) {
  const shade_query *query = context;
  return (several || caster != query->receiver) &&
         pl_view_shadow_reaches(query->view, caster, query->receiver);
}

bool pl_view_shadowed(const pl_view *view, size_t i) {
  shade_query query = {.view = view, .receiver = &view->entities[i]};
  if (!query.receiver->is_body)
    return true; /* a mesh can shadow itself */
  return view->shadowed != NULL ? view->shadowed[i] : pl_view_any(view, shades, &query);
}

static double distance_m(const double a[3], const double b[3]) {
  const double offset[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return sqrt(dot(offset, offset));
}

double pl_view_hidden_sun(const pl_view *view, const pl_view_entity *caster,
                          const pl_view_entity *receiver) {
  const double gap = distance_m(receiver->center_m, caster->center_m) - receiver->radius_m;
  const double farthest = distance_m(receiver->center_m, view->sun_position_m) + receiver->radius_m;
  if (!pl_view_shadow_reaches(view, caster, receiver))
    return 0.0;
  if (gap <= caster->radius_m || !(view->sun_radius_m < farthest))
    return 1.0;
  const double ratio = asin(caster->radius_m / gap) / asin(view->sun_radius_m / farthest);
  return fmin(1.0, ratio * ratio);
}

double pl_view_factor(const pl_view_entity *receiver, const pl_view_entity *source) {
  const double gap = distance_m(receiver->center_m, source->center_m) - receiver->radius_m;
  if (gap <= source->radius_m)
    return 1.0;
  return source->radius_m * source->radius_m / (gap * gap);
}

/* Bound of pi times BRDF times cosine. Lambert: the albedo. GGX: D <= 1/(pi alpha^2) and cos(o) (1
 * + Lambda(o)) >= alpha/2, hence D G F/(4 cos(o)) <= F/(2 pi alpha^3); the diffuse base keeps at
 * most 1 - F. The compensation for multiple scattering between microfacets is not a Lambertian
 * lobe: at alpha 1 it exceeds 1 by at most MULTIPLE_SCATTERING_EXCESS, measured in
 * tests/c/test_reflectance.c. */
#define MULTIPLE_SCATTERING_EXCESS 0.06
static double gain(double alpha) {
  return fmax(1.0 + MULTIPLE_SCATTERING_EXCESS, 0.5 / (alpha * alpha * alpha));
}

double pl_view_transfer(const pl_view_entity *receiver, const pl_view_entity *source) {
  const double lobe = gain(fmax(receiver->ggx_alpha_min, 1e-3)) * pl_view_factor(receiver, source);
  return fmin(receiver->albedo_max, 1.0) * fmin(1.0, lobe);
}

double pl_view_transfer_most(const pl_view_entity *receiver, double factor) {
  return fmin(receiver->albedo_max, 1.0) * gain(fmax(receiver->ggx_alpha_min, 1e-3)) * factor;
}

double pl_view_light(const pl_view_entity *source) {
  const double lobe = gain(fmax(source->ggx_alpha_min, LIGHT_ALPHA_MIN));
  return source->albedo_max * lobe * source->irradiance / PI + source->emission_max;
}

double pl_view_light_most(const pl_view *view, const pl_view_entity *source) {
  const double sine =
      view->sun_radius_m / (distance_m(source->center_m, view->sun_position_m) + source->radius_m);
  const double lobe = fmin(gain(fmax(source->ggx_alpha_min, 1e-3)), 1.0 / (sine * sine));
  return source->albedo_max * lobe * source->irradiance / PI + source->emission_max;
}

/* The factor of a pair takes all of the source to be at its centre, while a facet may be nearer by
 * its radius. */
double pl_view_light_at(const pl_view *view, const pl_view_entity *receiver,
                        const pl_view_entity *source) {
  const double most = pl_view_light_most(view, source);
  const double gap = distance_m(receiver->center_m, source->center_m) - receiver->radius_m;
  if (!(gap > source->radius_m && source->sent_gain > 0.0))
    return most;
  const double nearer = gap / (gap - source->radius_m);
  const double sent = source->albedo_max * source->sent_gain * nearer * nearer;
  return fmin(most, sent * source->irradiance / PI + source->emission_max);
}

double pl_view_series(const pl_view *view, int bounces) {
  double albedo = 0.0, sum = 0.0, term = 1.0;
  if (view->tree != NULL)
    albedo = view->tree->albedo_max;
  for (size_t i = 0; view->tree == NULL && i < view->entity_count; i++)
    albedo = fmax(albedo, fmin(1.0, view->entities[i].albedo_max));
  for (int i = 0; i < bounces; i++, term *= albedo)
    sum += term;
  return sum;
}

pl_view_entity pl_view_ring_sphere(const pl_view_entity *body) {
  pl_view_entity shell = *body;
  shell.radius_m = body->rings->radius_m;
  return shell;
}

double pl_view_from_volumes(const pl_view *view, const pl_view_entity *receiver) {
  double sum = 0.0;
  for (size_t k = 0; k < view->volume_count; k++) {
    const pl_view_volume *volume = &view->volumes[k];
    const pl_view_entity ball = {
        .center_m = {volume->center_m[0], volume->center_m[1], volume->center_m[2]},
        .radius_m = volume->radius_m};
    sum += pl_view_transfer(receiver, &ball) * (volume->scattered + volume->emitted);
  }
  return sum;
}

double pl_view_received(const pl_view *view, size_t i) {
  const pl_view_entity *receiver = &view->entities[i];
  double sum = pl_view_from_volumes(view, receiver);
  sum += pl_view_sum_light(view, receiver);
  for (size_t k = 0; (view->tree == NULL || view->tree->ringed) && k < view->entity_count; k++) {
    const pl_view_entity *source = &view->entities[k];
    if (k == i || source->rings == NULL)
      continue;
    const pl_view_entity shell = pl_view_ring_sphere(source);
    sum += pl_view_transfer(receiver, &shell) * source->rings->light;
  }
  return sum;
}

double pl_view_shell_fraction(const pl_view *view, const pl_view_entity *body, double radius_m) {
  pl_view_entity shell = *body;
  double fraction = 0.0;
  shell.radius_m = radius_m;
  for (size_t i = 0; i < view->entity_count; i++) {
    const pl_view_entity *entity = &view->entities[i];
    if (entity == body || !entity->in_frame)
      continue;
    if (pl_view_shadow_reaches(view, &shell, entity))
      return 1.0;
    if (view->max_bounces > 0)
      fraction = fmax(fraction,
                      pl_view_transfer(entity, &shell) * pl_view_series(view, view->max_bounces));
  }
  return fmin(1.0, fraction);
}
