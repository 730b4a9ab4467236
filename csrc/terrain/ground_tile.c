/* Makes tiles: heights of lattice nodes, stitched to coarser neighbours, as posts and slopes. */
#include "terrain/ground_tile.h"

#include "terrain/cube.h"

enum {
  SIDE = PL_GROUND_TILE_SIDE,
  POSTS = PL_GROUND_TILE_POSTS,
  CELLS = PL_GROUND_TILE_CELLS,
  COARSE = CELLS / 2 + 3
};

/* The skirt extends this fraction of a cell along the surface, and as far below it. */
#define SKIRT (1.0 / 16.0)
/* Slopes are clamped to this. */
#define STEEPEST 16.0

/* Nodes of a lattice with their points; the outermost ring serves differences alone. */
typedef struct nodes {
  int width, height;
  double *heights, *radii; /* over the datum; from the centre, m */
  pl_vec3 *directions;
} nodes;

/* What a tile is made from. */
typedef struct work {
  const pl_terrain *terrain;
  pl_ground_tile *tile;
  double step_m;              /* posts are multiples of it */
  nodes fine;                 /* SIDE x SIDE */
  pl_vec3 posts[SIDE * SIDE]; /* body axes; with the skirt */
  double slopes[POSTS * POSTS][2];
  double heights[SIDE * SIDE];
  double radii[SIDE * SIDE];
  pl_vec3 directions[SIDE * SIDE];
} work;

void pl_ground_tile_axes(int face, pl_vec3 direction, pl_vec3 *east, pl_vec3 *north) {
  const pl_vec3 pole = face < 4 ? (pl_vec3){0.0, 0.0, 1.0} : (pl_vec3){1.0, 0.0, 0.0};
  *east = pl_vec3_unit(pl_vec3_cross(pole, direction));
  *north = pl_vec3_cross(direction, *east);
}

/* Fills nodes from lattice node (i0, j0) on. */
static pl_status fill(const pl_terrain *terrain, int face, int level, int64_t i0, int64_t j0,
                      const nodes *out) {
  const pl_terrain_nodes block = {
      .face = face, .level = level, .i0 = i0, .j0 = j0, .width = out->width, .height = out->height};
  PL_TRY(pl_terrain_block(terrain, &block, out->heights, out->directions));
  for (int k = 0; k < out->width * out->height; k++) {
    const pl_vec3 d = out->directions[k];
    out->radii[k] = pl_terrain_datum_m(terrain, d) + out->heights[k];
  }
  return PL_OK;
}

/* Slopes of the surface at an inner node: the gradient of the distance from the centre, from its
 * differences between the four nodes around, over this distance. On a sphere they are exactly 0. */
static void slope_at(const nodes *of, int face, int i, int j, double out[2]) {
  const int k = j * of->width + i;
  const pl_vec3 s = pl_vec3_sub(of->directions[k + 1], of->directions[k - 1]);
  const pl_vec3 t = pl_vec3_sub(of->directions[k + of->width], of->directions[k - of->width]);
  const double rise_s = (of->radii[k + 1] - of->radii[k - 1]) / of->radii[k];
  const double rise_t = (of->radii[k + of->width] - of->radii[k - of->width]) / of->radii[k];
  pl_vec3 east, north;
  pl_ground_tile_axes(face, of->directions[k], &east, &north);
  const double se = pl_vec3_dot(s, east), sn = pl_vec3_dot(s, north);
  const double te = pl_vec3_dot(t, east), tn = pl_vec3_dot(t, north);
  const double area = se * tn - sn * te;
  const double slope[2] = {(rise_s * tn - rise_t * sn) / area, (rise_t * se - rise_s * te) / area};
  for (int a = 0; a < 2; a++)
    out[a] = fmin(fmax(slope[a], -STEEPEST), STEEPEST);
}

static pl_vec3 point_of(const nodes *of, int k) {
  return pl_vec3_scale(of->directions[k], of->radii[k]);
}

static double snap(double x, double step) { return nearbyint(x / step) * step; }
static pl_vec3 snap3(pl_vec3 p, double step) {
  return (pl_vec3){snap(p.x, step), snap(p.y, step), snap(p.z, step)};
}

/* The end of the skirt at an edge post: on the way to the next post outwards, and lower. */
static pl_vec3 skirt_of(pl_vec3 edge, pl_vec3 next, double fraction, double drop_m) {
  const pl_vec3 out = pl_vec3_madd(edge, fraction, pl_vec3_sub(next, edge));
  return pl_vec3_madd(out, -drop_m, pl_vec3_unit(edge));
}

/* Posts, slopes and skirt of the lattice's own level. */
static void set_fine(work *work) {
  const nodes *fine = &work->fine;
  const int face = work->tile->id.face;
  for (int j = 1; j <= POSTS; j++)
    for (int i = 1; i <= POSTS; i++) {
      work->posts[j * SIDE + i] = snap3(point_of(fine, j * SIDE + i), work->step_m);
      slope_at(fine, face, i, j, work->slopes[(j - 1) * POSTS + i - 1]);
    }
  for (int j = 0; j < SIDE; j++)
    for (int i = 0; i < SIDE; i += j == 0 || j == SIDE - 1 ? 1 : SIDE - 1) {
      const int inner_i = i < 1 ? 1 : i > POSTS ? POSTS : i;
      const int inner_j = j < 1 ? 1 : j > POSTS ? POSTS : j;
      work->posts[j * SIDE + i] =
          skirt_of(work->posts[inner_j * SIDE + inner_i], point_of(fine, j * SIDE + i), SKIRT,
                   SKIRT * work->tile->cell_m);
    }
}

/* A line of posts that coarser nodes determine: of an edge with both its corners, or one corner. */
typedef struct seam {
  int i, j;   /* first post, in the array with the skirt */
  int di, dj; /* step along it */
  int oi, oj; /* step outwards */
  int nodes;  /* coarse nodes on it */
} seam;

static void bound_height(pl_ground_tile *tile, double height) {
  tile->low_m = (float)fmin((double)tile->low_m, height);
  tile->high_m = (float)fmax((double)tile->high_m, height);
}

/* Sets the posts that are coarse nodes themselves, and their slopes and skirt. */
static void set_coarse_nodes(work *work, const seam *seam, const nodes *coarse) {
  const pl_ground_tile *tile = work->tile;
  for (int n = 0; n < seam->nodes; n++) {
    const int ci = 1 + n * seam->di, cj = 1 + n * seam->dj;
    const int i = seam->i + 2 * n * seam->di, j = seam->j + 2 * n * seam->dj;
    const int from = cj * coarse->width + ci;
    const int next = (cj + seam->oj) * coarse->width + ci + seam->oi;
    pl_vec3 *post = &work->posts[j * SIDE + i];
    *post = snap3(point_of(coarse, from), 2.0 * work->step_m);
    slope_at(coarse, tile->id.face, ci, cj, work->slopes[(j - 1) * POSTS + i - 1]);
    work->posts[(j + seam->oj) * SIDE + i + seam->oi] =
        skirt_of(*post, point_of(coarse, next), 0.5 * SKIRT, SKIRT * tile->cell_m);
    bound_height(work->tile, coarse->heights[from]);
  }
}

/* Sets the posts between coarse nodes to the middles of the coarse edges. */
static void set_middles(work *work, const seam *seam) {
  for (int n = 1; n < 2 * seam->nodes - 1; n += 2) {
    const int i = seam->i + n * seam->di, j = seam->j + n * seam->dj;
    for (int out = 0; out < 2; out++) {
      pl_vec3 *p = &work->posts[(j + out * seam->oj) * SIDE + i + out * seam->oi];
      const int by = seam->dj * SIDE + seam->di;
      *p = pl_vec3_scale(pl_vec3_add(p[-by], p[by]), 0.5);
    }
    double(*s)[2] = &work->slopes[(j - 1) * POSTS + i - 1];
    const int by = seam->dj * POSTS + seam->di;
    for (int a = 0; a < 2; a++)
      s[0][a] = 0.5 * (s[-by][a] + s[by][a]);
  }
}

static pl_status set_seam(work *work, const seam *seam) {
  enum { MOST = 3 * COARSE };
  double heights[MOST], radii[MOST];
  pl_vec3 directions[MOST];
  const pl_ground_tile_id id = work->tile->id;
  const nodes coarse = {.width = seam->di * (seam->nodes - 1) + 3,
                        .height = seam->dj * (seam->nodes - 1) + 3,
                        .heights = heights,
                        .radii = radii,
                        .directions = directions};
  PL_TRY(fill(work->terrain, id.face, pl_ground_tile_lattice(id) - 1,
              (int64_t)id.i * (CELLS / 2) + (seam->i - 1) / 2 - 1,
              (int64_t)id.j * (CELLS / 2) + (seam->j - 1) / 2 - 1, &coarse));
  set_coarse_nodes(work, seam, &coarse);
  set_middles(work, seam);
  return PL_OK;
}

/* Where posts belong to a coarser neighbour. Corners come first: their skirts lead diagonally. */
static pl_status set_seams(work *work) {
  enum { LAST = POSTS, EDGE = CELLS / 2 + 1 };
  static const seam seams[8] = {
      {1, 1, 0, 1, -1, 0, EDGE},   {LAST, 1, 0, 1, 1, 0, EDGE}, {1, 1, 1, 0, 0, -1, EDGE},
      {1, LAST, 1, 0, 0, 1, EDGE}, {1, 1, 1, 0, -1, -1, 1},     {LAST, 1, 1, 0, 1, -1, 1},
      {1, LAST, 1, 0, -1, 1, 1},   {LAST, LAST, 1, 0, 1, 1, 1},
  };
  for (int k = 7; k >= 0; k--)
    if (work->tile->id.coarse >> k & 1)
      PL_TRY(set_seam(work, &seams[k]));
  return PL_OK;
}

/* The margin is for rounding to floats. */
static void set_distance(const work *work) {
  double most_m = 0.0;
  for (int k = 0; k < SIDE * SIDE; k++)
    most_m = fmax(most_m, pl_vec3_norm(work->posts[k]));
  work->tile->most_m = most_m * (1.0 + 1e-7);
}

static void set_positions(const work *work) {
  pl_ground_tile *tile = work->tile;
  pl_vec3 low = work->posts[0], high = low;
  for (int k = 1; k < SIDE * SIDE; k++) {
    const pl_vec3 p = work->posts[k];
    low = (pl_vec3){fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z)};
    high = (pl_vec3){fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z)};
  }
  const double grain = ldexp(1.0, ilogb(tile->cell_m));
  tile->origin = snap3(pl_vec3_scale(pl_vec3_add(low, high), 0.5), grain);
  double radius_m = 0.0;
  for (int k = 0; k < SIDE * SIDE; k++) {
    const pl_vec3f p = pl_vec3_to_float(pl_vec3_sub(work->posts[k], tile->origin));
    tile->positions[k][0] = p.x;
    tile->positions[k][1] = p.y;
    tile->positions[k][2] = p.z;
    radius_m = fmax(radius_m, pl_vec3_norm(pl_vec3f_to_double(p)));
  }
  tile->radius_m = radius_m * (1.0 + 1e-6);
}

static void set_slopes(const work *work) {
  enum { COUNT = POSTS * POSTS };
  pl_ground_tile *tile = work->tile;
  double most = 0.0;
  for (int k = 0; k < COUNT; k++)
    most = fmax(most, fmax(fabs(work->slopes[k][0]), fabs(work->slopes[k][1])));
  tile->slope_unit = (float)(most / INT16_MAX);
  const double per_slope = most > 0.0 ? INT16_MAX / most : 0.0;
  for (int k = 0; k < COUNT; k++)
    for (int a = 0; a < 2; a++)
      tile->slopes[k][a] = (int16_t)nearbyint(work->slopes[k][a] * per_slope);
}

pl_status pl_ground_tile_make(const pl_terrain *terrain, pl_ground_tile_id id,
                              pl_ground_tile *out) {
  work work;
  const double cell_m = pl_cube_cell_m(pl_ground_tile_lattice(id), pl_terrain_radius_m(terrain));
  out->id = id;
  out->cell_m = cell_m;
  out->rocks = NULL;
  out->rays = NULL;
  work.terrain = terrain;
  work.tile = out;
  work.step_m = ldexp(1.0, ilogb(cell_m) - 17);
  work.fine = (nodes){SIDE, SIDE, work.heights, work.radii, work.directions};
  PL_TRY(fill(terrain, id.face, pl_ground_tile_lattice(id), (int64_t)id.i * CELLS - 1,
              (int64_t)id.j * CELLS - 1, &work.fine));
  out->low_m = out->high_m = (float)work.heights[SIDE + 1];
  for (int j = 1; j <= POSTS; j++)
    for (int i = 1; i <= POSTS; i++)
      bound_height(out, work.heights[j * SIDE + i]);
  set_fine(&work);
  PL_TRY(set_seams(&work));
  set_distance(&work);
  set_positions(&work);
  set_slopes(&work);
  return PL_OK;
}
