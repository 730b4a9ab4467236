#include "annotate/instance_coverage.h"

#include <string.h>

#include "annotate/channel.h"
#include "annotate/filled_pixel.h"
#include "annotate/mixed_pixels.h"
#include "scene/image_sample.h"
#include "trace/tracer.h"

/* Rays that are traced together: some packets of one pixel. */
enum { RUN = 8 * PL_TRACER_PACKET };

bool pl_instance_coverage_init(const pl_instance_coverage_settings *settings, void *const *channels,
                               pl_instance_coverage *out) {
  *out = (pl_instance_coverage){.settings = *settings};
  for (size_t i = 0; i < pl_channel_count; i++) {
    if (strcmp(pl_channels[i].name, "coverage") == 0)
      out->parts = channels[i];
    else if (strcmp(pl_channels[i].name, "coverage_instance") == 0)
      out->ids = channels[i];
  }
  return out->parts != NULL || out->ids != NULL;
}

pl_status pl_instance_coverage_check(const pl_instance_coverage *coverage) {
  const pl_instance_coverage_settings *s = &coverage->settings;
  if (s->samples < 1 || s->samples > PL_COVERAGE_SAMPLES_MAX)
    return pl_fail(PL_E_RANGE, "coverage: samples must be in 1..%d, not %d",
                   PL_COVERAGE_SAMPLES_MAX, s->samples);
  if (s->layers < 1 || s->layers > PL_COVERAGE_LAYERS_MAX)
    return pl_fail(PL_E_RANGE, "coverage: layers must be in 1..%d, not %d", PL_COVERAGE_LAYERS_MAX,
                   s->layers);
  return PL_OK;
}

/* Number of rays of a pixel that see an instance. */
typedef struct instance_count {
  int32_t id;
  int count;
} instance_count;

/* What the rays of a pixel see. */
typedef struct tally {
  size_t count;
  instance_count seen[PL_COVERAGE_SAMPLES_MAX];
  pl_surface_id last; /* the surface that was met last, and its instance */
  int32_t last_id;
} tally;

static int32_t instance_of(const pl_snapshot *shot, pl_surface_id id, tally *t) {
  if (!pl_surface_same(id, t->last)) {
    pl_geometry_label label;
    pl_geometry_of(id)->label(shot, id, &label);
    t->last = id;
    t->last_id = label.instance_id;
  }
  return t->last_id;
}

static void add(const pl_snapshot *shot, pl_surface_id id, tally *t) {
  if (pl_surface_is_none(id))
    return;
  const int32_t instance = instance_of(shot, id, t);
  size_t k = 0;
  while (k < t->count && t->seen[k].id != instance)
    k++;
  if (k == t->count)
    t->seen[t->count++] = (instance_count){instance, 0};
  t->seen[k].count++;
}

/* Where the rays of a pixel leave it, from its centre, px. */
typedef double offset_list[PL_COVERAGE_SAMPLES_MAX][2];

/* A ray of a pixel, through the centre of the lens. */
static pl_ray ray_of(const pl_snapshot *shot, const double offset[2], int x, int y) {
  const pl_vec3 direction = pl_snapshot_ray(shot, x + offset[0], y + offset[1]);
  if (pl_vec3_dot(direction, direction) > 0.0)
    return (pl_ray){.t_max = INFINITY, .direction = direction, .skip_body = PL_NO_BODY};
  return (pl_ray){.t_max = -1.0, .direction = {0.0, 0.0, 1.0}, .skip_body = PL_EVERY_ELLIPSOID};
}

/* Adds the other rays of a pixel; the first is that through its centre. No ray that
 * pl_image_sample_offset can choose meets a mesh that the mask does not tell. */
static void cast(const pl_snapshot *shot, const pl_tile_result *result, int samples,
                 const offset_list offsets, int x, int y, tally *t) {
  const bool meshes = pl_coverage_pixel(result->coverage, x, y);
  pl_ray rays[RUN];
  pl_hit hits[RUN];
  for (int from = 1; from < samples; from += RUN) {
    const int count = samples - from < RUN ? samples - from : RUN;
    for (int i = 0; i < count; i++)
      rays[i] = ray_of(shot, offsets[from + i], x, y);
    pl_tracer_closest(result->tracer, rays, hits, (size_t)count, true, meshes);
    for (int i = 0; i < count; i++)
      add(shot, hits[i].surface_id, t);
  }
}

/* Counts what the rays of a pixel see. */
static void look(const pl_instance_coverage *coverage, const pl_snapshot *shot,
                 const pl_tile_result *result, const offset_list offsets, int x, int y, tally *t) {
  const pl_tile tile = result->tile;
  t->count = 0;
  add(shot, result->points[y * PL_TILE_SIDE + x].surface_id, t);
  cast(shot, result, coverage->settings.samples, offsets, tile.x0 + x, tile.y0 + y, t);
}

/* The largest first; of equal ones the lower id. */
static void sort(tally *t) {
  for (size_t i = 1; i < t->count; i++) {
    const instance_count moved = t->seen[i];
    size_t k = i;
    for (; k > 0; k--) {
      const instance_count *before = &t->seen[k - 1];
      if (before->count > moved.count || (before->count == moved.count && before->id < moved.id))
        break;
      t->seen[k] = *before;
    }
    t->seen[k] = moved;
  }
}

/* Sums what has no layer of its own. */
static void fold(tally *t, size_t layers) {
  if (t->count <= layers)
    return;
  instance_count *rest = &t->seen[layers - 1];
  for (size_t i = layers; i < t->count; i++)
    rest->count += t->seen[i].count;
  rest->id = PL_COVERAGE_REST;
  t->count = layers;
}

static void write_pixel(const pl_instance_coverage *coverage, size_t at, const tally *t) {
  const size_t layers = (size_t)coverage->settings.layers;
  for (size_t k = 0; k < layers; k++) {
    const instance_count s = k < t->count ? t->seen[k] : (instance_count){0, 0};
    if (coverage->parts != NULL)
      coverage->parts[at * layers + k] = (float)s.count / (float)coverage->settings.samples;
    if (coverage->ids != NULL)
      coverage->ids[at * layers + k] = s.id;
  }
}

/* Writes a pixel that one instance fills, or with a part of 0 none. */
static void write_whole(const pl_instance_coverage *coverage, size_t at, float part, int32_t id) {
  const size_t layers = (size_t)coverage->settings.layers;
  if (coverage->parts != NULL) {
    memset(coverage->parts + at * layers, 0, layers * sizeof *coverage->parts);
    coverage->parts[at * layers] = part;
  }
  if (coverage->ids != NULL) {
    memset(coverage->ids + at * layers, 0, layers * sizeof *coverage->ids);
    coverage->ids[at * layers] = id;
  }
}

/* Whether one instance, or nothing, is known to be seen over a whole pixel. */
static bool is_whole(const pl_tile_result *result, const bool *mixed, const pl_fill *fill, int x,
                     int y) {
  const int pixel = y * PL_TILE_SIDE + x;
  if (result->empty || !mixed[pixel])
    return true;
  const pl_point *point = &result->points[pixel];
  return pl_fill_has(fill, point->surface_id, point->triangle, result->tile.x0 + x,
                     result->tile.y0 + y);
}

void pl_instance_coverage_write(const pl_instance_coverage *coverage, const pl_snapshot *shot,
                                const pl_tile_result *result) {
  const pl_tile tile = result->tile;
  bool mixed[PL_TILE_PIXELS];
  offset_list offsets;
  pl_fill fill;
  tally t;
  for (int i = 0; i < coverage->settings.samples; i++)
    pl_image_sample_offset((uint32_t)i, coverage->settings.samples, offsets[i]);
  t.count = 0;
  t.last = PL_NO_SURFACE;
  t.last_id = 0;
  if (!result->empty) {
    pl_mixed_pixels_find(shot, result->coverage, tile, mixed);
    pl_fill_begin(shot, coverage->adjacencies, tile, &fill);
  }
  for (int y = 0; y < tile.height; y++)
    for (int x = 0; x < tile.width; x++) {
      const size_t column = (size_t)(tile.x0 + x), row = (size_t)(tile.y0 + y);
      const size_t at = row * (size_t)shot->rays.camera.width + column;
      const pl_surface_id id =
          result->empty ? PL_NO_SURFACE : result->points[y * PL_TILE_SIDE + x].surface_id;
      if (is_whole(result, mixed, &fill, x, y)) {
        const bool none = pl_surface_is_none(id);
        write_whole(coverage, at, none ? 0.0f : 1.0f, none ? 0 : instance_of(shot, id, &t));
        continue;
      }
      look(coverage, shot, result, offsets, x, y, &t);
      sort(&t);
      fold(&t, (size_t)coverage->settings.layers);
      write_pixel(coverage, at, &t);
    }
}
