/* Places pieces: object pose * scale * motion. */
#include "scene/pieces.h"

/* A piece that is thinner than this fraction of its extent has no inverse in float, which ray
 * tracing needs. */
#define FLATNESS 1e-6

static bool is_flat(pl_mat3 m) {
  const pl_mat3 c = pl_mat3_transpose(m);
  const double edges = pl_vec3_norm(c.row[0]) * pl_vec3_norm(c.row[1]) * pl_vec3_norm(c.row[2]);
  return !(fabs(pl_mat3_determinant(m)) > FLATNESS * edges) || !(edges > 0.0);
}

static void set_to_view(pl_shot_piece *piece) {
  const pl_mat3 c = pl_mat3_transpose(piece->linear);
  const pl_vec3 columns[4] = {c.row[0], c.row[1], c.row[2], piece->origin};
  for (int i = 0; i < 4; i++) {
    piece->to_view[3 * i] = (float)columns[i].x;
    piece->to_view[3 * i + 1] = (float)columns[i].y;
    piece->to_view[3 * i + 2] = (float)columns[i].z;
  }
}

/* Normals transform with the cofactor matrix, which scales with the square of lengths; this scale
 * is divided out. */
static void set_normal(pl_shot_piece *piece) {
  const double determinant = pl_mat3_determinant(piece->linear);
  const double length = cbrt(fabs(determinant));
  piece->side = determinant < 0.0 ? -1.0f : 1.0f;
  piece->normal = pl_mat3_cofactor(piece->linear);
  for (int i = 0; i < 3 && length > 0.0; i++)
    piece->normal.row[i] =
        pl_vec3_scale(piece->normal.row[i], (double)piece->side / (length * length));
}

static void place(const pl_shot_object *object, size_t k, const pl_affine *motion,
                  pl_shot_piece *out) {
  *out = (pl_shot_piece){.model = &object->object->cut->pieces[k],
                         .cover = &object->object->cut->covers[k]};
  const pl_affine moved = pl_model_mesh_motion(object->object->model, motion);
  const pl_vec3 shifted = pl_vec3_sub(moved.t, object->object->offset);
  out->linear = pl_mat3_mul(object->rotation, motion->m);
  for (int i = 0; i < 3; i++)
    out->linear.row[i] = pl_vec3_scale(out->linear.row[i], object->scale);
  out->origin = pl_vec3_add(
      object->position, pl_mat3_mul_vec(object->rotation, pl_vec3_scale(shifted, object->scale)));
  out->present = out->model->triangle_count > 0 && !is_flat(motion->m);
  set_to_view(out);
  set_normal(out);
}

/* Returns a corner of a piece's bounding box, camera-relative. */
static pl_vec3 corner_of(const pl_shot_piece *piece, int corner) {
  const float *low = piece->model->bounds_min, *high = piece->model->bounds_max;
  const pl_vec3 p = {corner & 1 ? high[0] : low[0], corner & 2 ? high[1] : low[1],
                     corner & 4 ? high[2] : low[2]};
  return pl_vec3_add(piece->origin, pl_mat3_mul_vec(piece->linear, p));
}

/* Sets the bounding sphere about the centre of the box, in root axes, that contains the boxes of
 * all pieces. */
static void set_sphere(pl_shot_object *object) {
  pl_vec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t i = 0; i < 8 * object->piece_count; i++) {
    const pl_shot_piece *piece = &object->pieces[i / 8];
    if (!piece->present)
      continue;
    const pl_vec3 p = corner_of(piece, (int)(i % 8));
    low = (pl_vec3){fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z)};
    high = (pl_vec3){fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z)};
  }
  object->center = object->position;
  object->radius_m = 0.0;
  if (!(low.x <= high.x))
    return;
  object->center = pl_vec3_scale(pl_vec3_add(low, high), 0.5);
  for (size_t i = 0; i < 8 * object->piece_count; i++)
    if (object->pieces[i / 8].present) {
      const pl_vec3 p = corner_of(&object->pieces[i / 8], (int)(i % 8));
      object->radius_m = fmax(object->radius_m, pl_vec3_norm(pl_vec3_sub(p, object->center)));
    }
  object->radius_m *= 1.0 + 1e-6;
}

pl_status pl_pieces_place(const pl_object_state *state, pl_arena *arena, pl_shot_object *object) {
  const pl_affine rest = PL_AFFINE_IDENTITY;
  const size_t count = object->object->cut->count;
  pl_shot_piece *pieces = pl_arena_alloc(arena, count, sizeof *pieces);
  if (pieces == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the pieces of '%s'", object->object->name);
  for (size_t k = 0; k < count; k++)
    place(object, k, k == 0 ? &rest : &state->movers[k - 1], &pieces[k]);
  object->pieces = pieces;
  object->piece_count = count;
  set_sphere(object);
  return PL_OK;
}
