/* Vertices of paths. Positions are in double precision, shading in single. What depends on the kind
 * of geometry is in render/geometry.h. */
#include "render/vertex.h"

#include "math/sampling.h"
#include "render/geometry.h"
#include "scene/shot_frame.h"

void pl_vertex_locate(const pl_snapshot *shot, const pl_beam *beam, const pl_hit *hit, bool exact,
                      pl_vertex *out) {
  out->surface_id = hit->surface_id;
  out->triangle = hit->triangle;
  pl_geometry_of(hit->surface_id)->locate(shot, beam, hit, exact, out);
}

void pl_vertex_footprint(const pl_vertex *vertex, const pl_beam *beam, pl_vec3f *a, pl_vec3f *b) {
  const float width = beam->width_m + beam->spread * (float)vertex->t;
  const pl_vec3f d = pl_vec3_to_float(beam->direction), n = vertex->ng;
  const float cosine = pl_maxf(fabsf(pl_vec3f_dot(d, n)), 0.02f);
  pl_vec3f across = pl_vec3f_cross(n, d);
  if (pl_vec3f_dot(across, across) < 1e-8f)
    across = pl_basis_make(n).t;
  across = pl_vec3f_unit(across);
  *a = pl_vec3f_scale(across, width);
  *b = pl_vec3f_scale(pl_vec3f_cross(across, n), width / cosine);
}

/* An interpolated normal can face away from a viewer who sees the surface. It is bent back to this
 * cosine. */
#define GRAZING 1e-3f

static pl_vec3f bring_back(pl_vec3f n, float cosine, pl_vec3f view) {
  return pl_vec3f_unit(pl_vec3f_madd(n, GRAZING - cosine, view));
}

/* Surfaces are two-sided, because the winding of published models is not reliable. */
static void face_viewer(pl_surface *surface, pl_vec3f ng, pl_vec3f view) {
  surface->ng = ng;
  if (pl_vec3f_dot(ng, view) < 0.0f) {
    surface->ng = pl_vec3f_scale(ng, -1.0f);
    surface->n = pl_vec3f_scale(surface->n, -1.0f);
    surface->b = pl_vec3f_scale(surface->b, -1.0f);
  }
  const float cosine = pl_vec3f_dot(surface->n, view);
  if (cosine < GRAZING)
    pl_surface_set_frame(surface, bring_back(surface->n, cosine, view), surface->t, 1.0f);
}

void pl_vertex_face_layers(pl_vertex *vertex) {
  pl_lobes *lobes = &vertex->surface.lobes;
  if (!(pl_vec3f_dot(vertex->ng, vertex->surface.ng) < 0.0f))
    return;
  lobes->coat_normal = pl_vec3f_scale(lobes->coat_normal, -1.0f);
  lobes->inside = lobes->ior > 0.0f;
}

void pl_vertex_orient(const pl_snapshot *shot, const pl_beam *beam, pl_vertex *vertex) {
  const pl_geometry_kind *kind = pl_geometry_of(vertex->surface_id);
  const bool smooth = kind->smooth_normal != NULL;
  const pl_vec3f n = smooth ? kind->smooth_normal(shot, vertex) : vertex->ng;
  const bool behind = pl_vec3_dot(pl_vec3f_to_double(vertex->ng), beam->direction) > 0.0;
  vertex->surface.ng = behind ? pl_vec3f_scale(vertex->ng, -1.0f) : vertex->ng;
  vertex->surface.n = behind ? pl_vec3f_scale(n, -1.0f) : n;
  const pl_vec3f view = pl_vec3_to_float(pl_vec3_scale(beam->direction, -1.0));
  const float cosine = pl_vec3f_dot(vertex->surface.n, view);
  if (smooth && cosine < GRAZING) /* others are exact */
    vertex->surface.n = bring_back(vertex->surface.n, cosine, view);
}

/* Shades the vertices from `first` on that are of its kind, which shades several together. */
static void shade_kind(const pl_snapshot *shot, pl_detail detail, const pl_vertex_view *run,
                       size_t first, size_t count, bool *done) {
  const pl_geometry_kind *kind = pl_geometry_of(run[first].vertex->surface_id);
  pl_vertex_view same[PL_SHADE_RUN];
  size_t size = 0;
  for (size_t i = first; i < count; i++)
    if (pl_geometry_of(run[i].vertex->surface_id) == kind) {
      same[size++] = run[i];
      done[i] = true;
    }
  kind->shade_run(shot, detail, same, size);
}

void pl_vertex_shade_run(const pl_snapshot *shot, pl_detail detail, const pl_vertex_view *run,
                         size_t count) {
  bool done[PL_SHADE_RUN] = {false};
  for (size_t i = 0; i < count; i++)
    run[i].vertex->surface.rough = (pl_rough){0};
  for (size_t i = 0; i < count; i++) {
    const pl_geometry_kind *kind = pl_geometry_of(run[i].vertex->surface_id);
    if (kind->shade_run == NULL)
      kind->shade(shot, run[i].beam, detail, run[i].vertex);
    else if (!done[i])
      shade_kind(shot, detail, run, i, count, done);
  }
  for (size_t i = 0; i < count && !detail.color_only; i++) {
    pl_vertex *vertex = run[i].vertex;
    const pl_geometry_kind *kind = pl_geometry_of(vertex->surface_id);
    face_viewer(&vertex->surface, vertex->ng,
                pl_vec3_to_float(pl_vec3_scale(run[i].beam->direction, -1.0)));
    if (kind->set_horizon != NULL)
      kind->set_horizon(shot, vertex);
  }
}

void pl_vertex_shade(const pl_snapshot *shot, const pl_beam *beam, pl_detail detail,
                     pl_vertex *vertex) {
  const pl_vertex_view alone = {beam, vertex};
  pl_vertex_shade_run(shot, detail, &alone, 1);
}

pl_ray pl_vertex_ray(const pl_vertex *vertex, const pl_snapshot *shot, pl_vec3f direction,
                     double t_max) {
  const float side = pl_vec3f_dot(direction, vertex->surface.ng) < 0.0f ? -1.0f : 1.0f;
  pl_ray ray = {
      .t_max = t_max,
      .direction = pl_vec3_unit(pl_vec3f_to_double(direction)),
      .skip_body = PL_NO_BODY,
      .from_surface = vertex->surface_id,
  };
  pl_geometry_of(vertex->surface_id)->leave(shot, vertex, side, &ray);
  return ray;
}
