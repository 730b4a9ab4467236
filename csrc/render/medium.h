/* Participating media: clouds, rings and volumes, which rays pass through. Each kind is a row of
 * the table in medium.c and has the name of its effect. */
#ifndef PL_RENDER_MEDIUM_H
#define PL_RENDER_MEDIUM_H

#include "base/memory.h"
#include "light/sun.h"
#include "plan/effects.h"
#include "render/vertex.h"

struct pl_air_view;
struct pl_path_context;
struct pl_tile_buffers;

/* A ray's crossing of a medium. */
typedef struct pl_medium_crossing {
  double t;               /* m along the ray */
  pl_vec3f transmittance; /* for light from beyond, 0..1 */
  /* radiance that it adds by scattering sunlight and by emission, without the air between it and
   * the ray's start, W m-2 sr-1 */
  pl_vec3f radiance;
  /* relative rms error of the radiance that it adds and of the light that it blocks, from detail
   * finer than the beam */
  float unsure;
} pl_medium_crossing;

/* The crossings of one ray, in order of t. If there are too many, the farthest are left out. */
enum { PL_MEDIUM_CROSSINGS = 16 };
typedef struct pl_medium_list {
  size_t count;
  pl_medium_crossing items[PL_MEDIUM_CROSSINGS];
} pl_medium_list;
void pl_medium_list_add(pl_medium_list *list, const pl_medium_crossing *crossing);

enum { PL_MEDIUM_KINDS_MAX = 8 };
/* The media of a frame, read-only once built. */
typedef struct pl_media {
  const struct pl_air_view *air; /* borrowed; NULL: none */
  uint32_t subpixel;             /* body whose sub-pixel image is being rendered, or PL_NO_BODY */
  bool emitted_light;            /* the camera sees what they emit */
  const void *own[PL_MEDIUM_KINDS_MAX]; /* by kind: what its `build` made; NULL: none */
} pl_media;

/* A ray, and which crossings of it are wanted. */
typedef struct pl_medium_ray {
  const pl_beam *beam;
  double t_max; /* crossings are 0 < t < t_max */
  bool camera;  /* whether it starts at the camera */
  bool dark;    /* only the transmittance is wanted, no radiance */
  /* body on whose surface it starts, or PL_NO_BODY: light that its media scatter down is part of
   * pl_media_toward_sun, and is left out here */
  uint32_t from_body;
  /* Above 0: the ray is the only one of its pixel, whose beam is split into parts x parts beams
   * where that shows more than a filter does; 1: it is not split. `pixel`: change of the unit
   * direction across the pixel, along its rows and columns. */
  int parts;
  pl_vec3 pixel[2];
} pl_medium_ray;

typedef struct pl_medium_kind {
  const pl_effect *effect; /* its row in the table of effects */
  /* Builds from a snapshot, in `arena`; *own stays NULL if there is no such medium. `value`: that
   * of the effect, not 0. */
  pl_status (*build)(const pl_snapshot *shot, int value, pl_arena *arena, const void **own);
  /* Whether such a medium may be on camera rays in a cone about a unit axis. */
  bool (*in_cone)(const void *own, const pl_snapshot *shot, pl_vec3 axis, double half_angle);
  /* Adds the crossings of a ray. */
  void (*cross)(const pl_media *media, const void *own, const pl_snapshot *shot,
                const pl_medium_ray *ray, pl_medium_list *out);
  /* Transmittance for sunlight to a point relative to the camera: mean over the sun's disc and over
   * a footprint `width_m` wide about the point. */
  pl_vec3f (*toward_sun)(const pl_media *media, const void *own, const pl_snapshot *shot,
                         pl_vec3 point, const pl_sun_view *sun, float width_m);
  /* it lies between a ground and its sky, whose light it dims as it dims the sun's */
  bool before_sky;
  bool filtered; /* one crossing of a beam is its mean over the whole beam, except at outlines */
  /* Whether a few samples of a pixel may miss what its whole beam from the camera covers. `faint`:
   * the fraction of the beam that a medium in full sun must fill to be visible against black. May
   * be NULL: never. */
  bool (*thin)(const void *own, const pl_snapshot *shot, const pl_beam *pixel, double faint);
} pl_medium_kind;
/* The table of kinds. */
extern const pl_medium_kind *const pl_medium_kinds[];
extern const size_t pl_medium_kind_count;

/* Builds the media of a snapshot; values[k]: of the effect of the k-th kind. *any: whether there
 * are any. */
pl_status pl_media_build(const pl_snapshot *shot, const int *values, const struct pl_air_view *air,
                         pl_arena *arena, pl_media *out, bool *any);
/* Whether any medium may be in a cone of rays from the camera; `media` may be NULL. */
bool pl_media_in_cone(const pl_media *media, const pl_snapshot *shot, pl_vec3 axis,
                      double half_angle);
/* The same for the kinds that are not filtered. */
bool pl_media_rough_in_cone(const pl_media *media, const pl_snapshot *shot, pl_vec3 axis,
                            double half_angle);
/* True if a pixel's beam crosses a medium that a small number of samples may miss. */
bool pl_media_thin(const pl_media *media, const pl_snapshot *shot, const pl_beam *pixel,
                   double faint);
/* Whether a ray sees the media of a body: those of a sub-pixel body are in its own image alone. */
bool pl_medium_ray_sees(const pl_media *media, const pl_medium_ray *ray, const pl_snapshot *shot,
                        uint32_t body);

/* All crossings of a ray. */
void pl_media_cross(const pl_media *media, const pl_snapshot *shot, const pl_medium_ray *ray,
                    pl_medium_list *out);
/* Transmittance for light that reaches the camera along a beam from distance t_max, beyond all air;
 * `media` and `air` may be NULL. */
pl_vec3f pl_media_passed(const pl_media *media, const struct pl_air_view *air,
                         const pl_snapshot *shot, const pl_beam *beam, double t_max);
/* Transmittance for sunlight to a point, see pl_medium_kind. */
pl_vec3f pl_media_toward_sun(const pl_media *media, const pl_snapshot *shot, pl_vec3 point,
                             const pl_sun_view *sun, float width_m);
/* The part of `sky`, the sky's light on a vertex, that media transmit; `media` may be NULL: all. */
pl_vec3f pl_media_dim_sky(const pl_media *media, const pl_snapshot *shot, const pl_vertex *vertex,
                          float width_m, pl_vec3f sky);
/* Irradiance of the sun on a surface that faces it: with eclipses by bodies, the air in front of it
 * and media of the other kinds. Meshes cast no shadow there. `kind`: the caller's, whose own media
 * are left out. */
pl_vec3f pl_media_sunlight(const pl_media *media, const pl_medium_kind *kind,
                           const pl_snapshot *shot, pl_vec3 point, const pl_sun_view *sun,
                           float width_m);

/* A radiance seen through media, without air. */
pl_vec3f pl_media_seen(const pl_medium_list *list, pl_vec3f radiance);
/* For the rays of a wave, whose hits are known: adds the media's radiance to the samples and
 * attenuates the throughput of the paths. Takes the place of pl_air_apply. */
void pl_media_apply(const struct pl_path_context *context, int bounce, size_t count,
                    struct pl_tile_buffers *buffers);

#endif
