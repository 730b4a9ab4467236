/* Columns of air: the table of transmittances. It holds corrections to a closed form, so that a
 * small table is accurate from the zenith to the horizon. */
#include <math.h>

#include "air/table.h"

/* Nodes of the integrals that fill the table. */
enum { FINE = 48 };

/* Parameter of the spacing of nodes in height. They are evenly spaced, or denser at the surface if
 * the atmosphere is high compared with the radius. */
static double bend_of(const pl_air *air, const pl_air_column *column) {
  const double high = 0.1;
  return column->top_m > high * air->radius_m ? column->top_m / air->radius_m : 0.0;
}

static double height_at(const pl_air *air, const pl_air_column *column, int node) {
  const double w = (double)node / (PL_AIR_HEIGHTS - 1), bend = bend_of(air, column);
  return w * column->top_m / (1.0 + (1.0 - w) * bend);
}

static float node_at(const pl_air_column *column, double height_m) {
  const double x = height_m * column->per_height;
  if (x <= 0.0)
    return 0.0f;
  return (float)(x * (1.0 + column->bend) / (1.0 + column->bend * x)) * (PL_AIR_HEIGHTS - 1);
}

/* Nodes in the cosine are denser near s, where the air mass bends. */
static double cosine_at(double s, int node) {
  const double v = (double)node / (PL_AIR_COSINES - 1);
  return s * v / (1.0 + s - v);
}

/* Distance in metres from a height to a higher one, for zenith cosine mu >= 0; 0 to a lower one. */
static double reach(const pl_air *air, double height_m, double mu, double upper_m) {
  const double r = air->radius_m + height_m;
  /* difference of the squared radii */
  const double rise = (upper_m - height_m) * (upper_m + air->radius_m + r);
  return upper_m <= height_m ? 0.0 : rise / (sqrt(r * r * mu * mu + rise) + r * mu);
}

/* Height at a distance along such a ray. */
static double height_along(const pl_air *air, double height_m, double mu, double distance) {
  const double r = air->radius_m + height_m;
  const double rise = distance * (2.0 * r * mu + distance);
  return height_m + rise / (sqrt(r * r + rise) + r);
}

/* Column of a layered density along a ray, over the density at the starting height, m. */
static double integrate_layers(const pl_air *air, const pl_air_rule *rule, int part,
                               double height_m, double mu) {
  const pl_air_layers *layers = &air->layers[part];
  const double length = reach(air, height_m, mu, air->columns[part].top_m);
  const double scale_m = layers->scale_m[height_m > layers->bend_m];
  const double s2 = 8.0 * scale_m / (PL_PI * (air->radius_m + height_m));
  const double scale = fmin(4.0 * scale_m / (mu + sqrt(mu * mu + s2)), 1e3 * length);
  const double all = -expm1(-length / scale);
  double sum = 0.0;
  for (int i = 0; i < rule->count; i++) {
    const double left = 1.0 - rule->place[i] * all;
    const double at = height_along(air, height_m, mu, -scale * log(left));
    sum += rule->weight[i] * pl_air_layers_ratio(layers, height_m, at) / left;
  }
  return sum * scale * all;
}

static double tent(const pl_air_settings *s, double height_m) {
  return fmax(0.0, 1.0 - fabs(height_m - s->ozone_center_m) / s->ozone_width_m);
}

/* Column of the ozone layer along a ray, m, integrated piecewise between the heights where the
 * triangular profile has corners. */
static double integrate_tent(const pl_air *air, const pl_air_rule *rule, double height_m, double mu,
                             double top_m) {
  const pl_air_settings *s = &air->settings;
  const double bends[3] = {s->ozone_center_m - s->ozone_width_m, s->ozone_center_m, top_m};
  double sum = 0.0, from = 0.0;
  for (int k = 0; k < 3; k++) {
    const double to = fmax(from, reach(air, height_m, mu, fmin(bends[k], top_m)));
    for (int i = 0; k > 0 && i < rule->count; i++) {
      const double at = height_along(air, height_m, mu, from + (to - from) * rule->place[i]);
      sum += (to - from) * rule->weight[i] * tent(s, at);
    }
    from = to;
  }
  return sum;
}

/* Integral from x upwards of the triangular profile of half width 1 about 0. */
static double tent_above(double x) {
  if (x >= 0.0)
    return x >= 1.0 ? 0.0 : 0.5 * (1.0 - x) * (1.0 - x);
  return x <= -1.0 ? 1.0 : 1.0 - 0.5 * (1.0 + x) * (1.0 + x);
}

/* Vertical column: for an exponential density, over the density at the height; for ozone, the
 * column itself. */
static double vertical(const pl_air *air, int part, double height_m) {
  const pl_air_settings *s = &air->settings;
  const double top_m = air->columns[part].top_m;
  if (part < 2)
    return -air->layers[part].scale_m[0] *
           expm1(-fmax(0.0, top_m - height_m) / air->layers[part].scale_m[0]);
  const double x = (height_m - s->ozone_center_m) / s->ozone_width_m;
  return s->ozone_width_m * fmax(0.0, tent_above(x) - air->columns[part].above);
}

static void build_column(pl_air *air, const pl_air_rule *rule, int part) {
  pl_air_column *column = &air->columns[part];
  for (int i = 0; i < PL_AIR_HEIGHTS; i++) {
    /* At the very top all columns are 0; the ratio is taken from just below. */
    const double h = fmin(height_at(air, column, i), column->top_m * (1.0 - 1e-6));
    const bool bent = part < 2 && air->layers[part].bent;
    const double up = bent ? integrate_layers(air, rule, part, h, 1.0) : vertical(air, part, h);
    double masses[PL_AIR_COSINES], s = 0.0;
    for (int k = 0; k < PL_AIR_COSINES; k++) {
      const double mu = k == 0 ? 0.0 : cosine_at(s, k);
      const double along = part < 2 ? integrate_layers(air, rule, part, h, mu)
                                    : integrate_tent(air, rule, h, mu, column->top_m);
      masses[k] = along / up;
      if (k == 0)
        s = 2.0 / masses[0];
      column->ratio[i][k] = (float)(masses[k] * 0.5 * (mu + sqrt(mu * mu + s * s)));
    }
    column->grazing[i] = (float)s;
    column->up[i] = (float)up;
  }
}

void pl_air_build_columns(pl_air *air) {
  const pl_air_settings *s = &air->settings;
  const pl_air_rule rule = pl_air_rule_make(FINE);
  for (int part = 0; part < PL_AIR_PARTS; part++) {
    const double layer_m = s->ozone_center_m + s->ozone_width_m;
    air->columns[part].top_m = part < 2 ? s->top_m : fmin(s->top_m, layer_m);
    pl_air_column *column = &air->columns[part];
    column->bend = bend_of(air, column);
    column->per_height = 1.0 / column->top_m;
    if (part == 2)
      column->above = tent_above((column->top_m - s->ozone_center_m) / s->ozone_width_m);
    if (air->present[part])
      build_column(air, &rule, part);
  }
}

/* Vertical column above a point between nodes i and i + 1. */
static float up_from(const pl_air *air, int part, const pl_air_place *place, int i) {
  const float *up = air->columns[part].up + i;
  if (part == 2)
    return (float)vertical(air, part, place->height_m);
  if (air->layers[part].bent)
    return place->density[part] * (up[0] + (place->node[part] - (float)i) * (up[1] - up[0]));
  return (float)air->layers[part].scale_m[0] * (place->density[part] - air->layers[part].rest);
}

/* Rays on ground of its own do not come near the centre of a body. */
static const double LEAST_R = 1e-3;

/* Below this height the density, exp(20) times that at the surface, no longer grows. */
static double deepest_m(const pl_air *air) {
  return -20.0 * fmin(air->layers[0].scale_m[0], air->layers[1].scale_m[0]);
}

pl_air_place pl_air_place_of(const pl_air *air, double squared_r_less_1) {
  const double r = sqrt(fmax(1.0 + squared_r_less_1, LEAST_R * LEAST_R));
  const double height_m = squared_r_less_1 / (r + 1.0) * air->radius_m;
  pl_air_place place = {.height_m = fmax(deepest_m(air), height_m), .r = r};
  pl_air_density(air, place.height_m, place.density);
  for (int part = 0; part < PL_AIR_PARTS; part++) {
    const pl_air_column *column = &air->columns[part];
    if (!air->present[part] || place.height_m >= column->top_m)
      continue;
    const float node = place.node[part] = node_at(column, place.height_m);
    const int i = node < PL_AIR_HEIGHTS - 2 ? (int)node : PL_AIR_HEIGHTS - 2;
    const float *s = column->grazing + i;
    place.grazing[part] = s[0] + (node - (float)i) * (s[1] - s[0]);
    place.up[part] = up_from(air, part, &place, i);
  }
  return place;
}

/* Air mass for a zenith cosine mu >= 0. */
static float mass_of(const pl_air_column *column, float node, float s, float mu) {
  const int i = node < PL_AIR_HEIGHTS - 2 ? (int)node : PL_AIR_HEIGHTS - 2;
  const float y = node - (float)i;
  const float v = mu * (1.0f + s) / (mu + s) * (PL_AIR_COSINES - 1);
  const int k = v < PL_AIR_COSINES - 2 ? (int)v : PL_AIR_COSINES - 2;
  const float x = v - (float)k;
  const float *low = column->ratio[i] + k, *high = column->ratio[i + 1] + k;
  const float below = low[0] + x * (low[1] - low[0]), above = high[0] + x * (high[1] - high[0]);
  return 2.0f * (below + y * (above - below)) / (mu + sqrtf(mu * mu + s * s));
}

void pl_air_column_up(const pl_air *air, const pl_air_place *place, double mu,
                      float out[PL_AIR_PARTS]) {
  for (int part = 0; part < PL_AIR_PARTS; part++)
    out[part] = place->up[part] > 0.0f
                    ? place->up[part] * mass_of(&air->columns[part], place->node[part],
                                                place->grazing[part], (float)mu)
                    : 0.0f;
}

/* A descending ray passes its lowest point and rises again to the height of its start. Its column
 * is twice the horizontal column at the lowest point, less the column behind its start. */
void pl_air_column_any(const pl_air *air, const pl_air_place *place, double mu,
                       double lowest2_less_1, float out[PL_AIR_PARTS]) {
  if (mu >= 0.0) {
    pl_air_column_up(air, place, mu, out);
    return;
  }
  float behind[PL_AIR_PARTS];
  pl_air_column_up(air, place, -mu, behind);
  const double level2_less_1 = fmin(0.0, (place->r - 1.0) * (place->r + 1.0));
  const pl_air_place low = pl_air_place_of(air, fmax(lowest2_less_1, level2_less_1));
  pl_air_column_up(air, &low, 0.0, out);
  for (int part = 0; part < PL_AIR_PARTS; part++)
    out[part] = pl_maxf(0.0f, 2.0f * out[part] - behind[part]);
}

pl_vec3f pl_air_depth_of(const pl_air *air, const float column[PL_AIR_PARTS], float length) {
  float depth[3];
  for (int k = 0; k < 3; k++)
    depth[k] = length * (column[0] * air->extinction[0][k] + column[1] * air->extinction[1][k] +
                         column[2] * air->extinction[2][k]);
  return pl_vec3f_make(depth[0], depth[1], depth[2]);
}

pl_vec3f pl_air_dimmed(pl_vec3f depth) {
  return pl_vec3f_make(expf(-depth.x), expf(-depth.y), expf(-depth.z));
}

pl_vec3f pl_air_depth(const pl_air *air, pl_vec3 point, pl_vec3 direction, double stretch) {
  float column[PL_AIR_PARTS];
  const double along = pl_vec3_dot(point, direction);
  const pl_vec3 lowest = pl_vec3_madd(point, -along, direction);
  const double low = pl_vec3_dot(lowest, lowest) - 1.0;
  const pl_air_place place = pl_air_place_of(air, low + along * along);
  pl_air_column_any(air, &place, fmax(-1.0, fmin(1.0, along / place.r)), low, column);
  return pl_air_depth_of(air, column, (float)(1.0 / stretch));
}

pl_vec3f pl_air_transmittance(const pl_air *air, pl_vec3 point, pl_vec3 direction, double stretch) {
  return pl_air_dimmed(pl_air_depth(air, point, direction, stretch));
}
