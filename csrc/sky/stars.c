/* Stars in the frame: aberration, projection, and contribution to pixels. */
#include "sky/stars.h"

#include <stdlib.h>
#include <string.h>

/* Urban and Seidelmann (eds.), Explanatory Supplement to the Astronomical Almanac, 3rd ed. 2013,
 * equation 7.40. */
pl_vec3 pl_star_aberrate(pl_vec3 direction, pl_vec3 beta) {
  const double b2 = pl_vec3_dot(beta, beta), along = pl_vec3_dot(direction, beta);
  const double inverse_gamma = sqrt(1.0 - b2);
  const pl_vec3 sum = pl_vec3_madd(pl_vec3_scale(direction, inverse_gamma),
                                   1.0 + along / (1.0 + inverse_gamma), beta);
  return pl_vec3_unit(pl_vec3_scale(sum, 1.0 / (1.0 + along)));
}

/* Solid angle of a spherical triangle of unit vectors: van Oosterom and Strackee 1983, written with
 * differences to keep precision for small triangles. */
static double triangle(pl_vec3 a, pl_vec3 b, pl_vec3 c) {
  const pl_vec3 across = pl_vec3_cross(pl_vec3_sub(b, a), pl_vec3_sub(c, a));
  const double volume = fabs(pl_vec3_dot(a, across));
  return 2.0 * atan2(volume, 1.0 + pl_vec3_dot(a, b) + pl_vec3_dot(b, c) + pl_vec3_dot(c, a));
}

static double quadrangle(pl_vec3 a, pl_vec3 b, pl_vec3 c, pl_vec3 d) {
  const pl_vec3 corners[4] = {a, b, c, d};
  for (int i = 0; i < 4; i++)
    if (pl_vec3_dot(corners[i], corners[i]) == 0.0)
      return 0.0;
  return triangle(a, b, c) + triangle(a, c, d);
}

static pl_vec3 corner(const pl_camera *camera, int x, int y) {
  return pl_vec3_unit(pl_camera_ray(camera, x - 0.5, y - 0.5));
}

double pl_pixel_solid_angle(const pl_camera *camera, int x, int y) {
  return quadrangle(corner(camera, x, y), corner(camera, x + 1, y), corner(camera, x + 1, y + 1),
                    corner(camera, x, y + 1));
}

static bool in_image(const pl_camera *camera, int x, int y) {
  return x >= 0 && y >= 0 && x < camera->width && y < camera->height;
}

/* True if any pixel of the image may receive light of a star at (u, v). */
static bool reaches_image(const pl_camera *camera, double u, double v) {
  return u > -1.0 && v > -1.0 && u < camera->width && v < camera->height;
}

void pl_star_splat_at(const pl_camera *camera, const pl_star *star, double u, double v,
                      pl_star_splat *out) {
  out->count = 0;
  if (!reaches_image(camera, u, v))
    return;
  const int x0 = (int)floor(u), y0 = (int)floor(v);
  const double right = u - x0, down = v - y0;
  for (int i = 0; i < 4; i++) {
    const int x = x0 + i % 2, y = y0 + i / 2;
    const double weight = (i % 2 ? right : 1.0 - right) * (i / 2 ? down : 1.0 - down);
    if (!(weight > 0.0) || !in_image(camera, x, y))
      continue;
    const double angle = pl_pixel_solid_angle(camera, x, y);
    if (!(angle > 0.0))
      continue;
    const double scale = weight / angle;
    out->pixels[out->count] = (uint32_t)y * (uint32_t)camera->width + (uint32_t)x;
    out->light[out->count++] =
        (pl_vec3f){(float)(scale * (double)star->light[0]), (float)(scale * (double)star->light[1]),
                   (float)(scale * (double)star->light[2])};
  }
}

/* --- stars in the frame */

typedef struct gathering {
  const pl_star_catalogue *catalogue;
  const pl_snapshot *shot;
  pl_vec3 beta, axis;
  double half_angle_rad; /* half angle of the cone that contains the image, including aberration */
  double faint;          /* total brightness of a cell's stars that may be omitted, W m-2 */
  double left;           /* total brightness of the omitted stars, W m-2 */
  pl_star_field *field;
  size_t room;
} gathering;

static bool in_cone(const gathering *g, const pl_sky_cell *cell) {
  const double sine = pl_vec3_norm(pl_vec3_cross(g->axis, cell->axis));
  return atan2(sine, pl_vec3_dot(g->axis, cell->axis)) <= g->half_angle_rad + cell->half_angle_rad;
}

/* Computes the position in the image; false for a star behind the camera or outside the image. */
static bool see(const gathering *g, const pl_star *star, pl_field_star *out) {
  const pl_camera *camera = &g->shot->rays.camera;
  double pixel[2];
  *out = (pl_field_star){.star = star, .direction = pl_star_aberrate(star->direction, g->beta)};
  const pl_vec3 view = pl_mat3_mul_vec_t(g->shot->camera_to_root, out->direction);
  if (!pl_camera_project(camera, view, pixel))
    return false;
  out->u = pixel[0];
  out->v = pixel[1];
  return reaches_image(camera, pixel[0], pixel[1]);
}

static void gather_cell(gathering *g, const pl_sky_cell *cell) {
  const pl_star *stars = g->catalogue->stars + cell->first;
  const double *rest = g->catalogue->rest + cell->first;
  for (size_t i = 0; i < cell->count; i++) {
    const double brightness = (double)pl_star_brightness(&stars[i]);
    if (brightness + rest[i] <= g->faint) {
      g->left += brightness + rest[i];
      return;
    }
    if (see(g, &stars[i], &g->field->stars[g->field->count]))
      g->field->count++;
  }
}

static int compare(const void *left, const void *right) {
  const pl_field_star *a = left, *b = right;
  const float fa = pl_star_brightness(a->star), fb = pl_star_brightness(b->star);
  if (fa != fb)
    return fa > fb ? -1 : 1;
  return a->star < b->star ? -1 : a->star > b->star;
}

static void set_levels(pl_star_field *field) {
  /* Steps of 0.1 mag: 25 log10 of the ratio; limited to 100 mag. */
  const double tenths = 25.0, most = 1000.0;
  for (size_t i = 0; i < field->count; i++) {
    const double ratio = (double)pl_star_brightness(field->stars[0].star) /
                         (double)pl_star_brightness(field->stars[i].star);
    field->stars[i].level = 1 + (int)fmin(tenths * log10(ratio), most);
    field->levels = field->stars[i].level;
  }
}

/* --- bounds for the plan */

/* Light summed by pixel: a hash table with open addressing. */
typedef struct sums {
  uint32_t *pixels; /* pixel index + 1; 0: free */
  pl_vec3f *light;
  size_t mask;
  float most; /* maximum over all pixels and bands */
} sums;

static pl_status sums_init(sums *s, size_t stars, pl_arena *arena) {
  size_t room = 16;
  while (room < 8 * stars)
    room *= 2;
  s->pixels = pl_arena_alloc(arena, room, sizeof *s->pixels);
  s->light = pl_arena_alloc(arena, room, sizeof *s->light);
  s->mask = room - 1;
  s->most = 0.0f;
  if (s->pixels == NULL || s->light == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for %zu stars", stars);
  memset(s->pixels, 0, room * sizeof *s->pixels);
  return PL_OK;
}

static void sums_add(sums *s, uint32_t pixel, pl_vec3f light) {
  size_t at = (pixel * UINT32_C(2654435761)) & s->mask; /* Knuth's multiplicative hash */
  while (s->pixels[at] != 0 && s->pixels[at] != pixel + 1)
    at = (at + 1) & s->mask;
  if (s->pixels[at] == 0)
    s->light[at] = (pl_vec3f){0.0f, 0.0f, 0.0f};
  s->pixels[at] = pixel + 1;
  s->light[at] = pl_vec3f_add(s->light[at], light);
  s->most = pl_maxf(s->most, pl_vec3f_max(s->light[at]));
}

/* For each level, the maximum radiance in a pixel due to all stars beyond that level; adds stars
 * from the faintest on. `always`: bound of the radiance of stars that are not in the field. */
static pl_status set_left(const pl_star_field *field, const pl_camera *camera, float always,
                          pl_arena *arena, pl_view_sky *view) {
  sums s;
  size_t i = field->count;
  float *left = pl_arena_alloc(arena, (size_t)field->levels + 1, sizeof *left);
  PL_TRY(sums_init(&s, field->count, arena));
  if (left == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for %zu stars", field->count);
  for (int level = field->levels; level >= 0; level--) {
    for (; i > 0 && field->stars[i - 1].level > level; i--) {
      pl_star_splat splat;
      pl_star_splat_at(camera, field->stars[i - 1].star, field->stars[i - 1].u,
                       field->stars[i - 1].v, &splat);
      for (int k = 0; k < splat.count; k++)
        sums_add(&s, splat.pixels[k], splat.light[k]);
    }
    left[level] = always + s.most;
  }
  view->star_left = left;
  return PL_OK;
}

/* Estimate of the minimum solid angle of a pixel, for deciding which stars to omit: half the
 * minimum over the corners and the centre of the image. */
static double least_angle(const pl_camera *camera) {
  const int w = camera->width - 1, h = camera->height - 1;
  double least = pl_pixel_solid_angle(camera, w / 2, h / 2);
  for (int i = 0; i < 4; i++) {
    const double angle = pl_pixel_solid_angle(camera, i % 2 ? w : 0, i / 2 ? h : 0);
    least = angle > 0.0 ? fmin(least, angle) : least;
  }
  return 0.5 * least;
}

/* Counts the cells and stars of the catalogue that may be in the frame. */
static size_t seen_cells(const gathering *g, size_t *stars) {
  size_t cells = 0;
  *stars = 0;
  for (size_t c = 0; c < PL_SKY_CELLS; c++) {
    const pl_sky_cell *cell = &g->catalogue->cells[c];
    if (cell->count == 0 || !in_cone(g, cell))
      continue;
    cells++;
    *stars += cell->count;
  }
  return cells;
}

pl_status pl_star_field_gather(const pl_star_catalogue *catalogue, const pl_snapshot *shot,
                               pl_vec3 beta, double faint, pl_arena *arena, pl_star_field *out,
                               pl_view_sky *view) {
  gathering g = {.catalogue = catalogue, .shot = shot, .beta = beta, .field = out};
  const double w = shot->rays.camera.width, h = shot->rays.camera.height;
  const double rect[4] = {-1.0, -1.0, w, h}, image[4] = {-0.5, -0.5, w - 0.5, h - 0.5};
  const double angle = least_angle(&shot->rays.camera);
  size_t room;
  *out = (pl_star_field){0};
  pl_snapshot_cone(shot, shot->rays.camera.lens.model == NULL ? rect : image, &g.axis,
                   &g.half_angle_rad);
  /* A lens model may have no ray outside its image: the cone of the image is widened by two pixels
   * instead. */
  g.half_angle_rad += 2.0 * pl_vec3_norm(beta) + 2.0 * sqrt(2.0 * angle);
  const size_t cells = seen_cells(&g, &room);
  g.faint = cells > 0 ? faint * angle / (double)cells : 0.0;
  out->stars = pl_arena_alloc(arena, room + 1, sizeof *out->stars);
  if (out->stars == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for %zu stars", room);
  for (size_t c = 0; c < PL_SKY_CELLS; c++)
    if (catalogue->cells[c].count > 0 && in_cone(&g, &catalogue->cells[c]))
      gather_cell(&g, &catalogue->cells[c]);
  qsort(out->stars, out->count, sizeof *out->stars, compare);
  set_levels(out);
  view->catalogued = true;
  view->star_count = out->count;
  view->star_levels = out->levels;
  return set_left(out, &shot->rays.camera, (float)(g.left / angle), arena, view);
}
