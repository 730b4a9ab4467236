/* Voronoi cells about random sites: distances and a colour for each cell. */
#include <string.h>

#include "math/cellular.h"
#include "shade/node_pattern.h"
#include "shade/node_rows.h"

enum { FIRST, SECOND, EDGE, SMOOTH };
static const char *const features[] = {"first", "second", "edge", "smooth", NULL};

static float mean_of(int feature, float randomness, float smoothness) {
  switch (feature) {
  case FIRST:
    return pl_cellular_mean_first(randomness);
  case SECOND:
    return pl_cellular_mean_second(randomness);
  case EDGE:
    return pl_cellular_mean_edge(randomness);
  default:
    return pl_cellular_mean_smooth(randomness, smoothness);
  }
}

/* Against the unit vectors to the nearest sites. */
PL_WIDE static void first_gradient(const pl_cellular_lanes *cell, float gradient[3][PL_LANES]) {
  for (size_t axis = 0; axis < 3; axis++)
    PL_EACH_LANE(i) {
      const float by = cell->first[i] > 0.0f ? -1.0f / cell->first[i] : 0.0f;
      gradient[axis][i] = by * cell->to_site[axis][i];
    }
}

/* The distances of the feature, and the cells that contain the points. gradient: of the distances,
 * or NULL. */
static void find(const pl_node_call *call, int feature, const pl_pattern_place *place,
                 pl_cellular_lanes *cell, float distance[PL_LANES], float gradient[3][PL_LANES]) {
  const uint32_t seed = pl_pattern_seed(call, 1);
  const float *randomness = (*call->in[2])[0], *smoothness = (*call->in[3])[0];
  if (feature == EDGE) {
    pl_cellular_edge_lanes(&place->point, randomness, seed, cell, distance, gradient);
    return;
  }
  if (feature == SMOOTH) {
    pl_cellular_smooth_lanes(call->count, &place->point, randomness, smoothness, seed, cell,
                             distance, gradient);
    return;
  }
  if (feature == SECOND && gradient != NULL)
    pl_cellular_second_lanes(&place->point, randomness, seed, cell, gradient);
  else
    pl_cellular_find_lanes(&place->point, randomness, seed, cell);
  if (feature == FIRST && gradient != NULL)
    first_gradient(cell, gradient);
  memcpy(distance, feature == FIRST ? cell->first : cell->second, sizeof cell->first);
}

/* Factors on the deviations from the means: of colours, and of the feature's distance. */
PL_WIDE static bool fade(int feature, const pl_pattern_place *place, float *restrict left,
                         float *restrict kept) {
  int seen = 0;
  PL_EACH_LANE(i) {
    left[i] = pl_cellular_fade(place->width[i]);
    kept[i] = feature == EDGE ? pl_cellular_edge_fade(place->width[i]) : left[i];
    seen |= kept[i] > 0.0f ? 1 : 0;
  }
  return seen != 0;
}

PL_WIDE static void put(const pl_cellular_lanes *cell, const float *restrict distance,
                        const float *restrict mean, const float *restrict left,
                        const float *restrict kept, pl_lanes *restrict out) {
  const pl_vec3f half = {0.5f, 0.5f, 0.5f};
  PL_EACH_LANE(i) {
    pl_lane_scalar(out[0], i, mean[i] + kept[i] * (distance[i] - mean[i]));
    const pl_vec3f color = pl_vec3f_sub(pl_cellular_color(cell->id[i]), half);
    pl_lane_vector(out[1], i, pl_vec3f_madd(half, left[i], color), 0.0f);
  }
}

/* gradient: of the distance, or NULL. */
static void evaluate(const pl_node_call *call, float gradient[3][PL_LANES]) {
  const int feature = (int)call->constants[0].number;
  float left[PL_LANES], kept[PL_LANES], mean[PL_LANES], distance[PL_LANES];
  pl_cellular_lanes cell = {0};
  pl_pattern_place place;
  pl_pattern_place_of(call, &place);
  const bool seen = fade(feature, &place, left, kept);
  const size_t means = pl_node_lanes(call, 1u << 2 | 1u << 3);
  for (size_t i = 0; i < PL_LANES; i++) {
    mean[i] = i < means ? mean_of(feature, pl_node_number(call, 2, i), pl_node_number(call, 3, i))
                        : mean[0];
    distance[i] = mean[i];
  }
  float most = 0.0f;
  for (size_t i = 0; i < PL_LANES; i++)
    most = pl_maxf(left[i], most);
  if (most > 0.0f) /* if the cells have faded completely, no search is needed */
    find(call, seen ? feature : FIRST, &place, &cell, distance, gradient);
  for (size_t axis = 0; gradient != NULL && axis < 3; axis++)
    PL_EACH_LANE(i) gradient[axis][i] *= kept[i];
  put(&cell, distance, mean, left, kept, call->out);
}

static void voronoi(const pl_node_call *call) { evaluate(call, NULL); }

static void voronoi_slopes(const pl_node_call *call) {
  float gradient[3][PL_LANES] = {{0.0f}};
  evaluate(call, gradient);
  pl_pattern_slopes(call, (const float(*)[PL_LANES])gradient);
  memset(call->out_slopes[1], 0, sizeof(pl_slopes));
}

/* Of the distances of cells of one kind; colours have steps. */
static bool has_slopes(const pl_constant *constants, unsigned uniform, unsigned read) {
  static const unsigned SHAPED = 1u << 2 | 1u << 3;
  (void)constants;
  return (uniform & SHAPED) == SHAPED && (read & 1u << 1) == 0;
}

static const pl_socket inputs[] = {
    PL_PATTERN_VECTOR,
    {"randomness", PL_SCALAR, {1.0f, 1.0f, 1.0f}, "0: cubes; 1: sites anywhere in their cells"},
    {"smoothness", PL_SCALAR, {0.5f, 0.5f, 0.5f}, "0..1, rounds creases; of smooth alone"},
};
static const pl_socket outputs[] = {
    {"distance", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "In cells"},
    {"color", PL_COLOR, {0.0f, 0.0f, 0.0f}, "Of the cell: three numbers, uniform in 0..1"}};
static const pl_constant_row constants[] = {
    {"feature", PL_CHOICE, FIRST, 0, 0, features, 0,
     "The distance: first, to the nearest site; second, to the next; edge, to the nearest wall "
     "between cells; smooth, the first without creases"},
    PL_PATTERN_SEED};

const pl_node_kind pl_node_voronoi = {
    .name = "voronoi",
    .doc = "Cells about random sites; fades to its mean with the footprint",
    .inputs = inputs,
    .input_count = 4,
    .outputs = outputs,
    .output_count = 2,
    .constants = constants,
    .constant_count = 2,
    .evaluate = voronoi,
    .evaluate_slopes = voronoi_slopes,
    .has_slopes = has_slopes,
};
