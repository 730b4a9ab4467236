/* What a terrain keeps, and the work space of its heights. */
#ifndef PL_TERRAIN_TERRAIN_PARTS_H
#define PL_TERRAIN_TERRAIN_PARTS_H

#include "terrain/apron.h"
#include "terrain/diamond_square.h"
#include "terrain/fractal_detail.h"
#include "terrain/terrain.h"

/* Detail is drawn from the level whose cells are at most this many posts wide: wider waves are the
 * raster's own, and U(q) takes them away but for a fraction of 1/256 or less. */
#define PL_TERRAIN_OVERLAP 4.0

typedef struct pl_layer {
  pl_terrain_layer given;
  double spacing_m;
  int coarsest;    /* level of detail */
  bool refined;    /* by diamond-square, not by the sum of octaves */
  pl_apron *apron; /* owned, or NULL */
  pl_diamond_square diamond;
} pl_layer;

/* Variances of slopes along any one axis, by level of the lattice; of the laws, thus means. */
typedef struct pl_slope_table {
  double octave[PL_CUBE_LEVELS];     /* of the octave of detail of this level */
  double beyond[PL_CUBE_LEVELS + 1]; /* of all octaves from this level on */
  double craters[PL_CUBE_LEVELS];    /* of what cells of this level leave out of craters */
  double stones[PL_CUBE_LEVELS]; /* fraction of the ground under rocks that such cells leave out */
  double stone_relief[PL_CUBE_LEVELS]; /* of their surface */
  double stone_height;                 /* of these over the ground, over their width */
  double textures[PL_CUBE_LEVELS];     /* of what cells of this level leave out of textures */
  double shared;                       /* below roughness_baseline_m, of detail and craters */
} pl_slope_table;

/* A crater of a catalogue, with its place there, from 1 on. */
typedef struct pl_numbered_crater {
  pl_known_crater crater;
  int64_t number;
} pl_numbered_crater;

struct pl_terrain {
  uint64_t number;
  pl_vec3 radii_m;
  double radius_m;
  pl_fractal_detail detail;
  const pl_crater_field *craters;
  const struct pl_rock_field *rocks; /* borrowed, or NULL */
  pl_raster_stack albedo, roughness, mask;
  pl_terrain_patch patch;
  size_t layer_count;
  pl_layer *layers;            /* owned */
  pl_diamond_weights *diamond; /* owned; NULL where none is refined */
  pl_slope_table slopes;
  pl_numbered_crater *known; /* owned; by ascending z of the directions */
  size_t known_count;
  double known_most_m;     /* greatest diameter */
  pl_wheel_tracks *tracks; /* owned; NULL for none */
  pl_ground_texture textures[PL_GROUND_TEXTURES];
  size_t texture_count;
};

/* Makes the aprons of layers; those below them have theirs. */
pl_status pl_terrain_add_aprons(pl_terrain *terrain, const double *aprons_m);
/* What the rasters show of craters. */
pl_crater_model pl_terrain_crater_model(const pl_terrain *terrain);
/* Copies and checks textures. */
pl_status pl_terrain_take_textures(pl_terrain *terrain, const pl_terrain_frame *frame);
/* Adds the heights of textures, as means over cells. */
void pl_terrain_add_textures(const pl_terrain *terrain, const pl_vec3 *directions, size_t count,
                             double cell_m, double *heights_m);
/* Sets terrain->slopes from the laws of detail and craters. */
void pl_slope_table_init(pl_terrain *terrain, double roughness_baseline_m);

/* Detail at posts of rasters: a hash table of those that the nodes at hand need. */
enum { PL_POSTS = 4096, PL_STENCIL = 16 };

typedef struct pl_posts {
  int level, count;
  pl_detail_cache cache;
  /* Posts that are in the table, but have no value yet, all of one layer. */
  pl_detail_strip strip;
  int pending[PL_DETAIL_STRIP];
  int16_t layer[PL_POSTS]; /* -1: no post */
  int column[PL_POSTS], row[PL_POSTS];
  double q_m[PL_POSTS];
} pl_posts;

void pl_posts_init(pl_posts *posts, int level);
/* Writes the interpolation of the detail, from the posts of the layer, for nodes at the columns and
 * rows u, v: only where `wanted`. */
void pl_posts_interpolate(pl_posts *posts, const pl_terrain *terrain, int layer, size_t count,
                          const double *u, const double *v, const bool *wanted, double *out_m);

#endif
