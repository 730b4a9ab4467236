/* Waves along or around an axis, distorted by noise. */
#include "math/fractal.h"
#include "math/pattern.h"
#include "shade/node_pattern.h"
#include "shade/node_rows.h"

enum { BANDS_X, BANDS_Y, BANDS_Z, BANDS_DIAGONAL, RINGS_X, RINGS_Y, RINGS_Z, RINGS_SPHERICAL };
static const char *const paths[] = {
    "x", "y", "z", "diagonal", "rings_x", "rings_y", "rings_z", "rings_spherical", NULL};
/* In the order of pl_wave_shape. */
static const char *const profiles[] = {"sine", "saw", "triangle", NULL};

/* Phase of the wave in periods, and its gradient, a unit vector (zero on the axis of rings). */
static double phase_of(int path, pl_vec3 p, pl_vec3 *gradient) {
  static const pl_vec3 AXES[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  if (path <= BANDS_DIAGONAL) {
    *gradient = pl_vec3_unit(AXES[path]);
    return pl_vec3_dot(p, *gradient);
  }
  if (path != RINGS_SPHERICAL) {
    const pl_vec3 axis = AXES[path - RINGS_X];
    p = pl_vec3_madd(p, -pl_vec3_dot(p, axis), axis);
  }
  *gradient = pl_vec3_unit(p);
  return pl_vec3_norm(p);
}

/* Box filter over the footprint, along the gradient of the distorted phase. The variance of the
 * box, w^2/12 for a width w, is increased by the variance of the distortion that the footprint
 * hides. */
static float wave_at(const pl_node_call *call, const pl_pattern_place *place, size_t lane) {
  const pl_vec3 point = pl_pattern_point(place, lane);
  const float distortion = pl_node_number(call, 3, lane), detail = pl_node_number(call, 4, lane);
  pl_vec3 gradient;
  double phase = (double)pl_node_number(call, 2, lane) +
                 phase_of((int)call->constants[0].number, point, &gradient);
  double hidden = 0.0;
  if (distortion != 0.0f) {
    const pl_fractal shape = {.octaves = pl_node_number(call, 5, lane),
                              .roughness = pl_node_number(call, 6, lane),
                              .lacunarity = 2.0f,
                              .seed = pl_pattern_seed(call, 2)};
    const pl_fractal_value shift =
        pl_fractal_gradient(&shape, pl_vec3_scale(point, (double)detail),
                            detail != 0.0f ? place->width[lane] * fabsf(detail) : 0.0f);
    phase += (double)(distortion * shift.value);
    gradient =
        pl_vec3_madd(gradient, (double)(distortion * detail), pl_vec3f_to_double(shift.gradient));
    hidden = 12.0 * (double)(distortion * distortion * shift.lost_variance);
  }
  const double slope = pl_vec3_norm(gradient), side = (double)place->side[lane];
  const double along = slope > 0.0 ? slope * side : 0.0;
  const float width = isinf(side) ? (float)side : (float)sqrt(along * along + hidden);
  return pl_wave((pl_wave_shape)(int)call->constants[1].number, phase, width);
}

static void wave(const pl_node_call *call) {
  pl_pattern_place place;
  pl_pattern_place_of(call, &place);
  for (size_t i = 0; i < call->count; i++)
    pl_lane_scalar(call->out[0], i, wave_at(call, &place, i));
  pl_lanes_fill(call->out[0], call->count);
}

static const pl_socket inputs[] = {
    PL_PATTERN_VECTOR,
    {"phase", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "Added, in turns"},
    {"distortion", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "Turns that the noise adds, at most"},
    {"detail_scale", PL_SCALAR, {1.0f, 1.0f, 1.0f}, "Cells of the noise per wave"},
    {"octaves", PL_SCALAR, {2.0f, 2.0f, 2.0f}, "Of the noise, 1..16"},
    {"roughness", PL_SCALAR, {0.5f, 0.5f, 0.5f}, "Of the noise"},
};
static const pl_socket outputs[] = {{"value", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "0..1, mean 1/2"}};
static const pl_constant_row constants[] = {
    {"path", PL_CHOICE, BANDS_X, 0, 0, paths, 0,
     "Where waves run: along an axis or the diagonal; rings: away from an axis or the origin"},
    {"profile", PL_CHOICE, PL_WAVE_SINE, 0, 0, profiles, 0, "Over one period, which is a cell"},
    PL_PATTERN_SEED};

const pl_node_kind pl_node_wave = {
    .name = "wave",
    .doc = "Bands or rings, averaged over the footprint",
    .inputs = inputs,
    .input_count = 7,
    .outputs = outputs,
    .output_count = 1,
    .constants = constants,
    .constant_count = 3,
    .evaluate = wave,
};
