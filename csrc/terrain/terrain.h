/* Heights of a body's ground: rasters, from coarse to fine, and fractal detail below their posts.
 *
 * A height is over the ellipsoid of the body's radii, along the direction from its centre: on an
 * ellipsoid that is not a sphere not quite along its normal. It is a function of the direction and
 * of a level of the cube's lattice (`terrain/cube.h`), which says how much is drawn: the same bits
 * alone, in any block, on any thread.
 *
 *     h(d) = layers blended of U(Z)(d) + q(d) - U(q)(d),
 *            + textures(d) + tracks(d) + craters(d) + fillets(d)
 *
 * U interpolates a raster's posts Z, or means of them where cells of the lattice are wider. q is
 * the detail (`terrain/fractal_detail.h`) of wavelengths below a few posts; without U(q), its own
 * interpolation from the same posts, only what the posts cannot hold is added, and posts keep their
 * heights to the bit. With PL_DETAIL_DIAMOND_SQUARE rasters are refined on their own lattices
 * instead (`terrain/diamond_square.h`). Where no raster reaches, h is q alone, from the longest
 * wavelength. Craters (`terrain/crater_field.h`) are added to all of it, wider than 2 to 4 cells,
 * but for those that a raster shows; smaller ones do move posts. */
#ifndef PL_TERRAIN_TERRAIN_H
#define PL_TERRAIN_TERRAIN_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "math/vec.h"
#include "terrain/crater_blocks.h"
#include "terrain/crater_field.h"
#include "terrain/detail_law.h"
#include "terrain/ground_texture.h"
#include "terrain/raster.h"
#include "terrain/raster_stack.h"
#include "terrain/wheel_tracks.h"

#define PL_TERRAIN_LAYERS 1024
/* Greatest values of rasters of albedo and of roughness (rad; a little above 60 degrees). */
#define PL_TERRAIN_ALBEDO_MOST 10.0
#define PL_TERRAIN_ROUGHNESS_MOST 1.0473

typedef struct pl_terrain_layer {
  const pl_raster *raster; /* borrowed */
  pl_raster_interpolation interpolation;
  double border_posts; /* width of its blending into the layers below */
  double datum_m; /* radius of the sphere that its heights are over; 0: over the body's ellipsoid */
} pl_terrain_layer;

/* A crater of a catalogue: labelled, but not drawn. */
typedef struct pl_known_crater {
  pl_vec3 direction; /* of its centre; unit, body axes */
  double diameter_m;
} pl_known_crater;

/* A square on the ground; a side of 0: none. Meshes are fine only in it. */
typedef struct pl_terrain_patch {
  pl_vec3 center; /* unit, body axes */
  double side_m;
} pl_terrain_patch;

typedef struct pl_terrain_frame {
  pl_vec3 radii_m;                /* of the body's ellipsoid */
  const pl_terrain_layer *layers; /* copied; each lies over those before it */
  size_t layer_count;             /* at most PL_TERRAIN_LAYERS */
  /* Width of the ground around each layer that is raised or lowered to meet its edges
   * (terrain/apron.h), 0: none; NULL: none of any. Not for a raster that goes around the body. */
  const double *aprons_m;
  pl_terrain_detail detail;
  const pl_crater_field *craters;    /* borrowed; NULL: none */
  const struct pl_rock_field *rocks; /* borrowed; NULL: none */
  /* Roughness that a law of reflectance states is that of slopes below this baseline; 0: of slopes
   * finer than all detail. */
  double roughness_baseline_m;
  /* Of the surface, with borrowed rasters; NULL: none. Albedo as in the body's colour map; Hapke's
   * roughness, rad. */
  const pl_raster_stack *albedo, *roughness;
  const pl_raster_stack *mask; /* of whole numbers; NULL: none */
  pl_terrain_patch patch;
  const pl_known_crater *known; /* copied */
  size_t known_count;
  const pl_wheel_track *tracks; /* copied */
  size_t track_count;
  const pl_ground_texture *textures; /* copied, with borrowed rasters; at most PL_GROUND_TEXTURES */
  size_t texture_count;
} pl_terrain_frame;

typedef struct pl_terrain pl_terrain;

/* PL_E_RANGE with a text that names what is wrong. Rasters, craters and rocks must outlive the
 * terrain. */
pl_status pl_terrain_create(const pl_terrain_frame *frame, pl_terrain **out);
void pl_terrain_destroy(pl_terrain *terrain);

/* Returns a number that no other terrain of the process has or will have: a key for what is kept.
 */
uint64_t pl_terrain_number(const pl_terrain *terrain);
/* Geometric mean of the radii, of which the lattice's cells are a fraction. */
double pl_terrain_radius_m(const pl_terrain *terrain);
/* The rocks on the ground; NULL for none. They are no part of its heights, but for the soil at
 * their feet (terrain/rock_fillets.h). */
const struct pl_rock_field *pl_terrain_rocks(const pl_terrain *terrain);
/* Tracks of wheels, which its heights have; NULL without any. */
const pl_wheel_tracks *pl_terrain_tracks(const pl_terrain *terrain);
/* Whether textures have roughness or albedo. */
bool pl_terrain_has_textures(const pl_terrain *terrain);
/* Whether textures of heights have slopes over a footprint. */
bool pl_terrain_has_texture_slopes(const pl_terrain *terrain, double footprint_m);
/* Returns the product of the factors of textures in a unit direction, over a footprint. */
double pl_terrain_texture(const pl_terrain *terrain, pl_ground_texture_kind kind, pl_vec3 direction,
                          double footprint_m);
/* Returns a bound of the factors of textures on the albedo, at least 1. */
double pl_terrain_texture_brightest(const pl_terrain *terrain);
/* Rasters of the surface; empty without any. */
const pl_raster_stack *pl_terrain_albedo(const pl_terrain *terrain);
const pl_raster_stack *pl_terrain_roughness(const pl_terrain *terrain);
const pl_raster_stack *pl_terrain_mask(const pl_terrain *terrain);
bool pl_terrain_has_patch(const pl_terrain *terrain);
/* Whether a sphere (body axes, m) is wholly beside the patch that the terrain states: over none of
 * the ground of the square about its centre, with sides to the east and the north. */
bool pl_terrain_beside_patch(const pl_terrain *terrain, pl_vec3 center, double radius_m);
/* Distance of the ellipsoid from the centre, along a unit direction. */
double pl_terrain_datum_m(const pl_terrain *terrain, pl_vec3 direction);

/* Writes the heights in `count` unit directions, with all that the lattice of this level resolves.
 * Fails only if there is no memory for craters or refined rasters. Faster than one by one, most of
 * all where neighbours in the array are near each other. */
pl_status pl_terrain_heights(const pl_terrain *terrain, const pl_vec3 *directions, size_t count,
                             int level, double *heights_m);
/* The same without the soil at the feet of rocks: the ground that rocks are set on. */
pl_status pl_terrain_heights_below_fillets(const pl_terrain *terrain, const pl_vec3 *directions,
                                           size_t count, int level, double *heights_m);
/* Returns the height in one direction, to the same bits; NAN if there is no memory for craters. */
double pl_terrain_height(const pl_terrain *terrain, pl_vec3 direction, int level);
/* Returns the height without craters: fast. NAN if there is no memory for refined rasters. */
double pl_terrain_base_height(const pl_terrain *terrain, pl_vec3 direction, int level);

/* Nodes (i0 + column, j0 + row) of a face, which may lie a few beyond its edges. */
typedef struct pl_terrain_nodes {
  int face, level;
  int64_t i0, j0;
  int width, height;
} pl_terrain_nodes;

/* Writes the heights of nodes, row by row: those of pl_terrain_height to the bit. `directions`, if
 * not NULL, receives those of the nodes: pl_cube_direction to the bit. */
pl_status pl_terrain_block(const pl_terrain *terrain, const pl_terrain_nodes *nodes,
                           double *heights_m, pl_vec3 *directions);

/* Lists the craters that are drawn in a region, as pl_crater_list; none without a field of them. */
pl_status pl_terrain_craters(const pl_terrain *terrain, pl_vec3 direction, double radius_m,
                             double min_m, double max_m, pl_crater **out, size_t *count);

/* Lists the craters with blocks within an angle of a direction, as pl_crater_sources. */
pl_status pl_terrain_sources(const pl_terrain *terrain, const pl_crater_blocks *blocks,
                             pl_vec3 axis, double angle_rad, pl_crater_source **out, size_t *count);
/* Writes the excess of brightness of rays (terrain/crater_rays.h) in unit directions, as resolved
 * by the lattice of a level; 0 without them. */
pl_status pl_terrain_rays(const pl_terrain *terrain, const pl_vec3 *directions, size_t count,
                          int level, float *out);
/* Returns by how much rays brighten fresh ground, over 1; 0 without rays. */
double pl_terrain_ray_brightness(const pl_terrain *terrain);

/* Returns the coarsest level with cells of at most `cell_m`, at most PL_CUBE_LEVELS - 1. */
int pl_terrain_level_of(const pl_terrain *terrain, double cell_m);
/* Returns the level beyond which detail adds nothing. */
int pl_terrain_finest_level(const pl_terrain *terrain);
/* Writes bounds of all heights at all levels; those of craters as pl_crater_bounds states. */
void pl_terrain_bounds(const pl_terrain *terrain, double *low_m, double *high_m);
/* Returns the standard deviation of the detail that levels beyond this one add; what rasters hold
 * below the cells of a coarse level is not in it. */
double pl_terrain_relief_m(const pl_terrain *terrain, int level);

/* Writes the slope (rise over distance, as a vector along the ground in body axes) between points
 * `baseline_m` apart, with all that a lattice with cells of that width resolves. */
pl_status pl_terrain_slope(const pl_terrain *terrain, pl_vec3 direction, double baseline_m,
                           pl_vec3 *out);

#endif
