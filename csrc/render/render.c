/* Rendering of tiles: skips those that see only black space, fills the geometry buffer, samples
 * colour. */
#include "render/render.h"

#include "base/hash.h"
#include "base/memory.h"
#include "base/work.h"
#include "light/sun.h"
#include "math/philox.h"
#include "render/body_points.h"
#include "render/path.h"
#include "render/irradiance_filter.h"
#include "render/coverage_mask.h"
#include "render/irradiance_record.h"
#include "render/shadow_mask.h"

/* Number of samples after which the noise is checked first; then at every doubling. */
enum { FIRST_CHECK = 2 };
/* The same where an error is stated, then at every half more: fewer do not tell a variance. */
enum { FIRST_AIMED = 8 };
/* Maximum number of samples per pixel, relative to the usual number: as many as pixels need that
 * outlines of full contrast cross. */
enum { MOST = 2 };

struct pl_render_scratch {
  int threads;
  pl_tile_buffers *buffers; /* owned, one per worker */
  pl_sun_view *suns;        /* owned, one per object */
  size_t sun_count;         /* capacity of suns */
  pl_coverage coverage;
  pl_irradiance_record irradiance;
};

pl_status pl_render_scratch_create(int threads, pl_render_scratch **out) {
  void *scratch, *buffers;
  if (threads < 1 || threads > 256)
    return pl_fail(PL_E_RANGE, "threads must be in 1..256, not %d", threads);
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_render_scratch), "scratch memory", &scratch));
  pl_status status =
      pl_alloc_or_fail((size_t)threads, sizeof(pl_tile_buffers), "tile buffers", &buffers);
  if (status != PL_OK) {
    pl_free(scratch);
    return status;
  }
  pl_render_scratch *made = scratch;
  *made = (pl_render_scratch){.threads = threads, .buffers = buffers};
  status = pl_irradiance_init(&made->irradiance);
  if (status != PL_OK) {
    pl_free(buffers);
    pl_free(scratch);
    return status;
  }
  *out = made;
  return PL_OK;
}

void pl_render_scratch_destroy(pl_render_scratch *scratch) {
  if (scratch == NULL)
    return;
  for (int i = 0; i < scratch->threads; i++) {
    pl_free(scratch->buffers[i].patches);
    pl_free(scratch->buffers[i].air);
  }
  pl_free(scratch->buffers);
  pl_free(scratch->suns);
  pl_coverage_clear(&scratch->coverage);
  pl_irradiance_clear(&scratch->irradiance);
  pl_free(scratch);
}

int pl_render_scratch_threads(const pl_render_scratch *scratch) { return scratch->threads; }

typedef struct job {
  const pl_snapshot *shot;
  const pl_tracer *tracer;
  const pl_render_settings *settings;
  pl_render_scratch *scratch;
  pl_tile_fn done;
  void *context;
  int columns;   /* tiles per row */
  size_t behind; /* tiles in the rows before those that are worked on */
  int row0, row1;
  double pixel_rad;
  int block; /* side of what is rendered of a tile, pixels: PL_TILE_SIDE but for a pilot */
} job;

static pl_tile whole_tile(const job *job, size_t item) {
  const int column = (int)(item % (size_t)job->columns);
  const int row = job->row0 / PL_TILE_SIDE + (int)(item / (size_t)job->columns);
  const int x0 = column * PL_TILE_SIDE, below = (row + 1) * PL_TILE_SIDE;
  const int y0 = row * PL_TILE_SIDE > job->row0 ? row * PL_TILE_SIDE : job->row0;
  const int w = job->shot->rays.camera.width - x0, h = (below < job->row1 ? below : job->row1) - y0;
  return (pl_tile){x0, y0, w < PL_TILE_SIDE ? w : PL_TILE_SIDE, h};
}

/* Where a block lies in a length: at one of the multiples of its side, by hash. */
static int block_at(int length, int side, uint64_t word) {
  const int places = length > side ? (length - side) / side + 1 : 1;
  return side * (int)(word % (uint64_t)places);
}

/* The pixels of a tile that are rendered. */
static pl_tile tile_of(const job *job, size_t item) {
  const pl_tile whole = whole_tile(job, item);
  const int side = job->block;
  if (side == PL_TILE_SIDE)
    return whole;
  const uint64_t word = pl_hash(PL_HASH_SEED, &item, sizeof item);
  return (pl_tile){whole.x0 + block_at(whole.width, side, word),
                   whole.y0 + block_at(whole.height, side, word >> 32),
                   whole.width < side ? whole.width : side,
                   whole.height < side ? whole.height : side};
}

/* What the cone of a tile may contain. */
typedef struct content {
  bool meshes, bodies, sun, air, media, rough_media;
  pl_vec3 axis; /* of the cone */
  double half_angle_rad;
} content;

static content tile_content(const job *job, pl_tile tile) {
  const pl_snapshot *shot = job->shot;
  content out = {.meshes = false};
  const double rect[4] = {tile.x0 - 0.5, tile.y0 - 0.5, tile.x0 + tile.width - 0.5,
                          tile.y0 + tile.height - 0.5};
  pl_snapshot_cone(shot, rect, &out.axis, &out.half_angle_rad);
  for (int y = 0; y < tile.height && !out.meshes; y++)
    for (int x = 0; x < tile.width && !out.meshes; x++)
      out.meshes = pl_coverage_pixel(&job->scratch->coverage, tile.x0 + x, tile.y0 + y);
  out.sun =
      pl_snapshot_sees(shot, shot->sun.position, shot->sun.radius_m, out.axis, out.half_angle_rad);
  out.air = pl_air_in_cone(job->settings->air, shot, out.axis, out.half_angle_rad);
  out.media = pl_media_in_cone(job->settings->media, shot, out.axis, out.half_angle_rad);
  out.rough_media =
      pl_media_rough_in_cone(job->settings->media, shot, out.axis, out.half_angle_rad);
  for (size_t i = 0; i < shot->body_count && !out.bodies; i++)
    out.bodies = pl_shot_is_smooth(&shot->bodies[i]) && /* others are meshes for rays */
                 pl_snapshot_sees(shot, shot->bodies[i].center, shot->bodies[i].radius_m, out.axis,
                                  out.half_angle_rad);
  return out;
}

/* One random word per pixel, keyed by (seed, "render", frame, pixel). */
static void draw_seeds(const job *job, pl_tile tile, uint32_t *seeds) {
  const uint64_t key[2] = {job->settings->seed, pl_hash(PL_HASH_SEED, "render", 6)};
  for (int y = 0; y < tile.height; y++) {
    for (int x = 0; x < tile.width; x++) {
      const uint64_t pixel = (uint64_t)(tile.y0 + y) * (uint64_t)job->shot->rays.camera.width +
                             (uint64_t)(tile.x0 + x);
      const uint64_t counter[4] = {pixel, job->settings->frame, 0, 0};
      uint64_t words[4];
      pl_philox(key, counter, words);
      seeds[y * PL_TILE_SIDE + x] = (uint32_t)words[0];
    }
  }
}

/* A position relative to a tile. Packets of rays follow the full tiles of the image. A band of rows
 * may contain only a part of a full tile; positions of the full tile may then lie outside `tile`.
 */
typedef struct place {
  int x, y; /* pixels from the tile's corner */
} place;

static place place_of(pl_tile tile, uint32_t nth) {
  const uint32_t pixel = pl_tile_pixel(nth);
  const int cut = (int)((uint32_t)tile.y0 % PL_TILE_SIDE);
  return (place){(int)(pixel % PL_TILE_SIDE), (int)(pixel / PL_TILE_SIDE) - cut};
}

/* Packs position `nth` of the packet that begins at `first` into one number; unpack_place reverses
 * it. */
static uint32_t pack_place(place first, uint32_t nth) {
  const uint32_t pixel = pl_tile_pixel(nth);
  const uint32_t x = (uint32_t)first.x + pixel % PL_TILE_SIDE;
  const uint32_t y = (uint32_t)(first.y + PL_TILE_SIDE) + pixel / PL_TILE_SIDE;
  return y * PL_TILE_SIDE + x;
}

static place unpack_place(uint32_t packed) {
  return (place){(int)(packed % PL_TILE_SIDE), (int)(packed / PL_TILE_SIDE) - PL_TILE_SIDE};
}

static bool is_inside(pl_tile tile, place at) {
  return at.x < tile.width && at.y >= 0 && at.y < tile.height;
}

/* Whether a pixel of the packet that begins at a position may see a mesh. */
static bool packet_may_see(const job *job, pl_tile tile, place at) {
  enum { WIDE = 4, HIGH = 2 };
  _Static_assert(WIDE * HIGH == PL_TRACER_PACKET, "a block of the Z-order curve");
  const int x1 = at.x + WIDE < tile.width ? at.x + WIDE : tile.width;
  const int y1 = at.y + HIGH < tile.height ? at.y + HIGH : tile.height;
  for (int y = at.y > 0 ? at.y : 0; y < y1; y++)
    for (int x = at.x; x < x1; x++)
      if (pl_coverage_pixel(&job->scratch->coverage, tile.x0 + x, tile.y0 + y))
        return true;
  return false;
}

/* Lists the positions of all packets in which a pixel may see a mesh; returns their number. The
 * rays of a packet affect rounding, so a packet always has the rays of all of its positions. Labels
 * are therefore the same with and without colour, for any number of samples, and in bands of rows.
 */
static size_t list_mesh_places(const job *job, pl_tile tile, uint32_t *places) {
  size_t count = 0;
  for (uint32_t i = 0; i < PL_TILE_PIXELS; i += PL_TRACER_PACKET) {
    const place first = place_of(tile, i);
    if (!packet_may_see(job, tile, first))
      continue;
    for (uint32_t k = 0; k < PL_TRACER_PACKET; k++)
      places[count++] = pack_place(first, k);
  }
  return count;
}

/* Direction through the centre of a pixel; zero where the lens has no ray, for which centre_ray
 * makes a ray that hits nothing. */
static pl_vec3 centre_direction(const job *job, pl_tile tile, place at, const pl_tile_buffers *b) {
  const int pixel = at.y * PL_TILE_SIDE + at.x;
  if (is_inside(tile, at))
    return (pl_vec3){b->directions[0][pixel], b->directions[1][pixel], b->directions[2][pixel]};
  return pl_snapshot_ray(job->shot, tile.x0 + at.x, tile.y0 + at.y);
}

static pl_ray centre_ray(const job *job, pl_tile tile, place at, const pl_tile_buffers *b) {
  const pl_vec3 direction = centre_direction(job, tile, at, b);
  if (pl_vec3_dot(direction, direction) > 0.0)
    return (pl_ray){.t_max = INFINITY, .direction = direction, .skip_body = PL_EVERY_ELLIPSOID};
  return (pl_ray){.t_max = -1.0, .direction = {0.0, 0.0, 1.0}, .skip_body = PL_EVERY_ELLIPSOID};
}

/* Fills the points of pixels whose first hit is on a mesh, for the first `count` positions in
 * `active`. The points on bodies must be filled before. */
static void fill_mesh_points(const job *job, pl_tile tile, size_t count, pl_tile_buffers *b) {
  for (size_t i = 0; i < count; i++)
    b->rays[i] = centre_ray(job, tile, unpack_place(b->active[i]), b);
  pl_tracer_closest(job->tracer, b->rays, b->hits, count, true, true);
  for (size_t i = 0; i < count; i++) {
    const place at = unpack_place(b->active[i]);
    const int pixel = at.y * PL_TILE_SIDE + at.x;
    const pl_hit *hit = &b->hits[i];
    if (pl_surface_is_none(hit->surface_id) || !is_inside(tile, at))
      continue;
    pl_point *point = &b->points[pixel];
    if (!pl_surface_is_none(point->surface_id) && point->t < hit->t)
      continue;
    const pl_beam beam = {.direction = b->rays[i].direction, .spread = (float)job->pixel_rad};
    b->center_hits[pixel] = *hit;
    pl_vertex vertex;
    pl_vertex_locate(job->shot, &beam, hit, true, &vertex);
    pl_vertex_orient(job->shot, &beam, &vertex);
    *point = pl_point_of(&vertex);
  }
}

static void fill_body_points(const job *job, pl_tile tile, const content *content,
                             pl_tile_buffers *b) {
  pl_body_points(job->shot, tile, content->axis, content->half_angle_rad, b->directions, b->points);
  for (int y = 0; y < tile.height; y++)
    for (int x = 0; x < tile.width; x++) {
      const int pixel = y * PL_TILE_SIDE + x;
      const pl_point *point = &b->points[pixel];
      b->center_hits[pixel] = (pl_hit){.surface_id = PL_NO_SURFACE};
      if (!pl_surface_is_none(point->surface_id))
        b->center_hits[pixel] = (pl_hit){.surface_id = point->surface_id, .t = (float)point->t};
    }
}

/* Fills the geometry buffer: the hits of the rays through the pixels' centres. */
static void fill_points(const job *job, pl_tile tile, const content *content, pl_tile_buffers *b) {
  fill_body_points(job, tile, content, b);
  if (content->meshes)
    fill_mesh_points(job, tile, list_mesh_places(job, tile, b->active), b);
}

/* Whether sampling is adaptive. With an aperture it is not: a few samples of a blurred outline may
 * all miss it, and then do not show that more are needed. */
static bool is_adaptive(const job *job) {
  return (job->settings->noise_dn > 0.0f || job->settings->target_dn > 0.0f) &&
         !(job->shot->rays.camera.aperture_m > 0.0) && job->settings->slice == NULL;
}

/* Whether pixels share the light of paths, which a stated error of each pixel rules out. */
static bool filters_irradiance(const job *job) {
  return is_adaptive(job) && !(job->settings->target_dn > 0.0f);
}

static pl_path_context context_of(const job *job, pl_tile tile, const content *content) {
  return (pl_path_context){
      .shot = job->shot,
      .tracer = job->tracer,
      .settings = job->settings,
      .suns = job->scratch->suns,
      .tile = tile,
      .pixel_rad = job->pixel_rad,
      .camera_sun = pl_sun_view_at(&job->shot->sun, (pl_vec3){0.0, 0.0, 0.0}),
      .spread = (float)(job->pixel_rad / sqrt((double)job->settings->samples)),
      .coverage = &job->scratch->coverage,
      .centred = !(job->shot->rays.camera.aperture_m > 0.0) && job->settings->slice == NULL,
      .sharp = !(job->shot->rays.camera.aperture_m > 0.0),
      .filters_irradiance = filters_irradiance(job),
      .few_samples = filters_irradiance(job) && job->settings->samples <= PL_IRRADIANCE_ROW,
      .bodies = content->bodies,
      .sun = content->sun,
      .air = content->air,
      .media = content->media,
      .rough_media = content->rough_media,
  };
}

/* Fills the points on bodies for a slice. Pixels without a sample at this instant, and pixels that
 * may see a mesh, get none. */
static void fill_slice_points(const job *job, pl_tile tile, const content *content,
                              pl_tile_buffers *b) {
  fill_body_points(job, tile, content, b);
  for (int y = 0; y < tile.height; y++)
    for (int x = 0; x < tile.width; x++) {
      const int pixel = y * PL_TILE_SIDE + x;
      if (b->sample_counts[pixel] == 0 ||
          pl_coverage_pixel(&job->scratch->coverage, tile.x0 + x, tile.y0 + y))
        b->points[pixel].surface_id = PL_NO_SURFACE;
    }
}

/* Renders the samples of one instant; radiance is their sum over the number of all samples. */
static void sample_slice(const job *job, pl_tile tile, const content *content, pl_tile_buffers *b) {
  const pl_path_context context = context_of(job, tile, content);
  draw_seeds(job, tile, b->seeds);
  if (!pl_path_count_slice(&context, b))
    return;
  if (job->settings->air != NULL)
    pl_air_prepare(&context, b);
  fill_slice_points(job, tile, content, b);
  pl_path_prefilter(&context, b);
  pl_path_slice(&context, b);
}

static void fill_shadows(const job *job, pl_tile tile, const content *content, pl_tile_buffers *b) {
  const pl_path_context context = context_of(job, tile, content);
  pl_shadow_mask(&context, b);
}

static pl_status sample_colour(const job *job, size_t item, int worker, const content *content) {
  const pl_tile tile = tile_of(job, item);
  const int column = (int)(item % (size_t)job->columns);
  const int row = (int)(item / (size_t)job->columns);
  pl_tile_buffers *b = &job->scratch->buffers[worker];
  const int samples = job->settings->samples;
  const pl_path_context context = context_of(job, tile, content);
  if (job->settings->air != NULL)
    pl_air_prepare(&context, b);
  pl_path_prefilter(&context, b);
  if (b->active_count > 0)
    draw_seeds(job, tile, b->seeds);
  const bool adaptive = is_adaptive(job);
  const bool aimed = adaptive && job->settings->target_dn > 0.0f;
  const int most = adaptive && !aimed && samples > 1 ? MOST * samples : samples;
  const bool limb = !aimed && most > samples && most < PL_SUN_LIMB_SAMPLES && context.sun;
  const int last = limb ? PL_SUN_LIMB_SAMPLES : most;
  int check = aimed ? FIRST_AIMED : adaptive ? FIRST_CHECK : most;
  for (int i = 0; i < last && b->active_count > 0; i++) {
    pl_path_sample(&context, (uint32_t)i, b);
    if (i == 0)
      pl_path_drop_single(b);
    if (limb && i + 1 == most)
      pl_path_keep_limb(&context, b);
    if (i + 1 != check || check >= most)
      continue;
    check = aimed ? check + check / 2 : 2 * check;
    pl_path_adapt(&context, b);
  }
  if (aimed && job->settings->missed != NULL && b->active_count > 0)
    atomic_fetch_add(job->settings->missed, pl_path_missed(&context, b));
  return pl_irradiance_keep(&job->scratch->irradiance, row, column, &context, b);
}

/* Fills the radiance behind everything, for all pixels of the tile. */
static void fill_backdrop(const job *job, pl_tile tile, pl_vec3f *out) {
  for (int y = 0; y < tile.height; y++)
    for (int x = 0; x < tile.width; x++)
      out[y * PL_TILE_SIDE + x] =
          pl_backdrop_radiance(job->settings->backdrop, job->shot, tile.x0 + x, tile.y0 + y);
}

static pl_status render_item(const job *job, size_t item, int worker) {
  pl_tile_buffers *b = &job->scratch->buffers[worker];
  const pl_tile tile = tile_of(job, item);
  const content content = tile_content(job, tile);
  for (int i = 0; i < PL_TILE_PIXELS; i++)
    b->radiance[i] = (pl_vec3f){0.0f, 0.0f, 0.0f};
  const bool behind = job->settings->samples > 0 && job->settings->backdrop != NULL;
  const bool anything =
      content.meshes || content.bodies || content.sun || content.air || content.media;
  if (behind)
    fill_backdrop(job, tile, anything || job->settings->slice != NULL ? b->backdrop : b->radiance);
  if (job->settings->slice != NULL) {
    if (anything || behind)
      sample_slice(job, tile, &content, b);
  } else if (anything) {
    fill_points(job, tile, &content, b);
    if (job->settings->shadow_mask)
      fill_shadows(job, tile, &content, b);
    if (job->settings->samples > 0)
      PL_TRY(sample_colour(job, item, worker, &content));
  } else {
    for (int i = 0; i < PL_TILE_PIXELS; i++)
      b->points[i].surface_id = PL_NO_SURFACE;
  }
  const pl_tile_result result = {.tile = tile,
                                 .empty = !anything,
                                 .points = b->points,
                                 .radiance = b->radiance,
                                 .tracer = job->tracer,
                                 .coverage = &job->scratch->coverage};
  return job->done(job->context, &result, worker);
}

/* Counts what a block took as if all of its tile had been rendered. */
static void scale_work(const job *job, size_t item, const pl_work_counts *before) {
  const pl_tile whole = whole_tile(job, item), block = tile_of(job, item);
  const uint64_t all = (uint64_t)whole.width * (uint64_t)whole.height;
  const uint64_t done = (uint64_t)block.width * (uint64_t)block.height;
  for (int i = 0; i < PL_WORK_COUNT; i++)
    pl_work_done.of[i] = before->of[i] + (pl_work_done.of[i] - before->of[i]) * all / done;
}

static pl_status render_tile(void *context, size_t nth, int worker) {
  const job *job = context;
  const size_t item = job->behind + nth;
  const pl_work_counts before = pl_work_done;
  PL_TRY(render_item(job, item, worker));
  if (job->block != PL_TILE_SIDE)
    scale_work(job, item, &before);
  return PL_OK;
}

/* Delivers a tile again, with the filtered light added. */
static pl_status light_tile(void *context, size_t nth, int worker) {
  const job *job = context;
  const pl_irradiance_record *irradiance = &job->scratch->irradiance;
  const size_t item = job->behind + nth, columns = (size_t)job->columns;
  const int row = (int)(item / columns), column = (int)(item % columns);
  const pl_irradiance_tile *tile = pl_irradiance_tile_at(irradiance, row, column);
  pl_vec3f *radiance = job->scratch->buffers[worker].radiance;
  if (!tile->lit || job->settings->pilot)
    return PL_OK;
  pl_irradiance_filter_light(irradiance, row, column, job->settings, job->pixel_rad, radiance);
  const pl_tile_result result = {.tile = tile->tile,
                                 .radiance = radiance,
                                 .tracer = job->tracer,
                                 .coverage = &job->scratch->coverage};
  return job->done(job->context, &result, worker);
}

static pl_status run_rows(job *job, int from, int to, pl_item_fn work, pl_cancel *cancel) {
  const size_t columns = (size_t)job->columns;
  job->behind = (size_t)from * columns;
  return pl_parallel_for(job->scratch->threads, (size_t)(to - from) * columns, work, job, cancel);
}

/* Samples band after band. The last row of each is lit with the next band, whose first row it
 * needs.
 */
static pl_status render_bands(job *job, int rows, pl_cancel *cancel) {
  pl_irradiance_record *irradiance = &job->scratch->irradiance;
  PL_TRY(pl_irradiance_start(irradiance, job->columns, rows, job->scratch->threads));
  for (int row = 0, lit = 0; row < rows; row += irradiance->band) {
    const int end = row + irradiance->band < rows ? row + irradiance->band : rows;
    const int ready = end < rows ? end - 1 : rows;
    pl_irradiance_turn(irradiance, row);
    PL_TRY(run_rows(job, row, end, render_tile, cancel));
    PL_TRY(pl_irradiance_reserve(irradiance));
    PL_TRY(run_rows(job, lit, ready, light_tile, cancel));
    lit = ready;
  }
  return PL_OK;
}

/* Computes the sun as seen from each object's centre. */
static pl_status view_suns(pl_render_scratch *scratch, const pl_snapshot *shot) {
  if (shot->object_count > scratch->sun_count) {
    pl_sun_view *grown = pl_realloc(scratch->suns, shot->object_count, sizeof *grown);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for %zu objects", shot->object_count);
    scratch->suns = grown;
    scratch->sun_count = shot->object_count;
  }
  for (size_t i = 0; i < shot->object_count; i++)
    scratch->suns[i] = pl_sun_view_at(&shot->sun, shot->objects[i].center);
  return PL_OK;
}

/* Makes the buffers of effects that a frame has and no frame before it had. */
static pl_status make_effect_buffers(const job *job) {
  const pl_render_settings *settings = job->settings;
  void *room;
  for (int i = 0; i < job->scratch->threads && settings->samples > 0; i++) {
    pl_tile_buffers *b = &job->scratch->buffers[i];
    if (b->patches == NULL && filters_irradiance(job)) {
      PL_TRY(pl_alloc_or_fail(PL_TILE_PIXELS, sizeof *b->patches, "patches of a tile", &room));
      b->patches = room;
    }
    if (b->air == NULL && settings->air != NULL) {
      PL_TRY(pl_alloc_or_fail(1, sizeof *b->air, "the air of a tile", &room));
      b->air = room;
    }
  }
  return PL_OK;
}

/* Side of the blocks of a pilot: so small that they are a 16th of the picture, but so large that
 * they have PILOT_PIXELS. */
enum { PILOT_SIDE = 8, PILOT_PIXELS = 4096 };
static int block_of(const pl_render_settings *settings, const pl_camera *camera) {
  const int64_t pixels = (int64_t)camera->width * camera->height;
  int side = PL_TILE_SIDE;
  while (settings->pilot && side > PILOT_SIDE &&
         pixels * (side / 2) * (side / 2) >= PILOT_PIXELS * (int64_t)PL_TILE_PIXELS)
    side /= 2;
  return side;
}

/* Approximate number of rays per pixel: one through its centre, and those of colour and labels. */
static int rays_of(const pl_render_settings *settings) {
  const int count = settings->slice != NULL ? settings->slice->count : 0;
  return count > 0 ? (settings->samples + count - 1) / count
                   : 1 + settings->samples + settings->label_rays;
}

pl_status pl_render(const pl_snapshot *shot, const pl_tracer *tracer,
                    const pl_render_settings *settings, pl_render_scratch *scratch, pl_tile_fn done,
                    void *context, pl_cancel *cancel) {
  const int columns = (shot->rays.camera.width + PL_TILE_SIDE - 1) / PL_TILE_SIDE;
  const int row0 = settings->row0;
  const int row1 = settings->row1 > 0 ? settings->row1 : shot->rays.camera.height;
  const int rows = (row1 + PL_TILE_SIDE - 1) / PL_TILE_SIDE - row0 / PL_TILE_SIDE;
  job job = {
      .shot = shot,
      .tracer = tracer,
      .settings = settings,
      .scratch = scratch,
      .done = done,
      .context = context,
      .columns = columns,
      .row0 = row0,
      .row1 = row1,
      .pixel_rad = 1.0 / fmax(shot->rays.camera.fx, shot->rays.camera.fy),
      .block = block_of(settings, &shot->rays.camera),
  };
  pl_work_add(PL_WORK_pixels, (size_t)columns * (size_t)rows * PL_TILE_PIXELS);
  PL_TRY(view_suns(scratch, shot));
  PL_TRY(make_effect_buffers(&job));
  PL_TRY(pl_coverage_update(&scratch->coverage, shot, row0, row1, rays_of(settings),
                            scratch->threads));
  return filters_irradiance(&job) ? render_bands(&job, rows, cancel)
                                  : run_rows(&job, 0, rows, render_tile, cancel);
}
