/* Bounds the sunlight that each facet of a mesh sends into one direction, and sums them. */
#include "scene/sent_light.h"

#include <math.h>

#include "math/vec.h"
#include "shade/ggx.h"

/* Bound of g for a GGX lobe on a facet whose shading normals are off its own by at most an angle of
 * this sine. The radiance in the mirror direction is E F D G2 / (4 cos(o)) with D <= 1/(pi alpha^2)
 * and G2 / (4 cos(o)) <= 1 / (2 (cos(o) + sqrt(cos(o)^2 + alpha^2 sin(o)^2))), which is at most
 * 1/(2 alpha). The facet shows the cosine of its own normal, at most cos(o) + sine, of its area. */
static double lobe(double alpha, double sine) {
  const double even = 0.25 + 0.5 * sine / alpha;
  return fmin(even, 0.5 / alpha) / (alpha * alpha);
}

/* Two lobes, of a coat and its base, have the smallest alpha of both times cbrt(1/2), at which the
 * bound with 1/alpha^3 is that of both. That with 1/alpha^2 needs the remaining factor. */
static double gain_of(const pl_model_summary *summary, double sine) {
  const double alpha = fmax(summary->ggx_alpha_min, (double)PL_GGX_ALPHA_MIN);
  const double lobes = summary->coat_max > 0.0 ? cbrt(2.0) : 1.0;
  const double diffuse = 1.06; /* as in plan/view.c, for light reflected by several microfacets */
  return diffuse + (summary->diffuse ? 0.0 : lobes * lobe(alpha, summary->bumped ? 1.0 : sine));
}

static pl_vec3 corner_of(const pl_model *model, const uint32_t *corner, size_t k) {
  const float *p = model->positions + 3 * (size_t)corner[k];
  return (pl_vec3){p[0], p[1], p[2]};
}

/* Area of a triangle, and the largest sine of the angles between its normal and those of its
 * corners; 1 where that is not known. */
static double area_of(const pl_model *model, size_t triangle, double *sine) {
  const uint32_t *corner = model->indices + 3 * triangle;
  const pl_vec3 a = corner_of(model, corner, 0);
  const pl_vec3 across = pl_vec3_cross(pl_vec3_sub(corner_of(model, corner, 1), a),
                                       pl_vec3_sub(corner_of(model, corner, 2), a));
  const double length = pl_vec3_norm(across);
  *sine = 0.0;
  for (size_t k = 0; k < 3 && length > 0.0; k++) {
    const float *n = model->normals + 3 * (size_t)corner[k];
    const pl_vec3 normal = {n[0], n[1], n[2]};
    const double cosine = pl_vec3_dot(normal, across) / length;
    const double off = pl_vec3_norm(pl_vec3_cross(normal, across)) / length;
    *sine = fmax(*sine, cosine > 0.0 ? fmin(off, 1.0) : 1.0);
  }
  return 0.5 * length;
}

/* Summaries of what covers a triangle; neighbours mostly have the same graph. */
typedef struct covers {
  const pl_model *model;
  const pl_model_summary *own; /* a graph may use the material below */
  const pl_object_materials *materials;
  const pl_object_graph *graph; /* that `summary` is of */
  pl_model_summary summary;
} covers;

static pl_model_summary summary_at(covers *of, uint32_t triangle) {
  const pl_object_graph *graph = pl_object_materials_at(of->materials, triangle);
  if (graph == NULL)
    return pl_material_summarise(of->model, pl_material_of(of->model, triangle));
  if (graph != of->graph) {
    of->graph = graph;
    of->summary = *of->own;
    pl_graph_summarise(graph->graph, &of->summary);
  }
  return of->summary;
}

pl_sent_light pl_sent_light_of(const pl_model *model, const pl_model_summary *summary,
                               const pl_object_materials *materials) {
  covers of = {.model = model, .own = summary, .materials = materials};
  pl_sent_light out = {0};
  for (size_t t = 0; t < model->triangle_count; t++) {
    double sine;
    const double area = area_of(model, t, &sine);
    const pl_model_summary at = summary_at(&of, (uint32_t)t);
    const double gain = gain_of(&at, sine);
    if (gain < PL_SENT_MIRROR)
      out.area_gain += area * gain;
    else
      out.mirrors += area;
  }
  return out;
}
