/* Integral along a ray of the light that air scatters towards the ray's origin. */
#include <math.h>

#include "air/table.h"
#include "base/work.h"
#include "math/quadrature.h"

pl_air_rule pl_air_rule_make(int count) {
  const pl_gauss gauss = pl_gauss_make(count);
  pl_air_rule rule = {.count = gauss.count};
  for (int i = 0; i < gauss.count; i++) {
    rule.place[i] = 0.5 * (1.0 + gauss.node[i]);
    rule.weight[i] = 0.5 * gauss.weight[i];
  }
  return rule;
}

/* Fraction of a unit disc on one side of a line at signed distance x from its centre. */
static double part_above(double x) {
  if (x >= 1.0)
    return 1.0;
  return x <= -1.0 ? 0.0 : 0.5 + (x * sqrt((1.0 - x) * (1.0 + x)) + asin(x)) / PL_PI;
}

/* Optical depth towards the sun at a point where the sine of the solar elevation is mu. *part:
 * fraction of the disc above the horizon, 0..1; if it is 0, the depth is not set. */
static pl_vec3f depth_sun(const pl_air *air, const pl_air_sun *sun, const pl_air_place *place,
                          double mu, float *part) {
  float column[PL_AIR_PARTS];
  *part = 1.0f;
  if (mu < sun->radius_rad) {
    /* The horizon lies below the horizontal by the dip angle. */
    const double dip = asin(sqrt(fmax(0.0, (place->r - 1.0) * (place->r + 1.0))) / place->r);
    const double height = asin(fmax(-1.0, fmin(1.0, mu))) + dip;
    *part = (float)part_above(height / fmax(sun->radius_rad, 1e-9));
    if (*part == 0.0f)
      return (pl_vec3f){0.0f, 0.0f, 0.0f};
    if (height < sun->radius_rad) /* centre of the visible part */
      mu = sin(0.5 * (height + sun->radius_rad) - dip);
  }
  const double low = place->r * place->r * (1.0 - mu) * (1.0 + mu) - 1.0;
  pl_air_column_any(air, place, mu, low, column);
  return pl_air_depth_of(air, column, (float)(1.0 / sun->stretch));
}

pl_vec3f pl_air_sunlight(const pl_air *air, const pl_air_sun *sun, pl_vec3 point) {
  float part;
  const pl_air_place place = pl_air_place_of(air, pl_vec3_dot(point, point) - 1.0);
  const double mu = pl_vec3_dot(point, sun->direction) / place.r;
  const pl_vec3f depth = depth_sun(air, sun, &place, fmax(-1.0, fmin(1.0, mu)), &part);
  return pl_vec3f_scale(pl_air_dimmed(depth), part);
}

/* A ray relative to its lowest point. Positions on it are distances from there, in radii, that
 * increase along the ray. */
typedef struct chord {
  const pl_air *air;
  const pl_air_ray *ray;
  const pl_air_sun *sun;
  pl_air_mode mode;
  pl_vec3 lowest;
  double low;      /* squared norm of `lowest`, less 1 */
  double from, to; /* the part inside the air and before the end of the ray */
  /* dot products of the lowest point and of the direction with the sun's direction */
  double sun0, sun1;
  float phases[2][3];
  float length; /* metres along the ray per metre of column */
} chord;

/* False if the ray meets no air. */
static bool set_chord(const pl_air *air, const pl_air_ray *ray, chord *c) {
  const double start = pl_vec3_dot(ray->origin, ray->direction);
  c->lowest = pl_vec3_madd(ray->origin, -start, ray->direction);
  c->low = pl_vec3_dot(c->lowest, c->lowest) - 1.0;
  const double top = air->settings.top_m / air->radius_m; /* its square less 1 is top (2 + top) */
  const double reach2 = top * (2.0 + top) - c->low;
  if (!(reach2 > 0.0))
    return false;
  const double reach = sqrt(reach2);
  c->from = fmax(start, -reach);
  c->to = fmin(start + ray->end, reach);
  if (c->low < 0.0 && start < 0.0 && !ray->to_ground) /* ends on the surface */
    c->to = fmin(c->to, -sqrt(-c->low));
  return c->to > c->from;
}

bool pl_air_meets(const pl_air *air, const pl_air_ray *ray) {
  chord c;
  return set_chord(air, ray, &c);
}

static pl_air_place place_at(const chord *c, double x) {
  return pl_air_place_of(c->air, c->low + x * x);
}

/* Optical depth from a point on the chord along it to the top of the air. */
static pl_vec3f depth_at(const chord *c, const pl_air_place *place, double x) {
  float column[PL_AIR_PARTS];
  pl_air_column_up(c->air, place, fmin(1.0, fabs(x) / place->r), column);
  return pl_air_depth_of(c->air, column, c->length);
}

/* A point on the chord, and the depth from there to the top of the air. */
typedef struct level {
  double x;
  pl_air_place place;
  pl_vec3f depth;
} level;

static level level_at(const chord *c, double x) {
  level out = {.x = x, .place = place_at(c, x)};
  out.depth = depth_at(c, &out.place, x);
  return out;
}

static void set_phases(chord *c) {
  const float cosine = c->ray->sun_cosine;
  for (int k = 0; k < 3; k++) {
    const float g = (float)c->air->settings.mie_g[k];
    c->phases[0][k] = pl_air_rayleigh_phase(cosine);
    c->phases[1][k] = pl_air_mie_phase(cosine, g);
  }
}

/* Scattering coefficient, 1/m, for isotropic light; or times the phase functions, for sunlight. */
static pl_vec3f sent_on(const chord *c, const float density[PL_AIR_PARTS], bool phases) {
  float sent[3];
  for (int k = 0; k < 3; k++) {
    const float rayleigh = density[0] * c->air->scattering[0][k];
    const float mie = density[1] * c->air->scattering[1][k];
    sent[k] = phases ? rayleigh * c->phases[0][k] + mie * c->phases[1][k] : rayleigh + mie;
  }
  return pl_vec3f_make(sent[0], sent[1], sent[2]);
}

/* Scattered sunlight per metre. mu: cosine of the sun's zenith angle at the point. depth: from
 * there to the start of the ray. */
static pl_vec3f sunlit(const chord *c, const pl_air_place *place, double mu, pl_vec3f depth) {
  float part;
  const pl_vec3f toward = depth_sun(c->air, c->sun, place, mu, &part);
  if (!(part > 0.0f))
    return (pl_vec3f){0.0f, 0.0f, 0.0f};
  const pl_vec3f dimmed = pl_air_dimmed(pl_vec3f_add(depth, toward));
  return pl_vec3f_scale(pl_vec3f_mul(sent_on(c, place->density, true), dimmed), part);
}

/* Radiance that a metre of air at x adds to the ray, attenuated by `depth` on its way. */
static pl_vec3f source(const chord *c, const pl_air_place *place, double x, pl_vec3f depth) {
  const float *density = place->density;
  pl_vec3f light = {0.0f, 0.0f, 0.0f};
  const double mu = fmax(-1.0, fmin(1.0, (c->sun0 + x * c->sun1) / place->r));
  if (c->mode != PL_AIR_AGAIN)
    light = sunlit(c, place, mu, depth);
  if (c->mode == PL_AIR_ONCE)
    return light;
  const pl_vec3f around = pl_vec3f_mul(pl_air_several(c->air, place, mu), pl_air_dimmed(depth));
  return pl_vec3f_add(light, pl_vec3f_mul(sent_on(c, density, false), around));
}

/* Distance, in radii, over which the air thins out along the chord from a low point: the depth over
 * the extinction at the point, times SPREAD. Nodes are distributed exponentially with this
 * distance. */
static const double SPREAD = 2.5;
static double thinning(const chord *c, const pl_air_place *place, pl_vec3f depth) {
  const float *density = place->density;
  const float(*e)[3] = (const float(*)[3])c->air->extinction;
  const float here = density[0] * (e[0][0] + e[0][1] + e[0][2]) +
                     density[1] * (e[1][0] + e[1][1] + e[1][2]) +
                     density[2] * (e[2][0] + e[2][1] + e[2][2]);
  const double all = (double)(depth.x + depth.y + depth.z) / (double)c->length;
  return here > 0.0f ? SPREAD * all / (double)here / c->air->radius_m : INFINITY;
}

/* Optical depth from the start of the chord to a point: `depth` plus or minus the depth above the
 * point. */
typedef struct way {
  pl_vec3f depth;
  float side;
} way;

static pl_vec3f way_depth(const way *w, const level *at) {
  return pl_vec3f_madd(w->depth, w->side, at->depth);
}

static float least(pl_vec3f v) { return pl_minf(v.x, pl_minf(v.y, v.z)); }

/* Light from beyond this depth in every band is negligible. */
static const float OPAQUE = 12.0f;

/* End of the visible part of the interval from a to b. */
static level cut(const chord *c, const way *w, const level *a, const level *b) {
  enum { HALVINGS = 12 };
  if (!(least(way_depth(w, b)) > OPAQUE))
    return *b;
  double near = a->x;
  level far = *b;
  for (int i = 0; i < HALVINGS; i++) {
    const level middle = level_at(c, 0.5 * (near + far.x));
    if (least(way_depth(w, &middle)) > OPAQUE)
      far = middle;
    else
      near = middle.x;
  }
  return far;
}

/* Integral over the chord from a point to x = high, which have the same sign; the point is nearer
 * to the lowest of the chord. */
static pl_vec3f integrate(const chord *c, const pl_air_rule *rule, const level *from, double high,
                          const way *w) {
  const double low = from->x, length = fabs(high - low), sign = high > low ? 1.0 : -1.0;
  pl_vec3f sum = {0.0f, 0.0f, 0.0f};
  if (!(length > 0.0)) /* two breakpoints coincide */
    return sum;
  const double scale = fmin(thinning(c, &from->place, from->depth), 1e3 * length);
  const double all = -expm1(-length / scale);
  for (int i = 0; i < rule->count; i++) {
    const double left = 1.0 - rule->place[i] * all;
    const double x = low - sign * scale * log(left);
    const pl_air_place place = place_at(c, x);
    const pl_vec3f depth = pl_vec3f_madd(w->depth, w->side, depth_at(c, &place, x));
    const double weight = rule->weight[i] * scale * all / left * c->air->radius_m;
    sum = pl_vec3f_madd(sum, (float)weight * c->length, source(c, &place, x, depth));
  }
  return sum;
}

/* Sets the breakpoints of the integrand in ascending order: the ends of the chord, its lowest
 * point, and its intersections with the edge of the body's shadow, a cylinder. Returns their
 * number. */
enum { BENDS = 5 };
static int find_bends(const chord *c, double bends[BENDS]) {
  int count = 0;
  bends[count++] = c->from;
  if (c->from < 0.0 && c->to > 0.0)
    bends[count++] = 0.0;
  const double a = (1.0 - c->sun1) * (1.0 + c->sun1), b = c->sun0 * c->sun1;
  const double discriminant = b * b - a * (c->low - c->sun0 * c->sun0);
  for (int side = -1; discriminant > 0.0 && a > 0.0 && side <= 1; side += 2) {
    const double x = (b + side * sqrt(discriminant)) / a;
    if (x > c->from && x < c->to && c->sun0 + x * c->sun1 < 0.0)
      bends[count++] = x;
  }
  bends[count++] = c->to;
  for (int i = 1; i < count; i++)
    for (int k = i; k > 0 && bends[k - 1] > bends[k]; k--) {
      const double swapped = bends[k];
      bends[k] = bends[k - 1];
      bends[k - 1] = swapped;
    }
  return count;
}

/* The breakpoints, each evaluated once. Returns their number. */
static int find_levels(const chord *c, level levels[BENDS]) {
  double bends[BENDS];
  const int count = find_bends(c, bends);
  for (int i = 0; i < count; i++)
    levels[i] = level_at(c, bends[i]);
  return count;
}

/* Optical depth from the start of the chord along it to the top of the air. */
static pl_vec3f depth_ahead(const level *levels, int count) {
  const level *lowest = levels;
  if (!(levels->x < 0.0))
    return levels->depth;
  while (lowest < levels + count - 1 && lowest->x < 0.0)
    lowest++;
  return pl_vec3f_madd(pl_vec3f_scale(levels->depth, -1.0f), 2.0f, lowest->depth);
}

/* Light that the air between breakpoints scatters along the chord. */
static pl_vec3f scattered_along(const chord *c, const pl_air_rule *rule, const level *levels,
                                int count, pl_vec3f ahead) {
  pl_vec3f sum = {0.0f, 0.0f, 0.0f};
  const pl_vec3f behind = pl_vec3f_scale(levels->depth, -1.0f);
  for (int i = 0; i + 1 < count; i++) {
    const level *at = &levels[i];
    const bool down = at->x < 0.0;
    const way w = down ? (way){behind, 1.0f} : (way){ahead, -1.0f};
    if (least(way_depth(&w, at)) > OPAQUE)
      break;
    const level end = cut(c, &w, at, at + 1);
    sum = pl_vec3f_add(sum, down ? integrate(c, rule, &end, at->x, &w)
                                 : integrate(c, rule, at, end.x, &w));
  }
  return sum;
}

pl_air_light pl_air_scatter_by(const pl_air *air, const pl_air_ray *ray, const pl_air_sun *sun,
                               const pl_air_rule *rule, pl_air_mode mode) {
  pl_air_light out = {{0.0f, 0.0f, 0.0f}, {1.0f, 1.0f, 1.0f}};
  level levels[BENDS];
  chord c = {.air = air, .ray = ray, .sun = sun, .mode = mode};
  c.length = (float)(1.0 / ray->stretch);
  if (!set_chord(air, ray, &c))
    return out;
  c.sun0 = pl_vec3_dot(c.lowest, sun->direction);
  c.sun1 = pl_vec3_dot(ray->direction, sun->direction);
  set_phases(&c);
  const int count = find_levels(&c, levels);
  pl_work_add(PL_WORK_air_rays, 1);
  pl_work_add(PL_WORK_air_steps, (size_t)rule->count * (size_t)(count > 1 ? count - 1 : 0));
  const pl_vec3f ahead = depth_ahead(levels, count);
  const pl_vec3f at_from = levels->depth, at_to = levels[count - 1].depth;
  out.scattered = scattered_along(&c, rule, levels, count, ahead);
  const pl_vec3f depth = c.to > 0.0 ? pl_vec3f_sub(ahead, at_to) : pl_vec3f_sub(at_to, at_from);
  out.transmitted = pl_air_dimmed(
      pl_vec3f_make(pl_maxf(depth.x, 0.0f), pl_maxf(depth.y, 0.0f), pl_maxf(depth.z, 0.0f)));
  return out;
}

pl_air_light pl_air_scatter(const pl_air *air, const pl_air_ray *ray, const pl_air_sun *sun,
                            const pl_air_rule *rule, bool multiple) {
  return pl_air_scatter_by(air, ray, sun, rule, multiple ? PL_AIR_SEVERAL : PL_AIR_ONCE);
}
