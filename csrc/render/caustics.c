/* Sampling of the mirrors in the table from one point. */
#include "render/caustics.h"

#include "math/color.h"
#include "shade/ggx.h"
#include "shade/reflectance.h"

/* Mirrors that give a point less than this part of the light in their beam are left to BSDF
 * sampling. */
static const float REACH_MIN = 1e-3f;
/* Minimum probability of either strategy for sampling a mirror. */
static const float WAY_MIN = 0.05f;
/* If BSDF sampling finds a mirror's light at this part of the table's density or more, the mirror
 * is left to it. */
static const float LOBE_FINDS = 0.5f;

/* Density of the mirror's lobe at a unit direction towards it: that of sampling visible normals of
 * its microfacets as seen from the sun, 1/sr. */
static float lobe_pdf(const pl_caustic_mirror *m, pl_vec3f direction) {
  const pl_vec3f out = pl_vec3f_scale(direction, -1.0f);
  if (!(pl_vec3f_dot(out, m->basis.n) > 0.0f))
    return 0.0f;
  const pl_vec3f h = pl_basis_to_local(&m->basis, pl_vec3f_unit(pl_vec3f_add(m->sun, out)));
  return m->peak * pl_ggx_density(m->alpha, m->alpha, h);
}

static bool sample_lobe(const pl_caustic_mirror *m, const float u[2], pl_vec3f *direction) {
  const pl_vec3f h = pl_ggx_visible_normal(m->alpha, m->alpha, m->local, u);
  const pl_vec3f out = pl_vec3f_sub(pl_vec3f_scale(h, 2.0f * pl_vec3f_dot(m->local, h)), m->local);
  *direction = pl_vec3f_unit(pl_vec3f_scale(pl_basis_to_world(&m->basis, out), -1.0f));
  return out.z > 0.0f;
}

/* Density of sampling the rectangle uniformly by area, 1/sr. */
static float rectangle_pdf(const pl_caustic_draw *draw, pl_vec3f direction) {
  const pl_caustic_mirror *m = draw->mirror;
  const float facing = -pl_vec3f_dot(direction, m->basis.n);
  if (!(facing > 0.0f))
    return 0.0f;
  const float t = pl_vec3f_dot(draw->from, m->basis.n) / facing;
  const pl_vec3f at = pl_vec3f_madd(draw->from, t, direction);
  if (fabsf(pl_vec3f_dot(at, m->basis.t)) > m->half[0] ||
      fabsf(pl_vec3f_dot(at, m->basis.b)) > m->half[1])
    return 0.0f;
  return t * t / (m->area * facing);
}

static void sample_rectangle(const pl_caustic_draw *draw, const float u[2], pl_vec3f *direction) {
  const pl_caustic_mirror *m = draw->mirror;
  const float x = m->half[0] * (2.0f * u[0] - 1.0f), y = m->half[1] * (2.0f * u[1] - 1.0f);
  const pl_vec3f at = pl_vec3f_madd(pl_vec3f_scale(m->basis.t, x), y, m->basis.b);
  *direction = pl_vec3f_unit(pl_vec3f_sub(at, draw->from));
}

/* Part of a mirror's beam that a point receives: 1 if the lobe lies within the rectangle as seen
 * from the point. Estimated as the density of the lobe at the point of the rectangle nearest to the
 * sun's image, times the rectangle's solid angle. `direction`: set to that point. */
static float reach(const pl_caustic_mirror *m, pl_vec3f from, pl_vec3f *direction) {
  const float height = pl_vec3f_dot(from, m->basis.n);
  if (!(height > 1e-3f * (m->half[0] + m->half[1])))
    return 0.0f;
  const pl_vec3f at = pl_vec3f_madd(from, height / m->local.z, m->image);
  const float x = pl_vec3f_dot(at, m->basis.t), y = pl_vec3f_dot(at, m->basis.b);
  const float nearest_x = pl_minf(pl_maxf(x, -m->half[0]), m->half[0]);
  const float nearest_y = pl_minf(pl_maxf(y, -m->half[1]), m->half[1]);
  const pl_vec3f place =
      pl_vec3f_madd(pl_vec3f_scale(m->basis.t, nearest_x), nearest_y, m->basis.b);
  const pl_vec3f way = pl_vec3f_sub(place, from);
  const float square = pl_vec3f_dot(way, way), distance = sqrtf(square);
  *direction = pl_vec3f_scale(way, 1.0f / distance);
  const float solid_angle = pl_minf(m->area * height / (square * distance), PL_PI_F);
  const float ratio = solid_angle * lobe_pdf(m, *direction);
  return ratio / (1.0f + ratio);
}

/* Inserts a candidate; the list keeps the brightest. */
static void insert(pl_caustic_draws *out, const pl_caustic_draw *draw) {
  int at = out->count;
  if (at == PL_CAUSTIC_DRAWS) {
    if (!(draw->chance > out->draws[--at].chance))
      return;
  } else {
    out->count++;
  }
  for (; at > 0 && draw->chance > out->draws[at - 1].chance; at--)
    out->draws[at] = out->draws[at - 1];
  out->draws[at] = *draw;
}

static void add_mirror(const pl_caustic_mirror *m, const pl_vertex *vertex, pl_vec3f wo,
                       pl_caustic_draws *out) {
  const pl_surface *s = &vertex->surface;
  const pl_vec3f from = pl_vec3_to_float(pl_vec3_sub(vertex->position, m->center));
  pl_vec3f direction;
  const float part = reach(m, from, &direction);
  if (!(part > REACH_MIN) || !pl_surface_admits(s, direction))
    return;
  const pl_vec3f wi = pl_surface_to_local(s, direction);
  const pl_caustic_draw draw = {.mirror = m,
                                .from = from,
                                .by_lobe = pl_minf(pl_maxf(part, WAY_MIN), 1.0f - WAY_MIN),
                                .chance = part * m->light *
                                          pl_luminance(s->reflectance->evaluate(s, wo, wi))};
  const float found = lobe_pdf(m, direction) / pl_maxf(part, WAY_MIN);
  if (draw.chance > 0.0f && s->reflectance->pdf(s, wo, wi) < LOBE_FINDS * found)
    insert(out, &draw);
}

float pl_caustics_at(const pl_caustics *caustics, const pl_vertex *vertex, pl_vec3f wo,
                     pl_caustic_draws *out) {
  float light = 0.0f;
  out->count = 0;
  for (size_t i = 0; i < caustics->count; i++)
    add_mirror(&caustics->mirrors[i], vertex, wo, out);
  for (int i = 0; i < out->count; i++)
    light += out->draws[i].chance;
  for (int i = 0; i < out->count; i++)
    out->draws[i].chance /= light;
  return light;
}

bool pl_caustics_sample(const pl_caustic_draws *draws, const float u[2], float choice,
                        pl_vec3f *direction) {
  int at = 0;
  while (at + 1 < draws->count && choice >= draws->draws[at].chance)
    choice -= draws->draws[at++].chance;
  const pl_caustic_draw *draw = &draws->draws[at];
  if (choice < draw->by_lobe * draw->chance)
    return sample_lobe(draw->mirror, u, direction);
  sample_rectangle(draw, u, direction);
  return true;
}

float pl_caustics_pdf(const pl_caustic_draws *draws, pl_vec3f direction) {
  float sum = 0.0f;
  for (int i = 0; i < draws->count; i++) {
    const pl_caustic_draw *draw = &draws->draws[i];
    sum += draw->chance * (draw->by_lobe * lobe_pdf(draw->mirror, direction) +
                           (1.0f - draw->by_lobe) * rectangle_pdf(draw, direction));
  }
  return sum;
}
