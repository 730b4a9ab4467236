/* Counts crossings of rays along the axes of a mesh with its triangles. */
#include "geom/inside.h"

#include <float.h>
#include <math.h>

#include "geom/shape.h"

/* A ray from `from` along an axis, upwards (sign 1) or downwards (-1). `across`: the other two
 * axes, right-handed with it. */
typedef struct line {
  double from[3];
  int axis, across[2];
  double sign;
} line;

/* Sign of a sum that rounding may change by up to 16 ulp of its terms' size; 0 if it is not known.
 */
static int certain_sign(double sum, double size) {
  return fabs(sum) <= 16.0 * DBL_EPSILON * size ? 0 : (sum > 0.0 ? 1 : -1);
}

/* How often a ray leaves the surface through a triangle: 1, 0, or -1 where it enters. Signs of
 * edges seen along the ray say whether it passes within, that of the volume with the ray's origin
 * whether the triangle is ahead. False if rounding decides. */
static bool cross(const pl_model *model, uint32_t triangle, const line *ray, int *out) {
  double at[3][3];
  int edge[3];
  double normal = 0.0, volume = 0.0, size = 0.0;
  *out = 0;
  for (size_t k = 0; k < 3; k++) {
    const float *p = model->positions + 3 * (size_t)model->indices[3 * (size_t)triangle + k];
    for (size_t i = 0; i < 2; i++)
      at[k][i] = (double)p[ray->across[i]] - ray->from[ray->across[i]];
    at[k][2] = ray->sign * ((double)p[ray->axis] - ray->from[ray->axis]);
  }
  for (size_t k = 0; k < 3; k++) {
    const double *a = at[(k + 1) % 3], *b = at[(k + 2) % 3];
    const double area = a[0] * b[1] - a[1] * b[0];
    const double area_size = fabs(a[0] * b[1]) + fabs(a[1] * b[0]);
    edge[k] = certain_sign(area, area_size);
    normal += area;
    volume += area * at[k][2];
    size += area_size * fabs(at[k][2]);
  }
  const bool some = edge[0] > 0 || edge[1] > 0 || edge[2] > 0;
  const bool other = edge[0] < 0 || edge[1] < 0 || edge[2] < 0;
  if (some && other)
    return true;
  const int side = certain_sign(volume, size);
  if (edge[0] == 0 || edge[1] == 0 || edge[2] == 0 || side == 0)
    return false;
  if ((normal > 0.0) == (side > 0))
    *out = normal > 0.0 ? 1 : -1;
  return true;
}

static bool is_met(const pl_box *box, const line *ray) {
  for (int i = 0; i < 2; i++) {
    const int k = ray->across[i];
    if (ray->from[k] < (double)box->low[k] || ray->from[k] > (double)box->high[k])
      return false;
  }
  return ray->sign > 0.0 ? ray->from[ray->axis] <= (double)box->high[ray->axis]
                         : ray->from[ray->axis] >= (double)box->low[ray->axis];
}

/* Sums the crossings of a ray; false if rounding decides one. */
static bool count_crossings(const pl_cover *cover, const line *ray, int *turns, size_t *seen) {
  *turns = 0;
  for (uint32_t k = 0; k < cover->count;) {
    const pl_box *box = &cover->boxes[k];
    const bool met = is_met(box, ray);
    if (met && box->after == k + 1)
      for (uint32_t i = 0; i < box->count; i++) {
        int crossing;
        (*seen)++;
        if (!cross(cover->model, cover->triangles[box->first + i], ray, &crossing))
          return false;
        *turns += crossing;
      }
    k = met ? k + 1 : box->after;
  }
  return true;
}

static bool is_in_box(const pl_box *box, pl_vec3 p) {
  const double at[3] = {p.x, p.y, p.z};
  for (int k = 0; k < 3; k++)
    if (at[k] < (double)box->low[k] || at[k] > (double)box->high[k])
      return false;
  return true;
}

pl_inside pl_cover_inside(const pl_cover *cover, pl_vec3 point) {
  const pl_vec3 p = pl_model_mesh_point(cover->model, point);
  pl_inside out = {false, 0};
  if (cover->count == 0 || !is_in_box(&cover->boxes[0], p))
    return out;
  for (int k = 0; k < 6; k++) {
    /* downwards the two axes across change places, so that the ray looks from the same side */
    const int axis = k % 3, up = k < 3, next = (axis + 1) % 3, last = (axis + 2) % 3;
    const line ray = {.from = {p.x, p.y, p.z},
                      .axis = axis,
                      .across = {up ? next : last, up ? last : next},
                      .sign = up ? 1.0 : -1.0};
    int turns;
    if (count_crossings(cover, &ray, &turns, &out.triangles)) {
      out.inside = turns != 0;
      return out;
    }
  }
  out.triangles += cover->model->triangle_count;
  out.inside = fabs(pl_shape_winding(cover->model, point)) >= 0.5;
  return out;
}
