/* Voronoi cells about random sites: distances and a colour for each cell. */
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

/* The distance of the feature, and the cell that contains the point. */
static float find(int feature, pl_vec3 point, float randomness, float smoothness, uint32_t seed,
                  pl_cellular *cell) {
  if (feature == EDGE)
    return pl_cellular_edge(point, randomness, seed, cell);
  *cell = pl_cellular_find(point, randomness, seed);
  if (feature == SMOOTH)
    return pl_cellular_smooth(point, randomness, smoothness, seed);
  return feature == FIRST ? cell->first : cell->second;
}

static void voronoi(const pl_node_call *call) {
  const pl_pattern_place place = pl_pattern_place_of(call);
  const int feature = (int)call->constants[0].number;
  const uint32_t seed = pl_pattern_seed(call, 1);
  const float randomness = call->in[2][0], smoothness = call->in[3][0];
  const float left = pl_cellular_fade(place.width);
  const float kept = feature == EDGE ? pl_cellular_edge_fade(place.width) : left;
  const float mean = mean_of(feature, randomness, smoothness);
  float distance = mean;
  pl_cellular cell = {0};
  if (left > 0.0f) { /* if the cells have faded completely, no search is needed */
    const int needed = kept > 0.0f ? feature : FIRST;
    const float found = find(needed, place.point, randomness, smoothness, seed, &cell);
    distance += kept * (found - mean);
  }
  pl_value_scalar(call->out[0], distance);
  const pl_vec3f half = {0.5f, 0.5f, 0.5f};
  const pl_vec3f color = pl_vec3f_sub(pl_cellular_color(cell.id), half);
  pl_value_vector(call->out[1], pl_vec3f_madd(half, left, color), 0.0f);
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
};
