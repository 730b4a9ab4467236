/* Which bodies are drawn to, and how often; drawing. */
#include "render/planetshine.h"

#include "math/color.h"
#include "shade/reflectance.h"

/* The least radiance of a white surface, of what is shown as white, for which a body is drawn. */
static const float INVISIBLE = 1e-5f;
/* Colours that stand for those of surfaces whose mean no one has: soils, and graphs. Guesses. */
static const float SOIL = 0.15f, GRAPH = 0.3f;
/* Part of the sun's light that a mesh may get by way of itself and other meshes. A guess as well:
 * it keeps paths for that light. Bodies are convex and have little of it. */
static const float BY_MESHES = 0.02f;
/* Bodies of which a surface sends on less than this part of what a diffuse one would are behind its
 * gloss: other things are in it. */
static const float GLOSS = 0.02f;
/* Paths are drawn by the lobe in any case, with this chance at least: meshes light each other. And
 * by it alone where bodies would get so few that finding them is not worth the while. */
static const float LOBE_MIN = 0.4f, LOBE_MIN_ON_BODIES = 0.1f, SHARE_MIN = 0.04f;
/* Bodies whose lit part is wider than this, sr, are found by the lobe's own draws as well, which
 * lie where the light counts. By measurement. */
static const float WIDE_SR = 1.5f;
/* Of all paths so many are to meet bodies at least: weak light is noise that is seen, too. */
static const float WANTED_MIN = 0.1f;

/* Mirrors of the sun get this share of draws at most. */
static const float MIRRORS_MAX = 0.8f;

/* A thing so small for the distance of a body sees it in one direction: draws to it are those of
 * the thing's centre, and what parallax hides of it is left to the lobe. */
static const double PARALLAX_MAX = 0.003;

static float mean_color(const pl_shot_body *body) {
  const pl_body_state *state = body->state;
  float map[4] = {1.0f, 1.0f, 1.0f, 1.0f};
  if (body->body->graph != NULL)
    return GRAPH;
  if (body->body->map != NULL)
    pl_texture_mean(body->body->map, map);
  const pl_vec3f color = {map[0] * state->albedo[0], map[1] * state->albedo[1],
                          map[2] * state->albedo[2]};
  return pl_minf(pl_luminance(color), 1.0f) * (body->body->reflectance->photometric ? SOIL : 1.0f);
}

/* Keeps the brightest, in falling order; the rest is other light. */
static void insert(pl_shine_sky *sky, float light[PL_SHINE_LIGHTS], uint32_t body, float found) {
  int at = sky->count;
  if (at == PL_SHINE_LIGHTS) {
    at--;
    sky->other += pl_minf(found, light[at]);
    if (!(found > light[at]))
      return;
  } else {
    sky->count++;
  }
  for (; at > 0 && found > light[at - 1]; at--) {
    light[at] = light[at - 1];
    sky->body[at] = sky->body[at - 1];
  }
  light[at] = found;
  sky->body[at] = body;
}

/* `own`: the body that the thing is, or -1. */
static void fill_sky(const pl_planetshine *p, pl_vec3 center, double radius_m, int own,
                     float white_radiance, pl_shine_sky *sky) {
  float light[PL_SHINE_LIGHTS];
  for (size_t i = 0; i < p->shot->body_count; i++) {
    const pl_shot_body *body = &p->shot->bodies[i];
    const double gap = pl_vec3_norm(pl_vec3_sub(body->center, center)) - radius_m;
    const double sine = body->radius_m / fmax(gap, body->radius_m);
    const float found = p->radiance[i] * (float)(sine * sine);
    if ((int)i != own && found > INVISIBLE * white_radiance)
      insert(sky, light, (uint32_t)i, found);
  }
}

static void look_at(const pl_planetshine *p, uint32_t body, pl_vec3 point, pl_shine_light *out) {
  static const float middle[2] = {0.5f, 0.5f};
  out->seen = pl_lune_make(&p->shot->bodies[body], p->suns[body], point, &out->lune) &&
              pl_lune_sample(&out->lune, middle, &out->middle, &out->pdf);
}

static void fill_lights(const pl_planetshine *p, pl_vec3 center, double radius_m,
                        pl_shine_sky *sky) {
  sky->far = true;
  for (int i = 0; i < sky->count; i++) {
    const pl_shot_body *body = &p->shot->bodies[sky->body[i]];
    const double gap = pl_vec3_norm(pl_vec3_sub(body->center, center)) - body->radius_m;
    sky->far = sky->far && radius_m < PARALLAX_MAX * gap;
    look_at(p, sky->body[i], center, &sky->lights[i]);
  }
}

static void fill_skies(pl_planetshine *p, float white_radiance) {
  const pl_snapshot *shot = p->shot;
  for (size_t i = 0; i < shot->object_count; i++) {
    const pl_shot_object *object = &shot->objects[i];
    pl_shine_sky *sky = &p->skies[i];
    const double sun = object->dark ? 0.0 : pl_shot_sun_irradiance(&shot->sun, object->center);
    *sky = (pl_shine_sky){.other = BY_MESHES * (float)sun / PL_PI_F};
    fill_sky(p, object->center, object->radius_m, object->object->body, white_radiance, sky);
    fill_lights(p, object->center, object->radius_m, sky);
    p->any = p->any || sky->count > 0;
  }
  for (size_t i = 0; i < shot->body_count; i++) {
    pl_shine_sky *sky = &p->skies[shot->object_count + i];
    *sky = (pl_shine_sky){.other = 0.0f};
    fill_sky(p, shot->bodies[i].center, shot->bodies[i].radius_m, (int)i, white_radiance, sky);
    p->any = p->any || sky->count > 0;
  }
}

pl_status pl_planetshine_build(const pl_snapshot *shot, float white_radiance, pl_arena *arena,
                               pl_planetshine *out) {
  const size_t things = shot->object_count + shot->body_count;
  *out = (pl_planetshine){
      .shot = shot,
      .suns = pl_arena_alloc(arena, shot->body_count, sizeof *out->suns),
      .radiance = pl_arena_alloc(arena, shot->body_count, sizeof *out->radiance),
      .skies = pl_arena_alloc(arena, things, sizeof *out->skies),
  };
  if (out->suns == NULL || out->radiance == NULL || out->skies == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the light of %zu bodies", shot->body_count);
  for (size_t i = 0; i < shot->body_count; i++) {
    const pl_shot_body *body = &shot->bodies[i];
    const float sun = (float)pl_shot_sun_irradiance(&shot->sun, body->center);
    out->suns[i] = pl_vec3_sub(shot->sun.position, body->center);
    out->radiance[i] = mean_color(body) * sun / PL_PI_F;
  }
  fill_skies(out, white_radiance);
  return PL_OK;
}

bool pl_shine_is_light(const pl_snapshot *shot, uint32_t thing, uint32_t from) {
  return thing != from && (thing >= shot->object_count || shot->objects[thing].object->body >= 0);
}

/* What a body in the sky may bring: the light that the surface sends on, and the part of the lobe's
 * own draws that meet it; both by one direction, in the middle of what is lit, or between that and
 * the zenith for a body that reaches far up from the horizon. */
typedef struct guess {
  float light, met;
  float white; /* what a white diffuse surface that faces the body would send on */
} guess;

static guess guess_at(const pl_shine_light *light, const pl_surface *s, pl_vec3f wo,
                      float radiance) {
  pl_vec3f direction = light->middle;
  guess out = {.white = radiance / (light->pdf * PL_PI_F)};
  if (!pl_surface_admits(s, direction)) {
    direction = pl_vec3f_unit(pl_vec3f_madd(direction, (float)(1.0 / light->lune.d), s->ng));
    if (!pl_surface_admits(s, direction))
      return out;
  }
  const pl_vec3f wi = pl_surface_to_local(s, direction);
  const float reflected = pl_luminance(s->reflectance->evaluate(s, wo, wi));
  out.light = radiance * reflected / light->pdf;
  out.met = pl_minf(s->reflectance->pdf(s, wo, wi) / light->pdf, 1.0f);
  return out;
}

/* What a vertex sees: light of the bodies that are drawn to, and what else is known of. */
typedef struct sums {
  float light, met, gloss, wide;
} sums;

static void list_bodies(const pl_planetshine *p, const pl_shine_sky *sky, const pl_vertex *vertex,
                        pl_vec3f wo, pl_shine *out, sums *sums) {
  out->count = 0;
  for (int i = 0; i < sky->count; i++) {
    const uint32_t body = sky->body[i];
    const float radiance = p->radiance[body];
    pl_shine_light own;
    const pl_shine_light *light = sky->far ? &sky->lights[i] : &own;
    if (!sky->far)
      look_at(p, body, vertex->position, &own);
    if (!light->seen)
      continue;
    const guess found = guess_at(light, &vertex->surface, wo, radiance);
    if (found.white * PL_PI_F > WIDE_SR * radiance) {
      sums->wide += found.light;
      continue;
    }
    sums->gloss += GLOSS * found.white;
    if (!(found.light > 0.0f))
      continue;
    out->lunes[out->count] = light->lune;
    sums->light += out->chance[out->count++] = found.light;
    sums->met += found.met;
  }
}

/* Sets the share of bodies; returns a guess of the light that the surface sends on of theirs. */
static float share_bodies(const pl_planetshine *p, const pl_vertex *vertex, pl_vec3f wo,
                          pl_shine *out) {
  const pl_surface *s = &vertex->surface;
  const float color = pl_luminance(s->color);
  sums sums = {0.0f, 0.0f, 0.0f, 0.0f};
  const pl_shine_sky *sky = &p->skies[vertex->thing];
  list_bodies(p, sky, vertex, wo, out, &sums);
  const float all = sums.light + sums.wide;
  if (!(sums.light > 0.0f) || !(sums.met < 1.0f))
    return all;
  /* Of all paths so many are to meet bodies, of which the lobe's own draws find some. */
  const float other = (sky->other + sums.gloss) * color + sums.wide;
  const float part = sums.light / (sums.light + other);
  const bool least = sums.light > sums.gloss * color && !(sums.wide > 0.0f);
  const float wanted = least ? pl_maxf(part, WANTED_MIN) : part;
  const bool on_body = vertex->thing >= p->shot->object_count;
  const float most = 1.0f - (on_body ? LOBE_MIN_ON_BODIES : LOBE_MIN);
  const float share = pl_minf((wanted - sums.met) / (1.0f - sums.met), most);
  if (!(share > SHARE_MIN))
    return all;
  out->share = share;
  for (int i = 0; i < out->count; i++)
    out->chance[i] /= sums.light;
  return all;
}

/* Takes the share of mirrors from what bodies and the lobe have; `known`: light of bodies. */
static void share_mirrors(const pl_caustics *caustics, const pl_vertex *vertex, pl_vec3f wo,
                          float known, pl_shine *out) {
  const float light = pl_caustics_at(caustics, vertex, wo, &out->mirrors);
  const float color = pl_luminance(vertex->surface.color);
  if (!(light > 0.0f))
    return;
  const float part = light / (light + known + BY_MESHES * color * caustics->sun / PL_PI_F);
  const float share = pl_minf(part, MIRRORS_MAX);
  if (!(share > SHARE_MIN))
    return;
  out->share = share + (1.0f - share) * out->share;
  out->mirrored = share / out->share;
}

void pl_shine_at(const pl_planetshine *p, const pl_caustics *caustics, const pl_vertex *vertex,
                 pl_vec3f wo, pl_shine *out) {
  const pl_surface *s = &vertex->surface;
  float known = 0.0f;
  out->share = out->mirrored = 0.0f;
  out->count = 0;
  if (s->reflectance->layered && s->lobes.inside)
    return;
  if (p != NULL && p->skies[vertex->thing].count > 0)
    known = share_bodies(p, vertex, wo, out);
  if (caustics != NULL)
    share_mirrors(caustics, vertex, wo, known, out);
}

static float density(const pl_shine *shine, float lobe, float bodies) {
  return (1.0f - shine->share) * lobe + shine->share * bodies;
}

/* Density of drawing to bodies and mirrors; `drawn`: a body whose own density is known, or -1. */
static float bodies_pdf(const pl_shine *shine, pl_vec3f direction, int drawn, float known) {
  float sum = 0.0f;
  for (int i = 0; i < shine->count && shine->mirrored < 1.0f; i++)
    sum += shine->chance[i] * (i == drawn ? known : pl_lune_pdf(&shine->lunes[i], direction));
  if (!(shine->mirrored > 0.0f))
    return sum;
  return (1.0f - shine->mirrored) * sum +
         shine->mirrored * pl_caustics_pdf(&shine->mirrors, direction);
}

float pl_shine_pdf(const pl_shine *shine, const pl_surface *s, pl_vec3f wo, pl_vec3f wi,
                   pl_vec3f direction) {
  const float lobe = s->reflectance->pdf(s, wo, wi);
  if (!(shine->share > 0.0f))
    return lobe;
  return density(shine, lobe, bodies_pdf(shine, direction, -1, 0.0f));
}

static bool sample_lobe(const pl_surface *s, pl_vec3f wo, const float u[2], float choice,
                        pl_shine_draw *out) {
  if (!s->reflectance->sample(s, wo, u, choice, &out->wi, &out->weight, &out->lobe_pdf))
    return false;
  out->pdf = out->lobe_pdf;
  out->direction = pl_vec3f_unit(pl_surface_to_world(s, out->wi));
  const float side = pl_vec3f_dot(out->direction, s->ng);
  return out->wi.z > 0.0f ? side > 0.0f : out->wi.z < 0.0f && side < 0.0f;
}

/* A direction to one of the bodies, or mirrors (-1), by `choice` in [0, 1); a body's own density.
 */
static bool sample_target(const pl_shine *shine, const float u[2], float choice, int *body,
                          pl_vec3f *direction, float *known) {
  *body = -1;
  if (choice < shine->mirrored)
    return pl_caustics_sample(&shine->mirrors, u, choice / shine->mirrored, direction);
  if (shine->mirrored > 0.0f)
    choice = (choice - shine->mirrored) / (1.0f - shine->mirrored);
  int at = 0;
  while (at + 1 < shine->count && choice >= shine->chance[at])
    choice -= shine->chance[at++];
  *body = at;
  return pl_lune_sample(&shine->lunes[at], u, direction, known);
}

static bool sample_set(const pl_shine *shine, const pl_surface *s, pl_vec3f wo, const float u[2],
                       float choice, pl_shine_draw *out) {
  int at;
  float known = 0.0f;
  if (!sample_target(shine, u, choice, &at, &out->direction, &known) ||
      !pl_surface_admits(s, out->direction))
    return false;
  out->wi = pl_surface_to_local(s, out->direction);
  out->lobe_pdf = s->reflectance->pdf(s, wo, out->wi);
  if (!(out->lobe_pdf > 0.0f))
    return false;
  out->pdf = density(shine, out->lobe_pdf, bodies_pdf(shine, out->direction, at, known));
  out->weight = pl_vec3f_scale(s->reflectance->evaluate(s, wo, out->wi), 1.0f / out->pdf);
  return true;
}

bool pl_shine_sample(const pl_shine *shine, const pl_surface *s, pl_vec3f wo, const float u[2],
                     float choice, pl_shine_draw *out) {
  const float share = shine->share;
  out->set = choice < share;
  if (!(share > 0.0f))
    return sample_lobe(s, wo, u, choice, out);
  if (choice < share)
    return sample_set(shine, s, wo, u, choice / share, out);
  if (!sample_lobe(s, wo, u, pl_minf((choice - share) / (1.0f - share), 0x1.fffffep-1f), out))
    return false;
  out->pdf = density(shine, out->lobe_pdf, bodies_pdf(shine, out->direction, -1, 0.0f));
  out->weight = pl_vec3f_scale(out->weight, out->lobe_pdf / out->pdf);
  return true;
}
