/* Ray marching through a part of a ray on which the set of volumes is constant. */
#include "render/volume_march.h"

#include <math.h>

#include "base/work.h"
#include "math/sampling.h"
#include "shade/graph_medium.h"

/* Marching ends below this transmittance. */
static const float DARK = 1e-4f;
/* Upper bound that keeps sums of lights finite. */
static const float LIGHT_MAX = 1e30f;
/* Minimum number of steps through a volume whose density varies; and divisor of the number of steps
 * for rays that start at surfaces. */
enum { STEPS_MIN = 4, OF_SURFACES = 4 };

/* Phase function of Henyey and Greenstein 1941, 1/sr; cosine: of the scattering angle. */
static float phase(float g, float cosine) {
  const float base = 1.0f + g * g - 2.0f * g * cosine;
  return (1.0f - g * g) / (4.0f * PL_PI_F * base * sqrtf(base));
}

/* The sum of all media at a point, per metre. */
typedef struct mixture {
  pl_vec3f extinction; /* 1/m */
  pl_vec3f scattered;  /* scattering coefficient times phase function, 1/(m sr) */
  pl_vec3f emission;   /* W m-3 sr-1 */
} mixture;

static void add_medium(const pl_volume_item *item, const pl_volume_ray *ray, pl_vec3 point,
                       float radius_m, mixture *sum) {
  const pl_shot_volume *shot = item->shot;
  const pl_volume *v = shot->volume;
  pl_medium medium = {.density = 1.0f, .albedo = {1.0f, 1.0f, 1.0f}};
  if (v->graph != NULL) {
    const pl_vec3 place = pl_mat3_mul_vec_t(shot->rotation, pl_vec3_sub(point, shot->origin));
    const pl_vec3f viewer = pl_vec3_to_float(pl_vec3_scale(ray->direction, -1.0));
    const pl_graph_point at = pl_volume_point(shot, place, viewer, radius_m);
    medium = pl_graph_medium(v->graph, &at, v->parameters);
  }
  if (!(medium.density > 0.0f))
    return;
  const float cosine = pl_vec3f_dot(pl_vec3_to_float(ray->direction), item->sun.direction);
  const float turned = phase(v->g, cosine);
  const pl_vec3f e = pl_vec3f_scale(
      pl_vec3f_make(v->extinction[0], v->extinction[1], v->extinction[2]), medium.density);
  const pl_vec3f albedo =
      pl_vec3f_mul(pl_vec3f_make(v->albedo[0], v->albedo[1], v->albedo[2]), medium.albedo);
  const pl_vec3f own = pl_vec3f_make(v->emission[0], v->emission[1], v->emission[2]);
  sum->extinction = pl_vec3f_add(sum->extinction, e);
  sum->scattered = pl_vec3f_madd(sum->scattered, turned, pl_vec3f_mul(e, albedo));
  sum->emission = pl_vec3f_madd(sum->emission, medium.density, pl_vec3f_add(own, medium.emission));
}

/* Light that leaves a step with a uniform source of 1, per source: (1 - exp(-x)) / x times the
 * length, m. */
static float seen_m(float extinction, float length) {
  const float x = extinction * length;
  return x > 1e-3f ? -expm1f(-x) / extinction : length * (1.0f - 0.5f * x);
}

static pl_vec3f seen(pl_vec3f extinction, float length) {
  return pl_vec3f_make(seen_m(extinction.x, length), seen_m(extinction.y, length),
                       seen_m(extinction.z, length));
}

static pl_vec3f cut_off(pl_vec3f light) {
  return pl_vec3f_make(pl_minf(light.x, LIGHT_MAX), pl_minf(light.y, LIGHT_MAX),
                       pl_minf(light.z, LIGHT_MAX));
}

/* One step from `start` to `end`, with the medium at `middle`. */
static void step(const pl_volume_view *view, const pl_volume_ray *ray, const pl_volume_part *part,
                 double start, double end, double middle, pl_volume_stretch *sum) {
  const float length = (float)(end - start);
  const float width = ray->width_m + ray->spread * (float)middle;
  const pl_vec3 point = pl_vec3_madd(ray->origin, middle, ray->direction);
  mixture m = {{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}};
  for (size_t i = 0; i < part->count; i++)
    add_medium(part->items[i], ray, point, 0.5f * pl_maxf(length, width), &m);
  if (ray->sun != NULL) {
    pl_vec3f source = ray->unlit ? (pl_vec3f){0.0f, 0.0f, 0.0f} : m.emission;
    if (pl_vec3f_max(m.scattered) > 0.0f) {
      const pl_vec3f sun = pl_vec3f_mul(ray->sun(ray->context, point, &part->items[0]->sun),
                                        pl_volume_toward_sun(view, point));
      source = pl_vec3f_add(source, pl_vec3f_mul(m.scattered, sun));
    }
    const pl_vec3f light = cut_off(pl_vec3f_mul(source, seen(m.extinction, length)));
    sum->radiance = pl_vec3f_add(sum->radiance, pl_vec3f_mul(sum->transmittance, light));
  }
  const pl_vec3f e = m.extinction;
  sum->transmittance =
      pl_vec3f_mul(sum->transmittance,
                   pl_vec3f_make(expf(-e.x * length), expf(-e.y * length), expf(-e.z * length)));
}

/* End of the fraction `part` of the steps, if each step extinguishes the same amount of light;
 * `depth`: optical depth over `length`. In a uniform medium most of the scattered light comes from
 * the near part. */
static double even_place(double part, double depth, double length) {
  if (depth < 1e-3)
    return part * length;
  return fmin(length, -log1p(part * expm1(-depth)) / depth * length);
}

/* Sum of the media's extinction coefficients in the band with the largest sum, 1/m. */
static double extinction_of(const pl_volume_part *part) {
  double sum[3] = {0.0, 0.0, 0.0};
  for (size_t i = 0; i < part->count; i++)
    for (int k = 0; k < 3; k++)
      sum[k] += (double)part->items[i]->shot->volume->extinction[k];
  return fmax(sum[0], fmax(sum[1], sum[2]));
}

/* Half of the steps are placed for the densest band. The others are of equal length, for bands of
 * lower extinction and for light from behind. */
static void march_even(const pl_volume_view *view, const pl_volume_ray *ray,
                       const pl_volume_part *part, pl_volume_stretch *sum) {
  const double length = part->end - part->start, dense = extinction_of(part);
  const int steps = ray->sun != NULL ? view->steps : 1;
  const int alike = steps / 2, by_light = steps - alike;
  double place = 0.0;
  for (int i = 0, k = 0; i + k < steps;) {
    const double next_alike = k < alike ? length * (k + 1.0) / (alike + 1.0) : length;
    const double next_by_light = even_place((i + 1.0) / by_light, dense * length, length);
    const double next = i + k + 1 == steps ? length : fmin(next_alike, next_by_light);
    const double middle = place + even_place(0.5, dense * (next - place), next - place);
    step(view, ray, part, part->start + place, part->start + next, part->start + middle, sum);
    if (next_alike < next_by_light)
      k++;
    else
      i++;
    place = next;
  }
}

/* Distribution of the steps over a part of a ray. It follows the volume that needs the most steps.
 * If that has a core, steps subtend equal angles at its origin (equiangular sampling, Kulla and
 * Fajardo 2012), as if the ray passed the origin no closer than the core. */
typedef struct spacing {
  /* m: distance along the ray to the point closest to the origin, and that point's distance from
   * the origin, combined with the core's radius; off 0: steps of equal length */
  double middle, off;
  double angles[2];
  double steps;
} spacing;

static spacing spacing_in(const pl_volume_ray *ray, const pl_volume_part *part,
                          const pl_shot_volume *shot) {
  const double core_m = shot->volume->core_m;
  spacing out = {.off = 0.0, .steps = (part->end - part->start) / (2.0 * shot->radius_m)};
  if (!(core_m > 0.0))
    return out;
  const pl_vec3 from = pl_vec3_sub(shot->origin, ray->origin);
  out.middle = pl_vec3_dot(from, ray->direction);
  out.off = hypot(pl_vec3_norm(pl_vec3_madd(from, -out.middle, ray->direction)), core_m);
  out.angles[0] = atan((part->start - out.middle) / out.off);
  out.angles[1] = atan((part->end - out.middle) / out.off);
  out.steps = (out.angles[1] - out.angles[0]) / PL_PI;
  return out;
}

/* The distribution for a part of a ray. Shorter parts take fewer steps, and so do rays that start
 * at surfaces, because a pixel has many of them. */
static spacing spacing_of(const pl_volume_view *view, const pl_volume_ray *ray,
                          const pl_volume_part *part) {
  spacing out = {.steps = -1.0};
  for (size_t i = 0; i < part->count; i++) {
    if (part->items[i]->columns == NULL)
      continue;
    const spacing found = spacing_in(ray, part, part->items[i]->shot);
    if (found.steps > out.steps)
      out = found;
  }
  const int most = ray->camera ? view->steps : (view->steps + OF_SURFACES - 1) / OF_SURFACES;
  const int least = most < STEPS_MIN ? most : STEPS_MIN;
  out.steps = fmin(most, fmax(least, ceil(most * out.steps)));
  return out;
}

/* Ends of step `i` of `steps`, and the point where its medium is evaluated. */
static void step_of(const spacing *s, const pl_volume_part *part, int i, int steps, double ends[2],
                    double *middle) {
  for (int side = 0; side < 2; side++) {
    const double at = (double)(i + side) / steps;
    const double angle = s->angles[0] + at * (s->angles[1] - s->angles[0]);
    ends[side] = s->off > 0.0 ? s->middle + s->off * tan(angle)
                              : part->start + at * (part->end - part->start);
    ends[side] = fmin(part->end, fmax(part->start, ends[side]));
  }
  *middle = 0.5 * (ends[0] + ends[1]);
  if (!(s->off > 0.0))
    return;
  /* Where the angle per metre equals its mean over the step. Steps are then exact for densities
   * that fall with the square of the distance, and for uniform ones. */
  const double angle = (s->angles[1] - s->angles[0]) / steps;
  const double along2 = (ends[1] - ends[0]) / angle * s->off - s->off * s->off;
  const double along = copysign(sqrt(fmax(0.0, along2)), *middle - s->middle);
  *middle = fmin(ends[1], fmax(ends[0], s->middle + along));
}

void pl_volume_march(const pl_volume_view *view, const pl_volume_ray *ray,
                     const pl_volume_part *part, pl_volume_stretch *sum) {
  bool even = true;
  for (size_t i = 0; i < part->count; i++)
    even = even && part->items[i]->columns == NULL;
  if (even) {
    pl_work_add(PL_WORK_volume_steps, 1);
    march_even(view, ray, part, sum);
    return;
  }
  const spacing s = spacing_of(view, ray, part);
  const int steps = (int)s.steps;
  pl_work_add(PL_WORK_volume_steps, (size_t)steps);
  for (int i = 0; i < steps && pl_vec3f_max(sum->transmittance) > DARK; i++) {
    double ends[2], middle;
    step_of(&s, part, i, steps, ends, &middle);
    step(view, ray, part, ends[0], ends[1], middle, sum);
  }
}
