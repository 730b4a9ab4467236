/* Prefiltering: pixels whose colour needs no sampling, on a body away from terminator and shadows.
 * A Lambert surface has a closed form if the sun's disc is entirely above (or below) the horizon;
 * photometric laws away from opposition nearly have one. The map is filtered over the pixel's
 * footprint, so that shading once gives the pixel's mean. */
#include <string.h>

#include "base/work.h"
#include "light/sun.h"
#include "math/color.h"
#include "render/body_light.h"
#include "render/reflectance_lod.h"
#include "render/path.h"
#include "shade/water.h"

/* The whole disc clears the horizon if the sun is higher than its radius times this. The margin is
 * for rounding and for the change of the normal across a pixel. */
static const float HORIZON_MARGIN = 1.5f;
/* The same for bodies above the horizon: normals are in single precision. */
static const double HORIZON_ROUNDING = 1e-5;
/* Towards the limb a pixel's footprint grows until one value no longer is its mean. Minimum cosine
 * of the view angle, and maximum length of the footprint over the body's radius; it is shorter
 * where air, relief or water vary faster than plain ground. */
static const float COSINE_MIN = 0.15f, ARC_MAX_RAD = 0.03f, ARC_MAX_VARIED_RAD = 0.01f;

/* Whether one of the spheres of a tree, except that of an item, may hide a part of the sun. */
static bool any_before_sun(const pl_sphere_tree *tree, uint32_t but, const pl_vertex *vertex,
                           const pl_sun_view *sun, double margin_m) {
  size_t k = 0;
  uint32_t item;
  while ((item = pl_sun_next_sphere(sun, tree, vertex->position, margin_m, &k)) != PL_NO_ITEM)
    if (item != but)
      return true;
  return false;
}

/* Whether the point of a body may be in or near a shadow. */
static bool near_shadow(const pl_snapshot *shot, const pl_vertex *vertex, const pl_sun_view *sun,
                        double margin_m) {
  const uint32_t own = pl_surface_index(vertex->surface_id);
  return any_before_sun(&shot->object_tree, PL_NO_ITEM, vertex, sun, margin_m) ||
         any_before_sun(&shot->body_tree, own, vertex, sun, margin_m);
}

/* Whether a volume may shadow a part of the pixel. */
static bool near_volume(const pl_path_context *context, const pl_vertex *vertex,
                        const pl_sun_view *sun, double margin_m) {
  const pl_snapshot *shot = context->shot;
  for (size_t i = 0; context->settings->media != NULL && i < shot->volume_count; i++)
    if (pl_sun_behind_sphere(sun, vertex->position, shot->volumes[i].center,
                             shot->volumes[i].radius_m + margin_m))
      return true;
  return false;
}

/* Whether the body is a Lambert surface of which only the map varies. The colours of a varying
 * graph are at best functions of filtered patterns, whose value at the centre is not the pixel's
 * mean. */
static bool is_plain(const pl_body *body) {
  if (body->graph == NULL)
    return body->reflectance == &pl_reflectance_lambert;
  return pl_graph_reflectance(body->graph) == &pl_reflectance_lambert &&
         pl_graph_is_uniform(body->graph);
}

/* Whether the body follows a photometric law that is nearly linear over the sun's disc here. If the
 * disc is replaced by its centre, opposition surges, however narrow, and the lobes of b up to 0.6
 * change by rho^2/8 of their second derivative, which is at most rho^2/(4 g^2): 3e-4 at this angle
 * for the sun at 1 AU. */
static const float PHASE_MIN_RAD = 0.15f;
static bool is_calm(const pl_body *body, pl_vec3f toward, const pl_sun_view *sun) {
  if (body->graph != NULL || !body->reflectance->photometric || sun->sin_radius > 0.01f)
    return false;
  const float cosine = -pl_vec3f_dot(toward, sun->direction); /* cosine of the phase angle */
  return fabsf(cosine) < cosf(PHASE_MIN_RAD);
}

/* Sunlight that the shaded body reflects, W m-2 sr-1. */
static pl_vec3f reflected(const pl_surface *s, pl_vec3f toward, const pl_sun_view *sun,
                          float height) {
  if (s->reflectance == &pl_reflectance_lambert)
    return pl_vec3f_scale(s->color, (height > 0.0f ? height * sun->irradiance : 0.0f) / PL_PI_F);
  if (!(height > 0.0f))
    return (pl_vec3f){0.0f, 0.0f, 0.0f};
  const pl_vec3f wo = pl_surface_to_local(s, pl_vec3f_scale(toward, -1.0f));
  const pl_vec3f wi = pl_surface_to_local(s, sun->direction);
  return pl_vec3f_scale(s->reflectance->evaluate(s, wo, wi), sun->irradiance);
}

/* Relief and water vary within a pixel. If the sun is this high above the surface, no slope within
 * the pixel faces away from it. Over waves with at least the slopes of a calm sea, a small sun is
 * replaced by its centre: the relative error is rho^2/(2 alpha^2), 4e-3 of the glint for the sun at
 * 1 AU. */
static const float HEIGHT_OVER_RELIEF = 0.3f, WAVES_MIN = 0.05f;
static bool is_even(const pl_surface *s, const pl_sun_view *sun, float height) {
  if (s->reflectance == &pl_reflectance_water &&
      !(s->alpha > WAVES_MIN && sun->sin_radius < 0.1f * s->alpha))
    return false;
  const bool bent = pl_vec3f_dot(s->n, s->ng) < 1.0f - 1e-6f;
  return !bent || height < 0.0f ||
         (height > HEIGHT_OVER_RELIEF && pl_vec3f_dot(sun->direction, s->n) > HEIGHT_OVER_RELIEF);
}

/* Whether a sphere rises above the horizon of a point. */
static bool rises(pl_vec3 center, double radius_m, const pl_vertex *vertex) {
  const pl_vec3 up = pl_vec3f_to_double(vertex->ng);
  return pl_vec3_dot(up, pl_vec3_sub(center, vertex->position)) >
         -radius_m * (1.0 + HORIZON_ROUNDING);
}

/* Radius of a body with its clouds and rings, m. */
static double reach_of(const pl_shot_body *body) {
  const double rings = body->body->rings != NULL ? pl_rings_outer_m(body->body->rings) : 0.0;
  return fmax(body->radius_m + body->state->clouds.altitude_m, rings);
}

/* Whether anything that may noticeably light a body is above the horizon of a point on it. */
static bool is_lit_by_others(const pl_path_context *context, const pl_vertex *vertex,
                             pl_vec3f toward) {
  const pl_snapshot *shot = context->shot;
  const uint32_t own = pl_surface_index(vertex->surface_id);
  if (!context->settings->effects.body_bounces || !pl_body_lit_by_others(shot, vertex, toward))
    return false;
  for (size_t i = 0; i < shot->body_count; i++)
    if (i != own && rises(shot->bodies[i].center, reach_of(&shot->bodies[i]), vertex))
      return true;
  for (size_t i = 0; i < shot->volume_count; i++)
    if (rises(shot->volumes[i].center, shot->volumes[i].radius_m, vertex))
      return true;
  return shot->bodies[own].near_meshes;
}

/* Whether the body can be prefiltered in the tile at all. */
static bool may_prefilter(const pl_path_context *context, const pl_shot_body *body) {
  const pl_render_settings *settings = context->settings;
  if ((body->subpixel && !settings->see_subpixel) || !context->sharp || context->rough_media ||
      settings->exact)
    return false;
  if (!is_plain(body->body) && !body->body->reflectance->photometric)
    return false;
  return !settings->emitters_on_bodies &&
         !(settings->effects.body_bounces && body->bounced && body->senders == NULL &&
           (!context->filters_irradiance || settings->air != NULL));
}

/* Whether one value is the mean over the footprint of a point, apart from the map. */
static bool spans_little(const pl_path_context *context, const pl_shot_body *body,
                         const pl_vertex *vertex, pl_vec3f toward, const pl_sun_view *sun,
                         double *footprint_m) {
  const float cosine = fabsf(pl_vec3f_dot(toward, vertex->ng));
  const pl_vec3 radii = body->state->radii_m;
  *footprint_m = vertex->t * context->pixel_rad / pl_maxf(cosine, COSINE_MIN);
  const float arc = (float)(*footprint_m / fmin(radii.x, fmin(radii.y, radii.z)));
  const pl_body *kind = body->body;
  const bool varied = kind->air != NULL || !pl_ground_is_plain(&kind->ground);
  const float longest = varied ? ARC_MAX_VARIED_RAD : ARC_MAX_RAD;
  if (cosine < COSINE_MIN || arc > longest)
    return false;
  const float height = pl_vec3f_dot(sun->direction, vertex->ng);
  if (fabsf(height) < HORIZON_MARGIN * sun->sin_radius + arc)
    return false;
  return is_plain(body->body) || is_calm(body->body, toward, sun);
}

/* Error of a pixel's value, in DN, from detail of media finer than the beam, in front of `light`: a
 * medium adds its own radiance and blocks part of the light. Air between media and surface is
 * ignored: it attenuates the light as it adds its own. */
static float unsure_dn(const pl_render_settings *settings, const pl_medium_list *list,
                       pl_vec3f light, pl_vec3f seen) {
  float unsure = 0.0f;
  for (size_t i = 0; i < list->count; i++) {
    const pl_medium_crossing *at = &list->items[i];
    const float kept = pl_luminance(light) - pl_luminance(pl_vec3f_mul(light, at->transmittance));
    unsure += at->unsure * fabsf(pl_luminance(at->radiance) - kept);
  }
  return unsure > 0.0f ? pl_path_error_dn(settings, pl_luminance(seen), unsure) : 0.0f;
}

/* Crossings of a pixel's beam with media in front of a vertex, in parts x parts beams. */
static void cross_media(const pl_path_context *context, uint32_t pixel, const pl_vertex *vertex,
                        int parts, pl_medium_list *out) {
  const pl_snapshot *shot = context->shot;
  const double x = context->tile.x0 + (int)(pixel % PL_TILE_SIDE);
  const double y = context->tile.y0 + (int)(pixel / PL_TILE_SIDE);
  const pl_beam beam = {.direction = pl_snapshot_ray(shot, x, y),
                        .spread = (float)context->pixel_rad};
  pl_medium_ray ray = {
      .beam = &beam, .t_max = vertex->t, .camera = true, .from_body = PL_NO_BODY, .parts = parts};
  if (parts > 1) {
    ray.pixel[0] =
        pl_vec3_sub(pl_snapshot_ray(shot, x + 0.5, y), pl_snapshot_ray(shot, x - 0.5, y));
    ray.pixel[1] =
        pl_vec3_sub(pl_snapshot_ray(shot, x, y + 0.5), pl_snapshot_ray(shot, x, y - 0.5));
  }
  pl_media_cross(context->settings->media, shot, &ray, out);
}

/* Limit of the standard error that clouds finer than a pixel may leave, in tolerances: the same as
 * for noise (QUIET in adaptive_sampling.c). */
static const float HIDDEN = 3.0f;

/* Light of a point as the camera sees it through air and media. If a beam leaves too large an error
 * from the detail of clouds, narrower ones are used: the error of n x n beams falls as n^-3. False
 * if the error stays too large. */
static bool see_through(const pl_path_context *context, uint32_t pixel, const pl_vertex *vertex,
                        pl_vec3f light, pl_tile_buffers *b) {
  enum { PARTS_MOST = 4 };
  const pl_render_settings *settings = context->settings;
  const float allowed = HIDDEN * settings->noise_dn;
  pl_medium_list list;
  list.count = 0;
  for (int parts = 1; parts <= PARTS_MOST;) {
    if (context->media)
      cross_media(context, pixel, vertex, parts, &list);
    b->prefiltered[pixel] = settings->air != NULL ? pl_air_seen(context, pixel, light, &list, b)
                                                  : pl_media_seen(&list, light);
    const float off = unsure_dn(settings, &list, light, b->prefiltered[pixel]);
    if (!(off > allowed))
      return true;
    const int wanted = (int)ceilf((float)parts * cbrtf(pl_minf(off / allowed, 1e3f)));
    parts = parts < PARTS_MOST && wanted > PARTS_MOST ? PARTS_MOST : wanted;
  }
  return false;
}

/* The prefiltered light of a shaded point as the camera sees it; false if it must be sampled. */
static bool seen_light(const pl_path_context *context, uint32_t pixel, const pl_vertex *vertex,
                       const pl_sun_view *sun, pl_vec3f toward, double footprint_m,
                       pl_tile_buffers *b) {
  const pl_render_settings *settings = context->settings;
  const float height = pl_vec3f_dot(sun->direction, vertex->ng);
  const float over = height > 0.0f ? pl_vec3f_dot(sun->direction, vertex->surface.n) : height;
  pl_vec3f light = reflected(&vertex->surface, toward, sun, over);
  if (settings->media != NULL)
    light = pl_vec3f_mul(light, pl_media_toward_sun(settings->media, context->shot,
                                                    vertex->position, sun, (float)footprint_m));
  if (settings->air != NULL)
    light = pl_air_ground_light(context, pixel, vertex, light, (float)footprint_m, b);
  if (settings->effects.emitted_light)
    light = pl_vec3f_add(light, vertex->surface.emission);
  return see_through(context, pixel, vertex, light, b);
}

/* Computes the mean radiance of the pixel from the body at its centre; false if it must be sampled.
 */
static bool prefilter_pixel(const pl_path_context *context, uint32_t pixel, pl_tile_buffers *b) {
  const pl_snapshot *shot = context->shot;
  const pl_surface_id id = b->points[pixel].surface_id;
  if (!pl_surface_is_ellipsoid(id))
    return false;
  const pl_shot_body *body = pl_shot_body_of(shot, id);
  const pl_render_settings *settings = context->settings;
  if (!may_prefilter(context, body))
    return false;
  pl_vertex vertex = pl_point_vertex(&b->points[pixel]);
  const pl_vec3 direction = {b->directions[0][pixel], b->directions[1][pixel],
                             b->directions[2][pixel]};
  const pl_vec3f toward = pl_vec3_to_float(direction);
  const pl_sun_view sun = pl_sun_view_at(&shot->sun, vertex.position);
  double footprint_m;
  if (!spans_little(context, body, &vertex, toward, &sun, &footprint_m) ||
      (settings->effects.cast_shadows && body->shadowed &&
       near_shadow(shot, &vertex, &sun, footprint_m)) ||
      near_volume(context, &vertex, &sun, footprint_m))
    return false;
  const pl_beam beam = {.direction = direction, .spread = (float)context->pixel_rad};
  pl_detail detail = settings->detail;
  detail.box = true;
  pl_work_add(PL_WORK_closed, 1);
  pl_vertex_shade(shot, &beam, detail, &vertex);
  pl_reflectance_lod_apply(shot, settings, &vertex);
  if (!is_even(&vertex.surface, &sun, pl_vec3f_dot(sun.direction, vertex.ng)))
    return false;
  b->lit[pixel] = is_lit_by_others(context, &vertex, toward);
  /* light on a part of a body is not filtered */
  if (b->lit[pixel] && (body->senders != NULL || !context->filters_irradiance))
    return false;
  if (b->lit[pixel] && context->media) /* the indirect light would have to be attenuated by them */
    return false;
  if (b->lit[pixel])
    b->prefiltered_surface[pixel] = vertex.surface;
  return seen_light(context, pixel, &vertex, &sun, toward, footprint_m, b);
}

/* A tile with a border of one pixel. */
enum { BORDERED = PL_TILE_SIDE + 2 };

/* Whether a pixel of the tile, or one of its neighbours, is outside the coverage of meshes. */
static bool leaves_coverage(const pl_path_context *context, int x, int y) {
  const pl_tile tile = context->tile;
  for (int v = y > 0 ? y - 1 : 0; v <= y + 1 && v < tile.height; v++)
    for (int u = x > 0 ? x - 1 : 0; u <= x + 1 && u < tile.width; u++)
      if (!pl_coverage_pixel(context->coverage, tile.x0 + u, tile.y0 + v))
        return true;
  return false;
}

/* Stands for the surface at a position where the lens has no ray; it equals no other. */
static const pl_surface_id no_ray = {UINT32_MAX - 1};

/* The body at a pixel's centre, in the tile or next to it; also behind a mesh, if a neighbour
 * without meshes needs it. Where the lens has no ray, a value that differs from all in the tile. */
static pl_surface_id body_at(const pl_path_context *context, const pl_tile_buffers *b, int x,
                             int y) {
  const pl_tile tile = context->tile;
  if (x >= 0 && y >= 0 && x < tile.width && y < tile.height) {
    const pl_surface_id id = b->points[y * PL_TILE_SIDE + x].surface_id;
    if (!pl_surface_is_mesh(id) || !leaves_coverage(context, x, y))
      return id;
  }
  pl_hit hit;
  const pl_vec3 direction = pl_snapshot_ray(context->shot, tile.x0 + x, tile.y0 + y);
  if (pl_vec3_norm(direction) == 0.0)
    return no_ray;
  const pl_ray ray = {.t_max = INFINITY, .direction = direction, .skip_body = PL_NO_BODY};
  pl_tracer_closest(context->tracer, &ray, &hit, 1, false, false);
  return hit.surface_id;
}

/* Whether a pixel lies on one body: if its centre and those around it do, since the body's outline
 * is convex. Likewise whether it lies on none: a body that enters the pixel covers one of these
 * centres. Its outline is a union of discs of its smallest radius of curvature. A disc that extends
 * half a pixel between two centres and covers neither is smaller than a pixel: over a chord of one
 * pixel the sagitta is half a pixel only if the radius is. For bodies whose radius of curvature is
 * less than a few pixels see find_narrow. */
static void compare_centres(const pl_surface_id at[BORDERED][BORDERED], pl_tile tile,
                            bool covered[PL_TILE_PIXELS]) {
  bool row[BORDERED][PL_TILE_SIDE];
  for (int y = 0; y < tile.height + 2; y++)
    for (int x = 0; x < tile.width; x++)
      row[y][x] = pl_surface_same(at[y][x], at[y][x + 1]) & pl_surface_same(at[y][x], at[y][x + 2]);
  for (int y = 0; y < tile.height; y++)
    for (int x = 0; x < tile.width; x++) {
      const bool column =
          pl_surface_same(at[y][x], at[y + 1][x]) & pl_surface_same(at[y][x], at[y + 2][x]);
      covered[y * PL_TILE_SIDE + x] = row[y][x] & row[y + 1][x] & row[y + 2][x] & column;
    }
}

static void cover_pixels(const pl_path_context *context, const pl_tile_buffers *b,
                         bool covered[PL_TILE_PIXELS]) {
  pl_surface_id at[BORDERED][BORDERED];
  for (int y = 0; y < context->tile.height + 2; y++)
    for (int x = 0; x < context->tile.width + 2; x++)
      at[y][x] = body_at(context, b, x - 1, y - 1);
  compare_centres(at, context->tile, covered);
  for (int i = 0; i < PL_TILE_PIXELS; i++)
    covered[i] = covered[i] && !b->narrow[i];
}

/* Bodies up to this size, in pixels, may lie between centres, and between samples. So may the tips
 * of longer ones that are as sharply curved. */
static const double NARROW_PX = 5.0;

/* The smallest radius of curvature of an ellipsoid is about b^2/a, b its shortest and a its longest
 * semi-axis. */
static bool is_narrow(const pl_shot_body *body, double pixel_m) {
  const pl_vec3 radii = body->state->radii_m;
  const double least = fmin(radii.x, fmin(radii.y, radii.z));
  return pl_shot_is_smooth(body) &&
         (body->subpixel || 2.0 * least * least < NARROW_PX * pixel_m * body->radius_m);
}

/* Whether a narrow body may touch what a pixel's centre hits, or hide it. The light of sub-pixel
 * bodies is added to the sky later, and the sky behind them is as black as they are. */
static bool may_hide(const pl_path_context *context, const pl_shot_body *body,
                     const pl_point *point) {
  const pl_render_settings *settings = context->settings;
  if (pl_surface_is_none(point->surface_id))
    return !body->subpixel || settings->see_subpixel || settings->backdrop != NULL;
  return point->t > pl_vec3_norm(body->center) - body->radius_m;
}

/* Range of a tile's pixels along an axis that lie nearer than `reach` to `at`. */
static void reached(double at, double reach, int first, int count, int range[2]) {
  range[0] = (int)fmax(0.0, fmin(count, floor(at - reach) - first));
  range[1] = (int)fmax(0.0, fmin(count, ceil(at + reach) + 1.0 - first));
}

/* Marks the pixels where a narrow body may be in front of the hit of the centre. */
static void find_narrow(const pl_path_context *context, pl_tile_buffers *b) {
  const pl_snapshot *shot = context->shot;
  memset(b->narrow, 0, sizeof b->narrow);
  if (!shot->rays.kind->projects) { /* it may be anywhere */
    memset(b->narrow, 1, sizeof b->narrow);
    return;
  }
  for (size_t i = 0; i < shot->body_count; i++) {
    const pl_shot_body *body = &shot->bodies[i];
    const pl_vec3 seen = pl_mat3_mul_vec_t(shot->camera_to_root, body->center);
    const double pixel_m = context->pixel_rad * pl_vec3_norm(body->center);
    double at[2];
    if (!is_narrow(body, pixel_m) || !pl_camera_project(&shot->rays.camera, seen, at))
      continue;
    const double reach = fmax(0.5 * NARROW_PX, body->radius_m / pixel_m) + 1.0;
    int xs[2], ys[2];
    reached(at[0], reach, context->tile.x0, context->tile.width, xs);
    reached(at[1], reach, context->tile.y0, context->tile.height, ys);
    for (int y = ys[0]; y < ys[1]; y++)
      for (int x = xs[0]; x < xs[1]; x++) {
        const int pixel = y * PL_TILE_SIDE + x;
        const double off_x = context->tile.x0 + x - at[0], off_y = context->tile.y0 + y - at[1];
        if (fabs(off_x) < reach && fabs(off_y) < reach &&
            may_hide(context, body, &b->points[pixel]))
          b->narrow[pixel] = true;
      }
  }
}

/* Whether a pixel outside the coverage of meshes sees only the background: no body covers it. For a
 * slice, not all centres are known. */
static bool is_sky(const pl_path_context *context, uint32_t pixel, bool covered,
                   const pl_tile_buffers *b) {
  if (context->sun || context->air || context->media)
    return false;
  return !context->bodies || (covered && context->sharp && context->settings->slice == NULL &&
                              pl_surface_is_none(b->points[pixel].surface_id));
}

/* Decides how a pixel outside the coverage of meshes is rendered; true if its radiance is known. */
static bool finish_pixel(const pl_path_context *context, uint32_t pixel, bool covered,
                         pl_tile_buffers *b) {
  const bool sky = is_sky(context, pixel, covered, b);
  const pl_vec3f nothing = {0.0f, 0.0f, 0.0f};
  const pl_vec3f behind = context->settings->backdrop != NULL ? b->backdrop[pixel] : nothing;
  if (context->air && !context->media && !context->settings->exact &&
      pl_air_alone(context, pixel, behind, &b->radiance[pixel], b)) {
    b->counts[pixel] = 1;
    return true;
  }
  const pl_surface_id id = b->prefiltered_id[pixel];
  const bool prefiltered = covered && !pl_surface_is_none(id);
  b->single[pixel] = prefiltered && b->lit[pixel];
  if (!sky && (!prefiltered || b->single[pixel]))
    return false;
  b->counts[pixel] = 1;
  b->radiance[pixel] = sky ? behind : b->prefiltered[pixel];
  return true;
}

static void reset_pixel(uint32_t pixel, pl_tile_buffers *b) {
  b->counts[pixel] = 0;
  b->single[pixel] = false;
  b->followed[pixel] = 0;
  b->square[pixel] = 0.0f;
  b->sample[pixel] = b->filtered[pixel] = (pl_vec3f){0.0f, 0.0f, 0.0f};
  if (b->patches != NULL)
    b->patches[pixel].count = 0;
}

/* Appends a pixel to the active ones; those that may see a mesh come first. */
static void activate(uint32_t pixel, bool mesh, pl_tile_buffers *b) {
  b->active[b->active_count++] = pixel;
  if (!mesh)
    return;
  b->active[b->active_count - 1] = b->active[b->active_meshes];
  b->active[b->active_meshes++] = pixel;
}

/* Largest difference of prefiltered luminance to the neighbours of the tile whose centres show the
 * same body. */
static float uneven_at(const pl_path_context *context, uint32_t pixel, const pl_tile_buffers *b) {
  static const int sides[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  const int x = (int)(pixel % PL_TILE_SIDE), y = (int)(pixel / PL_TILE_SIDE);
  const float own = pl_luminance(b->prefiltered[pixel]);
  float most = 0.0f;
  for (int k = 0; k < 4; k++) {
    const int u = x + sides[k][0], v = y + sides[k][1];
    if (u < 0 || v < 0 || u >= context->tile.width || v >= context->tile.height)
      continue;
    const uint32_t other = (uint32_t)(v * PL_TILE_SIDE + u);
    if (pl_surface_same(b->prefiltered_id[other], b->prefiltered_id[pixel]))
      most = pl_maxf(most, fabsf(pl_luminance(b->prefiltered[other]) - own));
  }
  return most;
}

/* Has every sample shaded in pixels of which a mesh may hide a part, where neighbours tell
 * that the body's light varies: the mean over the part that is seen is not that over the pixel. */
static void refuse_parts(const pl_path_context *context, pl_tile_buffers *b) {
  const pl_render_settings *settings = context->settings;
  bool refused[PL_TILE_PIXELS] = {false};
  for (size_t i = 0; i < b->active_meshes; i++) {
    const uint32_t pixel = b->active[i];
    if (b->single[pixel] || pl_surface_is_none(b->prefiltered_id[pixel]))
      continue;
    const float seen = pl_luminance(b->prefiltered[pixel]);
    /* half of it, as the parts of a pixel are half a pixel from its centre at most */
    refused[pixel] =
        pl_path_error_dn(settings, seen, 0.5f * uneven_at(context, pixel, b)) > settings->noise_dn;
  }
  for (size_t i = 0; i < b->active_meshes; i++)
    if (refused[b->active[i]])
      b->prefiltered_id[b->active[i]] = PL_NO_SURFACE;
}

void pl_path_prefilter(const pl_path_context *context, pl_tile_buffers *b) {
  /* If few pixels have a sample in the slice, tracing them is cheaper than testing all centres. */
  const pl_slice *slice = context->settings->slice;
  const bool sparse = slice != NULL && slice->count > context->settings->samples;
  bool covered[PL_TILE_PIXELS] = {false};
  find_narrow(context, b);
  if (context->bodies && !context->sun && !sparse)
    cover_pixels(context, b, covered);
  b->active_count = b->active_meshes = 0;
  for (uint32_t i = 0; i < PL_TILE_PIXELS; i++) {
    const uint32_t pixel = pl_tile_pixel(i);
    if (!pl_tile_has(context->tile, pixel))
      continue;
    const bool mesh =
        pl_coverage_pixel(context->coverage, context->tile.x0 + (int)(pixel % PL_TILE_SIDE),
                          context->tile.y0 + (int)(pixel / PL_TILE_SIDE));
    const bool prefiltered = prefilter_pixel(context, pixel, b);
    b->prefiltered_id[pixel] = prefiltered ? b->points[pixel].surface_id : PL_NO_SURFACE;
    reset_pixel(pixel, b);
    if (mesh || !finish_pixel(context, pixel, covered[pixel], b))
      activate(pixel, mesh, b);
  }
  refuse_parts(context, b);
}
