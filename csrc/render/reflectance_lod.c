/* The angles in view are sampled on a grid of rays and along the body's outline. */
#include "render/reflectance_lod.h"

#include <string.h>

#include "base/memory.h"
#include "light/sun.h"
#include "shade/reflectance.h"

/* In ascending order of cost; without the body's own law. */
static const pl_reflectance *const cheaper[PL_VIEW_LODS - 1] = {
    &pl_reflectance_lambert, &pl_reflectance_minnaert, &pl_reflectance_lunar_lambert,
    &pl_reflectance_lommel_seeliger, &pl_reflectance_hapke_smooth};

/* Rays of the grid per side; bisection steps to the outline; and factors on the albedo that each
 * point of a body with maps is tried with, for albedos that occur between the points. */
enum { GRID = 12, POINTS = GRID * GRID, STEPS = 16, ALBEDOS = 3, VALUES = 3 * ALBEDOS };
static const float ALBEDO[ALBEDOS] = {1.0f, 0.7f, 1.4f};

/* The body's radiance at a point of the image, by all laws; 0 where it is dark. */
typedef struct law_point {
  bool seen;
  float exact[VALUES], cheap[PL_VIEW_LODS - 1][VALUES];
} law_point;

typedef struct law_samples {
  const pl_snapshot *shot;
  pl_surface_id surface_id;
  pl_detail detail;
  bool mapped;
  double x0, y0, dx, dy; /* pixels: position of the first ray, and spacing of the rays */
  law_point points[POINTS];
  law_point edges[POINTS][2]; /* points of the outline towards the next ray in x and in y */
} law_samples;

static void set3(pl_vec3f v, float scale, float out[3]) {
  out[0] = v.x * scale;
  out[1] = v.y * scale;
  out[2] = v.z * scale;
}

static pl_vec3f brighter(pl_vec3f color, float factor) {
  return pl_vec3f_make(pl_minf(color.x * factor, 1.0f), pl_minf(color.y * factor, 1.0f),
                       pl_minf(color.z * factor, 1.0f));
}

static void evaluate(const law_samples *s, pl_surface *surface, pl_vec3f wo, pl_vec3f wi,
                     float irradiance, law_point *out) {
  const pl_reflectance *own = surface->reflectance;
  const pl_vec3f color = surface->color;
  for (int a = 0; a < ALBEDOS; a++) {
    surface->color = brighter(color, s->mapped ? ALBEDO[a] : 1.0f);
    set3(own->evaluate(surface, wo, wi), irradiance, out->exact + 3 * a);
    for (int k = 0; k < PL_VIEW_LODS - 1; k++)
      set3(cheaper[k]->evaluate(surface, wo, wi), irradiance, out->cheap[k] + 3 * a);
  }
}

/* False if the ray through (u, v) does not hit the body first. */
static bool meets(const law_samples *s, double u, double v, pl_beam *beam, pl_vertex *vertex) {
  *beam = (pl_beam){.direction = pl_snapshot_ray(s->shot, u, v),
                    .spread = (float)(1.0 / s->shot->rays.camera.fx)};
  return pl_vec3_dot(beam->direction, beam->direction) > 0.0 &&
         pl_vertex_meet_bodies(s->shot, beam, vertex) &&
         pl_surface_same(vertex->surface_id, s->surface_id);
}

static void measure(const law_samples *s, double u, double v, law_point *out) {
  pl_beam beam;
  pl_vertex vertex;
  memset(out, 0, sizeof *out);
  if (!meets(s, u, v, &beam, &vertex))
    return;
  out->seen = true;
  pl_vertex_shade(s->shot, &beam, s->detail, &vertex);
  pl_surface *surface = &vertex.surface;
  const pl_sun_view sun = pl_sun_view_at(&s->shot->sun, vertex.position);
  const pl_vec3f view = pl_vec3_to_float(pl_vec3_scale(beam.direction, -1.0));
  if (!pl_surface_admits(surface, sun.direction))
    return;
  evaluate(s, surface, pl_surface_to_local(surface, view),
           pl_surface_to_local(surface, sun.direction), sun.irradiance, out);
}

/* Measures at the body's outline between (u, v), which is on the body, and (u + du, v + dv). */
static void measure_edge(const law_samples *s, double u, double v, double du, double dv,
                         law_point *out) {
  double on = 0.0, off = 1.0;
  for (int i = 0; i < STEPS; i++) {
    pl_beam beam;
    pl_vertex vertex;
    const double middle = 0.5 * (on + off);
    if (meets(s, u + middle * du, v + middle * dv, &beam, &vertex))
      on = middle;
    else
      off = middle;
  }
  measure(s, u + on * du, v + on * dv, out);
}

/* Measures the outline between a point and the next one, if exactly one of them is on the body. */
static void find_edge(law_samples *s, int x, int y, int axis) {
  const double u = s->x0 + x * s->dx, v = s->y0 + y * s->dy;
  const double du = axis == 0 ? s->dx : 0.0, dv = axis == 0 ? 0.0 : s->dy;
  const bool here = s->points[y * GRID + x].seen;
  const bool there = s->points[(y + axis) * GRID + x + 1 - axis].seen;
  law_point *edge = &s->edges[y * GRID + x][axis];
  edge->seen = false;
  if (here && !there)
    measure_edge(s, u, v, du, dv, edge);
  else if (there && !here)
    measure_edge(s, u + du, v + dv, -du, -dv, edge);
}

static void take_samples(law_samples *s) {
  for (int y = 0; y < GRID; y++)
    for (int x = 0; x < GRID; x++)
      measure(s, s->x0 + x * s->dx, s->y0 + y * s->dy, &s->points[y * GRID + x]);
  for (int i = 0; i < POINTS; i++)
    for (int axis = 0; axis < 2; axis++) {
      s->edges[i][axis].seen = false;
      if ((axis == 0 ? i % GRID : i / GRID) + 1 < GRID)
        find_edge(s, i % GRID, i / GRID, axis);
    }
}

/* Sets the part of the image that may show the body: around its centre, or the whole image. */
static void set_window(const pl_shot_body *body, law_samples *s) {
  const pl_camera *camera = &s->shot->rays.camera;
  const pl_vec3 c = pl_mat3_mul_vec_t(s->shot->camera_to_root, body->center);
  const double distance = pl_vec3_norm(c), sine = body->radius_m / distance;
  double low[2] = {-0.5, -0.5}, high[2] = {camera->width - 0.5, camera->height - 0.5};
  if (sine < 0.2 && c.z > 0.9 * distance) { /* lenses change this by less than a third */
    const double focal[2] = {camera->fx, camera->fy};
    const double middle[2] = {camera->cx + camera->fx * c.x / c.z + camera->skew * c.y / c.z,
                              camera->cy + camera->fy * c.y / c.z};
    for (int k = 0; k < 2; k++) {
      const double reach = 1.4 * focal[k] * sine / (c.z / distance) + 1.0;
      low[k] = fmax(low[k], middle[k] - reach);
      high[k] = fmin(high[k], middle[k] + reach);
    }
  }
  s->x0 = low[0];
  s->y0 = low[1];
  s->dx = (high[0] - low[0]) / (GRID - 1);
  s->dy = (high[1] - low[1]) / (GRID - 1);
}

/* The i-th point of the grid, or of the outline after those. */
static const law_point *point_of(const law_samples *s, size_t i) {
  return i < POINTS ? &s->points[i] : &s->edges[(i - POINTS) / 2][(i - POINTS) % 2];
}
enum { ALL = 3 * POINTS };

/* The least-squares factor on the cheaper law, for each band. */
static void fit(const law_samples *s, int law, float factor[3]) {
  for (int band = 0; band < 3; band++) {
    double both = 0.0, square = 0.0;
    for (size_t i = 0; i < ALL; i++) {
      const law_point *p = point_of(s, i);
      for (int k = band; p->seen && k < VALUES; k += 3) {
        both += (double)p->exact[k] * (double)p->cheap[law][k];
        square += (double)p->cheap[law][k] * (double)p->cheap[law][k];
      }
    }
    factor[band] = square > 0.0 ? (float)(both / square) : 0.0f;
  }
}

static float off_by(const law_point *p, int law, const float factor[3], int k) {
  return factor[k % 3] * p->cheap[law][k] - p->exact[k];
}

/* Error of a law at a point, plus the largest change of the error to a neighbour, because the
 * error may have its extremum in between. */
static float margin(const law_samples *s, size_t i, int law, const float factor[3], int k) {
  const law_point *p = point_of(s, i);
  const float here = off_by(p, law, factor, k);
  float change = 0.0f;
  const size_t x = i % GRID, y = i / GRID;
  const law_point *near[4] = {NULL, NULL, NULL, NULL};
  if (i < POINTS) {
    near[0] = x + 1 < GRID ? &s->points[i + 1] : NULL;
    near[1] = y + 1 < GRID ? &s->points[i + GRID] : NULL;
    near[2] = x > 0 ? &s->points[i - 1] : NULL;
    near[3] = y > 0 ? &s->points[i - GRID] : NULL;
  }
  for (int n = 0; n < 4; n++)
    if (near[n] != NULL && near[n]->seen)
      change = pl_maxf(change, fabsf(off_by(near[n], law, factor, k) - here));
  return fabsf(here) + change;
}

static pl_status summarise(const law_samples *s, pl_arena *arena, pl_view_lods **lods) {
  size_t count = 0;
  for (size_t i = 0; i < ALL; i++)
    count += point_of(s, i)->seen ? VALUES : 0;
  float *values = pl_arena_alloc(arena, count * PL_VIEW_LODS + 1, sizeof *values);
  *lods = pl_arena_alloc(arena, 1, sizeof **lods);
  if (values == NULL || *lods == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for photometric laws");
  (*lods)->count = count;
  for (int law = 0; law < PL_VIEW_LODS - 1; law++) {
    float *off = values + ((size_t)law + 1) * count;
    float *factor = (*lods)->factor[law];
    (*lods)->off[law] = off;
    fit(s, law, factor);
    for (size_t i = 0; i < ALL; i++)
      for (int k = 0; point_of(s, i)->seen && k < VALUES; k++)
        *off++ = margin(s, i, law, factor, k);
  }
  (*lods)->exact = values;
  for (size_t i = 0; i < ALL; i++)
    for (int k = 0; point_of(s, i)->seen && k < VALUES; k++)
      *values++ = point_of(s, i)->exact[k];
  return PL_OK;
}

/* Whether enough points of the grid are lit. Otherwise the errors between its rays are unknown. */
static bool is_covered(const law_samples *s) {
  const int enough = 16;
  int lit = 0;
  for (int i = 0; i < POINTS; i++) {
    float light = 0.0f;
    for (int k = 0; k < VALUES; k++)
      light += s->points[i].exact[k];
    lit += light > 0.0f;
  }
  return lit >= enough;
}

/* Whether cheaper laws may replace the body's own. */
static bool has_others(const pl_shot_body *body) {
  return body->in_frame && pl_shot_is_smooth(body) && body->body->graph == NULL &&
         !pl_ground_has_relief(&body->body->ground) &&
         body->body->reflectance == &pl_reflectance_hapke;
}

pl_status pl_reflectance_lod_fit(const pl_snapshot *shot, pl_detail detail, pl_arena *arena,
                                 pl_view *view) {
  pl_view_entity *entities = NULL;
  for (size_t i = 0; i < shot->body_count; i++) {
    const pl_shot_body *body = &shot->bodies[i];
    if (!has_others(body))
      continue;
    if (entities == NULL &&
        (entities = pl_arena_alloc(arena, view->entity_count, sizeof *entities)))
      memcpy(entities, view->entities, view->entity_count * sizeof *entities);
    law_samples *samples = pl_arena_alloc(arena, 1, sizeof *samples);
    if (entities == NULL || samples == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for photometric laws");
    samples->shot = shot;
    samples->detail = detail;
    samples->surface_id = pl_surface_of_body(i);
    samples->mapped =
        body->body->map != NULL || body->body->regolith_map != NULL ||
        (body->body->terrain != NULL && (pl_terrain_albedo(body->body->terrain)->count > 0 ||
                                         pl_terrain_has_textures(body->body->terrain) ||
                                         pl_terrain_tracks(body->body->terrain) != NULL));
    set_window(body, samples);
    take_samples(samples);
    if (!is_covered(samples))
      continue;
    pl_view_lods *lods;
    PL_TRY(summarise(samples, arena, &lods));
    entities[pl_shot_slot(shot, samples->surface_id)].lods = lods;
    view->entities = entities;
  }
  return PL_OK;
}

void pl_reflectance_lod_apply(const pl_snapshot *shot, const pl_render_settings *settings,
                              pl_vertex *vertex) {
  if (settings->lods_down == 0 || !pl_surface_is_ellipsoid(vertex->surface_id))
    return;
  const pl_shot_body *body = pl_shot_body_of(shot, vertex->surface_id);
  if (body->lods == NULL || settings->emitters_on_bodies ||
      (settings->effects.body_bounces && body->bounced && body->senders == NULL))
    return;
  const int law = PL_VIEW_LODS - 1 - settings->lods_down;
  const float *factor = body->lods->factor[law];
  pl_surface *s = &vertex->surface;
  s->reflectance = cheaper[law];
  if (s->reflectance->photometric)
    for (int k = 0; k < 3; k++)
      s->regolith.excess[k] = factor[k] - 1.0f;
  else
    s->color = pl_vec3f_mul(s->color, pl_vec3f_make(factor[0], factor[1], factor[2]));
}
