/* Directions on the triangles of a snapshot's objects, in view axes. Inline because shading calls
 * them for every vertex. */
#ifndef PL_SCENE_SHOT_FRAME_H
#define PL_SCENE_SHOT_FRAME_H

#include "math/sampling.h"
#include "scene/snapshot.h"
#include "shade/surface.h"

/* Returns the edge between two corners in view axes. Float suffices, since the translation cancels.
 */
static inline pl_vec3f pl_shot_edge(const float m[12], const float *from, const float *to) {
  const float x = to[0] - from[0], y = to[1] - from[1], z = to[2] - from[2];
  return pl_vec3f_make(m[0] * x + m[3] * y + m[6] * z, m[1] * x + m[4] * y + m[7] * z,
                       m[2] * x + m[5] * y + m[8] * z);
}

/* Returns the camera-relative position of a mesh point, m. `piece`: the triangle's piece, or NULL.
 */
static inline pl_vec3 pl_shot_corner(const pl_shot_object *object, const pl_shot_piece *piece,
                                     const float *p) {
  if (piece != NULL)
    return pl_vec3_add(piece->origin, pl_mat3_mul_vec(piece->linear, (pl_vec3){p[0], p[1], p[2]}));
  const pl_vec3 local = pl_vec3_scale(
      pl_vec3_sub((pl_vec3){p[0], p[1], p[2]}, object->object->offset), object->scale);
  return pl_vec3_add(object->position, pl_mat3_mul_vec(object->rotation, local));
}

/* Makes an orthonormal frame about n. `tangent` need not be perpendicular to n; if it is zero or
 * parallel to n, any frame is returned. */
static inline void pl_surface_set_frame(pl_surface *surface, pl_vec3f n, pl_vec3f tangent,
                                        float handedness) {
  const pl_vec3f t = pl_vec3f_madd(tangent, -pl_vec3f_dot(tangent, n), n);
  surface->n = n;
  if (pl_vec3f_dot(t, t) > 1e-12f) {
    surface->t = pl_vec3f_unit(t);
    surface->b = pl_vec3f_scale(pl_vec3f_cross(n, surface->t), handedness);
  } else {
    const pl_basis basis = pl_basis_make(n);
    surface->t = basis.t;
    surface->b = basis.b;
  }
}

static inline pl_vec3f pl_shot_mix3(const float *values, size_t stride, const uint32_t *corner,
                                    const float w[3]) {
  pl_vec3f out = {0.0f, 0.0f, 0.0f};
  for (int k = 0; k < 3; k++) {
    const float *v = values + stride * corner[k];
    out = pl_vec3f_madd(out, w[k], pl_vec3f_make(v[0], v[1], v[2]));
  }
  return out;
}

/* Rotates a direction from model axes to view axes. */
static inline pl_vec3f pl_shot_rotate(const pl_mat3 *m, pl_vec3f v) {
  return pl_vec3f_make(
      (float)m->row[0].x * v.x + (float)m->row[0].y * v.y + (float)m->row[0].z * v.z,
      (float)m->row[1].x * v.x + (float)m->row[1].y * v.y + (float)m->row[1].z * v.z,
      (float)m->row[2].x * v.x + (float)m->row[2].y * v.y + (float)m->row[2].z * v.z);
}

/* Interpolated normal, flipped to the side of the geometric one: in published files normals and
 * winding may disagree. */
static inline pl_vec3f pl_shot_normal(const pl_shot_object *object, uint32_t triangle,
                                      const float w[3], pl_vec3f ng) {
  const pl_model *model = object->object->model;
  const uint32_t *corner = model->indices + 3 * (size_t)triangle;
  const pl_shot_piece *piece = pl_shot_piece_of(object, triangle);
  const pl_mat3 *turn = piece != NULL ? &piece->normal : &object->rotation;
  const pl_vec3f n =
      pl_vec3f_unit(pl_shot_rotate(turn, pl_shot_mix3(model->normals, 3, corner, w)));
  return pl_vec3f_dot(n, ng) < 0.0f ? pl_vec3f_scale(n, -1.0f) : n;
}

/* Shading frame: n is the interpolated normal, t follows the model's tangents if it has any. */
static inline void pl_shot_frame(const pl_shot_object *object, uint32_t triangle, const float w[3],
                                 pl_vec3f ng, pl_surface *surface) {
  const pl_model *model = object->object->model;
  const uint32_t *corner = model->indices + 3 * (size_t)triangle;
  pl_vec3f tangent = {0.0f, 0.0f, 0.0f};
  float handedness = 1.0f;
  if (model->tangents != NULL) {
    const pl_shot_piece *piece = pl_shot_piece_of(object, triangle);
    const pl_mat3 *turn = piece != NULL ? &piece->linear : &object->rotation;
    tangent = pl_shot_rotate(turn, pl_shot_mix3(model->tangents, 4, corner, w));
    handedness = model->tangents[4 * (size_t)corner[0] + 3] < 0.0f ? -1.0f : 1.0f;
    if (piece != NULL) {
      tangent = pl_vec3f_unit(tangent);
      handedness *= piece->side;
    }
  }
  pl_surface_set_frame(surface, pl_shot_normal(object, triangle, w, ng), tangent, handedness);
}

#endif
