/* Marching through a part of a ray that is in the same volumes all along. */
#include "render/volume_march.h"

#include <math.h>

#include "math/sampling.h"
#include "shade/graph_medium.h"

/* Less than this part of the light from beyond is not followed any more. */
static const float DARK = 1e-4f;
/* Sums of lights stay finite. */
static const float LIGHT_MAX = 1e30f;
/* Fewest steps through a volume whose density varies; and rays that come from surfaces take so many
 * times fewer. */
enum { STEPS_MIN = 4, OF_SURFACES = 4 };

/* Henyey and Greenstein 1941, 1/sr; cosine: of the angle by which light is turned. */
static float phase(float g, float cosine) {
  const float base = 1.0f + g * g - 2.0f * g * cosine;
  return (1.0f - g * g) / (4.0f * PL_PI_F * base * sqrtf(base));
}

/* A metre of all media at a point. */
typedef struct mixture {
  pl_vec3f extinction; /* 1/m */
  pl_vec3f scattered;  /* times the phase functions, 1/(m sr) */
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

/* What a step sends on of a source of 1 all along it, over its length: (1 - exp(-x)) / x, m. */
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

/* One step, from `start` on, whose medium is that at `middle`. */
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
    sum->radiance = pl_vec3f_add(sum->radiance, pl_vec3f_mul(sum->passed, light));
  }
  const pl_vec3f e = m.extinction;
  sum->passed = pl_vec3f_mul(
      sum->passed, pl_vec3f_make(expf(-e.x * length), expf(-e.y * length), expf(-e.z * length)));
}

/* Of steps that each take as much of the light, of which `depth` is taken in all: the end of a part
 * of them. Where the medium is the same all along, what scatters comes most from the near part. */
static double even_place(double part, double depth, double length) {
  if (depth < 1e-3)
    return part * length;
  return fmin(length, -log1p(part * expm1(-depth)) / depth * length);
}

/* Sum of the extinctions of the media in the band where it is largest, 1/m. */
static double extinction_of(const pl_volume_part *part) {
  double sum[3] = {0.0, 0.0, 0.0};
  for (size_t i = 0; i < part->count; i++)
    for (int k = 0; k < 3; k++)
      sum[k] += (double)part->items[i]->shot->volume->extinction[k];
  return fmax(sum[0], fmax(sum[1], sum[2]));
}

/* Half of the steps are for the densest band; the others are alike, for bands that see farther, and
 * for light that comes from behind. */
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

/* Steps of a part of a ray: as many as the volume asks for whose density is the finest there. Of
 * one with a core they are seen from its origin: even in the angle between them (equiangular, Kulla
 * and Fajardo 2012), as if the ray passed it no nearer than the core. */
typedef struct spacing {
  double middle, off; /* m: where the ray is nearest to it, and how near; off 0: all are alike */
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

/* Shorter ways take fewer steps, and so do rays that come from surfaces: they are many to a pixel.
 */
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

/* Ends of step `i` of so many. */
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
  /* Where a metre is as much of an angle as in the whole step: so steps are exact for what falls
   * off with the square of the distance, and for what is the same everywhere. */
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
    march_even(view, ray, part, sum);
    return;
  }
  const spacing s = spacing_of(view, ray, part);
  const int steps = (int)s.steps;
  for (int i = 0; i < steps && pl_vec3f_max(sum->passed) > DARK; i++) {
    double ends[2], middle;
    step_of(&s, part, i, steps, ends, &middle);
    step(view, ray, part, ends[0], ends[1], middle, sum);
  }
}
