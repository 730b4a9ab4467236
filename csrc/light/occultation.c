/* The outline of the part of the sun's disc that bodies occult, and the light inside it.
 *
 * A direction has the coordinates (x, y): its components perpendicular to the direction of the
 * sun's centre, divided by the sine of the sun's angular radius. The disc is then the unit disc, mu
 * = sqrt(1 - x^2 - y^2) holds exactly, and dx dy is solid angle times the cosine on a surface that
 * faces the sun. Let F(r) be the light inside radius r divided by 2 pi. The light inside a closed
 * curve is the integral of F dphi along the curve. */
#include "light/occultation.h"

#include <stdlib.h>

#include "base/memory.h"
#include "light/cone.h"
#include "light/limb.h"
#include "math/quadrature.h"
#include "math/roots.h"

enum { CROSSINGS = 4 }; /* largest number of crossings of the limbs of two ellipsoids */
/* Limbs closer than this (rad) coincide: a few eps, negligible against the sun's radius. */
static const double COINCIDENT = 1e-14;

/* Limb-darkening law of one band: F(r)/r^2 = sum g[j] mu^j / (1 + mu). */
typedef struct band_law {
  double g[PL_LIMB_TERMS + 1];
  double whole; /* F(1) */
} band_law;

typedef struct body_shade {
  pl_cone cone;
  double ring[CROSSINGS]; /* angles on the sun's limb of the crossings, ascending */
  size_t crossings;
} body_shade;

/* Working memory of the solver, allocated once per request. */
typedef struct workspace {
  pl_gauss rule;
  band_law *laws;
  body_shade *shades; /* [bodies]; the first `active` occult a part of the disc */
  size_t active;
  double *breaks; /* [CROSSINGS * bodies + 2] */
  double *light;  /* [bands] */
} workspace;

/* The sun's disc as seen from a point. */
typedef struct disc {
  pl_vec3 x, y, z; /* unit; z to the centre */
  double distance_m, sine, cosine;
} disc;

typedef struct curve {
  const disc *sun;
  const pl_cone *cone;  /* the cone whose depth is evaluated ... */
  const pl_cone *other; /* ... along the limb of this one; NULL: along the sun's limb */
} curve;

static pl_vec3 sun_limb(const disc *sun, double angle) {
  const pl_vec3 out = pl_vec3_madd(pl_vec3_scale(sun->x, cos(angle)), sin(angle), sun->y);
  return pl_vec3_madd(pl_vec3_scale(sun->z, sun->cosine), sun->sine, out);
}

static double depth_along(const void *context, double t) {
  const curve *c = context;
  return pl_cone_depth(c->cone, c->other ? pl_cone_limb(c->other, t) : sun_limb(c->sun, t));
}

/* Depth along an arc without a crossing, at the one of three points where its magnitude is largest:
 * limbs may touch at a single point. */
static double depth_of_arc(const disc *sun, const pl_cone *cone, const pl_cone *other, double a,
                           double b) {
  static const double places[] = {0.5, 0.31, 0.73};
  const curve c = {sun, cone, other};
  double depth = 0.0;
  for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
    const double here = depth_along(&c, a + places[i] * (b - a));
    depth = fabs(here) > fabs(depth) ? here : depth;
  }
  return depth;
}

/* Crossings of a body's limb with an arc of another body's limb, or of the sun's (`other` NULL), in
 * ascending order. Where limbs only touch, rounding produces pairs of crossings with no depth
 * between them; these pairs are discarded. `closed`: the arc is the whole limb. */
static size_t crossings_of(const disc *sun, const pl_cone *cone, const pl_cone *other, double from,
                           double to, bool closed, double out[CROSSINGS]) {
  const curve along = {sun, cone, other};
  size_t count = pl_roots_find(depth_along, &along, from, to, closed, out, CROSSINGS);
  for (size_t k = 0; k + 1 < count;) {
    if (fabs(depth_of_arc(sun, cone, other, out[k], out[k + 1])) > COINCIDENT) {
      k++;
      continue;
    }
    count -= 2;
    for (size_t m = k; m < count; m++)
      out[m] = out[m + 2];
    k = 0;
  }
  if (closed && count > 1 &&
      fabs(depth_of_arc(sun, cone, other, out[count - 1], out[0] + to - from)) <= COINCIDENT) {
    count -= 2;
    for (size_t m = 0; m < count; m++)
      out[m] = out[m + 1];
  }
  return count;
}

static band_law law_of(double wavelength_um) {
  double c[PL_LIMB_TERMS] = {1.0};
  if (wavelength_um > 0.0)
    pl_limb_polynomial(wavelength_um, c);
  band_law law = {.whole = 0.0};
  /* F = sum c_k (1 - mu^(k+2)) / (k+2), and 1 - mu^m = (1 - mu) (1 + mu + ... + mu^(m-1)). */
  for (int k = 0; k < PL_LIMB_TERMS; k++) {
    for (int j = 0; j < k + 2; j++)
      law.g[j] += c[k] / (k + 2.0);
    law.whole += c[k] / (k + 2.0);
  }
  return law;
}

static double law_at(const band_law *law, double mu) {
  double sum = 0.0;
  for (int j = PL_LIMB_TERMS; j >= 0; j--)
    sum = sum * mu + law->g[j];
  return sum / (1.0 + mu);
}

/* Adds the integral of F dphi along an arc of a body's limb inside the disc. mu is a square root
 * that vanishes at the ends. The substitution by the sine of an angle concentrates the nodes there
 * and makes powers of mu smooth. */
static void add_arc(const disc *sun, const pl_cone *cone, double from, double to, size_t bands,
                    workspace *w) {
  double parts[3][2];
  for (int i = 0; i < 3; i++) {
    parts[i][0] = pl_vec3_dot(cone->limb[i], sun->x);
    parts[i][1] = pl_vec3_dot(cone->limb[i], sun->y);
  }
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
  for (int i = 0; i < w->rule.count; i++) {
    const double u = 0.5 * PL_PI * w->rule.node[i], turn = middle + half * sin(u);
    const double step = w->rule.weight[i] * half * 0.5 * PL_PI * cos(u);
    const double c = cos(turn), s = sin(turn);
    const pl_vec3 d = pl_cone_limb(cone, turn);
    const double x = parts[0][0] + c * parts[1][0] + s * parts[2][0];
    const double y = parts[0][1] + c * parts[1][1] + s * parts[2][1];
    const double dx = c * parts[2][0] - s * parts[1][0], dy = c * parts[2][1] - s * parts[1][1];
    const double unit = 1.0 / (pl_vec3_dot(d, d) * sun->sine * sun->sine);
    const double mu = sqrt(fmax(0.0, 1.0 - (x * x + y * y) * unit));
    const double turned = step * (x * dy - y * dx) * unit;
    for (size_t band = 0; band < bands; band++)
      w->light[band] += turned * law_at(&w->laws[band], mu);
  }
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* True if an arc of body i's limb that no other limb crosses lies behind another body. Where limbs
 * coincide, the limb of the body with the smallest index is the outline. */
static bool behind_others(const disc *sun, const workspace *w, size_t i, double a, double b) {
  for (size_t j = 0; j < w->active; j++) {
    if (j == i)
      continue;
    const double depth = depth_of_arc(sun, &w->shades[j].cone, &w->shades[i].cone, a, b);
    if (depth > COINCIDENT || (depth > -COINCIDENT && j < i))
      return true;
  }
  return false;
}

/* Adds an arc of body i's limb in front of the sun. The arc is cut at the crossings with other
 * limbs, and into pieces of at most a quarter turn. */
static void add_limb(const disc *sun, size_t i, double from, double to, size_t bands,
                     workspace *w) {
  const pl_cone *own = &w->shades[i].cone;
  const bool whole = w->shades[i].crossings == 0;
  size_t count = 0;
  w->breaks[count++] = from;
  for (size_t j = 0; j < w->active; j++)
    if (j != i)
      count += crossings_of(sun, &w->shades[j].cone, own, from, to, whole, w->breaks + count);
  w->breaks[count++] = to;
  qsort(w->breaks, count, sizeof *w->breaks, ascending);
  for (size_t k = 0; k + 1 < count; k++) {
    const double a = w->breaks[k], b = w->breaks[k + 1];
    if (!(b > a) || behind_others(sun, w, i, a, b))
      continue;
    const int pieces = (int)ceil((b - a) / (0.5 * PL_PI) - 1e-9);
    for (int piece = 0; piece < pieces; piece++)
      add_arc(sun, own, a + (b - a) * piece / pieces, a + (b - a) * (piece + 1) / pieces, bands, w);
  }
}

static bool before_sun(const disc *sun, pl_vec3 direction) {
  const double across = pl_vec3_norm(pl_vec3_cross(direction, sun->z));
  return pl_vec3_dot(direction, sun->z) > 0.0 && across < sun->sine * pl_vec3_norm(direction);
}

/* Adds the arcs of a body's limb in front of the sun. Body and disc are both convex: between two
 * crossings where the sun's limb is not occulted, the body's limb runs inside the disc from one
 * crossing to the other. */
static void add_limbs(const disc *sun, size_t i, size_t bands, workspace *w) {
  const body_shade *shade = &w->shades[i];
  if (shade->crossings == 0)
    add_limb(sun, i, -PL_PI, PL_PI, bands, w);
  for (size_t k = 0; k < shade->crossings; k++) {
    const bool last = k + 1 == shade->crossings;
    const double a = shade->ring[k], b = last ? shade->ring[0] + 2.0 * PL_PI : shade->ring[k + 1];
    if (depth_of_arc(sun, &shade->cone, NULL, a, b) >= 0.0)
      continue;
    const double from = pl_cone_turn(&shade->cone, sun_limb(sun, a));
    const double to = pl_cone_turn(&shade->cone, sun_limb(sun, b));
    add_limb(sun, i, from, to < from ? to + 2.0 * PL_PI : to, bands, w);
  }
}

/* Length of the occulted part of the sun's limb, rad. */
static double hidden_ring(const disc *sun, workspace *w) {
  size_t count = 0;
  for (size_t i = 0; i < w->active; i++)
    for (size_t k = 0; k < w->shades[i].crossings; k++)
      w->breaks[count++] = w->shades[i].ring[k];
  if (count == 0)
    return 0.0;
  qsort(w->breaks, count, sizeof *w->breaks, ascending);
  double hidden = 0.0;
  for (size_t k = 0; k < count; k++) {
    const double a = w->breaks[k];
    const double b = k + 1 < count ? w->breaks[k + 1] : w->breaks[0] + 2.0 * PL_PI;
    for (size_t i = 0; i < w->active; i++)
      if (depth_of_arc(sun, &w->shades[i].cone, NULL, a, b) >= 0.0) {
        hidden += b - a;
        break;
      }
  }
  return hidden;
}

/* How much of the disc a body occults. */
typedef enum cover { COVER_NONE, COVER_PART, COVER_ALL } cover;

/* Classification by the body's circumscribed and inscribed spheres; COVER_PART if they do not
 * decide. */
static cover by_spheres(const disc *sun, pl_vec3 to_body, pl_vec3 radii_m) {
  const double far = pl_vec3_norm(to_body), a = asin(sun->sine);
  const double outer = fmax(radii_m.x, fmax(radii_m.y, radii_m.z));
  const double inner = fmin(radii_m.x, fmin(radii_m.y, radii_m.z));
  if (!(far < sun->distance_m * (1.0 - sun->sine)))
    return COVER_NONE;
  const double c =
      atan2(pl_vec3_norm(pl_vec3_cross(sun->z, to_body)), pl_vec3_dot(sun->z, to_body));
  if (far > outer && c >= a + asin(outer / far))
    return COVER_NONE;
  return far > inner && c <= asin(inner / far) - a ? COVER_ALL : COVER_PART;
}

/* Exact classification, by the crossings of the limbs. Fills shade->ring. */
static cover by_limbs(const disc *sun, body_shade *shade, pl_vec3 to_body) {
  /* Once around, starting at the point opposite to the body. */
  const double begin = atan2(-pl_vec3_dot(to_body, sun->y), -pl_vec3_dot(to_body, sun->x));
  const double end = begin + 2.0 * PL_PI;
  shade->crossings = crossings_of(sun, &shade->cone, NULL, begin, end, true, shade->ring);
  if (shade->crossings == 0 && depth_of_arc(sun, &shade->cone, NULL, begin, end) >= 0.0)
    return COVER_ALL;
  if (shade->crossings == 0 && !before_sun(sun, to_body))
    return COVER_NONE;
  for (size_t k = 0; k < shade->crossings; k++) {
    shade->ring[k] = fmod(shade->ring[k], 2.0 * PL_PI);
    shade->ring[k] += shade->ring[k] < 0.0 ? 2.0 * PL_PI : 0.0;
  }
  qsort(shade->ring, shade->crossings, sizeof *shade->ring, ascending);
  return COVER_PART;
}

static disc disc_from(pl_vec3 point, pl_vec3 sun_m, double radius_m) {
  const pl_vec3 to_sun = pl_vec3_sub(sun_m, point);
  disc sun = {.z = pl_vec3_unit(to_sun), .distance_m = pl_vec3_norm(to_sun)};
  const pl_vec3 axis = fabs(sun.z.x) < 0.6 ? (pl_vec3){1, 0, 0} : (pl_vec3){0, 1, 0};
  sun.x = pl_vec3_unit(pl_vec3_cross(axis, sun.z));
  sun.y = pl_vec3_cross(sun.z, sun.x);
  sun.sine = radius_m / sun.distance_m;
  sun.cosine = sqrt(fmax(0.0, (1.0 - sun.sine) * (1.0 + sun.sine)));
  return sun;
}

/* Collects the bodies that occult a part of the disc in the workspace. Returns true if one of them
 * occults the whole disc. */
static bool find_shades(const pl_occultation *r, size_t time, const disc *sun, workspace *w,
                        uint8_t *hides) {
  bool all = false;
  w->active = 0;
  for (size_t i = 0; i < r->bodies; i++) {
    const pl_pose pose = r->poses[time * r->bodies + i];
    const pl_vec3 to_body = pl_vec3_sub(pose.t, r->points[time]);
    body_shade *shade = &w->shades[w->active];
    cover kind = by_spheres(sun, to_body, r->radii_m[i]);
    if (kind == COVER_PART &&
        !pl_cone_make(pose, r->radii_m[i], r->points[time], sun->z, &shade->cone))
      kind = COVER_ALL;
    if (kind == COVER_PART)
      kind = by_limbs(sun, shade, to_body);
    w->active += kind == COVER_PART;
    all = all || kind == COVER_ALL;
    hides[i] = kind != COVER_NONE;
  }
  return all;
}

static pl_status solve_one(const pl_occultation *r, size_t time, workspace *w, double *fraction,
                           uint8_t *hides) {
  const pl_vec3 point = r->points[time], centre = r->sun_m[time];
  if (!pl_vec3_finite(point) || !pl_vec3_finite(centre))
    return pl_fail(PL_E_RANGE, "time %zu: a place is not finite", time);
  const disc sun = disc_from(point, centre, r->sun_radius_m);
  if (!(sun.sine < 1.0))
    return pl_fail(PL_E_RANGE, "time %zu: the point is inside the sun", time);
  for (size_t i = 0; i < r->bodies; i++)
    if (!pl_vec3_finite(r->poses[time * r->bodies + i].t))
      return pl_fail(PL_E_RANGE, "time %zu: the place of body %zu is not finite", time, i);
  const bool all = find_shades(r, time, &sun, w, hides);
  for (size_t band = 0; band < r->bands; band++)
    fraction[band] = all ? 0.0 : 1.0;
  if (all || w->active == 0)
    return PL_OK;
  const double ring = hidden_ring(&sun, w);
  for (size_t band = 0; band < r->bands; band++)
    w->light[band] = ring * w->laws[band].whole;
  for (size_t i = 0; i < w->active; i++)
    add_limbs(&sun, i, r->bands, w);
  for (size_t band = 0; band < r->bands; band++) {
    const double hidden = w->light[band] / (2.0 * PL_PI * w->laws[band].whole);
    fraction[band] = fmin(fmax(1.0 - hidden, 0.0), 1.0);
  }
  return PL_OK;
}

static pl_status check(const pl_occultation *r) {
  if (!(r->sun_radius_m > 0.0) || !isfinite(r->sun_radius_m))
    return pl_fail(PL_E_RANGE, "the sun's radius must be positive");
  if (r->nodes < 1 || r->nodes > PL_GAUSS_MAX)
    return pl_fail(PL_E_RANGE, "nodes is %d, but must be from 1 to %d", r->nodes, PL_GAUSS_MAX);
  for (size_t i = 0; i < r->bodies; i++)
    if (!pl_vec3_finite(r->radii_m[i]) ||
        !(fmin(r->radii_m[i].x, fmin(r->radii_m[i].y, r->radii_m[i].z)) > 0.0))
      return pl_fail(PL_E_RANGE, "the radii of body %zu must be positive", i);
  for (size_t band = 0; band < r->bands; band++)
    if (!(r->wavelength_um[band] >= 0.0) || !isfinite(r->wavelength_um[band]))
      return pl_fail(PL_E_RANGE, "wavelength %zu must be positive, or 0 for an even disc", band);
  return PL_OK;
}

static void workspace_clear(workspace *w) {
  pl_free(w->laws);
  pl_free(w->shades);
  pl_free(w->breaks);
  pl_free(w->light);
}

static pl_status workspace_init(const pl_occultation *r, workspace *w) {
  *w = (workspace){.rule = pl_gauss_make(r->nodes)};
  PL_TRY(pl_alloc_or_fail(r->bands, sizeof *w->laws, "eclipse", (void **)&w->laws));
  PL_TRY(pl_alloc_or_fail(r->bodies + 1, sizeof *w->shades, "eclipse", (void **)&w->shades));
  PL_TRY(pl_alloc_or_fail(CROSSINGS * r->bodies + 2, sizeof *w->breaks, "eclipse",
                          (void **)&w->breaks));
  PL_TRY(pl_alloc_or_fail(r->bands, sizeof *w->light, "eclipse", (void **)&w->light));
  for (size_t band = 0; band < r->bands; band++)
    w->laws[band] = law_of(r->wavelength_um[band]);
  return PL_OK;
}

pl_status pl_occultation_solve(const pl_occultation *r, const pl_occultation_result *out) {
  PL_TRY(check(r));
  workspace w;
  pl_status status = workspace_init(r, &w);
  for (size_t time = 0; status == PL_OK && time < r->times; time++)
    status = solve_one(r, time, &w, out->fraction + time * r->bands, out->hides + time * r->bodies);
  workspace_clear(&w);
  return status;
}
