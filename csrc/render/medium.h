/* Media: thin things that rays pass through, such as clouds. One kind a row of the table in
 * medium.c, with the same name as its effect. */
#ifndef PL_RENDER_MEDIUM_H
#define PL_RENDER_MEDIUM_H

#include "base/memory.h"
#include "light/sun.h"
#include "plan/effects.h"
#include "render/vertex.h"

struct pl_air_view;
struct pl_path_context;
struct pl_tile_buffers;

/* Where a ray meets a medium. */
typedef struct pl_medium_crossing {
  double t;          /* m along the ray */
  pl_vec3f passed;   /* part of what comes from beyond that is let through, 0..1 */
  pl_vec3f radiance; /* what it adds: sunlight that it scatters, what it emits; without the air
                        between it and the ray's start, W m-2 sr-1 */
  float unsure;      /* part by which what it adds and keeps back may be off, since the beam hides
                        detail: rms */
} pl_medium_crossing;

/* Of one ray, by t. The farthest are left out where there are too many. */
enum { PL_MEDIUM_CROSSINGS = 16 };
typedef struct pl_medium_list {
  size_t count;
  pl_medium_crossing items[PL_MEDIUM_CROSSINGS];
} pl_medium_list;
void pl_medium_list_add(pl_medium_list *list, const pl_medium_crossing *crossing);

enum { PL_MEDIUM_KINDS_MAX = 8 };
/* The media of a frame, read-only once built. */
typedef struct pl_media {
  const struct pl_air_view *air;        /* borrowed; NULL: none */
  uint32_t subpixel;                    /* body whose picture as a dot this is; PL_NOTHING */
  bool emission;                        /* the camera sees what they emit */
  const void *own[PL_MEDIUM_KINDS_MAX]; /* of each kind: what its build made; NULL: none */
} pl_media;

/* What is asked of a ray. */
typedef struct pl_medium_ray {
  const pl_beam *beam;
  double t_max;       /* crossings are 0 < t < t_max */
  bool camera;        /* from the camera */
  bool dark;          /* only what passes is wanted, no radiance */
  uint32_t from_body; /* body on whose surface it starts: what its media send down is in the light
                         that pl_media_toward_sun gives, and not wanted; PL_NOTHING */
  /* A pixel's beam is looked at in parts x parts places of the pixel, where that shows more than a
   * filter does; 0 or 1: as a whole. By how much the unit direction changes from side to side. */
  int parts;
  pl_vec3 pixel[2];
} pl_medium_ray;

typedef struct pl_medium_kind {
  const pl_effect *effect; /* its row */
  /* What the snapshot has of the kind, in `arena`: *own stays NULL if nothing. `value`: of the
   * effect, not 0. */
  pl_status (*build)(const pl_snapshot *shot, int value, pl_arena *arena, const void **own);
  /* Whether any may be on camera rays of a cone about a unit axis. */
  bool (*in_cone)(const void *own, const pl_snapshot *shot, pl_vec3 axis, double half_angle);
  /* Adds the crossings of a ray. */
  void (*cross)(const pl_media *media, const void *own, const pl_snapshot *shot,
                const pl_medium_ray *ray, pl_medium_list *out);
  /* What comes through to a camera-relative point of the sun's light, over its disc and over a
   * footprint `width_m` wide about the point. */
  pl_vec3f (*toward_sun)(const pl_media *media, const void *own, const pl_snapshot *shot,
                         pl_vec3 point, const pl_sun_view *sun, float width_m);
  bool before_sky; /* it lies between a ground and its sky, which is dimmed as the sun is */
  bool filtered;   /* one crossing of a beam says what all of it sees, but at outlines */
  /* Whether a few samples of a pixel may miss what its whole beam from the camera sees. `faint`:
   * the part of the beam that a medium in full sun must fill to be noticed before black. May be
   * NULL: never. */
  bool (*thin)(const void *own, const pl_snapshot *shot, const pl_beam *pixel, double faint);
} pl_medium_kind;
/* The table. */
extern const pl_medium_kind *const pl_medium_kinds[];
extern const size_t pl_medium_kind_count;

/* Lists the media of a snapshot; values[k]: of the k-th kind's effect. *any: whether there are any.
 */
pl_status pl_media_build(const pl_snapshot *shot, const int *values, const struct pl_air_view *air,
                         pl_arena *arena, pl_media *out, bool *any);
/* Whether any may be in a cone of rays from the camera; `media` may be NULL. */
bool pl_media_in_cone(const pl_media *media, const pl_snapshot *shot, pl_vec3 axis,
                      double half_angle);
/* The same, but for the kinds that are filtered. */
bool pl_media_rough_in_cone(const pl_media *media, const pl_snapshot *shot, pl_vec3 axis,
                            double half_angle);
/* Whether few samples may miss media that the beam of a pixel sees. */
bool pl_media_thin(const pl_media *media, const pl_snapshot *shot, const pl_beam *pixel,
                   double faint);
/* Whether a ray sees what a body carries: a dot's media are in its own picture alone. */
bool pl_medium_ray_sees(const pl_media *media, const pl_medium_ray *ray, const pl_snapshot *shot,
                        uint32_t body);

/* All crossings of a ray. */
void pl_media_cross(const pl_media *media, const pl_snapshot *shot, const pl_medium_ray *ray,
                    pl_medium_list *out);
/* What of the light from a unit direction comes to the camera, of things at t_max. */
pl_vec3f pl_media_passed(const pl_media *media, const pl_snapshot *shot, pl_vec3 direction,
                         double t_max);
/* What of the sun's light comes through to a point: see the rows. */
pl_vec3f pl_media_toward_sun(const pl_media *media, const pl_snapshot *shot, pl_vec3 point,
                             const pl_sun_view *sun, float width_m);
/* What of the light of the sky comes through to a point of the ground, whose normal is `up`. */
pl_vec3f pl_media_before_sky(const pl_media *media, const pl_snapshot *shot, pl_vec3 point,
                             pl_vec3f up, float width_m);
/* What comes through to a vertex of `sky`, the light of that; `media` may be NULL: all. */
pl_vec3f pl_media_dim_sky(const pl_media *media, const pl_snapshot *shot, const pl_vertex *vertex,
                          float width_m, pl_vec3f sky);
/* The sun's irradiance on a surface at a point that faces it: with eclipses by bodies, the air
 * before it and the other kinds' media; the things that are meshes cast no shadow there. `kind`:
 * that asks, whose own media are left out. */
pl_vec3f pl_media_sunlight(const pl_media *media, const pl_medium_kind *kind,
                           const pl_snapshot *shot, pl_vec3 point, const pl_sun_view *sun,
                           float width_m);

/* What is seen of a radiance through media, without air. */
pl_vec3f pl_media_seen(const pl_medium_list *list, pl_vec3f radiance);
/* Along the rays of a wave, whose hits are known: adds to the samples and dims what follows. Takes
 * the place of pl_air_apply. */
void pl_media_apply(const struct pl_path_context *context, int bounce, size_t count,
                    struct pl_tile_buffers *buffers);

#endif
