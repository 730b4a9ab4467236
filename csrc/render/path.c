/* Unidirectional path tracing. Sunlight is found by sampling the sun at every vertex and by paths
 * that hit it by chance, combined with the power heuristic (Veach 1997). Work is done in waves over
 * a tile, so that the shadow rays of a wave are traced together. */
#include "render/path.h"

#include "base/work.h"
#include "light/sun.h"
#include "math/color.h"
#include "math/sampler.h"
#include "math/sampling.h"
#include "render/body_light.h"
#include "render/draws.h"
#include "render/emitters_path.h"
#include "render/reflectance_lod.h"
#include "render/planetshine.h"
#include "render/sun_ray.h"
#include "shade/reflectance.h"

enum { ROULETTE_AFTER = 3 };
/* A sampling technique whose density is below this fraction of another's is left out of the
 * weights: the power heuristic would give it the square of this fraction. */
static const float RIVAL_MIN = 0.01f;

static void add(pl_vec3f *sum, pl_vec3f value) { *sum = pl_vec3f_add(*sum, value); }

static size_t start_paths(const pl_path_context *context, uint32_t index, pl_tile_buffers *b) {
  double offset[2];
  pl_image_sample_offset(index, context->settings->samples, offset);
  for (size_t i = 0; i < b->active_count; i++) {
    const uint32_t pixel = b->active[i];
    const int x = context->tile.x0 + (int)(pixel % PL_TILE_SIDE);
    const int y = context->tile.y0 + (int)(pixel / PL_TILE_SIDE);
    b->paths[i] = (pl_path){
        .beam = {.spread = context->spread},
        .throughput = {1.0f, 1.0f, 1.0f},
        .pdf = INFINITY,
        .pixel = pixel,
    };
    pl_beam *beam = &b->paths[i].beam;
    pl_image_sample_ray(context->shot, index, offset, x, y, b->seeds[pixel], &beam->origin,
                        &beam->direction);
    b->rays[i] = (pl_ray){.origin = beam->origin,
                          .t_max = INFINITY,
                          .direction = beam->direction,
                          .skip_body = context->bodies ? PL_NO_BODY : PL_EVERY_ELLIPSOID};
  }
  return b->active_count;
}

/* Whether a path may point at the sun. Uses the camera's view of the sun where parallax is small.
 */
static bool near_sun(const pl_path_context *context, const pl_path *path) {
  const pl_sun_view *sun = &context->camera_sun;
  const float parallax = 0.01f;
  if (!(pl_vec3_norm(path->beam.origin) < parallax * sun->distance_m))
    return true;
  const pl_vec3f across = pl_vec3f_cross(sun->direction, pl_vec3_to_float(path->beam.direction));
  const float reach = sun->sin_radius * (1.0f + 2.0f * parallax) + 2.0f * parallax;
  return pl_vec3f_dot(across, across) < reach * reach;
}

/* Radiance of the sun in a direction over its mean. That of the second band is also the density of
 * draws over the density for a uniform disc. */
static pl_vec3f disc_ratio(const pl_path_context *context, const pl_sun_view *sun,
                           pl_vec3f direction) {
  const pl_limb *limb = context->settings->limb;
  return limb != NULL ? pl_limb_ratio(limb, sun, direction) : (pl_vec3f){1.0f, 1.0f, 1.0f};
}

/* Shades a ray that leaves the scene: it sees the sun or nothing. */
static void shade_miss(const pl_path_context *context, int bounce, const pl_path *path,
                       pl_tile_buffers *b) {
  if (bounce == 0 && context->settings->backdrop != NULL)
    add(&b->sample[path->pixel], pl_vec3f_mul(path->throughput, b->backdrop[path->pixel]));
  if (!context->settings->effects.soft_sun && !isinf(path->pdf))
    return; /* a point sun is never hit by chance */
  if (!near_sun(context, path) || (isinf(path->pdf) && pl_path_limb_rays(context, path->pixel) > 0))
    return;
  const pl_sun_view sun = pl_sun_view_at(&context->shot->sun, path->beam.origin);
  const pl_vec3f direction = pl_vec3_to_float(path->beam.direction);
  if (!pl_sun_covers(&sun, direction))
    return;
  const pl_vec3f ratio = disc_ratio(context, &sun, direction);
  const float weight = pl_power_heuristic(path->pdf, ratio.y * pl_sun_pdf(&sun));
  const pl_vec3f light = pl_vec3f_scale(path->throughput, weight * sun.radiance);
  add(pl_path_sink(b, path->pixel, path->filtered), pl_vec3f_mul(light, ratio));
}

/* Whether shadow rays are needed from a vertex. */
static bool shadows_at(const pl_path_context *context, const pl_vertex *vertex) {
  if (!context->settings->effects.cast_shadows)
    return false;
  return !pl_surface_is_ellipsoid(vertex->surface_id) ||
         pl_shot_body_of(context->shot, vertex->surface_id)->shadowed;
}

/* Whether every shadow ray from a vertex would hit the body in whose umbra the object is. */
static bool dark_at(const pl_path_context *context, const pl_vertex *vertex) {
  return context->settings->effects.cast_shadows && pl_surface_is_mesh(vertex->surface_id) &&
         pl_shot_object_of(context->shot, vertex->surface_id)->dark;
}

/* A direction to the sun, and the sun's light over the density of the draw; pdf is 0 for a point
 * sun. */
typedef struct sun_draw {
  pl_vec3f toward, light;
  float pdf;
} sun_draw;

static sun_draw draw_sun(const pl_path_context *context, const pl_sun_view *sun, const float u[2]) {
  const pl_limb *limb = context->settings->limb;
  const float e = sun->irradiance;
  if (!context->settings->effects.soft_sun)
    return (sun_draw){sun->direction, {e, e, e}, 0.0f};
  const float even = pl_sun_pdf(sun), light = sun->radiance / even;
  if (limb == NULL)
    return (sun_draw){pl_sun_sample(sun, u), {light, light, light}, even};
  pl_vec3f ratio;
  const pl_vec3f toward = pl_limb_sample(limb, sun, u, &ratio);
  return (sun_draw){toward, pl_vec3f_scale(ratio, light / ratio.y), ratio.y * even};
}

/* Queues the sun's light on the vertex, or adds it at once where shadows are off. `onward`: how the
 * path continues, which may hit the sun by chance too; NULL if the path ends here. */
static size_t shade_sun(const pl_path_context *context, const pl_path *path,
                        const pl_vertex *vertex, const float u[2], pl_vec3f wo,
                        const pl_planetshine_ray *onward, size_t queued, pl_tile_buffers *b) {
  const pl_surface *s = &vertex->surface;
  if (dark_at(context, vertex))
    return queued;
  const pl_sun_view sun = pl_sun_view_of(context->shot, context->suns, vertex);
  const sun_draw draw = draw_sun(context, &sun, u);
  if (!pl_surface_admits(s, draw.toward))
    return queued;
  const pl_vec3f wi = pl_surface_to_local(s, draw.toward);
  /* Lobes much wider than the sun hit it so rarely that the weight of this draw is 1. */
  const bool rivals = onward != NULL && draw.pdf > 0.0f &&
                      (RIVAL_MIN * draw.pdf < pl_surface_pdf_most(s, wo) ||
                       (onward->fraction > 0.0f && onward->mirrored > 0.0f));
  const float weight =
      rivals ? pl_power_heuristic(draw.pdf, pl_planetshine_pdf(onward, s, wo, wi, draw.toward))
             : 1.0f;
  const pl_vec3f reflected = pl_vec3f_mul(path->throughput, s->reflectance->evaluate(s, wo, wi));
  pl_vec3f light = pl_vec3f_scale(pl_vec3f_mul(reflected, draw.light), weight);
  if (!(pl_vec3f_max(light) > 0.0f))
    return queued;
  if (context->settings->air != NULL)
    light = pl_vec3f_mul(light, pl_air_toward_sun(context->settings->air, context->shot,
                                                  vertex->position, draw.toward));
  if (context->settings->media != NULL)
    light = pl_vec3f_mul(light, pl_media_toward_sun(context->settings->media, context->shot,
                                                    vertex->position, &sun,
                                                    pl_beam_width(&path->beam, vertex->t)));
  if (!shadows_at(context, vertex)) {
    add(pl_path_sink(b, path->pixel, path->filtered), light);
    return queued;
  }
  b->shadow_rays[queued] = pl_sun_ray(vertex, context->shot, &sun, draw.toward);
  b->pending[queued] = (pl_pending){light, path->pixel, path->filtered};
  return queued + 1;
}

/* Russian roulette by the throughput; the surviving paths are weighted up to keep the mean. */
static bool roulette(pl_path *next, int bounce, float u) {
  if (bounce < ROULETTE_AFTER)
    return true;
  const float survive = pl_minf(pl_vec3f_max(next->throughput), 0.95f);
  if (!(u < survive))
    return false;
  next->throughput = pl_vec3f_scale(next->throughput, 1.0f / survive);
  return true;
}

/* Whether light from meshes is negligible on an object or body. */
static bool far_from_meshes(const pl_snapshot *shot, pl_surface_id id) {
  return pl_surface_is_ellipsoid(id) && !pl_shot_body_of(shot, id)->near_meshes;
}

/* The caustics that may reach a vertex; NULL if there are none. */
static const pl_caustics *caustics_at(const pl_path_context *context, const pl_vertex *vertex) {
  return far_from_meshes(context->shot, vertex->surface_id) ? NULL : context->settings->caustics;
}

/* Draws the next segment of a path from a vertex. Its cone spreads as the camera's does: what it
 * hits is seen in full detail, not as the mean over the lobe that the draw represents. */
static bool extend(const pl_path_context *context, const pl_path *path, const pl_vertex *vertex,
                   int bounce, const float u[2], const float choice[2], pl_vec3f wo,
                   const pl_planetshine_ray *planetshine, size_t kept, pl_tile_buffers *b) {
  pl_path *next = &b->paths[kept];
  pl_ray *ray = &b->rays[kept];
  pl_planetshine_draw drawn;
  if (!pl_planetshine_sample(planetshine, &vertex->surface, wo, u, choice[0], &drawn)) {
    if (bounce == 0 && drawn.set && !(planetshine->mirrored > 0.0f))
      pl_path_lose(context, vertex, path, b);
    return false;
  }
  *ray = pl_vertex_ray(vertex, context->shot, drawn.direction, INFINITY);
  ray->no_meshes = far_from_meshes(context->shot, vertex->surface_id);
  *next = (pl_path){
      .beam = {.origin = ray->origin,
               .direction = ray->direction,
               .width_m = pl_beam_width(&path->beam, vertex->t),
               .spread = path->beam.spread},
      .throughput = pl_vec3f_mul(path->throughput, drawn.weight),
      .pdf = drawn.pdf,
      .lobe_pdf = drawn.lobe_pdf,
      .pixel = path->pixel,
      .filtered = path->filtered,
  };
  return roulette(next, bounce, choice[1]);
}

/* Whether paths continue from an object or body. */
static bool bounces_at(const pl_path_context *context, pl_surface_id id) {
  const pl_render_settings *s = context->settings;
  return pl_surface_is_ellipsoid(id)
             ? s->effects.body_bounces && pl_shot_body_of(context->shot, id)->bounced
             : s->bounces > 0;
}

/* Whether they do from most of it, so that sharing their light between pixels pays. */
static bool shares_at(const pl_path_context *context, pl_surface_id id) {
  return bounces_at(context, id) &&
         (!pl_surface_is_ellipsoid(id) || pl_shot_body_of(context->shot, id)->senders == NULL);
}

static bool goes_on(const pl_path_context *context, const pl_path *path, const pl_vertex *vertex,
                    int bounce) {
  const bool ellipsoid = pl_surface_is_ellipsoid(vertex->surface_id);
  const int bounces = context->settings->bounces, least = ellipsoid ? 1 : 0;
  if (!bounces_at(context, vertex->surface_id) || bounce >= (bounces > least ? bounces : least))
    return false;
  return !ellipsoid ||
         pl_body_lit_by_others(context->shot, vertex, pl_vec3_to_float(path->beam.direction));
}

/* The random numbers of path `i` of the wave. */
typedef struct vertex_draws {
  float sun[2], direction[2], choice[2];
} vertex_draws;

static vertex_draws draws_of(const pl_tile_buffers *b, size_t i) {
  return (vertex_draws){{b->draws[0][i], b->draws[1][i]},
                        {b->draws[2][i], b->draws[3][i]},
                        {b->draws[4][i], b->draws[5][i]}};
}

/* Removes the lobes that the plan leaves out. */
static void set_lobes(const pl_render_settings *settings, pl_surface *s) {
  if (!settings->effects.clear_coat)
    s->lobes.coat = 0.0f;
  if (!settings->effects.transmission)
    s->lobes.transmission = 0.0f;
}

/* Turns the vertex's layers to the viewer's side. If the path comes from inside a solid, attenuates
 * it by the solid's extinction over the length of the segment in the mesh's units. */
static void meet_solid(const pl_snapshot *shot, pl_vertex *vertex, pl_path *path) {
  pl_lobes *lobes = &vertex->surface.lobes;
  pl_vertex_face_layers(vertex);
  if (!lobes->inside)
    return;
  const double units = vertex->t / pl_shot_object_of(shot, vertex->surface_id)->scale;
  path->throughput = pl_vec3f_mul(path->throughput, pl_lobes_passed(lobes, (float)units));
}

/* Sky light that a vertex reflects. */
static pl_vec3f sky_at(const pl_path_context *context, const pl_path *path, const pl_vertex *vertex,
                       int bounce, pl_vec3f wo) {
  const pl_render_settings *s = context->settings;
  const pl_vec3f sky = pl_air_sky_reflected(s->air, context->shot, vertex, wo,
                                            goes_on(context, path, vertex, bounce));
  return pl_media_dim_sky(s->media, context->shot, vertex, pl_beam_width(&path->beam, vertex->t),
                          sky);
}

/* Adds the vertex's emission, weighted against sampling it as a light. */
static void see_emission(const pl_path_context *context, const pl_path *path, const pl_ray *ray,
                         const pl_vertex *vertex, pl_tile_buffers *b) {
  const float weight = pl_emitters_met(context, path, ray, vertex);
  add(pl_path_sink(b, path->pixel, path->filtered),
      pl_vec3f_scale(pl_vec3f_mul(path->throughput, vertex->surface.emission), weight));
}

/* Decides whether and how the path continues, and which bodies and mirrors are sampled. The light
 * of mirrors has edges, which the irradiance filter would blur, and has little noise. It is
 * therefore not filtered: `own`. */
static bool look_on(const pl_path_context *context, const pl_path *path, const pl_vertex *vertex,
                    int bounce, pl_vec3f wo, pl_planetshine_ray *planetshine, pl_continuation *way,
                    bool *own, pl_tile_buffers *b) {
  *way = PL_CONTINUATION_DRAWN;
  *own = bounce > 0;
  if (!goes_on(context, path, vertex, bounce))
    return false;
  const pl_caustics *caustics = caustics_at(context, vertex);
  if (caustics != NULL) {
    pl_planetshine_at(context->settings->planetshine, caustics, vertex, wo, planetshine);
    *own = *own || planetshine->mirrored > 0.0f;
  }
  if (!*own)
    *way = pl_path_continuation(context, &vertex->surface, wo, path, b);
  if (*way != PL_CONTINUATION_NONE && caustics == NULL)
    pl_planetshine_at(context->settings->planetshine, NULL, vertex, wo, planetshine);
  return *way != PL_CONTINUATION_NONE;
}

/* Collects light at the shaded hit of path `i`; the continued path is stored at index `kept` <= i.
 */
static void shade_hit(const pl_path_context *context, int bounce, size_t i, pl_vertex *vertex,
                      size_t *kept, size_t *queued, pl_tile_buffers *b) {
  pl_path path = b->paths[i];
  const vertex_draws u = draws_of(b, i);
  if (bounce == 0)
    pl_reflectance_lod_apply(context->shot, context->settings, vertex);
  pl_surface *s = &vertex->surface;
  if (s->reflectance->layered) {
    set_lobes(context->settings, s);
    meet_solid(context->shot, vertex, &path);
  }
  if (pl_vec3f_max(s->emission) > 0.0f)
    see_emission(context, &path, &b->rays[i], vertex, b);
  if (bounce > 0 && !context->settings->effects.planetshine &&
      pl_planetshine_is_light(vertex->surface_id, b->rays[i].from_surface))
    return;
  const pl_vec3f wo =
      pl_surface_to_local(s, pl_vec3_to_float(pl_vec3_scale(path.beam.direction, -1.0)));
  pl_planetshine_ray planetshine;
  bool own;
  pl_continuation first;
  const bool onward = look_on(context, &path, vertex, bounce, wo, &planetshine, &first, &own, b);
  const pl_planetshine_ray *way = onward ? &planetshine : NULL;
  *queued = shade_sun(context, &path, vertex, u.sun, wo, way, *queued, b);
  if (context->settings->air != NULL)
    add(pl_path_sink(b, path.pixel, path.filtered),
        pl_vec3f_mul(path.throughput, sky_at(context, &path, vertex, bounce, wo)));
  if (context->settings->emitters != NULL)
    *queued = pl_emitters_shade(context, &path, vertex, bounce, wo, way, *queued, b);
  /* only from here on: the light added above is the pixel's own */
  path.filtered = path.filtered || first == PL_CONTINUATION_FILTERED;
  if (onward && extend(context, &path, vertex, bounce, u.direction, u.choice, wo, way, *kept, b) &&
      (own || pl_path_follow(context, vertex, &b->paths[*kept], b)))
    ++*kept;
}

/* Whether this is the first hit of a path, on a body whose radiance in sunlight is known for the
 * whole pixel. */
static bool is_prefiltered(const pl_tile_buffers *b, int bounce, size_t i) {
  const uint32_t pixel = b->paths[i].pixel;
  return bounce == 0 && pl_surface_same(b->prefiltered_id[pixel], b->hits[i].surface_id) &&
         (b->slot[pixel] != PL_PATCH_NONE || !b->lit[pixel]);
}

/* Adds indirect light where that of the sun is prefiltered; one path per patch is enough. */
static void follow_prefiltered(const pl_path_context *context, size_t i, size_t *kept,
                               pl_tile_buffers *b) {
  const pl_path path = b->paths[i];
  const vertex_draws u = draws_of(b, i);
  pl_vertex vertex;
  if (!b->lit[path.pixel] || pl_path_repeat(&b->patches[path.pixel].patch[b->slot[path.pixel]]))
    return;
  if (b->counts[path.pixel] == 0 && context->centred) {
    vertex = pl_point_vertex(&b->points[path.pixel]);
    vertex.surface = b->prefiltered_surface[path.pixel];
  } else {
    pl_vertex_locate(context->shot, &path.beam, &b->hits[i], false, &vertex);
    pl_vertex_shade(context->shot, &path.beam, context->settings->detail, &vertex);
  }
  const pl_vec3f view = pl_vec3_to_float(pl_vec3_scale(path.beam.direction, -1.0));
  const pl_vec3f wo = pl_surface_to_local(&vertex.surface, view);
  pl_planetshine_ray planetshine;
  pl_planetshine_at(context->settings->planetshine, NULL, &vertex, wo, &planetshine);
  if (extend(context, &path, &vertex, 0, u.direction, u.choice, wo, &planetshine, *kept, b) &&
      pl_path_follow(context, &vertex, &b->paths[*kept], b))
    ++*kept;
}

/* Whether an object or body is sub-pixel: the camera's rays do not shade it, they only hit it. */
static bool is_subpixel(const pl_path_context *context, pl_surface_id id) {
  const pl_snapshot *shot = context->shot;
  const bool dot = pl_surface_is_mesh(id) ? pl_shot_object_of(shot, id)->subpixel
                                          : pl_shot_body_of(shot, id)->subpixel;
  return dot && !context->settings->see_subpixel;
}

/* Whether the surface that path `i` hits is shaded at the hit. */
static bool is_shaded(const pl_path_context *context, int bounce, size_t i,
                      const pl_tile_buffers *b) {
  const pl_surface_id id = b->hits[i].surface_id;
  return !pl_surface_is_none(id) && !(bounce == 0 && is_subpixel(context, id)) &&
         !is_prefiltered(b, bounce, i);
}

/* Widens the beam of a camera ray, which hits something at distance t, by its part of the circle of
 * confusion there. */
static void widen_by_lens(const pl_path_context *context, double t, pl_beam *beam) {
  const double across = pl_image_confusion_m(context->shot, beam->direction, t);
  beam->width_m += (float)(across / sqrt((double)context->settings->samples));
}

static void count_hits(const pl_vertex_view *run, size_t count) {
  size_t of[3] = {0, 0, 0};
  for (size_t i = 0; i < count; i++) {
    const pl_surface_id id = run[i].vertex->surface_id;
    of[pl_surface_is_mesh(id) ? 0 : pl_surface_is_ellipsoid(id) ? 1 : 2]++;
  }
  pl_work_add(PL_WORK_mesh_hits, of[0]);
  pl_work_add(PL_WORK_body_hits, of[1]);
  pl_work_add(PL_WORK_ground_hits, of[2]);
}

/* Locates and shades the hits of paths `first` to `end`; vertex i - first of `b` is that of path i.
 */
static void shade_hits(const pl_path_context *context, int bounce, size_t first, size_t end,
                       pl_tile_buffers *b) {
  pl_vertex_view run[PL_SHADE_RUN];
  size_t count = 0;
  for (size_t i = first; i < end; i++) {
    pl_vertex *vertex = &b->vertices[i - first];
    pl_beam *beam = &b->paths[i].beam;
    if (!is_shaded(context, bounce, i, b))
      continue;
    pl_vertex_locate(context->shot, beam, &b->hits[i], false, vertex);
    if (bounce == 0 && context->shot->rays.camera.aperture_m > 0.0)
      widen_by_lens(context, vertex->t, beam);
    run[count++] = (pl_vertex_view){beam, vertex};
  }
  count_hits(run, count);
  pl_detail detail = context->settings->detail;
  detail.sub_cell = detail.sub_cell && bounce == 0; /* what lights others is seen from all sides */
  pl_vertex_shade_run(context->shot, detail, run, count);
}

/* Collects light at the hit of path `i`, of any kind, or beyond the scene. */
static void visit_hit(const pl_path_context *context, int bounce, size_t i, pl_vertex *vertex,
                      size_t *kept, size_t *queued, pl_tile_buffers *b) {
  if (pl_surface_is_none(b->hits[i].surface_id)) {
    shade_miss(context, bounce, &b->paths[i], b);
  } else if (is_shaded(context, bounce, i, b)) {
    shade_hit(context, bounce, i, vertex, kept, queued, b);
  } else if (is_prefiltered(b, bounce, i) && !is_subpixel(context, b->hits[i].surface_id)) {
    const uint32_t pixel = b->paths[i].pixel;
    add(&b->sample[pixel], b->prefiltered[pixel]);
    follow_prefiltered(context, i, kept, b);
  } /* else its light is computed in frame/subpixel_bodies.h */
}

/* Draws the random numbers of a wave. Where each pixel has few samples that the irradiance filter
 * combines, the draws are evenly distributed over pixels. */
static void draw_wave(const pl_path_context *context, uint32_t index, int bounce, size_t count,
                      pl_tile_buffers *b) {
  enum { ROW_BITS = 5 };
  _Static_assert(PL_TILE_SIDE == 1 << ROW_BITS, "rows of a tile");
  pl_draws draws = {.sun = {b->draws[0], b->draws[1]}, .choice = {b->draws[4], b->draws[5]}};
  float *direction[2] = {b->draws[2], b->draws[3]};
  if (bounce == 0 && context->few_samples) {
    for (size_t i = 0; i < count; i++)
      b->wave_seeds[i] = b->paths[i].pixel;
    pl_draws_spread(direction, b->wave_seeds, count, ROW_BITS, b->seeds[0], index);
  } else {
    draws.direction[0] = direction[0];
    draws.direction[1] = direction[1];
  }
  for (size_t i = 0; i < count; i++)
    b->wave_seeds[i] = b->seeds[b->paths[i].pixel];
  pl_draws_fill(&draws, b->wave_seeds, count, index, (uint32_t)bounce);
}

static size_t shade_wave(const pl_path_context *context, uint32_t index, int bounce, size_t count,
                         pl_tile_buffers *b) {
  size_t kept = 0, queued = 0;
  draw_wave(context, index, bounce, count, b);
  if (context->settings->media != NULL)
    pl_media_apply(context, bounce, count, b);
  else if (context->settings->air != NULL)
    pl_air_apply(context, bounce, count, b);
  for (size_t first = 0; first < count; first += PL_SHADE_RUN) {
    const size_t end = first + PL_SHADE_RUN < count ? first + PL_SHADE_RUN : count;
    shade_hits(context, bounce, first, end, b);
    for (size_t i = first; i < end; i++)
      visit_hit(context, bounce, i, &b->vertices[i - first], &kept, &queued, b);
  }
  pl_tracer_occluded(context->tracer, b->shadow_rays, b->occluded, queued, bounce == 0);
  for (size_t i = 0; i < queued; i++)
    if (!b->occluded[i])
      add(pl_path_sink(b, b->pending[i].pixel, b->pending[i].filtered), b->pending[i].radiance);
  return kept;
}

/* Adds the sample of a pixel to the sums of its patch, or of the pixel if it has no patch. */
static void gather_pixel(uint32_t pixel, pl_tile_buffers *b) {
  const uint32_t slot = b->slot[pixel];
  const pl_vec3f sample = b->sample[pixel], filtered = b->filtered[pixel];
  const float y = pl_luminance(sample), light = pl_luminance(filtered);
  b->counts[pixel]++;
  if (slot == PL_PATCH_NONE) {
    add(&b->radiance[pixel], sample);
    b->square[pixel] += y * y;
    return;
  }
  pl_patch *patch = &b->patches[pixel].patch[slot];
  add(&patch->own, sample);
  add(&patch->filtered, filtered);
  patch->own_square += y * y;
  patch->lit_square += light * light;
}

static void gather_sample(pl_tile_buffers *b) {
  for (size_t i = 0; i < b->active_count; i++) {
    const uint32_t pixel = b->active[i];
    gather_pixel(pixel, b);
    b->sample[pixel] = b->filtered[pixel] = (pl_vec3f){0.0f, 0.0f, 0.0f};
  }
}

/* Finds the patch of each path's hit. Light is filtered only where paths continue. */
static void find_patches(const pl_path_context *context, size_t count, pl_tile_buffers *b) {
  for (size_t i = 0; i < count; i++) {
    const uint32_t pixel = b->paths[i].pixel;
    b->slot[pixel] = PL_PATCH_NONE;
    if (context->filters_irradiance && !pl_surface_is_none(b->hits[i].surface_id) &&
        shares_at(context, b->hits[i].surface_id))
      b->slot[pixel] = pl_patch_meet(&b->patches[pixel], context->shot, &b->hits[i],
                                     b->rays[i].direction, (float)context->pixel_rad);
  }
}

void pl_path_sample(const pl_path_context *context, uint32_t index, pl_tile_buffers *b) {
  size_t count = start_paths(context, index, b);
  pl_work_add(PL_WORK_samples, count);
  if (index == 0 && context->centred) {
    for (size_t i = 0; i < count; i++)
      b->hits[i] = b->center_hits[b->paths[i].pixel];
  } else {
    const size_t meshes = b->active_meshes;
    pl_tracer_closest(context->tracer, b->rays, b->hits, meshes, true, true);
    pl_tracer_closest(context->tracer, b->rays + meshes, b->hits + meshes, count - meshes, true,
                      false);
  }
  find_patches(context, count, b);
  pl_path_see_limb(context, index, b);
  for (int bounce = 0; count > 0; bounce++) {
    count = shade_wave(context, index, bounce, count, b);
    if (count > 0)
      pl_tracer_closest(context->tracer, b->rays, b->hits, count, false, true);
  }
  gather_sample(b);
}
