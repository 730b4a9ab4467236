/* Selection of the bodies that are sampled, the fraction of draws for each, and the sampling. */
#include "render/planetshine.h"

#include <stdlib.h>

#include "math/color.h"
#include "render/body_albedo.h"
#include "render/render.h"
#include "shade/reflectance.h"

/* Minimum radiance of a white surface lit by a body that is sampled, relative to white. */
static const float INVISIBLE = 1e-5f;
/* Assumed colours of surfaces whose mean is not known: soils, and graphs. */
static const float SOIL = 0.15f, GRAPH = 0.3f;
/* Assumed fraction of the sun's light that a mesh gets by way of itself and other meshes. It
 * reserves paths for that light. Bodies are convex and get little of it. */
static const float BY_MESHES = 0.02f;
/* A surface that reflects less of a body's light than this fraction of a white diffuse surface has
 * the body outside its glossy lobe, which then reflects other light. */
static const float GLOSS = 0.02f;
/* Minimum fraction of paths that the lobe draws: meshes light each other. Below FRACTION_MIN bodies
 * would get so few paths that sampling them is not worth its cost, and the lobe draws all. */
static const float LOBE_MIN = 0.4f, LOBE_MIN_ON_BODIES = 0.1f, FRACTION_MIN = 0.04f;
/* Bodies whose light is wider than this, sr, are left to the lobe's draws, which find them well
 * enough and are denser where the light contributes more. Measured. */
static const float WIDE_SR = 1.5f;
/* Minimum fraction of all paths that are to hit bodies: noise of weak light is visible, too. */
static const float WANTED_MIN = 0.1f;

/* Maximum fraction of draws towards mirrors of the sun. */
static const float MIRRORS_MAX = 0.8f;

/* An object whose radius is below this fraction of the distance to a body and of the body's radius
 * sees the body in one direction. Draws towards it are those from the object's centre. The parts of
 * the body that are visible only through parallax are left to the lobe. */
static const double PARALLAX_MAX = 0.003;

/* Objects closer to each other than LIKE of a body's distance share one estimate of its radiance. A
 * frame makes at most ESTIMATES estimates; after that the nearest one is used. */
static const double LIKE = 0.05;
enum { ESTIMATES = 64 };
/* Minimum colour assumed for a body with clouds or air. */
static const float BEHIND_MEDIUM = 0.3f;

static float mean_color(const pl_shot_body *body) {
  const pl_body_state *state = body->state;
  float map[4] = {1.0f, 1.0f, 1.0f, 1.0f};
  if (body->body->graph != NULL)
    return GRAPH;
  if (body->body->map != NULL || body->body->terrain != NULL)
    pl_body_albedo_mean(body, map);
  const pl_vec3f color = {map[0] * state->albedo[0], map[1] * state->albedo[1],
                          map[2] * state->albedo[2]};
  const bool behind_medium = body->body->air != NULL || state->clouds.altitude_m > 0.0;
  const float own = pl_minf(pl_luminance(color), 1.0f);
  return pl_maxf(own * (body->body->reflectance->photometric ? SOIL : 1.0f),
                 behind_medium ? BEHIND_MEDIUM : 0.0f);
}

/* The brightest bodies in one sky, in descending order; `other`: the light of the rest. */
typedef struct ranking {
  uint32_t body[PL_PLANETSHINE_LIGHTS];
  float light[PL_PLANETSHINE_LIGHTS];
  int count;
  float other;
} ranking;

static void insert(ranking *r, uint32_t body, float found) {
  int at = r->count;
  if (at == PL_PLANETSHINE_LIGHTS) {
    at--;
    r->other += pl_minf(found, r->light[at]);
    if (!(found > r->light[at]))
      return;
  } else {
    r->count++;
  }
  for (; at > 0 && found > r->light[at - 1]; at--) {
    r->light[at] = r->light[at - 1];
    r->body[at] = r->body[at - 1];
  }
  r->light[at] = found;
  r->body[at] = body;
}

/* An object or body whose sky is computed. */
typedef struct place {
  pl_vec3 center;
  double radius_m;
  int own; /* index of the body if it is one, or -1 */
} place;

static int by_index(const void *a, const void *b) {
  const uint32_t i = *(const uint32_t *)a, j = *(const uint32_t *)b;
  return i < j ? -1 : i > j;
}

/* Lists, by index, the bodies that may be visible: none of a group is nearer than their sphere. */
static size_t list_visible(pl_planetshine *p, const place *at) {
  const pl_sphere_tree *tree = &p->shot->body_tree;
  size_t count = 0;
  for (size_t k = 0; k < tree->count;) {
    const pl_sphere *node = &tree->nodes[k];
    const double away = pl_vec3_norm(pl_vec3_sub(node->center, at->center)) - at->radius_m;
    const double gap = node->item != PL_INNER_NODE ? away : away - node->radius_m;
    const double most = 1.001 * (double)p->strength[k] / (gap * gap);
    const bool enters = !(gap > 0.0) || most > (double)(INVISIBLE * p->white);
    p->steps++;
    if (enters && node->item != PL_INNER_NODE)
      p->found[count++] = node->item;
    k = pl_sphere_next(tree, k, enters);
  }
  qsort(p->found, count, sizeof *p->found, by_index);
  return count;
}

static ranking rank_bodies(pl_planetshine *p, const place *at) {
  ranking out = {.count = 0};
  const size_t count = list_visible(p, at);
  for (size_t k = 0; k < count; k++) {
    const size_t i = p->found[k];
    const pl_shot_body *body = &p->shot->bodies[i];
    const double gap = pl_vec3_norm(pl_vec3_sub(body->center, at->center)) - at->radius_m;
    const double sine = body->radius_m / fmax(gap, body->radius_m);
    const float found = p->radiance[i] * (float)(sine * sine);
    if ((int)i != at->own && found > INVISIBLE * p->white)
      insert(&out, (uint32_t)i, found);
  }
  return out;
}

/* An existing estimate of a body's radiance from near a point; the nearest one if no more can be
 * made; NULL if there is none. */
static const pl_body_radiance *find_radiance(const pl_planetshine *p, uint32_t body, pl_vec3 point,
                                             double gap_m) {
  const pl_body_radiance *out = NULL;
  double least = p->radiance_count < ESTIMATES ? LIKE * gap_m : INFINITY;
  for (size_t i = 0; i < p->radiance_count; i++) {
    const double apart = pl_vec3_norm(pl_vec3_sub(p->estimates[i].point, point));
    if (p->estimates[i].body == body && apart < least) {
      least = apart;
      out = &p->estimates[i];
    }
  }
  return out;
}

/* The radiance of a body as seen from an object's centre, or from the point of a body's surface
 * that is nearest to the other body. */
static const pl_body_radiance *radiance_from(pl_planetshine *p, const pl_render_settings *settings,
                                             const place *at, uint32_t body) {
  const pl_vec3 to = pl_vec3_sub(p->shot->bodies[body].center, at->center);
  const double apart = pl_vec3_norm(to), gap = apart - p->shot->bodies[body].radius_m;
  pl_vec3 point = at->center;
  if (at->own >= 0 && gap > at->radius_m)
    point = pl_vec3_madd(point, at->radius_m / apart, to);
  const pl_body_radiance *like = find_radiance(p, body, point, gap);
  if (like != NULL || p->radiance_count == ESTIMATES)
    return like;
  pl_body_radiance *radiance = &p->estimates[p->radiance_count];
  if (!pl_body_radiance_make(p->shot, settings, body, p->suns[body], point, radiance))
    return NULL;
  p->radiance_count++;
  return radiance;
}

static void place_light(const pl_planetshine *p, const pl_body_radiance *radiance, pl_vec3 point,
                        pl_planetshine_light *out) {
  double even;
  out->seen = pl_body_disc_make(&p->shot->bodies[radiance->body], p->suns[radiance->body], point,
                                &out->disc);
  if (!out->seen)
    return;
  const float larger = (float)(out->disc.most / radiance->most);
  out->table = &radiance->table;
  out->middle =
      pl_vec3_to_float(pl_disc_direction(&out->disc, radiance->part, radiance->turn_rad, &even));
  out->irradiance = larger * radiance->irradiance;
  out->wide_sr = larger * radiance->wide_sr;
}

static void fill_sky(pl_planetshine *p, const pl_render_settings *settings, const place *at,
                     pl_planetshine_sky *sky) {
  const ranking ranking = rank_bodies(p, at);
  sky->far = true;
  sky->other += ranking.other;
  for (int i = 0; i < ranking.count; i++) {
    const pl_body_radiance *radiance = radiance_from(p, settings, at, ranking.body[i]);
    if (radiance == NULL || !(radiance->irradiance > INVISIBLE * PL_PI_F * p->white))
      continue;
    const pl_shot_body *body = &p->shot->bodies[radiance->body];
    const double gap = pl_vec3_norm(pl_vec3_sub(body->center, at->center)) - body->radius_m;
    sky->far = sky->far && at->radius_m < PARALLAX_MAX * fmin(gap, body->radius_m);
    place_light(p, radiance, at->center, &sky->lights[sky->count]);
    sky->estimate[sky->count++] = radiance;
  }
  p->any = p->any || sky->count > 0;
}

static void fill_skies(pl_planetshine *p, const pl_render_settings *settings) {
  const pl_snapshot *shot = p->shot;
  for (size_t i = 0; i < shot->object_count; i++) {
    const pl_shot_object *object = &shot->objects[i];
    const double sun = object->dark ? 0.0 : pl_shot_sun_irradiance(&shot->sun, object->center);
    const place at = {object->center, object->radius_m, object->object->body};
    p->skies[i] = (pl_planetshine_sky){.other = BY_MESHES * (float)sun / PL_PI_F};
    if (object->kept)
      fill_sky(p, settings, &at, &p->skies[i]);
  }
  for (size_t i = 0; i < shot->body_count; i++) {
    const place at = {shot->bodies[i].center, shot->bodies[i].radius_m, (int)i};
    pl_planetshine_sky *sky = &p->skies[shot->object_count + i];
    *sky = (pl_planetshine_sky){.other = 0.0f};
    if (shot->bodies[i].bounced)
      fill_sky(p, settings, &at, sky);
  }
}

/* A node follows the one above it. */
static void set_strengths(pl_planetshine *p) {
  const pl_sphere_tree *tree = &p->shot->body_tree;
  for (size_t k = tree->count; k-- > 0;) {
    const pl_sphere *node = &tree->nodes[k];
    p->strength[k] = 0.0f;
    if (node->item != PL_INNER_NODE)
      p->strength[k] = p->radiance[node->item] * (float)(node->radius_m * node->radius_m);
    for (size_t i = k + 1; i < node->after; i = tree->nodes[i].after)
      p->strength[k] = pl_maxf(p->strength[k], p->strength[i]);
  }
}

pl_status pl_planetshine_build(const pl_snapshot *shot, const pl_render_settings *settings,
                               pl_arena *arena, pl_planetshine *out) {
  const size_t entities = shot->object_count + shot->body_count;
  *out = (pl_planetshine){
      .shot = shot,
      .white = settings->white_radiance,
      .suns = pl_arena_alloc(arena, shot->body_count, sizeof *out->suns),
      .radiance = pl_arena_alloc(arena, shot->body_count, sizeof *out->radiance),
      .strength = pl_arena_alloc(arena, shot->body_tree.count, sizeof *out->strength),
      .found = pl_arena_alloc(arena, shot->body_count, sizeof *out->found),
      .estimates = pl_arena_alloc(arena, ESTIMATES, sizeof *out->estimates),
      .skies = pl_arena_alloc(arena, entities, sizeof *out->skies),
  };
  if (out->suns == NULL || out->radiance == NULL || out->strength == NULL || out->found == NULL ||
      out->estimates == NULL || out->skies == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the light of %zu bodies", shot->body_count);
  for (size_t i = 0; i < shot->body_count; i++) {
    const pl_shot_body *body = &shot->bodies[i];
    const float sun = (float)pl_shot_sun_irradiance(&shot->sun, body->center);
    out->suns[i] = pl_vec3_sub(shot->sun.position, body->center);
    out->radiance[i] = mean_color(body) * sun / PL_PI_F;
  }
  set_strengths(out);
  fill_skies(out, settings);
  return PL_OK;
}

bool pl_planetshine_is_light(pl_surface_id id, pl_surface_id from) {
  return !pl_surface_same(id, from) && pl_surface_kind_of(id) != PL_SURFACE_MESH;
}

/* Estimates for a body in the sky: the light that the surface reflects, and the fraction of the
 * lobe's draws that hit the body. Both are evaluated for one direction: to the centre of the body's
 * light, or, if that is below the horizon, tilted from there towards the zenith by the sine of the
 * body's angular radius, for bodies that extend far above the horizon. */
typedef struct guess {
  float light, met;
  float white; /* radiance of a white diffuse surface that faces the body */
} guess;

static guess guess_at(const pl_planetshine_light *light, const pl_surface *s, pl_vec3f wo) {
  pl_vec3f direction = light->middle;
  guess out = {.white = light->irradiance / PL_PI_F};
  if (!pl_surface_admits(s, direction)) {
    const double most = light->disc.most;
    direction = pl_vec3f_unit(pl_vec3f_madd(direction, (float)sqrt(most * (2.0 - most)), s->ng));
    if (!pl_surface_admits(s, direction))
      return out;
  }
  const pl_vec3f wi = pl_surface_to_local(s, direction);
  out.light = light->irradiance * pl_luminance(s->reflectance->evaluate(s, wo, wi));
  out.met = pl_minf(s->reflectance->pdf(s, wo, wi) * light->wide_sr, 1.0f);
  return out;
}

/* Sums over the bodies that a vertex sees. Over the sampled ones: their reflected light, the
 * fraction of the lobe's draws that hit them, and their GLOSS thresholds. Over wide bodies: their
 * reflected light. */
typedef struct sums {
  float light, met, gloss, wide;
} sums;

static void list_bodies(const pl_planetshine *p, const pl_planetshine_sky *sky,
                        const pl_vertex *vertex, pl_vec3f wo, pl_planetshine_ray *out, sums *sums) {
  out->count = 0;
  for (int i = 0; i < sky->count; i++) {
    pl_planetshine_light own;
    const pl_planetshine_light *light = sky->far ? &sky->lights[i] : &own;
    if (!sky->far)
      place_light(p, sky->estimate[i], vertex->position, &own);
    if (!light->seen)
      continue;
    const guess found = guess_at(light, &vertex->surface, wo);
    if (light->wide_sr > WIDE_SR) {
      sums->wide += found.light;
      continue;
    }
    sums->gloss += GLOSS * found.white;
    if (!(found.light > 0.0f))
      continue;
    out->disc[out->count] = light->disc;
    out->table[out->count] = light->table;
    sums->light += out->chance[out->count++] = found.light;
    sums->met += found.met;
  }
}

/* Sets the fraction of draws towards bodies; returns an estimate of the light of bodies that the
 * surface reflects. */
static float aim_at_bodies(const pl_planetshine *p, const pl_vertex *vertex, pl_vec3f wo,
                           pl_planetshine_ray *out) {
  const pl_surface *s = &vertex->surface;
  const float color = pl_luminance(s->color);
  sums sums = {0.0f, 0.0f, 0.0f, 0.0f};
  const pl_planetshine_sky *sky = &p->skies[pl_shot_slot(p->shot, vertex->surface_id)];
  list_bodies(p, sky, vertex, wo, out, &sums);
  const float all = sums.light + sums.wide;
  if (!(sums.light > 0.0f) || !(sums.met < 1.0f))
    return all;
  /* The wanted fraction of all paths is to hit bodies; the lobe's own draws provide part of it. */
  const float other = (sky->other + sums.gloss) * color + sums.wide;
  const float part = sums.light / (sums.light + pl_minf(other, p->white));
  const bool least = sums.light > sums.gloss * color && !(sums.wide > 0.0f);
  const float wanted = least ? pl_maxf(part, WANTED_MIN) : part;
  const bool on_body = pl_surface_is_ellipsoid(vertex->surface_id);
  const float most = 1.0f - (on_body ? LOBE_MIN_ON_BODIES : LOBE_MIN);
  const float fraction = pl_minf((wanted - sums.met) / (1.0f - sums.met), most);
  if (!(fraction > FRACTION_MIN))
    return all;
  out->fraction = fraction;
  for (int i = 0; i < out->count; i++)
    out->chance[i] /= sums.light;
  return all;
}

/* Takes the fraction for mirrors from the fractions of bodies and lobe; `known`: light of bodies.
 */
static void aim_at_mirrors(const pl_caustics *caustics, const pl_vertex *vertex, pl_vec3f wo,
                           float known, pl_planetshine_ray *out) {
  const float light = pl_caustics_at(caustics, vertex, wo, &out->mirrors);
  const float color = pl_luminance(vertex->surface.color);
  if (!(light > 0.0f))
    return;
  const float part = light / (light + known + BY_MESHES * color * caustics->sun / PL_PI_F);
  const float fraction = pl_minf(part, MIRRORS_MAX);
  if (!(fraction > FRACTION_MIN))
    return;
  out->fraction = fraction + (1.0f - fraction) * out->fraction;
  out->mirrored = fraction / out->fraction;
}

void pl_planetshine_at(const pl_planetshine *p, const pl_caustics *caustics,
                       const pl_vertex *vertex, pl_vec3f wo, pl_planetshine_ray *out) {
  const pl_surface *s = &vertex->surface;
  float known = 0.0f;
  out->fraction = out->mirrored = 0.0f;
  out->count = 0;
  if (s->reflectance->layered && s->lobes.inside)
    return;
  if (p != NULL && p->skies[pl_shot_slot(p->shot, vertex->surface_id)].count > 0)
    known = aim_at_bodies(p, vertex, wo, out);
  if (caustics != NULL)
    aim_at_mirrors(caustics, vertex, wo, known, out);
}

static float density(const pl_planetshine_ray *planetshine, float lobe, float bodies) {
  return (1.0f - planetshine->fraction) * lobe + planetshine->fraction * bodies;
}

/* Density of the draws towards bodies and mirrors; `drawn`: index of a body whose own density
 * `known` is given, or -1. */
static float bodies_pdf(const pl_planetshine_ray *planetshine, pl_vec3f direction, int drawn,
                        float known) {
  float sum = 0.0f;
  for (int i = 0; i < planetshine->count && planetshine->mirrored < 1.0f; i++)
    sum +=
        planetshine->chance[i] *
        (i == drawn ? known : pl_disc_pdf(&planetshine->disc[i], planetshine->table[i], direction));
  if (!(planetshine->mirrored > 0.0f))
    return sum;
  return (1.0f - planetshine->mirrored) * sum +
         planetshine->mirrored * pl_caustics_pdf(&planetshine->mirrors, direction);
}

float pl_planetshine_pdf(const pl_planetshine_ray *planetshine, const pl_surface *s, pl_vec3f wo,
                         pl_vec3f wi, pl_vec3f direction) {
  const float lobe = s->reflectance->pdf(s, wo, wi);
  if (!(planetshine->fraction > 0.0f))
    return lobe;
  return density(planetshine, lobe, bodies_pdf(planetshine, direction, -1, 0.0f));
}

static bool sample_lobe(const pl_surface *s, pl_vec3f wo, const float u[2],
                        pl_planetshine_draw *out) {
  if (!s->reflectance->sample(s, wo, u, &out->wi, &out->weight, &out->lobe_pdf))
    return false;
  out->pdf = out->lobe_pdf;
  out->direction = pl_vec3f_unit(pl_surface_to_world(s, out->wi));
  const float side = pl_vec3f_dot(out->direction, s->ng);
  return out->wi.z > 0.0f ? side > 0.0f : out->wi.z < 0.0f && side < 0.0f;
}

/* Draws a direction towards one of the bodies, or a mirror (body -1); `known`: the density of the
 * body's draw. */
static bool sample_target(const pl_planetshine_ray *planetshine, float u[2], float choice,
                          int *body, pl_vec3f *direction, float *known) {
  *body = -1;
  if (planetshine->mirrored > 0.0f && pl_sample_choose(planetshine->mirrored, &u[0]))
    return pl_caustics_sample(&planetshine->mirrors, u, choice, direction);
  int at = 0;
  while (at + 1 < planetshine->count && choice >= planetshine->chance[at])
    choice -= planetshine->chance[at++];
  *body = at;
  *direction = pl_disc_sample(&planetshine->disc[at], planetshine->table[at], u, known);
  return true;
}

static bool sample_set(const pl_planetshine_ray *planetshine, const pl_surface *s, pl_vec3f wo,
                       float u[2], float choice, pl_planetshine_draw *out) {
  int at;
  float known = 0.0f;
  if (!sample_target(planetshine, u, choice, &at, &out->direction, &known) ||
      !pl_surface_admits(s, out->direction))
    return false;
  out->wi = pl_surface_to_local(s, out->direction);
  out->lobe_pdf = s->reflectance->pdf(s, wo, out->wi);
  if (!(out->lobe_pdf > 0.0f))
    return false;
  out->pdf =
      density(planetshine, out->lobe_pdf, bodies_pdf(planetshine, out->direction, at, known));
  out->weight = pl_vec3f_scale(s->reflectance->evaluate(s, wo, out->wi), 1.0f / out->pdf);
  return true;
}

bool pl_planetshine_sample(const pl_planetshine_ray *planetshine, const pl_surface *s, pl_vec3f wo,
                           const float u[2], float choice, pl_planetshine_draw *out) {
  const float fraction = planetshine->fraction;
  float v[2] = {u[0], u[1]};
  out->set = fraction > 0.0f && pl_sample_choose(fraction, &v[0]);
  if (out->set)
    return sample_set(planetshine, s, wo, v, choice, out);
  if (!sample_lobe(s, wo, v, out))
    return false;
  if (fraction > 0.0f) {
    out->pdf =
        density(planetshine, out->lobe_pdf, bodies_pdf(planetshine, out->direction, -1, 0.0f));
    out->weight = pl_vec3f_scale(out->weight, out->lobe_pdf / out->pdf);
  }
  return true;
}
