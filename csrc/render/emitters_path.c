/* Next-event estimation of emitters. */
#include "render/emitters_path.h"

#include "light/emitters.h"
#include "math/sampler.h"
#include "math/sampling.h"
#include "shade/reflectance.h"

/* First dimension pair of the samples here, one per vertex; larger than those of the longest path.
 */
enum { FIRST_DIMENSION = 1 << 10 };

/* True if emitters are sampled at vertices on bodies (or on meshes). */
static bool drawn_on(const pl_render_settings *settings, bool on_body) {
  return settings->emitters != NULL && (!on_body || settings->emitters_on_bodies);
}

float pl_emitters_met(const pl_path_context *context, const pl_path *path, const pl_ray *ray,
                      const pl_vertex *vertex) {
  if (isinf(path->pdf))
    return context->settings->effects.emitted_light ? 1.0f : 0.0f;
  if (!drawn_on(context->settings, ray->skip_body != PL_NO_BODY))
    return 0.0f;
  const pl_vec3f direction = pl_vec3_to_float(path->beam.direction);
  const pl_emitter_hit hit = {vertex->surface_id, vertex->triangle, vertex->t,
                              fabsf(pl_vec3f_dot(direction, vertex->ng))};
  const float rival = pl_emitters_pdf(context->settings->emitters, path->beam.origin, &hit);
  return pl_power_heuristic(path->pdf, rival);
}

size_t pl_emitters_shade(const pl_path_context *context, const pl_path *path,
                         const pl_vertex *vertex, int bounce, pl_vec3f wo,
                         const pl_planetshine_ray *onward, size_t queued, pl_tile_buffers *b) {
  const pl_surface *s = &vertex->surface;
  if (!drawn_on(context->settings, pl_surface_is_ellipsoid(vertex->surface_id)))
    return queued;
  const uint32_t index = (uint32_t)b->counts[path->pixel]; /* number of samples before this one */
  /* Sampled from the origin of the shadow ray, so that a target seen edge-on does not occlude
   * itself. */
  pl_ray ray = pl_vertex_ray(vertex, context->shot, s->ng, 0.0f);
  float u[2];
  pl_emitter_sample drawn;
  pl_sample_2d(index, b->seeds[path->pixel], FIRST_DIMENSION + (uint32_t)bounce, u);
  if (!pl_emitters_sample(context->settings->emitters, ray.origin, u, &drawn) ||
      !pl_surface_admits(s, drawn.direction))
    return queued;
  /* A body is sampled by a sphere about it. A point of its own surface lies inside that sphere and
   * would light itself. */
  if (pl_surface_same(drawn.surface_id, vertex->surface_id) &&
      pl_surface_is_ellipsoid(vertex->surface_id))
    return queued;
  const pl_vec3f wi = pl_surface_to_local(s, drawn.direction);
  const float rival =
      onward != NULL ? pl_planetshine_pdf(onward, s, wo, wi, drawn.direction) : 0.0f;
  const float weight = pl_power_heuristic(drawn.pdf, rival) / drawn.pdf;
  const pl_vec3f reflected = pl_vec3f_mul(path->throughput, s->reflectance->evaluate(s, wo, wi));
  const pl_vec3f light = pl_vec3f_scale(pl_vec3f_mul(reflected, drawn.radiance), weight);
  if (!(pl_vec3f_max(light) > 0.0f))
    return queued;
  /* transmitted light: the ray starts on the other side */
  if (pl_vec3f_dot(drawn.direction, s->ng) < 0.0f)
    ray = pl_vertex_ray(vertex, context->shot, drawn.direction, 0.0f);
  ray.direction = pl_vec3_unit(pl_vec3f_to_double(drawn.direction));
  ray.t_max = drawn.distance_m;
  b->shadow_rays[queued] = ray;
  b->pending[queued] = (pl_pending){light, path->pixel, path->filtered};
  return queued + 1;
}
