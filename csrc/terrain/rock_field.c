#include "terrain/rock_field.h"

#include "base/memory.h"
#include "math/philox.h"
#include "terrain/rock_parts.h"

#define PURPOSE_ROCKS UINT64_C(0x726f636b73)
#define PURPOSE_BLOCKS UINT64_C(0x626c6f636b73)
#define DENSEST_EJECTA 1000.0
/* Random words of a block: whether it is there. */
enum { FOR_BLOCK = 8 };
#define LEAST_BURIAL 0.05
#define MOST_BURIAL 0.9

pl_rock_frame pl_rock_frame_default(double radius_m) {
  pl_rock_frame frame = {.radius_m = radius_m,
                         .law = {.kind = PL_ROCKS_VIPER, .factor = 1.0, .cutoff_m = 3.0},
                         .min_m = fmax(0.05, PL_SCATTER_MIN_OF_RADIUS * radius_m),
                         .max_m = fmin(20.0, PL_SCATTER_MAX_OF_RADIUS * radius_m),
                         .least_burial = 0.1,
                         .most_burial = 0.5,
                         .repose_rad = 35.0 * PL_PI / 180.0,
                         .ejecta = {.craters = {.life_ga = 0.3, .least_m = 25.0}}};
  static const double weights[PL_ROCK_FAMILIES] = {
      [PL_ROCK_BLOCK] = 3.0, [PL_ROCK_CUBE] = 1.0,    [PL_ROCK_WEDGE] = 2.0,
      [PL_ROCK_SLAB] = 1.0,  [PL_ROCK_TABLET] = 0.5,  [PL_ROCK_SHARD] = 0.5,
      [PL_ROCK_SPLIT] = 1.0, [PL_ROCK_COBBLE] = 1.0,  [PL_ROCK_BOULDER] = 4.0,
      [PL_ROCK_EGG] = 0.5,   [PL_ROCK_BRECCIA] = 2.0, [PL_ROCK_PITTED] = 2.0,
  };
  for (int k = 0; k < PL_ROCK_FAMILIES; k++)
    frame.families[k] = weights[k];
  return frame;
}

static pl_status check_scans(const pl_rock_frame *frame) {
  const bool shared = frame->families[PL_ROCK_MODEL] > 0.0;
  if (frame->scan_count > PL_ROCK_VARIANTS)
    return pl_fail(PL_E_RANGE, "%zu models of rocks; at most %d", frame->scan_count,
                   PL_ROCK_VARIANTS);
  if (shared && frame->scan_count == 0)
    return pl_fail(PL_E_RANGE, "the family 'model' of rocks has a weight, but no models");
  if (!shared && frame->scan_count > 0)
    return pl_fail(PL_E_RANGE, "models of rocks need a weight of the family 'model'");
  return PL_OK;
}

static pl_status check_families(const pl_rock_frame *frame) {
  PL_TRY(check_scans(frame));
  double sum = 0.0;
  for (int k = 0; k < PL_ROCK_FAMILIES; k++) {
    if (!(frame->families[k] >= 0.0 && isfinite(frame->families[k])))
      return pl_fail(PL_E_RANGE, "weight %g of rocks of family '%s'; must be 0 or more",
                     frame->families[k], pl_rock_families[k].name);
    sum += frame->families[k];
  }
  return sum > 0.0 && isfinite(sum)
             ? PL_OK
             : pl_fail(PL_E_RANGE, "the weights of families of rocks sum to %g; must be above 0",
                       sum);
}

static pl_status check_ejecta(const pl_rock_ejecta *ejecta) {
  const pl_crater_blocks *craters = &ejecta->craters;
  if (ejecta->at_rim == 0.0 ||
      (ejecta->at_rim > 0.0 && ejecta->at_rim <= DENSEST_EJECTA && craters->life_ga > 0.0 &&
       isfinite(craters->life_ga) && craters->least_m > 0.0 && isfinite(craters->least_m)))
    return PL_OK;
  return pl_fail(PL_E_RANGE,
                 "blocks about craters of %g m or more and %g Ga or less, at rims %g times the "
                 "rocks elsewhere; must be above 0, the last at most %g",
                 craters->least_m, craters->life_ga, ejecta->at_rim, DENSEST_EJECTA);
}

static pl_status check_frame(const pl_rock_frame *frame) {
  PL_TRY(pl_scatter_check("rocks", frame->radius_m, frame->min_m, frame->max_m));
  if (!(frame->least_burial >= LEAST_BURIAL && frame->most_burial >= frame->least_burial &&
        frame->most_burial <= MOST_BURIAL))
    return pl_fail(PL_E_RANGE,
                   "burial of rocks from %g to %g; must be from %g to %g, the least not above the "
                   "greatest",
                   frame->least_burial, frame->most_burial, LEAST_BURIAL, MOST_BURIAL);
  if (!(frame->repose_rad > 0.0 && frame->repose_rad < 0.5 * PL_PI))
    return pl_fail(PL_E_RANGE, "repose_rad = %g of rocks; must be above 0 and below pi/2",
                   frame->repose_rad);
  if (!(frame->fillet >= 0.0 && frame->fillet <= PL_ROCK_FILLET_MOST))
    return pl_fail(PL_E_RANGE, "fillet = %g of rocks; must be from 0 to %g", frame->fillet,
                   PL_ROCK_FILLET_MOST);
  PL_TRY(check_families(frame));
  PL_TRY(pl_rock_law_check(&frame->law, frame->min_m, frame->max_m));
  PL_TRY(check_ejecta(&frame->ejecta));
  const double cover =
      (1.0 + frame->ejecta.at_rim) * pl_rock_cover(&frame->law, frame->min_m, frame->max_m);
  if (!(cover <= PL_ROCK_COVER_MOST))
    return pl_fail(PL_E_RANGE,
                   "law '%s' covers %.3g of the ground with rocks of %g m or more%s; at most %g: "
                   "raise the least diameter or lower the density",
                   pl_rock_laws[frame->law.kind].name, cover, frame->min_m,
                   frame->ejecta.at_rim > 0.0 ? " at the rims of craters" : "", PL_ROCK_COVER_MOST);
  return PL_OK;
}

static double block_density(const void *field, double diameter_m) {
  const pl_rock_frame *frame = &((const pl_rock_field *)field)->frame;
  return frame->ejecta.at_rim * pl_rock_density(&frame->law, diameter_m);
}

/* Candidates are as dense everywhere as about new craters. */
static pl_status fill_blocks(pl_rock_field *field) {
  const pl_rock_frame *frame = &field->frame;
  PL_TRY(pl_scatter_init(frame->radius_m, frame->seed, PURPOSE_BLOCKS, block_density, field,
                         frame->min_m, frame->max_m, &field->blocks));
  for (int level = field->scatter.first; level <= field->scatter.last; level++)
    if (field->scatter.octaves[level].count > PL_ROCK_BLOCK_BIT ||
        field->blocks.octaves[level].count > PL_ROCK_BLOCK_BIT)
      return pl_fail(PL_E_RANGE,
                     "rocks of %g m and more are too dense for %g times as many about craters: "
                     "raise the least diameter or lower the density",
                     field->scatter.octaves[level].low_m, frame->ejecta.at_rim);
  return PL_OK;
}

static pl_status fill(pl_rock_field *field, const pl_rock_frame *frame) {
  field->frame = *frame;
  field->frame.scans = NULL; /* the list is the caller's */
  if (frame->law.kind == PL_ROCKS_TABLE)
    PL_TRY(pl_size_points_copy(&field->frame.law.table, &field->table));
  double sum = 0.0;
  for (int k = 0; k < PL_ROCK_FAMILIES; k++)
    field->families[k] = sum += frame->families[k];
  for (int k = 0; k < PL_ROCK_FAMILIES; k++)
    field->families[k] /= sum;
  PL_TRY(pl_rock_spheres_create(&field->spheres));
  PL_TRY(
      pl_rock_variants_create(field->spheres, frame->scans, frame->scan_count, &field->variants));
  PL_TRY(pl_scatter_init(frame->radius_m, frame->seed, PURPOSE_ROCKS, pl_rock_density,
                         &field->frame.law, frame->min_m, frame->max_m, &field->scatter));
  return frame->ejecta.at_rim > 0.0 ? fill_blocks(field) : PL_OK;
}

pl_status pl_rock_field_create(const pl_rock_frame *frame, pl_rock_field **out) {
  *out = NULL;
  PL_TRY(check_frame(frame));
  void *memory;
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_rock_field), "a field of rocks", &memory));
  pl_rock_field *field = memory;
  const pl_status status = fill(field, frame);
  if (status != PL_OK) {
    pl_rock_field_destroy(field);
    return status;
  }
  *out = field;
  return PL_OK;
}

void pl_rock_field_destroy(pl_rock_field *field) {
  if (field == NULL)
    return;
  pl_free(field->table);
  pl_scatter_clear(&field->scatter);
  pl_scatter_clear(&field->blocks);
  pl_free(field->variants);
  pl_rock_spheres_destroy(field->spheres);
  pl_free(field);
}

const pl_rock_frame *pl_rock_field_frame(const pl_rock_field *field) { return &field->frame; }

/* Shapes reach to 1.2 diameters from their centres, which are within 0.8 of the ground. */
double pl_rock_reach_m(const pl_rock_field *field) {
  return field != NULL ? 2.0 * field->frame.max_m : 0.0;
}

const pl_rock_sphere *pl_rock_field_spheres(const pl_rock_field *field) { return field->spheres; }

const pl_rock_variant *pl_rock_field_variants(const pl_rock_field *field) {
  return field->variants;
}

/* Whether a place in a cell, in 2^-53 of it, is in part `at` of its 2^below parts. */
static bool is_in(uint64_t place, int below, uint64_t at) {
  return place >> (53 - below) == (at & ((UINT64_C(1) << below) - 1));
}

pl_status pl_rock_region_init(const pl_rock_field *field, const pl_terrain *terrain, pl_vec3 axis,
                              double angle_rad, pl_rock_region *out) {
  *out = (pl_rock_region){.field = field};
  if (!(field->frame.ejecta.at_rim > 0.0))
    return PL_OK;
  return pl_terrain_sources(terrain, &field->frame.ejecta.craters, axis, angle_rad, &out->sources,
                            &out->source_count);
}

void pl_rock_region_clear(pl_rock_region *region) { pl_free(region->sources); }

uint64_t pl_rock_candidates(const pl_rock_region *region, const pl_scatter_cell *cell,
                            uint64_t *laws) {
  *laws = pl_scatter_count(&region->field->scatter, cell);
  return *laws + (region->source_count > 0 ? pl_scatter_count(&region->field->blocks, cell) : 0);
}

/* Whether a candidate for a block is one. */
static bool is_block(const pl_rock_region *region, pl_scatter_site *site) {
  uint64_t words[4];
  pl_scatter_words(&region->field->blocks, site->id, FOR_BLOCK, words);
  site->id |= PL_ROCK_BLOCK_BIT;
  return pl_philox_double(words[0]) < pl_crater_blocks_at(region->sources, region->source_count,
                                                          site->direction, site->diameter_m);
}

bool pl_rock_draw(const pl_rock_region *region, const pl_scatter_cell *cell, uint64_t n,
                  uint64_t laws, pl_scatter_site *out) {
  const pl_rock_field *field = region->field;
  if (n < laws)
    return pl_scatter_draw(&field->scatter, cell, n, NULL, out);
  return pl_scatter_draw(&field->blocks, cell, n - laws, NULL, out) && is_block(region, out);
}

static pl_status visit_squares(const pl_rock_region *region, const pl_rock_square *square,
                               pl_rock_site_fn visit, void *context) {
  const pl_scatter *scatter = &region->field->scatter;
  for (int level = scatter->first; level <= scatter->last && level <= square->level; level++) {
    const int below = square->level - level;
    const pl_scatter_cell cell = {level, square->face, square->i >> below, square->j >> below};
    uint64_t laws;
    const uint64_t count = pl_rock_candidates(region, &cell, &laws);
    for (uint64_t n = 0; n < count; n++) {
      pl_scatter_site site;
      if (pl_rock_draw(region, &cell, n, laws, &site) && is_in(site.place[0], below, square->i) &&
          is_in(site.place[1], below, square->j))
        PL_TRY(visit(context, &site));
    }
  }
  return PL_OK;
}

pl_status pl_rock_sites(const pl_rock_field *field, const pl_terrain *terrain,
                        const pl_rock_square *square, pl_rock_site_fn visit, void *context) {
  const double side = ldexp(2.0, -square->level);
  const pl_vec3 middle = pl_cube_direction(square->face, side * ((double)square->i + 0.5) - 1.0,
                                           side * ((double)square->j + 0.5) - 1.0);
  pl_rock_region region;
  if (square->level < field->scatter.first)
    return PL_OK;
  /* Half the diagonal of a cell is below 0.71 of its width. */
  PL_TRY(pl_rock_region_init(field, terrain, middle, 0.71 * ldexp(0.5 * PL_PI, -square->level),
                             &region));
  const pl_status status = visit_squares(&region, square, visit, context);
  pl_rock_region_clear(&region);
  return status;
}

static bool find_block(const pl_rock_field *field, const pl_terrain *terrain, uint64_t id,
                       pl_scatter_site *site) {
  pl_rock_region region;
  if (!(field->frame.ejecta.at_rim > 0.0) ||
      !pl_scatter_find(&field->blocks, id & ~(uint64_t)PL_ROCK_BLOCK_BIT, site) ||
      pl_rock_region_init(field, terrain, site->direction, 0.0, &region) != PL_OK)
    return false;
  const bool found = is_block(&region, site);
  pl_rock_region_clear(&region);
  return found;
}

bool pl_rock_find(const pl_rock_field *field, const pl_terrain *terrain, uint64_t id, pl_rock *rock,
                  pl_rock_shape *shape) {
  pl_scatter_site site;
  const bool blocks = field->frame.ejecta.at_rim > 0.0 && (id & PL_ROCK_BLOCK_BIT) != 0;
  const bool found =
      blocks ? find_block(field, terrain, id, &site) : pl_scatter_find(&field->scatter, id, &site);
  return found && pl_rock_set(field, terrain, &site, rock, shape);
}
