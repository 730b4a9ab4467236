/* Heights of strips of nodes: layers of rasters and detail. */
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "terrain/crater_rays.h"
#include "terrain/diamond_blocks.h"
#include "terrain/rock_fillets.h"
#include "terrain/terrain_parts.h"

enum { STRIP = PL_DETAIL_STRIP, FEW = 8 };

/* A layer at the nodes of a strip. */
typedef struct layer_strip {
  int layer; /* its place among those of the terrain */
  bool detailed;
  int levels;                       /* of diamond-square */
  bool here[STRIP], fractal[STRIP]; /* whether the layer counts; whether detail is added to it */
  bool lifts;                       /* whether its apron adds to what is below it */
  double lift_m[STRIP];
  double u[STRIP], v[STRIP], weight[STRIP];
  double sums_m[STRIP]; /* detail */
} layer_strip;

typedef struct work {
  const pl_terrain *terrain;
  size_t above;      /* the first layer that is left out */
  int level, finest; /* of the lattice; of detail on it */
  pl_detail_strip strip;
  pl_vec3 directions[STRIP];
  bool bare[STRIP]; /* whether something below all rasters is seen */
  layer_strip few[FEW];
  layer_strip *layers; /* those that are seen, from the uppermost; `few` or of their own */
  size_t count, room;
  pl_posts posts;
} work;

static pl_status begin(work *w, const pl_terrain *terrain, int level) {
  w->terrain = terrain;
  w->above = terrain->layer_count;
  w->level = level < 0 ? 0 : level < PL_CUBE_LEVELS ? level : PL_CUBE_LEVELS - 1;
  w->finest = w->level < terrain->detail.last ? w->level : terrain->detail.last;
  w->layers = w->few;
  w->room = FEW;
  pl_posts_init(&w->posts, w->level);
  return terrain->diamond != NULL ? pl_diamond_blocks_ready() : PL_OK;
}

static void end(work *w) {
  if (w->layers != w->few)
    pl_free(w->layers);
}

/* Makes room for one more layer. */
static pl_status make_room(work *w) {
  if (w->count < w->room)
    return PL_OK;
  layer_strip *own = w->layers != w->few ? w->layers : NULL;
  layer_strip *more = pl_realloc(own, 2 * w->room, sizeof *more);
  if (more == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for %zu rasters at a place", 2 * w->room);
  if (own == NULL)
    memcpy(more, w->few, sizeof w->few);
  w->layers = more;
  w->room *= 2;
  return PL_OK;
}

/* Whether and how detail is added to a layer. */
static void set_detail(const work *w, const pl_layer *layer, layer_strip *at) {
  const double radius_m = w->terrain->radius_m;
  at->detailed = pl_cube_cell_m(w->level, radius_m) < layer->spacing_m &&
                 w->finest >= layer->coarsest && w->finest >= w->terrain->detail.first;
  at->levels = 0;
  if (at->detailed && layer->refined) {
    at->levels = pl_diamond_levels(&layer->diamond, pl_cube_cell_m(w->finest, radius_m));
    at->detailed = at->levels > 0;
  }
}

/* Writes where a layer is seen at the strip, and what it leaves of those below; whether anywhere.
 */
static bool see(work *w, layer_strip *at) {
  const pl_layer *layer = &w->terrain->layers[at->layer];
  const pl_raster *raster = layer->given.raster;
  bool used = false;
  for (size_t k = 0; k < w->strip.count; k++) {
    at->fractal[k] = false;
    at->here[k] = w->bare[k] && pl_raster_find(raster, w->directions[k], &at->u[k], &at->v[k]);
    if (!at->here[k])
      continue;
    at->weight[k] = pl_raster_weight(raster, at->u[k], at->v[k], layer->given.border_posts);
    at->here[k] = at->weight[k] > 0.0;
    w->bare[k] = at->weight[k] < 1.0;
    used = used || at->here[k];
    /* At posts, q - U(q) is 0 by definition, not but for rounding. */
    at->fractal[k] = at->detailed && at->here[k] &&
                     !(at->u[k] == floor(at->u[k]) && at->v[k] == floor(at->v[k]));
  }
  return used;
}

/* Writes what the layer's apron adds where something below the layer is seen; whether anything. */
static bool lift(const work *w, layer_strip *at) {
  const pl_apron *apron = w->terrain->layers[at->layer].apron;
  at->lifts = false;
  for (size_t k = 0; apron != NULL && k < w->strip.count; k++) {
    at->lift_m[k] = w->bare[k] ? pl_apron_lift_m(apron, w->directions[k]) : 0.0;
    at->lifts = at->lifts || at->lift_m[k] != 0.0;
  }
  return at->lifts;
}

/* Finds the layers that are seen: from the uppermost down to the first that covers all others. */
static pl_status find_layers(work *w) {
  const pl_vec3 first = w->directions[0];
  double reach = 0.0;
  for (size_t k = 0; k < w->strip.count; k++) {
    w->bare[k] = true;
    reach = fmax(reach, pl_vec3_norm(pl_vec3_sub(w->directions[k], first)));
  }
  w->count = 0;
  for (size_t n = w->above; n-- > 0;) {
    const pl_layer *layer = &w->terrain->layers[n];
    const double apron_m = layer->apron != NULL ? layer->apron->width_m : 0.0;
    if (pl_raster_far(layer->given.raster, first, reach + apron_m / w->terrain->radius_m))
      continue;
    PL_TRY(make_room(w));
    layer_strip *at = &w->layers[w->count];
    at->layer = (int)n;
    set_detail(w, layer, at);
    const bool seen = see(w, at);
    if (lift(w, at) || seen)
      w->count++;
  }
  return PL_OK;
}

static void cut(const work *w, int coarsest, double *sums_m) {
  const double bound_m =
      PL_DETAIL_BOUND * pl_fractal_detail_deviation_m(&w->terrain->detail, coarsest, w->level);
  for (size_t k = 0; k < w->strip.count; k++)
    sums_m[k] = pl_fractal_detail_cut(sums_m[k], bound_m);
}

/* Sums octaves from the finest; each layer takes the sum of those that it needs. `sums_m` returns
 * the sum of all if it is needed, else less. */
static void sum_detail(work *w, double *sums_m) {
  const pl_fractal_detail *detail = &w->terrain->detail;
  int coarsest = w->finest + 1;
  for (size_t k = 0; k < w->strip.count; k++) {
    sums_m[k] = 0.0;
    if (w->bare[k])
      coarsest = detail->first;
  }
  for (size_t n = 0; n < w->count; n++) {
    const pl_layer *layer = &w->terrain->layers[w->layers[n].layer];
    if (w->layers[n].detailed && !layer->refined && layer->coarsest < coarsest)
      coarsest = layer->coarsest;
  }
  for (int octave = w->finest; octave >= coarsest; octave--) {
    pl_fractal_detail_add(detail, &w->strip, octave, w->level, &w->posts.cache, sums_m);
    for (size_t n = 0; n < w->count; n++)
      if (w->terrain->layers[w->layers[n].layer].coarsest == octave)
        memcpy(w->layers[n].sums_m, sums_m, w->strip.count * sizeof *sums_m);
  }
  cut(w, detail->first, sums_m);
}

/* The level of the raster's pyramid whose posts are about as far apart as nodes, or closer. */
static int pyramid_level(const work *w, const pl_layer *layer) {
  const double posts = pl_cube_cell_m(w->level, w->terrain->radius_m) / layer->spacing_m;
  return posts > 1.0 ? (int)floor(log2(posts) + 0.25) : 0;
}

/* Sets the layer's sums to the heights above its interpolated posts. */
static void set_added(work *w, layer_strip *at) {
  const pl_layer *layer = &w->terrain->layers[at->layer];
  double posts_m[STRIP];
  if (layer->refined) {
    for (size_t k = 0; k < w->strip.count; k++)
      if (at->fractal[k])
        at->sums_m[k] = pl_diamond_square_height(&layer->diamond, w->terrain->diamond, at->levels,
                                                 at->u[k], at->v[k]);
    return;
  }
  cut(w, layer->coarsest, at->sums_m);
  pl_posts_interpolate(&w->posts, w->terrain, at->layer, w->strip.count, at->u, at->v, at->fractal,
                       posts_m);
  for (size_t k = 0; k < w->strip.count; k++)
    if (at->fractal[k])
      at->sums_m[k] -= posts_m[k];
}

/* Lays one layer over the heights. */
static void lay(work *w, layer_strip *at, double *heights_m) {
  const pl_layer *layer = &w->terrain->layers[at->layer];
  const pl_terrain_layer *given = &layer->given;
  const int pyramid = pyramid_level(w, layer);
  if (at->detailed)
    set_added(w, at);
  for (size_t k = 0; at->lifts && k < w->strip.count; k++)
    heights_m[k] += at->lift_m[k];
  for (size_t k = 0; k < w->strip.count; k++) {
    if (!at->here[k])
      continue;
    double height_m =
        pl_raster_value(given->raster, pyramid, at->u[k], at->v[k], given->interpolation);
    if (at->fractal[k])
      height_m += at->sums_m[k];
    if (given->datum_m > 0.0)
      height_m += given->datum_m - pl_terrain_datum_m(w->terrain, w->directions[k]);
    heights_m[k] =
        at->weight[k] < 1.0 ? heights_m[k] + at->weight[k] * (height_m - heights_m[k]) : height_m;
  }
}

/* Heights in w->directions. */
static pl_status evaluate(work *w, double *heights_m) {
  for (size_t k = 0; k < w->strip.count; k++) {
    w->strip.x[k] = w->directions[k].x;
    w->strip.y[k] = w->directions[k].y;
    w->strip.z[k] = w->directions[k].z;
  }
  pl_detail_strip_close(&w->strip);
  PL_TRY(find_layers(w));
  sum_detail(w, heights_m);
  for (size_t n = w->count; n-- > 0;)
    lay(w, &w->layers[n], heights_m);
  return PL_OK;
}

/* Heights without craters, of any number of directions. */
static pl_status base_heights(work *w, const pl_vec3 *directions, size_t count, double *heights_m) {
  for (size_t done = 0; done < count; done += w->strip.count) {
    w->strip.count = count - done < STRIP ? count - done : STRIP;
    for (size_t k = 0; k < w->strip.count; k++)
      w->directions[k] = directions[done + k];
    PL_TRY(evaluate(w, heights_m + done));
  }
  return PL_OK;
}

/* Writes heights without craters, textures and tracks, of the first `layers` rasters and detail. */
static pl_status heights_below(const pl_terrain *terrain, size_t layers, const pl_vec3 *directions,
                               size_t count, int level, double *heights_m) {
  work w;
  PL_TRY(begin(&w, terrain, level));
  w.above = layers;
  const pl_status status = base_heights(&w, directions, count, heights_m);
  end(&w);
  return status;
}

/* Mean height of a layer about a place, over cells of its pyramid that are as wide as its border,
 * or a piece of the apron. */
static double mean_height_m(const pl_terrain *terrain, const pl_layer *layer, double u, double v,
                            pl_vec3 direction, double width_posts) {
  const int pyramid = (int)fmax(rint(log2(width_posts)), 0.0);
  double height_m = pl_raster_value(layer->given.raster, pyramid, u, v, PL_INTERPOLATION_BILINEAR);
  if (layer->given.datum_m > 0.0)
    height_m += layer->given.datum_m - pl_terrain_datum_m(terrain, direction);
  return height_m;
}

static pl_status add_apron(pl_terrain *terrain, size_t n, double apron_m) {
  pl_layer *layer = &terrain->layers[n];
  const pl_raster *raster = layer->given.raster;
  const pl_raster_frame *frame = pl_raster_frame_of(raster);
  double u[PL_APRON_PLACES], v[PL_APRON_PLACES], below_m[PL_APRON_PLACES];
  pl_vec3 directions[PL_APRON_PLACES];
  void *memory;
  pl_apron_places(raster, u, v);
  for (int k = 0; k < PL_APRON_PLACES; k++)
    directions[k] = pl_raster_direction(raster, u[k], v[k]);
  const double posts = (double)(frame->width > frame->height ? frame->width : frame->height);
  const double width_posts = fmax(layer->given.border_posts, posts / PL_APRON_PIECES);
  const int level = pl_cube_level(width_posts * layer->spacing_m, terrain->radius_m);
  PL_TRY(heights_below(terrain, n, directions, PL_APRON_PLACES, level, below_m));
  for (int k = 0; k < PL_APRON_PLACES; k++)
    below_m[k] = mean_height_m(terrain, layer, u[k], v[k], directions[k], width_posts) - below_m[k];
  PL_TRY(pl_alloc_or_fail(1, sizeof *layer->apron, "the apron of a raster", &memory));
  pl_apron_init(raster, below_m, apron_m, terrain->radius_m, memory);
  layer->apron = memory;
  return PL_OK;
}

pl_status pl_terrain_add_aprons(pl_terrain *terrain, const double *aprons_m) {
  for (size_t n = 0; n < terrain->layer_count; n++)
    if (aprons_m[n] > 0.0) {
      if (pl_raster_goes_round(terrain->layers[n].given.raster))
        return pl_fail(PL_E_RANGE,
                       "layer %zu of a terrain: an apron of a raster that goes around "
                       "the body",
                       n);
      PL_TRY(add_apron(terrain, n, aprons_m[n]));
    }
  return PL_OK;
}

/* Spacing of the posts of the uppermost raster in a direction, for pl_crater_model. */
static double posts_m(const void *context, pl_vec3 direction) {
  const pl_terrain *terrain = context;
  for (size_t n = terrain->layer_count; n-- > 0;) {
    const pl_layer *layer = &terrain->layers[n];
    double u, v;
    if (!pl_raster_far(layer->given.raster, direction, 0.0) &&
        pl_raster_find(layer->given.raster, direction, &u, &v) &&
        pl_raster_weight(layer->given.raster, u, v, layer->given.border_posts) >= 0.5)
      return layer->spacing_m;
  }
  return INFINITY;
}

/* Fraction of a crater that is drawn beside the rasters that show it, for pl_crater_model. It fades
 * over half its radius, so that the raster stands on no cliff. */
static double left_of(const void *context, pl_vec3 direction, double diameter_m, double posts) {
  const pl_terrain *terrain = context;
  double left = 1.0;
  for (size_t n = terrain->layer_count; n-- > 0 && left > 0.0;) {
    const pl_layer *layer = &terrain->layers[n];
    const bool whole = pl_raster_whole(layer->given.raster);
    if (diameter_m >= posts * layer->spacing_m) {
      const double away_m =
          whole ? 0.0 : pl_raster_outside_m(layer->given.raster, direction, terrain->radius_m);
      const double t = fmin(away_m / (0.25 * diameter_m), 1.0);
      left *= t * t * (3.0 - 2.0 * t);
    }
    if (whole) /* those below are hidden */
      break;
  }
  return left;
}

pl_crater_model pl_terrain_crater_model(const pl_terrain *terrain) {
  pl_crater_model model = {posts_m, terrain, left_of, INFINITY};
  for (size_t n = 0; n < terrain->layer_count; n++)
    model.least_spacing_m = fmin(model.least_spacing_m, terrain->layers[n].spacing_m);
  return model;
}

pl_status pl_terrain_craters(const pl_terrain *terrain, pl_vec3 direction, double radius_m,
                             double min_m, double max_m, pl_crater **out, size_t *count) {
  *out = NULL;
  *count = 0;
  const pl_crater_model model = pl_terrain_crater_model(terrain);
  return terrain->craters == NULL ? PL_OK
                                  : pl_crater_list(terrain->craters, &model, direction, radius_m,
                                                   min_m, max_m, out, count);
}

pl_status pl_terrain_sources(const pl_terrain *terrain, const pl_crater_blocks *blocks,
                             pl_vec3 axis, double angle_rad, pl_crater_source **out,
                             size_t *count) {
  const pl_crater_model model = pl_terrain_crater_model(terrain);
  return pl_crater_sources(terrain->craters, &model, blocks, axis, angle_rad, out, count);
}

pl_status pl_terrain_rays(const pl_terrain *terrain, const pl_vec3 *directions, size_t count,
                          int level, float *out) {
  const pl_crater_model model = pl_terrain_crater_model(terrain);
  if (terrain->craters != NULL)
    return pl_crater_add_rays(terrain->craters, &model, directions, count,
                              pl_cube_cell_m(level, terrain->radius_m), out);
  memset(out, 0, count * sizeof *out);
  return PL_OK;
}

double pl_terrain_ray_brightness(const pl_terrain *terrain) {
  return terrain->craters != NULL ? pl_crater_field_frame(terrain->craters)->rays.brightness : 0.0;
}

static pl_status heights_below_fillets(work *w, const pl_vec3 *directions, size_t count,
                                       double *heights_m) {
  const pl_terrain *terrain = w->terrain;
  const double cell_m = pl_cube_cell_m(w->level, terrain->radius_m);
  PL_TRY(base_heights(w, directions, count, heights_m));
  pl_terrain_add_textures(terrain, directions, count, cell_m, heights_m);
  if (terrain->tracks != NULL)
    pl_wheel_tracks_add_heights(terrain->tracks, directions, count, cell_m, heights_m);
  if (terrain->craters == NULL)
    return PL_OK;
  const pl_crater_model model = pl_terrain_crater_model(terrain);
  return pl_crater_add_heights(terrain->craters, &model, directions, count, cell_m, heights_m);
}

static pl_status full_heights(work *w, const pl_vec3 *directions, size_t count, double *heights_m) {
  const pl_terrain *terrain = w->terrain;
  PL_TRY(heights_below_fillets(w, directions, count, heights_m));
  return terrain->rocks == NULL
             ? PL_OK
             : pl_rock_fillets_add(terrain->rocks, terrain, directions, count,
                                   pl_cube_cell_m(w->level, terrain->radius_m), heights_m);
}

typedef pl_status (*heights_fn)(work *w, const pl_vec3 *directions, size_t count,
                                double *heights_m);

static pl_status heights_by(heights_fn of, const pl_terrain *terrain, const pl_vec3 *directions,
                            size_t count, int level, double *heights_m) {
  work w;
  PL_TRY(begin(&w, terrain, level));
  const pl_status status = of(&w, directions, count, heights_m);
  end(&w);
  return status;
}

pl_status pl_terrain_heights(const pl_terrain *terrain, const pl_vec3 *directions, size_t count,
                             int level, double *heights_m) {
  return heights_by(full_heights, terrain, directions, count, level, heights_m);
}

pl_status pl_terrain_heights_below_fillets(const pl_terrain *terrain, const pl_vec3 *directions,
                                           size_t count, int level, double *heights_m) {
  return heights_by(heights_below_fillets, terrain, directions, count, level, heights_m);
}

double pl_terrain_height(const pl_terrain *terrain, pl_vec3 direction, int level) {
  double height_m;
  return pl_terrain_heights(terrain, &direction, 1, level, &height_m) == PL_OK ? height_m
                                                                               : (double)NAN;
}

double pl_terrain_base_height(const pl_terrain *terrain, pl_vec3 direction, int level) {
  work w;
  double height_m;
  if (begin(&w, terrain, level) != PL_OK)
    return (double)NAN;
  const pl_status status = base_heights(&w, &direction, 1, &height_m);
  end(&w);
  return status == PL_OK ? height_m : (double)NAN;
}

/* Blocks are evaluated in parts of at most this many nodes on a side; a tile is one of them. */
enum { PART = 36 };

static pl_status part_heights(work *w, const pl_terrain_nodes *nodes, int column, int row,
                              double *heights_m, pl_vec3 *directions) {
  const int width = nodes->width - column < PART ? nodes->width - column : PART;
  const int height = nodes->height - row < PART ? nodes->height - row : PART;
  double across[PART], found_m[PART * PART];
  pl_vec3 found[PART * PART];
  for (int i = 0; i < width; i++)
    across[i] = pl_cube_tangent(pl_cube_node(nodes->level, nodes->i0 + column + i));
  for (int j = 0; j < height; j++) {
    const double along = pl_cube_tangent(pl_cube_node(nodes->level, nodes->j0 + row + j));
    for (int i = 0; i < width; i++)
      found[j * width + i] = pl_cube_tangent_direction(nodes->face, across[i], along);
  }
  PL_TRY(full_heights(w, found, (size_t)width * (size_t)height, found_m));
  for (int j = 0; j < height; j++) {
    const size_t at = (size_t)(row + j) * (size_t)nodes->width + (size_t)column;
    memcpy(heights_m + at, found_m + j * width, (size_t)width * sizeof *heights_m);
    if (directions != NULL)
      memcpy(directions + at, found + j * width, (size_t)width * sizeof *directions);
  }
  return PL_OK;
}

pl_status pl_terrain_block(const pl_terrain *terrain, const pl_terrain_nodes *nodes,
                           double *heights_m, pl_vec3 *directions) {
  work w;
  PL_TRY(begin(&w, terrain, nodes->level));
  pl_status status = PL_OK;
  for (int row = 0; row < nodes->height; row += PART)
    for (int column = 0; column < nodes->width && status == PL_OK; column += PART)
      status = part_heights(&w, nodes, column, row, heights_m, directions);
  end(&w);
  return status;
}
