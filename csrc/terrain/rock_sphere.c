/* Subdivided icosahedra. */
#include "base/memory.h"
#include "terrain/rock_shape.h"

#define GOLDEN 1.61803398874989485
enum { FIRST_VERTICES = 12, FIRST_TRIANGLES = 20 };

static const double corners[FIRST_VERTICES][3] = {
    {-1, GOLDEN, 0}, {1, GOLDEN, 0}, {-1, -GOLDEN, 0}, {1, -GOLDEN, 0},
    {0, -1, GOLDEN}, {0, 1, GOLDEN}, {0, -1, -GOLDEN}, {0, 1, -GOLDEN},
    {GOLDEN, 0, -1}, {GOLDEN, 0, 1}, {-GOLDEN, 0, -1}, {-GOLDEN, 0, 1}};
static const uint32_t faces[FIRST_TRIANGLES][3] = {
    {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};

/* Edges of a sphere that have their middle: for a vertex, up to six others and the middles. */
typedef struct edges {
  int count;
  uint32_t to[6], middle[6];
} edges;

static uint32_t middle_of(pl_rock_sphere *sphere, edges *known, uint32_t a, uint32_t b) {
  const uint32_t low = a < b ? a : b, high = a < b ? b : a;
  edges *at = &known[low];
  for (int k = 0; k < at->count; k++)
    if (at->to[k] == high)
      return at->middle[k];
  const uint32_t middle = (uint32_t)sphere->vertex_count++;
  sphere->vertices[middle] =
      pl_vec3_unit(pl_vec3_add(sphere->vertices[low], sphere->vertices[high]));
  at->to[at->count] = high;
  at->middle[at->count++] = middle;
  return middle;
}

static void subdivide(const pl_rock_sphere *from, pl_rock_sphere *to, edges *known) {
  to->vertex_count = from->vertex_count;
  to->triangle_count = 0;
  for (int k = 0; k < from->vertex_count; k++) {
    to->vertices[k] = from->vertices[k];
    known[k].count = 0;
  }
  for (int k = 0; k < from->triangle_count; k++) {
    const uint32_t *t = from->triangles[k];
    const uint32_t m[3] = {middle_of(to, known, t[0], t[1]), middle_of(to, known, t[1], t[2]),
                           middle_of(to, known, t[2], t[0])};
    const uint32_t parts[4][3] = {
        {t[0], m[0], m[2]}, {t[1], m[1], m[0]}, {t[2], m[2], m[1]}, {m[0], m[1], m[2]}};
    for (int p = 0; p < 4; p++, to->triangle_count++)
      for (int c = 0; c < 3; c++)
        to->triangles[to->triangle_count][c] = parts[p][c];
  }
}

static void make(pl_rock_sphere *spheres, edges *known) {
  spheres[0].vertex_count = FIRST_VERTICES;
  spheres[0].triangle_count = FIRST_TRIANGLES;
  for (int k = 0; k < FIRST_VERTICES; k++)
    spheres[0].vertices[k] = pl_vec3_unit((pl_vec3){corners[k][0], corners[k][1], corners[k][2]});
  for (int k = 0; k < FIRST_TRIANGLES; k++)
    for (int c = 0; c < 3; c++)
      spheres[0].triangles[k][c] = faces[k][c];
  for (int lod = 1; lod < PL_ROCK_LODS; lod++)
    subdivide(&spheres[lod - 1], &spheres[lod], known);
}

pl_status pl_rock_spheres_create(pl_rock_sphere **out) {
  size_t vertices = 0, triangles = 0;
  *out = NULL;
  for (int lod = 0; lod < PL_ROCK_LODS; lod++) {
    vertices += ((size_t)10 << (2 * lod)) + 2;
    triangles += (size_t)FIRST_TRIANGLES << (2 * lod);
  }
  const size_t heads = PL_ROCK_LODS * sizeof(pl_rock_sphere);
  const size_t points = vertices * sizeof(pl_vec3), indices = triangles * 3 * sizeof(uint32_t);
  void *block, *known;
  PL_TRY(pl_alloc_or_fail(1, heads + points + indices, "shapes of rocks", &block));
  const pl_status status = pl_alloc_or_fail(vertices, sizeof(edges), "shapes of rocks", &known);
  if (status != PL_OK) {
    pl_free(block);
    return status;
  }
  pl_rock_sphere *spheres = block;
  pl_vec3 *vertex = (pl_vec3 *)(void *)((char *)block + heads);
  uint32_t(*triangle)[3] = (uint32_t(*)[3])(void *)((char *)block + heads + points);
  for (int lod = 0; lod < PL_ROCK_LODS; lod++) {
    spheres[lod].vertices = vertex;
    spheres[lod].triangles = triangle;
    vertex += ((size_t)10 << (2 * lod)) + 2;
    triangle += (size_t)FIRST_TRIANGLES << (2 * lod);
  }
  make(spheres, known);
  pl_free(known);
  *out = spheres;
  return PL_OK;
}

void pl_rock_spheres_destroy(pl_rock_sphere *spheres) { pl_free(spheres); }

int pl_rock_lod(double diameter_m, double cell_m) {
  const int octave = ilogb(diameter_m / cell_m);
  return octave < 1 ? 1 : octave > PL_ROCK_LODS - 1 ? PL_ROCK_LODS - 1 : octave;
}
