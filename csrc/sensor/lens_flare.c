/* The stage `lens_flare`: ghosts of the sun, if sunlight enters the lens, and of pixels brighter
 * than white. A ghost is a uniform disc that contains a stated fraction of its source's light;
 * light of the disc outside the image is lost. Vignetting applies to ghosts as to all other light.
 * All light brighter than white within 4 x 4 pixels is one source, at its centroid. */
#include <math.h>
#include <string.h>

#include "plan/effects.h"
#include "sensor/stages.h"

static const double PI = 3.14159265358979323846;
enum { BLOCK = 4 };

typedef struct source {
  double place[2]; /* relative to the optical axis, pixels */
  double light[3];
} source;

typedef struct ghosts {
  pl_sensor_frame *frame;
  source *sources;
  size_t count;
  double per_px; /* tangent of the angle that a pixel subtends */
} ghosts;

pl_status pl_flare_check(const pl_flare *flare) {
  const double *baffle = flare->baffle_rad;
  if (flare->count < 0 || flare->count > PL_GHOSTS_MAX)
    return pl_fail(PL_E_RANGE, "sensor: a lens flare has up to %d ghosts, not %d", PL_GHOSTS_MAX,
                   flare->count);
  if (flare->count > 0 && !(baffle[0] >= 0.0 && baffle[1] >= baffle[0] && baffle[1] <= 1.5))
    return pl_fail(PL_E_RANGE, "sensor: lens flare: the angles of the baffle must rise, in 0..1.5");
  for (int i = 0; i < flare->count; i++) {
    const pl_ghost *g = &flare->ghosts[i];
    bool good = g->scale >= -2.0 && g->scale <= 2.0 && g->radius_rad > 0.0 && g->radius_rad <= 1.5;
    for (int band = 0; band < 3; band++)
      good = good && g->part[band] >= 0.0 && g->part[band] <= 1.0;
    if (!good)
      return pl_fail(PL_E_RANGE, "sensor: lens flare: ghost %d: a number is out of its range", i);
  }
  return PL_OK;
}

double pl_flare_baffle(const pl_flare *flare, double angle_rad) {
  const double *b = flare->baffle_rad;
  if (angle_rad <= b[0])
    return 1.0;
  return angle_rad >= b[1] ? 0.0 : (b[1] - angle_rad) / (b[1] - b[0]);
}

static double radius_px(const pl_ghost *ghost, double per_px) {
  return fmax(0.5, tan(ghost->radius_rad) / per_px);
}

/* --- sources */

/* Light through the aperture from a pixel relative to that from a pixel on the axis: the solid
 * angle varies as cos^3 of the angle, the projected aperture as the cosine. */
static double aperture_part(const pl_sensor_frame *f, int x, int y) {
  const double u = (x - f->centre_px[0]) / f->focal_px[0];
  const double v = (y - f->centre_px[1]) / f->focal_px[1];
  return pow(1.0 + u * u + v * v, -2.0);
}

static bool is_sun(const pl_flare_sun *sun, double x, double y) {
  return sun->on && hypot(x - sun->place_px[0], y - sun->place_px[1]) <= sun->radius_px + 1.5;
}

/* Adds the light brighter than white in a block to the list of sources. */
static void gather_block(ghosts *g, int x0, int y0, double white) {
  const pl_sensor_frame *f = g->frame;
  source s = {.place = {0.0, 0.0}};
  double weight = 0.0;
  for (int y = y0; y < y0 + BLOCK && y < f->height; y++)
    for (int x = x0; x < x0 + BLOCK && x < f->width; x++) {
      const pl_vec3f light = f->bands[(size_t)y * (size_t)f->width + (size_t)x];
      const double bands[3] = {light.x, light.y, light.z};
      const double brightest = fmax(bands[0], fmax(bands[1], bands[2]));
      if (!(brightest >= white) || is_sun(&f->sun, x, y))
        continue;
      const double part = aperture_part(f, x, y);
      for (int band = 0; band < 3; band++)
        s.light[band] += part * fmin(fmax(0.0, bands[band]), 1e30);
      const double w = fmin(brightest, 1e30);
      s.place[0] += w * (x - f->centre_px[0]);
      s.place[1] += w * (y - f->centre_px[1]);
      weight += w;
    }
  if (!(weight > 0.0))
    return;
  s.place[0] /= weight;
  s.place[1] /= weight;
  g->sources[g->count++] = s;
}

static pl_status gather(ghosts *g) {
  const pl_sensor_frame *f = g->frame;
  const size_t blocks =
      (((size_t)f->width + BLOCK - 1) / BLOCK) * (((size_t)f->height + BLOCK - 1) / BLOCK);
  const double white = pl_sensor_full_radiance(f->sensor);
  g->sources = pl_arena_alloc(f->arena, blocks + 1, sizeof *g->sources);
  if (g->sources == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for a lens flare");
  if (f->sun.on) {
    source *s = &g->sources[g->count++];
    for (int k = 0; k < 2; k++)
      s->place[k] = f->sun.place_px[k] - f->centre_px[k];
    for (int band = 0; band < 3; band++)
      s->light[band] = f->sun.light;
  }
  for (int y = 0; y < f->height; y += BLOCK)
    for (int x = 0; x < f->width; x += BLOCK)
      gather_block(g, x, y, white);
  return PL_OK;
}

/* --- discs */

/* Area of a disc of radius r on one side of a line at `t` from its centre, minus half the disc. */
static double below(double r, double t) {
  const double c = fmin(r, fmax(-r, t));
  return c * sqrt(r * r - c * c) + r * r * asin(c / r);
}

/* Adds the light of a disc in row y. Its area within the row is treated as a span of full row
 * height. */
static void add_disc(const pl_sensor_frame *f, int y, const double middle[2], double r,
                     const double each[3]) {
  const double area = below(r, y + 0.5 - middle[1]) - below(r, y - 0.5 - middle[1]);
  const double first = middle[0] - 0.5 * area, last = middle[0] + 0.5 * area;
  if (!(area > 0.0) || last <= -0.5 || first >= f->width - 0.5)
    return;
  const int x0 = (int)fmax(0.0, floor(first + 0.5));
  const int x1 = (int)fmin(f->width - 1.0, floor(last + 0.5));
  pl_vec3f *row = f->bands + (size_t)y * (size_t)f->width;
  for (int x = x0; x <= x1; x++) {
    const double part = fmin(last, x + 0.5) - fmax(first, x - 0.5);
    if (part > 0.0)
      row[x] = (pl_vec3f){(float)(row[x].x + part * each[0]), (float)(row[x].y + part * each[1]),
                          (float)(row[x].z + part * each[2])};
  }
}

static pl_status flare_row(void *context, size_t row, int worker) {
  (void)worker;
  const ghosts *g = context;
  const pl_sensor_frame *f = g->frame;
  const pl_flare *flare = &f->sensor->flare;
  for (int k = 0; k < flare->count; k++) {
    const pl_ghost *ghost = &flare->ghosts[k];
    const double r = radius_px(ghost, g->per_px), area = PI * r * r;
    for (size_t i = 0; i < g->count; i++) {
      const source *s = &g->sources[i];
      const double middle[2] = {f->centre_px[0] + ghost->scale * s->place[0],
                                f->centre_px[1] + ghost->scale * s->place[1]};
      if (fabs((double)row - middle[1]) >= r + 0.5)
        continue;
      const double each[3] = {ghost->part[0] * s->light[0] / area,
                              ghost->part[1] * s->light[1] / area,
                              ghost->part[2] * s->light[2] / area};
      add_disc(f, (int)row, middle, r, each);
    }
  }
  return PL_OK;
}

pl_status pl_stage_lens_flare(pl_sensor_frame *frame, int value) {
  (void)value;
  ghosts g = {.frame = frame, .per_px = 1.0 / fmax(frame->focal_px[0], frame->focal_px[1])};
  PL_TRY(gather(&g));
  if (g.count == 0)
    return PL_OK;
  return pl_parallel_for(frame->threads, (size_t)frame->height, flare_row, &g, frame->cancel);
}

/* --- the row */

/* Upper bound of the fraction of sunlight that passes the baffle. */
static double sun_part(const pl_view *view) {
  const double angle = fmax(0.0, view->sun_axis_rad - view->sun_radius_rad);
  return pl_flare_baffle(&view->sensor->flare, angle);
}

/* True if anything in the frame can be brighter than white. */
static bool over_bright(const pl_view *view, double brightest) {
  return brightest >= pl_sensor_full_radiance(view->sensor);
}

/* All discs whose sources lie within the disc's radius divided by the scale may overlap in one
 * pixel. A block is represented by its centroid, which is at most 6 pixels away from its pixels. */
double pl_flare_radiance_max(const pl_view *view, double brightest) {
  const pl_flare *flare = &view->sensor->flare;
  const double pixels = (double)view->width * view->height, sun = sun_part(view);
  double sum = 0.0;
  for (int k = 0; k < flare->count; k++) {
    const pl_ghost *ghost = &flare->ghosts[k];
    const double r = radius_px(ghost, view->pixel_rad), area = PI * r * r;
    const double part = fmax(ghost->part[0], fmax(ghost->part[1], ghost->part[2]));
    const double reach = (r + 1.0) / fmax(fabs(ghost->scale), 1e-9) + 6.0;
    const double light = sun > 0.0 ? sun * view->sun_irradiance / pow(view->pixel_rad, 2.0) : 0.0;
    if (part > 0.0 && over_bright(view, brightest))
      sum += part * brightest * fmin(pixels, PI * reach * reach) / area;
    sum += part * light / area;
  }
  return sum;
}

static const char *absent(const pl_view *view) {
  const char *none = pl_sensor_absent(view);
  if (none != NULL)
    return none;
  if (view->sensor->flare.count == 0)
    return "the lens has no ghosts";
  if (!(view->sensor->exposure_s > 0.0))
    return "the exposure time is zero";
  if (sun_part(view) > 0.0 || over_bright(view, pl_sensor_radiance_max(view)))
    return NULL;
  return "the baffle blocks the sun, and nothing is brighter than white";
}

static double bound_dn(const pl_view *view, int value) {
  if (value > 0)
    return 0.0;
  const double radiance = pl_flare_radiance_max(view, pl_sensor_radiance_max(view));
  return pl_sensor_light_dn(view, radiance * pl_sensor_response_white(view->sensor));
}

static double cost_ms(const pl_view *view, int value) {
  return pl_sensor_cost_ms(view, 10.0 * value * view->sensor->flare.count);
}

const pl_effect pl_effect_lens_flare = {
    .name = "lens_flare",
    .doc = "Sensor: ghost images of the sun and of light brighter than white in the lens",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
