/* Summary of a frame's view as plain data: the input of every effect's bound. */
#ifndef PL_PLAN_VIEW_H
#define PL_PLAN_VIEW_H

#include <stdbool.h>
#include <stddef.h>

/* Reflectance levels of detail of a body, from the cheapest to the body's own law, which is the
 * last. */
enum { PL_VIEW_LODS = 6 };
/* Radiance of the visible sample points of a body in every band, by its own law, and the error of
 * each cheaper law; W m-2 sr-1. Arrays are borrowed. */
typedef struct pl_view_lods {
  /* scale of the light that minimises the error of each cheaper law, per band */
  float factor[PL_VIEW_LODS - 1][3];
  size_t count;
  const float *exact;
  const float *off[PL_VIEW_LODS - 1];
} pl_view_lods;

/* Colour map of a body. */
typedef struct pl_view_map {
  const float *ranges; /* as in pl_texture_ranges; borrowed; NULL without a map */
  int levels;
  double texels_per_m; /* the smallest density */
} pl_view_map;
/* Rings of a body. */
typedef struct pl_view_rings {
  bool in_frame;   /* a sphere that encloses them touches the frustum */
  double radius_m; /* the outer one */
  double axis[3];  /* unit normal, root axes */
  double depth;    /* largest optical depth along the normal */
  double light;    /* upper bound of their radiance, W m-2 sr-1 */
} pl_view_rings;

struct pl_air;
struct pl_clouds;

/* One mesh object or body, reduced to what the bounds need. */
typedef struct pl_view_entity {
  bool is_body;         /* convex ellipsoid; otherwise a mesh */
  bool is_world;        /* a body of the scene, whether ellipsoid or mesh */
  bool in_frame;        /* its bounding sphere touches the frustum */
  bool textured;        /* has a colour map */
  double distance_m;    /* camera to the centre of the bounding sphere */
  double radius_m;      /* of the bounding sphere */
  double center_m[3];   /* camera-relative, root axes */
  double albedo_max;    /* upper bound of the reflectance in any band, 0..1 */
  double ggx_alpha_min; /* smallest GGX alpha of its materials; 1 when no material is glossy */
  /* Upper bound of the sunlight that a mesh sends into any one direction over that of a white
   * Lambertian disc as large as the bounding sphere; 0 where it is not known */
  double sent_gain;
  double irradiance;       /* of the unshadowed sun at the point nearest to it, W m-2 per band */
  double emission_max;     /* W m-2 sr-1, night lights included */
  double coat_max;         /* largest weight of a clear coat, 0..1 */
  double transmission_max; /* largest part of the light that is transmitted by a surface, 0..1 */
  pl_view_map map;
  bool graphed;  /* body whose surface is a material graph */
  bool pictured; /* mesh or graph with textures of more than one colour */
  bool bumped;   /* has a normal map or bump map */
  bool diffuse; /* purely Lambertian: radiance is proportional to its colour times the irradiance */
  bool rays;    /* terrain with bright rays of craters */
  bool sampled; /* terrain with textures of heights that samples of its nearest ground resolve */
  bool relief;  /* body whose normals are perturbed by a relief map */
  bool ocean;   /* body with open water */
  int terrain;  /* finest level of a height field that is its surface; 0: none */
  double lights_max; /* largest radiance of a body's night lights, W m-2 sr-1 */
  /* borrowed; used only by the rows in air/; NULL without an atmosphere */
  const struct pl_air *air;
  bool air_in_frame; /* the sphere that encloses the atmosphere touches the frustum */
  /* borrowed; used only by the row in shade/; NULL without clouds */
  const struct pl_clouds *clouds;
  bool clouds_in_frame;       /* the shell of the clouds touches the frustum */
  const pl_view_rings *rings; /* borrowed; NULL without rings */
  /* reflectance levels of detail of a body in the frame, or NULL if it has none */
  const pl_view_lods *lods;
} pl_view_entity;

/* Sky behind all objects and bodies. */
typedef struct pl_view_sky {
  bool catalogued;   /* the scene has a star catalogue */
  size_t star_count; /* stars in the frame */
  int star_levels;   /* range of their magnitudes in tenths of a magnitude, rounded up */
  /* Largest radiance that a pixel loses when the stars beyond the first i tenths of a magnitude are
   * left out, W m-2 sr-1; [star_levels + 1], borrowed. */
  const float *star_left;
  bool has_background;
  /* Smallest radiance that is white on the display or saturates the sensor, W m-2 sr-1. */
  double white_radiance;
  double background_max; /* largest radiance of the background in any band, W m-2 sr-1 */
} pl_view_sky;

/* A bounded volume and its bounding sphere. */
typedef struct pl_view_volume {
  bool in_frame;      /* the sphere touches the frustum */
  double center_m[3]; /* camera-relative, root axes */
  double distance_m, radius_m;
  double depth;     /* upper bound of the optical depth along any line, in any band */
  double scattered; /* upper bound of the sunlight scattered into any direction, W m-2 sr-1 */
  double emitted;   /* upper bound of the emitted radiance, W m-2 sr-1 */
} pl_view_volume;

struct pl_sensor;
typedef struct pl_view_tree pl_view_tree;

typedef struct pl_view {
  int width, height; /* pixels */
  double pixel_rad;  /* angle of one pixel on the optical axis */
  /* tangent of the largest angle to the axis in the image, without lens distortion */
  double corner_tangent;
  /* radiance encoded as 255 in the requested image, W m-2 sr-1; the smallest of several */
  double white_radiance;
  double display_white;     /* radiance encoded as 255 by the display, W m-2 sr-1 */
  double sun_radius_rad;    /* angular radius of the sun at the camera */
  double sun_position_m[3]; /* camera-relative, root axes */
  double sun_radius_m;
  double sun_axis_rad;   /* angle between the sun and the optical axis */
  double sun_irradiance; /* unshadowed, at the camera, W m-2 per band */
  bool sun_in_frame;
  double lens_shift_px; /* largest shift of a point of the image by lens distortion */
  /* largest circle of confusion of anything in the frame; infinite for objects at the lens */
  double defocus_px;
  /* largest motion in the image during the exposure, in pixels or in widths of glints */
  double blur_px;
  double skew_px;     /* the same from the exposure of the first row to that of the last */
  int samples;        /* upper limit of colour samples per pixel, set by the user */
  double target_dn;   /* error of a pixel that decides how many of them it gets; 0: none */
  int max_bounces;    /* upper limit of bounces, set by the user */
  int texture_filter; /* upper limit of the texture filter (a pl_filter), set by the user */
  int volume_steps;   /* upper limit of steps along rays through volumes, set by the user */
  const pl_view_entity *entities; /* borrowed */
  size_t entity_count;
  /* tree over the objects and bodies, borrowed; NULL when they are few, see view_tree.h */
  pl_view_tree *tree;
  /* borrowed: pl_view_shadowed of each object and body; NULL before it is known */
  const bool *shadowed;
  const pl_view_volume *volumes; /* borrowed */
  size_t volume_count;
  pl_view_sky sky;
  /* Borrowed; used only by the rows in sensor/. NULL when no digital numbers are made. */
  const struct pl_sensor *sensor;
} pl_view;

/* Returns the largest change of a pixel in digital numbers (of 255, display-encoded) by a change of
 * `radiance`. The sRGB encoding is concave, so the change is largest on black. From white_radiance
 * on every change is 255, so that bounds may stop there. */
double pl_view_dn(const pl_view *view, double radiance);
/* Returns the largest change in digital numbers when lit surfaces are dimmed by a fraction. */
double pl_view_dn_dimming(double fraction);
/* Returns the largest radiance of directly lit diffuse surfaces in the frame, W m-2 sr-1. */
double pl_view_radiance_max(const pl_view *view);
/* Returns the largest radiance along a ray through all participating media (volumes and rings) in
 * the frame, W m-2 sr-1. */
double pl_view_media_max(const pl_view *view);
/* Returns the largest emitted radiance in the frame, W m-2 sr-1. */
double pl_view_emission_max(const pl_view *view);
/* Returns the largest difference of radiance between two points of the frame, W m-2 sr-1:
 * white_radiance where glints or the sun may be in the frame. */
double pl_view_step(const pl_view *view);
/* Upper bound of the change of a pixel when the image shifts by `shift_px`, digital numbers. Along
 * each axis a pixel's mean changes by at most the largest step times the shift in pixels: what
 * enters on one side and leaves on the other. */
double pl_view_dn_shift(const pl_view *view, double shift_px);
/* Returns the largest radiance of the sky background in a pixel, W m-2 sr-1. */
double pl_view_sky_max(const pl_view *view);
/* As pl_view_dn, for changes of the sky: the larger one of the display's and of the sensor's
 * digital numbers. */
double pl_view_sky_dn(const pl_view *view, double radiance);
/* Returns the smallest GGX alpha in the frame; below 1 something may mirror the sun. */
double pl_view_alpha_min(const pl_view *view);
/* Returns true if the shadow of `caster` (umbra and penumbra) can reach `receiver`. */
bool pl_view_shadow_reaches(const pl_view *view, const pl_view_entity *caster,
                            const pl_view_entity *receiver);
/* Upper bound of the fraction of the sun's disc that `caster` hides from any point of
 * `receiver`. */
double pl_view_hidden_sun(const pl_view *view, const pl_view_entity *caster,
                          const pl_view_entity *receiver);
/* Returns true if any shadow can reach entities[i]. A body does not shadow itself: it is convex. */
bool pl_view_shadowed(const pl_view *view, size_t i);

/* Upper bound of the view factor of `source` from `receiver`, 0..1; 1 when they may touch. */
double pl_view_factor(const pl_view_entity *receiver, const pl_view_entity *source);
/* Upper bound of the part of a source's radiance that the receiver reflects into any one direction,
 * by one reflection: 0..1. */
double pl_view_transfer(const pl_view_entity *receiver, const pl_view_entity *source);
/* The same for several sources whose view factors, each less than 1, sum to `factor`. */
double pl_view_transfer_most(const pl_view_entity *receiver, double factor);
/* Radiance of an object or body that lights others: reflected sunlight and emission, W m-2 sr-1.
 * Not a bound for mirrors: of lobes it takes those of alpha 0.3. */
double pl_view_light(const pl_view_entity *source);
/* The same as an upper bound, mirrors included: the sun's own radiance at most. */
double pl_view_light_most(const pl_view *view, const pl_view_entity *source);
/* Upper bound of its radiance at a receiver, for pl_view_factor: from afar a mesh sends no more
 * than the sum of its facets. */
double pl_view_light_at(const pl_view *view, const pl_view_entity *receiver,
                        const pl_view_entity *source);
/* Upper bound of the radiance that `receiver` reflects of the light of volumes, W m-2 sr-1. */
double pl_view_from_volumes(const pl_view *view, const pl_view_entity *receiver);
/* Whether a body's rings may be in the frame. */
static inline bool pl_view_shows_rings(const pl_view_entity *body) {
  return body->rings != NULL && body->rings->in_frame;
}
/* Returns the rings of a body, which has some, as if they were an object: the sphere that encloses
 * them. */
pl_view_entity pl_view_ring_sphere(const pl_view_entity *body);
/* Returns 1 + r + r^2 + ..., `bounces` terms, where r is the largest albedo in the scene: the gain
 * by interreflection. */
double pl_view_series(const pl_view *view, int bounces);
/* Returns how much a shell of this radius about a body outside the view can affect the frame: the
 * fraction of its radiance that reaches objects in view, 1 if it can shadow them, else 0. */
double pl_view_shell_fraction(const pl_view *view, const pl_view_entity *body, double radius_m);

/* Upper bound of the radiance that entities[i] reflects of the light that all others reflect or
 * emit onto it directly, W m-2 sr-1. */
double pl_view_received(const pl_view *view, size_t i);

#endif
