/* Builds the table of surfaces that mirror the sun onto others in a frame. */
#include "light/sun.h"
#include "math/color.h"
#include "render/caustics.h"
#include "scene/shot_frame.h"
#include "shade/ggx.h"
#include "shade/reflectance.h"

static const float ALPHA_MAX = (float)PL_CAUSTIC_ALPHA_MAX;
/* On a curved mirror, the place of the sun's image depends on the receiving point, and a lobe that
 * covers all of these places would be too wide to find the sun. The limit is the mean square slope
 * of the normals over that of the lobe. */
static const float SPREAD_MAX = 2.0f;
/* If flat mirrors reflect less than this part of the light of all mirrors, the visible noise is
 * that of curved ones, and the table is not worth its cost. */
static const float LISTED_MIN = 0.2f;
/* Smallest part of the sun's light that a mirror in the table reflects. */
static const float LIGHT_MIN = 0.01f;
/* Smallest cosine of incidence; mirrors that the sun only grazes are left out. */
static const float COSINE_MIN = 0.02f;
/* A receiver must stand higher above a mirror's plane than this part of the mirror's size. Anything
 * lower is the mirror itself. */
static const float HEIGHT_MIN = 0.02f;
/* The beam is wider than the mirror by BEAM_ALPHAS times alpha times the distance. It ends where
 * alpha times the distance is FAR times the mirror's size. */
static const float BEAM_ALPHAS = 4.0f, FAR = 8.0f;
/* Boxes of a cover with less than 1/BOXES of its triangles are not subdivided. */
enum { BOXES = 64 };
/* Points per side of a mirror that are tested for direct sunlight. */
enum { SIDE = 4 };
/* Points of a facet at which bumps are evaluated. Their barycentric coordinates follow the sequence
 * of Roberts 2018, folded into the triangle. */
enum { BUMPS = 12 };
static const double STEP_U = 0.7548776662466927, STEP_V = 0.5698402909980532;

/* --- the rectangle ---------------------------------------------------------------------------- */

/* Sets the rectangle of a group of facets of an object, or of one of its pieces. */
static void place(const pl_shot_object *object, const pl_shot_piece *piece,
                  const pl_facet_group *group, pl_caustic_mirror *out) {
  const float *m = piece != NULL ? piece->to_view : object->to_view;
  const float zero[3] = {0.0f, 0.0f, 0.0f};
  const float center[3] = {group->center.x, group->center.y, group->center.z};
  const float sides[2][3] = {{group->half[0].x, group->half[0].y, group->half[0].z},
                             {group->half[1].x, group->half[1].y, group->half[1].z}};
  const pl_vec3f a = pl_shot_edge(m, zero, sides[0]), b = pl_shot_edge(m, zero, sides[1]);
  const pl_mat3 *turn = piece != NULL ? &piece->normal : &object->rotation;
  const pl_vec3f up = pl_shot_rotate(turn, group->normal);
  out->center = pl_shot_corner(object, piece, center);
  out->basis.n = pl_vec3f_across(a, b);
  if (pl_vec3f_dot(out->basis.n, up) < 0.0f)
    out->basis.n = pl_vec3f_scale(out->basis.n, -1.0f);
  out->basis.t = pl_vec3f_unit(a);
  out->basis.b = pl_vec3f_cross(out->basis.n, out->basis.t);
  out->half[0] = pl_vec3f_norm(a);
  out->half[1] = fabsf(pl_vec3f_dot(b, out->basis.b));
  out->area = 4.0f * out->half[0] * out->half[1];
}

static void turn_over(pl_basis *basis) {
  basis->n = pl_vec3f_scale(basis->n, -1.0f);
  basis->b = pl_vec3f_scale(basis->b, -1.0f);
}

/* --- its lobe --------------------------------------------------------------------------------- */

/* Shades a point of the group's largest facet, given by the weights uv of its second and third
 * corner, as seen by a ray from the sun whose footprint covers the whole mirror. `triangle`: index
 * in the object's model. False if the sun is below the shading normal's horizon or grazes it. */
static bool shade(const pl_snapshot *shot, pl_surface_id id, uint32_t triangle, const double uv[2],
                  pl_detail detail, const pl_caustic_mirror *m, pl_vertex *out) {
  const pl_shot_object *object = pl_shot_object_of(shot, id);
  const pl_model *model = object->object->model;
  const pl_shot_piece *piece = pl_shot_piece_of(object, triangle);
  const uint32_t *corner = model->indices + 3 * (size_t)triangle;
  const double weights[3] = {1.0 - uv[0] - uv[1], uv[0], uv[1]};
  pl_vec3 at = {0.0, 0.0, 0.0};
  for (size_t k = 0; k < 3; k++)
    at = pl_vec3_madd(at, weights[k],
                      pl_shot_corner(object, piece, model->positions + 3 * (size_t)corner[k]));
  const pl_vec3 sun = pl_vec3f_to_double(m->sun);
  const double size = (double)(m->half[0] + m->half[1]);
  const pl_beam beam = {.origin = pl_vec3_madd(at, size, sun),
                        .direction = pl_vec3_scale(pl_vec3_unit(sun), -1.0),
                        .width_m = 2.0f * pl_minf(m->half[0], m->half[1])};
  const pl_hit hit = {
      .surface_id = id, .triangle = triangle, .u = (float)uv[0], .v = (float)uv[1], .t = size};
  pl_vertex_locate(shot, &beam, &hit, false, out);
  pl_vertex_shade(shot, &beam, detail, out);
  return pl_vec3f_dot(out->surface.n, m->sun) > COSINE_MIN;
}

/* Variance of the normals' slopes due to a graph's bumps on the facet; they widen the lobe about
 * the image of the sun. 0 for other surfaces. */
static float bumpiness(const pl_snapshot *shot, pl_surface_id id, uint32_t triangle,
                       pl_detail detail, const pl_caustic_mirror *m) {
  const pl_shot_object *object = pl_shot_object_of(shot, id);
  float x = 0.0f, y = 0.0f, square = 0.0f;
  if (pl_object_materials_at(object->object->materials, triangle) == NULL)
    return 0.0f;
  for (int i = 0; i < BUMPS; i++) {
    const double u = fmod(0.5 + STEP_U * i, 1.0), v = fmod(0.5 + STEP_V * i, 1.0);
    const bool beyond = u + v > 1.0;
    const double uv[2] = {beyond ? 1.0 - u : u, beyond ? 1.0 - v : v};
    pl_vertex vertex;
    shade(shot, id, triangle, uv, detail, m, &vertex);
    const pl_vec3f n = pl_basis_to_local(&m->basis, vertex.surface.n);
    const float along = n.x / pl_maxf(n.z, COSINE_MIN), aside = n.y / pl_maxf(n.z, COSINE_MIN);
    x += along / BUMPS;
    y += aside / BUMPS;
    square += (along * along + aside * aside) / BUMPS;
  }
  return pl_maxf(square - x * x - y * y, 0.0f);
}

/* Density of sampled mirror directions over the density of microfacets. */
static float peak_of(float alpha, pl_vec3f sun) {
  return 1.0f / (4.0f * sun.z * (1.0f + pl_ggx_lambda(alpha, sun)));
}

/* Sets alpha and light from what a surface reflects in the mirror direction; false if that is too
 * little or the lobe too wide. Of a coat and its base, the sharper one that reflects enough is
 * used. */
static bool set_lobe(const pl_surface *s, float spread, float irradiance, float sin_sun,
                     pl_caustic_mirror *m) {
  const pl_vec3f wo = pl_surface_to_local(s, m->sun), wi = {-wo.x, -wo.y, wo.z};
  const bool coated = s->reflectance->layered && s->lobes.coat > 0.0f;
  const float sharp = coated ? pl_minf(s->alpha, s->lobes.coat_alpha) : s->alpha;
  const float broad = coated ? pl_maxf(s->alpha, s->lobes.coat_alpha) : s->alpha;
  const float value = pl_luminance(s->reflectance->evaluate(s, wo, wi));
  float alpha = pl_ggx_alpha(sharp);
  const pl_vec3f top = {0.0f, 0.0f, 1.0f};
  float light = value / (peak_of(alpha, wo) * pl_ggx_density(alpha, alpha, top));
  if (!(light > LIGHT_MIN)) {
    alpha = pl_ggx_alpha(broad);
    light = value / (peak_of(alpha, wo) * pl_ggx_density(alpha, alpha, top));
  }
  /* The mean square of a slope is twice that of a component. An offset of the sun's direction tilts
   * the half vector by half as much. */
  const float disc = 0.35f * sin_sun;
  m->alpha = sqrtf(alpha * alpha + disc * disc + spread);
  m->light = pl_minf(light, 1.0f) * irradiance;
  return light > LIGHT_MIN && alpha < ALPHA_MAX;
}

/* --- what it lights --------------------------------------------------------------------------- */

/* Box about a possible receiver: its centre relative to the mirror's centre, and its half axes, m.
 */
typedef struct receiver {
  pl_vec3f from, half[3];
} receiver;

/* Half of the box's extent along an axis. */
static float width_along(const receiver *r, pl_vec3f axis) {
  return fabsf(pl_vec3f_dot(r->half[0], axis)) + fabsf(pl_vec3f_dot(r->half[1], axis)) +
         fabsf(pl_vec3f_dot(r->half[2], axis));
}

/* True if a box overlaps the beam along one side of the mirror. Points are projected along the beam
 * onto the mirror's plane, which is linear in their position. */
static bool lies_within(const pl_caustic_mirror *m, const receiver *r, pl_vec3f side, float half) {
  const float lean = pl_vec3f_dot(m->image, side) / m->local.z;
  const pl_vec3f axis = pl_vec3f_madd(side, lean, m->basis.n);
  return fabsf(pl_vec3f_dot(r->from, axis)) < half + width_along(r, axis);
}

static bool meets(const pl_caustic_mirror *m, const receiver *r) {
  const float size = m->half[0] + m->half[1];
  const float height = pl_vec3f_dot(r->from, m->basis.n), room = width_along(r, m->basis.n);
  if (height + room < HEIGHT_MIN * size)
    return false;
  const float nearest = pl_maxf(height - room, 0.0f) / m->local.z;
  const float blur = BEAM_ALPHAS * m->alpha * (height + room) / (m->local.z * m->local.z);
  return m->alpha * nearest < FAR * size && lies_within(m, r, m->basis.t, m->half[0] + blur) &&
         lies_within(m, r, m->basis.b, m->half[1] + blur);
}

static receiver box_receiver(const pl_caustic_mirror *m, const pl_shot_object *object,
                             const pl_shot_piece *piece, const pl_box *box) {
  const float *to_view = piece != NULL ? piece->to_view : object->to_view;
  receiver out;
  float middle[3], end[3];
  for (int axis = 0; axis < 3; axis++)
    middle[axis] = 0.5f * (box->low[axis] + box->high[axis]);
  for (int axis = 0; axis < 3; axis++) {
    for (int k = 0; k < 3; k++)
      end[k] = k == axis ? box->high[k] : middle[k];
    out.half[axis] = pl_shot_edge(to_view, middle, end);
  }
  out.from = pl_vec3_to_float(pl_vec3_sub(pl_shot_corner(object, piece, middle), m->center));
  return out;
}

static bool lights_cover(const pl_caustic_mirror *m, const pl_shot_object *object,
                         const pl_shot_piece *piece, const pl_cover *cover) {
  /* Boxes of at most this many triangles are not subdivided. */
  const uint32_t fine = cover->count > 0 ? cover->boxes[0].count / BOXES : 0;
  for (size_t i = 0; i < cover->count;) {
    const pl_box *box = &cover->boxes[i];
    const receiver r = box_receiver(m, object, piece, box);
    if (!meets(m, &r)) {
      i = box->after;
      continue;
    }
    if (box->after == i + 1 || box->count <= fine)
      return true;
    i++;
  }
  return false;
}

static bool meets_sphere(const pl_caustic_mirror *m, pl_vec3 center, double radius_m) {
  const float radius = (float)radius_m;
  const receiver ball = {
      .from = pl_vec3_to_float(pl_vec3_sub(center, m->center)),
      .half = {{radius, 0.0f, 0.0f}, {0.0f, radius, 0.0f}, {0.0f, 0.0f, radius}}};
  return meets(m, &ball);
}

/* The beam meets the object's sphere. */
static bool lights_object(const pl_caustic_mirror *m, const pl_shot_object *object) {
  if (!object->kept)
    return false;
  if (object->pieces == NULL)
    return lights_cover(m, object, NULL, object->object->cover);
  for (size_t k = 0; k < object->piece_count; k++)
    if (object->pieces[k].present &&
        lights_cover(m, object, &object->pieces[k], object->pieces[k].cover))
      return true;
  return false;
}

/* A body is a receiver if its surface is near. */
static bool lights_body(const pl_caustic_mirror *m, const pl_shot_body *body) {
  const double height = pl_vec3_norm(pl_vec3_sub(body->center, m->center)) - body->radius_m;
  const pl_vec3 down = pl_vec3_unit(pl_vec3_sub(body->center, m->center));
  return body->shape == NULL && body->near_meshes &&
         (double)m->alpha * height < (double)(FAR * (m->half[0] + m->half[1])) &&
         pl_vec3f_dot(pl_vec3_to_float(down), m->image) < 0.0f;
}

static bool lights_anything(const pl_snapshot *shot, const pl_caustic_mirror *m) {
  const pl_sphere_tree *tree = &shot->object_tree;
  for (size_t k = 0; k < tree->count;) {
    const pl_sphere *sphere = &tree->nodes[k];
    const bool met = meets_sphere(m, sphere->center, sphere->radius_m);
    if (met && sphere->item != PL_INNER_NODE && lights_object(m, &shot->objects[sphere->item]))
      return true;
    k = pl_sphere_next(tree, k, met);
  }
  for (size_t i = 0; i < shot->body_count; i++)
    if (lights_body(m, &shot->bodies[i]))
      return true;
  return false;
}

/* Part of the mirror that is in direct sunlight. */
static float lit_part(const pl_tracer *tracer, const pl_caustic_mirror *m) {
  pl_ray rays[SIDE * SIDE];
  bool occluded[SIDE * SIDE];
  int lit = 0;
  const float lift = 1e-3f * (m->half[0] + m->half[1]);
  for (int i = 0; i < SIDE * SIDE; i++) {
    const float x = m->half[0] * (((float)(i % SIDE) + 0.5f) * (2.0f / SIDE) - 1.0f);
    const float y = m->half[1] * (((float)(i / SIDE) + 0.5f) * (2.0f / SIDE) - 1.0f);
    const pl_vec3f off = pl_vec3f_madd(pl_vec3f_madd(pl_vec3f_scale(m->basis.t, x), y, m->basis.b),
                                       lift, m->basis.n);
    rays[i] = (pl_ray){.origin = pl_vec3_add(m->center, pl_vec3f_to_double(off)),
                       .direction = pl_vec3_unit(pl_vec3f_to_double(m->sun)),
                       .t_max = INFINITY,
                       .skip_body = PL_NO_BODY,
                       .from_surface = PL_NO_SURFACE};
  }
  pl_tracer_occluded(tracer, rays, occluded, SIDE * SIDE, false);
  for (int i = 0; i < SIDE * SIDE; i++)
    lit += !occluded[i];
  return (float)lit / (SIDE * SIDE);
}

/* --- the table -------------------------------------------------------------------------------- */

/* True if the spread of normals adds little to the lobe. */
static bool is_flat(const pl_caustic_mirror *m, float spread) {
  return spread < SPREAD_MAX * (m->alpha * m->alpha - spread);
}

static float power_of(const pl_caustic_mirror *m) { return m->light * m->area * m->local.z; }

/* Inserts a mirror; the table keeps those of the largest power. */
static void insert(const pl_caustic_mirror *m, pl_caustics *out) {
  size_t at = out->count;
  if (at == PL_CAUSTIC_MIRRORS) {
    if (!(power_of(m) > power_of(&out->mirrors[--at])))
      return;
  } else {
    out->count++;
  }
  for (; at > 0 && power_of(m) > power_of(&out->mirrors[at - 1]); at--)
    out->mirrors[at] = out->mirrors[at - 1];
  out->mirrors[at] = *m;
}

typedef struct builder {
  const pl_snapshot *shot;
  const pl_tracer *tracer;
  pl_detail detail;
  pl_caustics *out;
  float listed, bent; /* power of listed flat mirrors, and of mirrors that are too curved */
} builder;

/* Turns the rectangle to the sun's side and sets the direction and image of the sun. False if the
 * sun does not light it. */
static bool face_sun(const builder *b, uint32_t triangle, const pl_sun_view *sun,
                     pl_caustic_mirror *m) {
  const pl_shot_object *object = pl_shot_object_of(b->shot, m->surface_id);
  m->sun = sun->direction;
  if (pl_vec3f_dot(m->basis.n, m->sun) < 0.0f) {
    if (!pl_back_is_there(object->object->model, triangle))
      return false;
    turn_over(&m->basis);
  }
  m->local = pl_basis_to_local(&m->basis, m->sun);
  m->image = pl_vec3f_madd(m->sun, -2.0f * m->local.z, m->basis.n);
  return m->area > 0.0f && m->local.z > COSINE_MIN;
}

/* `triangle`: index in the object's model. */
static void add_group(builder *b, pl_surface_id id, uint32_t triangle, const pl_shot_piece *piece,
                      const pl_facet_group *group) {
  pl_caustic_mirror m = {.surface_id = id};
  pl_vertex vertex;
  place(pl_shot_object_of(b->shot, id), piece, group, &m);
  const pl_sun_view sun = pl_sun_view_at(&b->shot->sun, m.center);
  const double middle[2] = {1.0 / 3.0, 1.0 / 3.0};
  if (!face_sun(b, triangle, &sun, &m) ||
      !shade(b->shot, id, triangle, middle, b->detail, &m, &vertex) ||
      !set_lobe(&vertex.surface, group->spread, sun.irradiance, sun.sin_radius, &m))
    return;
  const float bumps = bumpiness(b->shot, id, triangle, b->detail, &m);
  m.alpha = sqrtf(m.alpha * m.alpha + bumps);
  const float sides = 4.0f * pl_vec3f_norm(group->half[0]) * pl_vec3f_norm(group->half[1]);
  const float filled = sides > 0.0f ? pl_minf(group->area / sides, 1.0f) : 0.0f;
  m.peak = peak_of(m.alpha, m.local);
  if (m.alpha >= ALPHA_MAX || !is_flat(&m, group->spread)) {
    b->bent += filled * power_of(&m);
    return;
  }
  if (!lights_anything(b->shot, &m))
    return;
  m.light *= lit_part(b->tracer, &m);
  if (!(m.light > 0.0f))
    return;
  b->listed += filled * power_of(&m);
  insert(&m, b->out);
}

static void add_groups(builder *b, pl_surface_id id, const pl_shot_piece *piece, uint32_t first,
                       const pl_cover *cover) {
  for (size_t i = 0; i < cover->facets.count; i++) {
    const pl_facet_group *group = &cover->facets.groups[i];
    add_group(b, id, first + group->triangle, piece, group);
  }
}

static void add_object(builder *b, pl_surface_id id) {
  const pl_shot_object *object = pl_shot_object_of(b->shot, id);
  if (object->pieces == NULL) {
    add_groups(b, id, NULL, 0, object->object->cover);
    return;
  }
  for (size_t k = 0; k < object->piece_count; k++)
    if (object->pieces[k].present)
      add_groups(b, id, &object->pieces[k], (uint32_t)object->object->cut->first[k],
                 object->pieces[k].cover);
}

void pl_caustics_build(const pl_snapshot *shot, const pl_tracer *tracer, pl_detail detail,
                       pl_caustics *out) {
  builder b = {.shot = shot, .tracer = tracer, .detail = detail, .out = out};
  out->count = 0;
  out->sun = (float)pl_shot_sun_irradiance(&shot->sun, (pl_vec3){0.0, 0.0, 0.0});
  for (size_t i = 0; i < shot->craft_count; i++) {
    const pl_shot_object *object = &shot->objects[i];
    const pl_model_summary *summary = &object->object->summary;
    if (object->kept && !object->dark &&
        (summary->ggx_alpha_min < PL_CAUSTIC_ALPHA_MAX || summary->coat_max > 0.0))
      add_object(&b, object->id);
  }
  if (b.listed < LISTED_MIN * (b.listed + b.bent))
    out->count = 0;
}
