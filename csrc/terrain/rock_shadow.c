/* Outlines of meshes as functions of the angle about their centre. */
#include "terrain/rock_shadow.h"

#include "base/memory.h"

enum { DIRECTIONS = 12, RAYS = 128 };

/* Mean shadows of the meshes of families over those of the finest: vertices lie on the surface, and
 * edges between them cut corners off. Measured over all variants; a test repeats it. */
static const double family_shadows[PL_ROCK_MODEL][PL_ROCK_LODS] = {
    [PL_ROCK_BLOCK] = {0.681, 0.862, 0.946, 0.981, 0.995, 1.000},
    [PL_ROCK_CUBE] = {0.649, 0.838, 0.937, 0.978, 0.994, 1.000},
    [PL_ROCK_WEDGE] = {0.640, 0.828, 0.933, 0.975, 0.993, 1.000},
    [PL_ROCK_SLAB] = {0.690, 0.868, 0.948, 0.982, 0.995, 1.000},
    [PL_ROCK_TABLET] = {0.722, 0.898, 0.968, 0.989, 0.997, 1.000},
    [PL_ROCK_SHARD] = {0.654, 0.842, 0.940, 0.978, 0.994, 1.000},
    [PL_ROCK_SPLIT] = {0.628, 0.836, 0.936, 0.975, 0.993, 1.000},
    [PL_ROCK_COBBLE] = {0.732, 0.903, 0.969, 0.989, 0.997, 1.000},
    [PL_ROCK_BOULDER] = {0.690, 0.876, 0.956, 0.984, 0.995, 1.000},
    [PL_ROCK_EGG] = {0.737, 0.911, 0.973, 0.991, 0.997, 1.000},
    [PL_ROCK_BRECCIA] = {0.712, 0.883, 0.957, 0.982, 0.994, 1.000},
    [PL_ROCK_PITTED] = {0.715, 0.889, 0.959, 0.984, 0.995, 1.000},
};

/* Points of a mesh, and their angle about the centre of the shadow. */
typedef struct outline {
  const pl_rock_sphere *sphere;
  pl_vec3 *points;                  /* z is towards the light once they are turned */
  double (*flat)[2], *angle;        /* in rays */
  double ray[RAYS][2], reach[RAYS]; /* of the shadow along each ray */
} outline;

static pl_status make_room(const pl_rock_sphere *sphere, outline *out) {
  const size_t count = (size_t)sphere->vertex_count;
  void *block;
  PL_TRY(pl_alloc_or_fail(count, sizeof(pl_vec3) + 3 * sizeof(double), "shadows of rocks", &block));
  *out = (outline){.sphere = sphere, .points = block};
  out->flat = (double(*)[2])(void *)(out->points + count);
  out->angle = (double *)(void *)(out->flat + count);
  for (int k = 0; k < RAYS; k++) {
    out->ray[k][0] = cos(2.0 * PL_PI * k / RAYS);
    out->ray[k][1] = sin(2.0 * PL_PI * k / RAYS);
  }
  return PL_OK;
}

/* Light that comes evenly from half of all sides: a spiral. */
static pl_vec3 light_from(int n) {
  const double z = (n + 0.5) / DIRECTIONS, turn = 2.399963229728653 * n, r = sqrt(1.0 - z * z);
  return (pl_vec3){r * cos(turn), r * sin(turn), z};
}

static void project(outline *of, pl_vec3 light) {
  const pl_vec3 other = fabs(light.z) < 0.7 ? (pl_vec3){0, 0, 1} : (pl_vec3){1, 0, 0};
  const pl_vec3 x = pl_vec3_unit(pl_vec3_cross(other, light)), y = pl_vec3_cross(light, x);
  for (int k = 0; k < of->sphere->vertex_count; k++) {
    of->flat[k][0] = pl_vec3_dot(of->points[k], x);
    of->flat[k][1] = pl_vec3_dot(of->points[k], y);
    of->angle[k] = atan2(of->flat[k][1], of->flat[k][0]) * RAYS / (2.0 * PL_PI);
  }
}

/* Extends the shadow to an edge on the rays that cross it. */
static void extend(outline *of, uint32_t from, uint32_t to) {
  const double *a = of->flat[from], *b = of->flat[to];
  const double way[2] = {b[0] - a[0], b[1] - a[1]};
  const double begin = of->angle[from];
  double end = of->angle[to];
  if (end - begin > RAYS / 2)
    end -= RAYS;
  else if (begin - end > RAYS / 2)
    end += RAYS;
  const int last = (int)floor(fmax(begin, end));
  for (int k = (int)ceil(fmin(begin, end)); k <= last; k++) {
    const double *ray = of->ray[(k + 2 * RAYS) % RAYS];
    const double across = ray[0] * way[1] - ray[1] * way[0];
    const double part = across != 0.0 ? (ray[1] * a[0] - ray[0] * a[1]) / across : 0.0;
    double *reach = &of->reach[(k + 2 * RAYS) % RAYS];
    *reach = fmax(*reach, ray[0] * (a[0] + part * way[0]) + ray[1] * (a[1] + part * way[1]));
  }
}

static double shadow(outline *of, pl_vec3 light) {
  double area = 0.0;
  project(of, light);
  for (int k = 0; k < RAYS; k++)
    of->reach[k] = 0.0;
  for (int k = 0; k < of->sphere->triangle_count; k++)
    for (int c = 0; c < 3; c++) {
      const uint32_t from = of->sphere->triangles[k][c], to = of->sphere->triangles[k][(c + 1) % 3];
      if (from < to)
        extend(of, from, to);
    }
  for (int k = 0; k < RAYS; k++)
    area += PL_PI / RAYS * of->reach[k] * of->reach[k];
  return area;
}

pl_status pl_rock_shadow_mean(const pl_rock_sphere *sphere, const pl_rock_variant *variant,
                              double *out) {
  outline of;
  PL_TRY(make_room(sphere, &of));
  for (int k = 0; k < sphere->vertex_count; k++) {
    const pl_vec3 d = sphere->vertices[k];
    of.points[k] = pl_vec3_scale(d, pl_rock_variant_radius(variant, d));
  }
  *out = 0.0;
  for (int n = 0; n < DIRECTIONS; n++)
    *out += shadow(&of, light_from(n)) / DIRECTIONS;
  pl_free(of.points);
  return PL_OK;
}

pl_status pl_rock_variant_set_scales(const pl_rock_sphere *spheres, pl_rock_variant *variant) {
  double finest = 1.0, mean = 1.0;
  if (variant->scan != NULL)
    PL_TRY(pl_rock_shadow_mean(&spheres[PL_ROCK_LODS - 1], variant, &finest));
  for (int lod = 0; lod < PL_ROCK_LODS; lod++) {
    if (variant->scan != NULL)
      PL_TRY(pl_rock_shadow_mean(&spheres[lod], variant, &mean));
    else
      mean = family_shadows[variant->number / PL_ROCK_VARIANTS][lod];
    variant->scale[lod] = sqrt(finest / mean);
  }
  return PL_OK;
}
