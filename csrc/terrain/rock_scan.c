#include "terrain/rock_scan.h"

#include <stdatomic.h>

#include "base/memory.h"
#include "math/rotation.h"

enum { SIDE = 128, NODES = SIDE + 1, CELL = 8, CELLS = SIDE / CELL };
/* Surfaces further apart than this part of the distance are two. */
#define FOLD 0.02
/* Barycentric coordinates may be this far outside: rays do not pass between two triangles. */
#define EDGE 1e-9

static double sign_of(double x) { return x < 0.0 ? -1.0 : 1.0; }

/* Unit direction of a point of the octahedral map, in [-1, 1]^2. */
static pl_vec3 direction_of(double u, double v) {
  const double z = 1.0 - fabs(u) - fabs(v);
  if (z >= 0.0)
    return pl_vec3_unit((pl_vec3){u, v, z});
  return pl_vec3_unit((pl_vec3){(1.0 - fabs(v)) * sign_of(u), (1.0 - fabs(u)) * sign_of(v), z});
}

static pl_vec3 node_direction(int i, int j) {
  return direction_of(2.0 * i / SIDE - 1.0, 2.0 * j / SIDE - 1.0);
}

double pl_rock_scan_radius(const pl_rock_scan *scan, pl_vec3 d) {
  const double sum = fabs(d.x) + fabs(d.y) + fabs(d.z);
  double u = d.x / sum, v = d.y / sum;
  if (d.z < 0.0) {
    const double folded = (1.0 - fabs(v)) * sign_of(u);
    v = (1.0 - fabs(u)) * sign_of(v);
    u = folded;
  }
  const double x = 0.5 * SIDE * (u + 1.0), y = 0.5 * SIDE * (v + 1.0);
  const int i = x < SIDE ? (int)x : SIDE - 1, j = y < SIDE ? (int)y : SIDE - 1;
  const double a = x - i, b = y - j;
  const float *low = scan->radii + (size_t)j * NODES + i, *high = low + NODES;
  return (1.0 - b) * ((1.0 - a) * (double)low[0] + a * (double)low[1]) +
         b * ((1.0 - a) * (double)high[0] + a * (double)high[1]);
}

/* ---- centre and axes ------------------------------------------------------------------------ */

/* A mesh about its centre, along its principal axes. */
typedef struct placed {
  const pl_rock_model *model;
  pl_vec3 center;
  pl_mat3 axes;
} placed;

static pl_vec3 position(const pl_rock_model *model, uint32_t k) {
  return (pl_vec3){model->positions[k][0], model->positions[k][1], model->positions[k][2]};
}

static pl_vec3 corner(const placed *mesh, size_t triangle, int k) {
  const pl_vec3 p = position(mesh->model, mesh->model->triangles[triangle][k]);
  return pl_mat3_mul_vec(mesh->axes, pl_vec3_sub(p, mesh->center));
}

static pl_status check(const pl_rock_model *model) {
  for (size_t k = 0; k < model->vertex_count; k++)
    for (int c = 0; c < 3; c++)
      if (!isfinite(model->positions[k][c]))
        return pl_fail(PL_E_RANGE, "vertex %zu of %zu is not finite", k, model->vertex_count);
  for (size_t k = 0; k < model->triangle_count; k++)
    for (int c = 0; c < 3; c++)
      if (model->triangles[k][c] >= model->vertex_count)
        return pl_fail(PL_E_RANGE, "triangle %zu has vertex %u of %zu", k, model->triangles[k][c],
                       model->vertex_count);
  return PL_OK;
}

/* One of Jacobi's rotations: makes the element (p, q) of the symmetric matrix zero; rows of `axes`
 * turn with it. */
static void rotate(double m[3][3], double axes[3][3], int p, int q) {
  if (m[p][q] == 0.0)
    return;
  const double theta = 0.5 * (m[q][q] - m[p][p]) / m[p][q];
  const double t = sign_of(theta) / (fabs(theta) + sqrt(theta * theta + 1.0));
  const double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
  for (int k = 0; k < 3; k++) {
    const double x = m[k][p], y = m[k][q];
    m[k][p] = c * x - s * y;
    m[k][q] = s * x + c * y;
  }
  for (int k = 0; k < 3; k++) {
    const double x = m[p][k], y = m[q][k], a = axes[p][k], b = axes[q][k];
    m[p][k] = c * x - s * y;
    m[q][k] = s * x + c * y;
    axes[p][k] = c * a - s * b;
    axes[q][k] = s * a + c * b;
  }
}

/* Rows: principal axes of a covariance, the longest first, right-handed. */
static pl_mat3 axes_of(double m[3][3]) {
  enum { SWEEPS = 12 };
  double axes[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  for (int sweep = 0; sweep < SWEEPS; sweep++)
    for (int p = 0; p < 2; p++)
      for (int q = p + 1; q < 3; q++)
        rotate(m, axes, p, q);
  int first = 0, last = 0;
  for (int k = 1; k < 3; k++) {
    first = m[k][k] > m[first][first] ? k : first;
    last = m[k][k] <= m[last][last] ? k : last;
  }
  if (first == last) /* all alike */
    return (pl_mat3){{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
  const pl_vec3 x = {axes[first][0], axes[first][1], axes[first][2]};
  const pl_vec3 z = {axes[last][0], axes[last][1], axes[last][2]};
  return (pl_mat3){{x, pl_vec3_cross(z, x), z}};
}

/* Sums over a uniform surface: its area, the first and the second moments. */
static pl_status place(const pl_rock_model *model, placed *out) {
  double area = 0.0, second[3][3] = {{0.0}};
  pl_vec3 first = {0.0, 0.0, 0.0};
  const pl_vec3 origin = model->vertex_count > 0 ? position(model, 0) : first;
  *out = (placed){.model = model,
                  .center = origin,
                  .axes = {{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}}};
  for (size_t t = 0; t < model->triangle_count; t++) {
    const pl_vec3 a = corner(out, t, 0), b = corner(out, t, 1), c = corner(out, t, 2);
    const double part = 0.5 * pl_vec3_norm(pl_vec3_cross(pl_vec3_sub(b, a), pl_vec3_sub(c, a)));
    const pl_vec3 sum = pl_vec3_add(a, pl_vec3_add(b, c));
    const double all[4][3] = {
        {a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}, {sum.x, sum.y, sum.z}};
    area += part;
    first = pl_vec3_madd(first, part / 3.0, sum);
    for (int k = 0; k < 4; k++)
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
          second[i][j] += part / 12.0 * all[k][i] * all[k][j];
  }
  if (!(area > 0.0 && isfinite(area)))
    return pl_fail(PL_E_RANGE, "%zu triangles have an area of %g", model->triangle_count, area);
  const pl_vec3 mean = pl_vec3_scale(first, 1.0 / area);
  const double center[3] = {mean.x, mean.y, mean.z};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      second[i][j] = second[i][j] / area - center[i] * center[j];
  out->center = pl_vec3_add(origin, mean);
  out->axes = axes_of(second);
  return PL_OK;
}

/* ---- distances ------------------------------------------------------------------------------ */

typedef struct tables {
  double most[NODES * NODES], least[NODES * NODES]; /* 0: not met yet */
  pl_vec3 directions[NODES * NODES];
  pl_vec3 middles[CELLS * CELLS]; /* of cells of nodes */
  double cosines[CELLS * CELLS];  /* of the greatest angle of a node of the cell from it */
} tables;

static void lay_out(tables *all) {
  for (int j = 0; j < NODES; j++)
    for (int i = 0; i < NODES; i++)
      all->directions[j * NODES + i] = node_direction(i, j);
  for (int y = 0; y < CELLS; y++)
    for (int x = 0; x < CELLS; x++) {
      const int cell = y * CELLS + x;
      all->middles[cell] = node_direction(CELL * x + CELL / 2, CELL * y + CELL / 2);
      all->cosines[cell] = 1.0;
      for (int j = CELL * y; j <= CELL * (y + 1); j++)
        for (int i = CELL * x; i <= CELL * (x + 1); i++)
          all->cosines[cell] = fmin(
              all->cosines[cell], pl_vec3_dot(all->middles[cell], all->directions[j * NODES + i]));
    }
}

/* A triangle: its corners, and a cone about the centre that holds it. */
typedef struct facet {
  pl_vec3 a, ab, ac, normal;
  pl_vec3 axis;
  double cosine; /* of the cone's half angle; -1: all directions */
} facet;

static facet facet_of(const placed *mesh, size_t triangle) {
  const pl_vec3 a = corner(mesh, triangle, 0), b = corner(mesh, triangle, 1);
  const pl_vec3 c = corner(mesh, triangle, 2), middle = pl_vec3_add(a, pl_vec3_add(b, c));
  facet of = {.a = a, .ab = pl_vec3_sub(b, a), .ac = pl_vec3_sub(c, a), .cosine = -1.0};
  of.normal = pl_vec3_cross(of.ab, of.ac);
  const double least = fmin(pl_vec3_norm(a), fmin(pl_vec3_norm(b), pl_vec3_norm(c)));
  if (!(least > 0.0 && pl_vec3_norm(middle) > 0.0))
    return of;
  of.axis = pl_vec3_unit(middle);
  const double cosine =
      fmin(pl_vec3_dot(of.axis, pl_vec3_unit(a)),
           fmin(pl_vec3_dot(of.axis, pl_vec3_unit(b)), pl_vec3_dot(of.axis, pl_vec3_unit(c))));
  if (cosine > 0.1) /* a cone is convex as long as it is less than half of space */
    of.cosine = cosine;
  return of;
}

/* Whether a cone about the facet's axis and one about a cell's middle may meet. */
static bool meets(const facet *of, pl_vec3 middle, double cosine) {
  const double sines =
      sqrt(fmax(1.0 - of->cosine * of->cosine, 0.0) * fmax(1.0 - cosine * cosine, 0.0));
  return of->cosine == -1.0 || pl_vec3_dot(of->axis, middle) >= of->cosine * cosine - sines - 1e-9;
}

/* Distance along a direction at which a triangle is met; 0 if it is not (Moeller and Trumbore). */
static double met_at(const facet *of, pl_vec3 d) {
  const double along = pl_vec3_dot(of->normal, d);
  const double t = pl_vec3_dot(of->normal, of->a) / along;
  if (!(t > 0.0 && isfinite(t)))
    return 0.0;
  const pl_vec3 q = pl_vec3_cross(of->a, d);
  const double u = pl_vec3_dot(q, of->ac) / along, v = -pl_vec3_dot(q, of->ab) / along;
  return u >= -EDGE && v >= -EDGE && u + v <= 1.0 + EDGE ? t : 0.0;
}

static void add_cell(tables *all, const facet *of, int cell) {
  const int y = CELL * (cell / CELLS), x = CELL * (cell % CELLS);
  for (int j = y; j <= y + CELL; j++)
    for (int i = x; i <= x + CELL; i++) {
      const int node = j * NODES + i;
      const double t = met_at(of, all->directions[node]);
      if (!(t > 0.0))
        continue;
      all->most[node] = fmax(all->most[node], t);
      all->least[node] = all->least[node] > 0.0 ? fmin(all->least[node], t) : t;
    }
}

static void add_facet(tables *all, const facet *of) {
  for (int cell = 0; cell < CELLS * CELLS; cell++)
    if (meets(of, all->middles[cell], all->cosines[cell]))
      add_cell(all, of, cell);
}

static pl_status take(const tables *all, pl_rock_scan *out) {
  size_t open = 0, folded = 0;
  double most = 0.0;
  for (size_t k = 0; k < NODES * NODES; k++) {
    open += all->most[k] > 0.0 ? 0 : 1;
    folded += all->most[k] - all->least[k] > FOLD * all->most[k] ? 1 : 0;
    most = fmax(most, all->most[k]);
  }
  if (open > 0)
    return pl_fail(PL_E_RANGE,
                   "the surface does not surround its centre: rays in %.3g %% of the directions "
                   "from there do not meet it",
                   100.0 * (double)open / (NODES * NODES));
  for (size_t k = 0; k < NODES * NODES; k++)
    out->radii[k] = (float)(all->most[k] / most);
  out->folded = (double)folded / (NODES * NODES);
  return PL_OK;
}

static pl_status measure(const placed *mesh, pl_rock_scan *out) {
  void *memory;
  PL_TRY(pl_alloc_or_fail(NODES * NODES, sizeof(float), "the shape of a rock", &memory));
  out->radii = memory;
  PL_TRY(pl_alloc_or_fail(1, sizeof(tables), "the shape of a rock", &memory));
  tables *all = memory;
  lay_out(all);
  for (size_t t = 0; t < mesh->model->triangle_count; t++) {
    const facet of = facet_of(mesh, t);
    add_facet(all, &of);
  }
  const pl_status status = take(all, out);
  pl_free(all);
  return status;
}

pl_status pl_rock_scan_create(const pl_rock_model *model, pl_rock_scan *out) {
  static atomic_ullong last;
  *out = (pl_rock_scan){.serial = atomic_fetch_add(&last, 1) + 1};
  placed mesh;
  PL_TRY(check(model));
  PL_TRY(place(model, &mesh));
  const pl_status status = measure(&mesh, out);
  if (status != PL_OK)
    pl_rock_scan_clear(out);
  return status;
}

void pl_rock_scan_clear(pl_rock_scan *scan) {
  pl_free(scan->radii);
  *scan = (pl_rock_scan){0};
}
