/* The ground in view, for channels that need more of it than the point of one pixel: neighbours in
 * the picture, or heights around the point.
 *
 * Points are gathered from tiles while a frame renders, then rows of the channels are written. */
#ifndef PL_ANNOTATE_GROUND_MAP_H
#define PL_ANNOTATE_GROUND_MAP_H

#include "annotate/channel.h"
#include "terrain/plane_fit.h"

/* Rows that are written at once. */
enum { PL_GROUND_ROWS = 8 };
enum { PL_BASELINES_MAX = 8 };

/* What a lander cannot stand on, within its footprint. */
typedef struct pl_hazard_limits {
  double footprint_m;              /* diameter; 0: the channel is not available */
  double slope_rad, rms_m, rock_m; /* the greatest that are safe: slope and RMS height of the plane
                                      through the footprint, height of a rock over the ground */
} pl_hazard_limits;
/* Values of the channel: 0 for safe ground, or a sum. */
enum { PL_HAZARD_SLOPE = 1, PL_HAZARD_ROUGH = 2, PL_HAZARD_ROCK = 4, PL_HAZARD_UNKNOWN = 128 };

typedef struct pl_ground_settings {
  double baselines_m[PL_BASELINES_MAX]; /* the components of slope_baseline and rms_height */
  int baseline_count;                   /* 0: these channels are not available */
  int disc_points;                      /* see terrain/plane_fit.h */
  pl_hazard_limits hazard;
} pl_ground_settings;

/* What a pixel sees. */
typedef struct pl_ground_point {
  pl_vec3 position;   /* from the body's centre, body axes, m */
  double elevation_m; /* over its ellipsoid */
  int32_t body;       /* index among those of the snapshot; -1: no body is seen */
} pl_ground_point;

/* Images of the channels that need a map. */
typedef enum pl_ground_image {
  PL_GROUND_SLOPE_SOBEL,
  PL_GROUND_ROUGHNESS_LAPLACIAN,
  PL_GROUND_SLOPE_BASELINE,
  PL_GROUND_RMS_HEIGHT,
  PL_GROUND_HAZARD,
  PL_GROUND_IMAGES
} pl_ground_image;

/* Height of a rock that was set on the ground, or 0; kept by each worker. */
typedef struct pl_rock_memo {
  uint64_t id; /* 0: none */
  const pl_terrain *terrain;
  double height_m;
} pl_rock_memo;
enum { PL_ROCK_MEMOS = 2048 };

typedef struct pl_ground_map {
  const pl_snapshot *shot; /* of the bodies */
  const pl_ground_settings *settings;
  pl_ground_point *points;        /* a pixel each, row by row; NULL: no channel needs a map */
  void *images[PL_GROUND_IMAGES]; /* NULL: not asked for */
  pl_rock_memo *memos;            /* PL_ROCK_MEMOS zeros a worker, for hazards */
  pl_disc disc;
} pl_ground_map;

/* Sets everything but the points. Returns false if no channel that is asked for needs a map. */
bool pl_ground_map_init(const pl_snapshot *shot, const pl_ground_settings *settings,
                        void *const *channels, pl_ground_map *out);
/* PL_E_RANGE or PL_E_ARGUMENT, naming what is wrong with the settings of channels asked for. */
pl_status pl_ground_map_check(pl_ground_map *map);

/* Takes the points of a tile, with `stride` points a row. `tile`: x0, y0, width, height. `shot`:
 * that of the tile's instant. */
void pl_ground_map_take(const pl_ground_map *map, const pl_snapshot *shot, const pl_point *points,
                        size_t stride, const int tile[4]);

/* Pixels of a square of the picture that see one body, or none. */
typedef struct pl_ground_group {
  const pl_ground_map *map;
  pl_rock_memo *memos;       /* of the worker */
  const pl_terrain *terrain; /* of the body; NULL: it has none, or there is none */
  size_t count;
  size_t pixels[PL_GROUND_ROWS * PL_GROUND_ROWS];
  pl_vec3 directions[PL_GROUND_ROWS * PL_GROUND_ROWS]; /* of the points; only with terrain */
} pl_ground_group;
typedef pl_status (*pl_ground_group_fn)(const pl_ground_group *group);

/* Writes rows y0 to y1 - 1 of all images. */
pl_status pl_ground_map_write(const pl_ground_map *map, int y0, int y1, int worker);

#endif
