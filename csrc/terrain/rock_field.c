#include "terrain/rock_field.h"

#include "base/memory.h"
#include "terrain/rock_parts.h"

#define PURPOSE_ROCKS UINT64_C(0x726f636b73)
#define LEAST_BURIAL 0.05
#define MOST_BURIAL 0.9

pl_rock_frame pl_rock_frame_default(double radius_m) {
  pl_rock_frame frame = {.radius_m = radius_m,
                         .law = {.kind = PL_ROCKS_VIPER, .factor = 1.0, .cutoff_m = 3.0},
                         .min_m = fmax(0.05, PL_SCATTER_MIN_OF_RADIUS * radius_m),
                         .max_m = fmin(20.0, PL_SCATTER_MAX_OF_RADIUS * radius_m),
                         .least_burial = 0.1,
                         .most_burial = 0.5,
                         .repose_rad = 35.0 * PL_PI / 180.0};
  static const double shares[PL_ROCK_FAMILIES] = {
      [PL_ROCK_BLOCK] = 3.0, [PL_ROCK_CUBE] = 1.0,    [PL_ROCK_WEDGE] = 2.0,
      [PL_ROCK_SLAB] = 1.0,  [PL_ROCK_TABLET] = 0.5,  [PL_ROCK_SHARD] = 0.5,
      [PL_ROCK_SPLIT] = 1.0, [PL_ROCK_COBBLE] = 1.0,  [PL_ROCK_BOULDER] = 4.0,
      [PL_ROCK_EGG] = 0.5,   [PL_ROCK_BRECCIA] = 2.0, [PL_ROCK_PITTED] = 2.0,
  };
  for (int k = 0; k < PL_ROCK_FAMILIES; k++)
    frame.families[k] = shares[k];
  return frame;
}

static pl_status check_families(const pl_rock_frame *frame) {
  double sum = 0.0;
  for (int k = 0; k < PL_ROCK_FAMILIES; k++) {
    if (!(frame->families[k] >= 0.0 && isfinite(frame->families[k])))
      return pl_fail(PL_E_RANGE, "share %g of rocks of family '%s'; must be 0 or more",
                     frame->families[k], pl_rock_families[k].name);
    sum += frame->families[k];
  }
  return sum > 0.0 && isfinite(sum)
             ? PL_OK
             : pl_fail(PL_E_RANGE, "the shares of families of rocks sum to %g; must be above 0",
                       sum);
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
  PL_TRY(check_families(frame));
  PL_TRY(pl_rock_law_check(&frame->law, frame->min_m, frame->max_m));
  const double cover = pl_rock_cover(&frame->law, frame->min_m, frame->max_m);
  if (!(cover <= PL_ROCK_COVER_MOST))
    return pl_fail(PL_E_RANGE,
                   "law '%s' covers %.3g of the ground with rocks of %g m or more; at most %g: "
                   "raise the least diameter or lower the density",
                   pl_rock_laws[frame->law.kind].name, cover, frame->min_m, PL_ROCK_COVER_MOST);
  return PL_OK;
}

static pl_status fill(pl_rock_field *field, const pl_rock_frame *frame) {
  field->frame = *frame;
  if (frame->law.kind == PL_ROCKS_TABLE)
    PL_TRY(pl_size_points_copy(&field->frame.law.table, &field->table));
  double sum = 0.0;
  for (int k = 0; k < PL_ROCK_FAMILIES; k++)
    field->families[k] = sum += frame->families[k];
  for (int k = 0; k < PL_ROCK_FAMILIES; k++)
    field->families[k] /= sum;
  PL_TRY(pl_rock_spheres_create(&field->spheres));
  return pl_scatter_init(frame->radius_m, frame->seed, PURPOSE_ROCKS, pl_rock_density,
                         &field->frame.law, frame->min_m, frame->max_m, &field->scatter);
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
  pl_rock_spheres_destroy(field->spheres);
  pl_free(field);
}

const pl_rock_frame *pl_rock_field_frame(const pl_rock_field *field) { return &field->frame; }

/* Shapes reach to 1.2 diameters from their centres, which are within 0.8 of the ground. */
double pl_rock_reach_m(const pl_rock_field *field) {
  return field != NULL ? 2.0 * field->frame.max_m : 0.0;
}

const pl_rock_sphere *pl_rock_field_spheres(const pl_rock_field *field) { return field->spheres; }

/* Whether a place in a cell, in 2^-53 of it, is in part `at` of its 2^below parts. */
static bool is_in(uint64_t place, int below, uint64_t at) {
  return place >> (53 - below) == (at & ((UINT64_C(1) << below) - 1));
}

pl_status pl_rock_sites(const pl_rock_field *field, const pl_rock_square *square,
                        pl_rock_site_fn visit, void *context) {
  const pl_scatter *scatter = &field->scatter;
  for (int level = scatter->first; level <= scatter->last && level <= square->level; level++) {
    const int below = square->level - level;
    const pl_scatter_cell cell = {level, square->face, square->i >> below, square->j >> below};
    const uint64_t count = pl_scatter_count(scatter, &cell);
    for (uint64_t n = 0; n < count; n++) {
      pl_scatter_site site;
      if (pl_scatter_draw(scatter, &cell, n, NULL, &site) &&
          is_in(site.place[0], below, square->i) && is_in(site.place[1], below, square->j))
        PL_TRY(visit(context, &site));
    }
  }
  return PL_OK;
}

bool pl_rock_find(const pl_rock_field *field, const pl_terrain *terrain, uint64_t id, pl_rock *rock,
                  pl_rock_shape *shape) {
  pl_scatter_site site;
  return pl_scatter_find(&field->scatter, id, &site) &&
         pl_rock_set(field, terrain, &site, rock, shape);
}
