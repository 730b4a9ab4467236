/* What a frame is about to see, as plain data: the input of every effect's bound. */
#ifndef PL_PLAN_VIEW_H
#define PL_PLAN_VIEW_H

#include <stdbool.h>
#include <stddef.h>

/* The laws that may stand for a body's own, from the cheapest on; the last is its own. */
enum { PL_VIEW_LAWS = 6 };
/* Points of a body that are seen, in every band: radiance by its own law, and how far it may be off
 * by the others; W m-2 sr-1. Arrays are borrowed. */
typedef struct pl_view_laws {
  float factor[PL_VIEW_LAWS - 1][3]; /* on the light, with which the others come nearest */
  size_t count;
  const float *exact;
  const float *off[PL_VIEW_LAWS - 1];
} pl_view_laws;

struct pl_air;
struct pl_clouds;

/* One mesh object or body, reduced to what bounds need. */
typedef struct pl_view_thing {
  bool is_body;            /* convex ellipsoid; otherwise a mesh */
  bool is_world;           /* a body of either kind */
  bool in_frame;           /* its bounding sphere touches the frustum */
  bool textured;           /* has a colour map */
  double distance_m;       /* camera to the centre of the bounding sphere */
  double radius_m;         /* of the bounding sphere */
  double center_m[3];      /* camera-relative, root axes */
  double albedo_max;       /* upper bound of the reflectance in any band, 0..1 */
  double ggx_alpha_min;    /* smallest GGX alpha of its materials; 1 when nothing is glossy */
  double irradiance;       /* of the unshadowed sun at its nearest point, W m-2 per band */
  double emission_max;     /* W m-2 sr-1; with the lights of the night */
  double coat_max;         /* heaviest clear coat, 0..1 */
  double transmission_max; /* largest part of the light that passes a surface, 0..1 */
  /* Of a body's map: as pl_texture_ranges, and the fewest texels a metre; NULL without one. */
  const float *map_ranges;
  int map_levels;
  double map_texels_per_m;
  bool graphed;             /* of a body: its surface is a graph's */
  bool pictured;            /* of a mesh or graph: has textures that are not of one colour */
  bool bumped;              /* has normals that are bent */
  bool diffuse;             /* Lambert alone: radiance is the colour's times what it receives */
  bool relief;              /* of a body: its normals are bent by a map */
  bool ocean;               /* of a body: it has open water */
  double lights_max;        /* of a body: of its lights of the night, W m-2 sr-1 */
  const struct pl_air *air; /* borrowed, for the rows in air/ alone; NULL: none */
  bool air_in_frame;        /* a sphere that holds it touches the frustum */
  const struct pl_clouds *clouds; /* borrowed, for the row in shade/ alone; NULL: none */
  bool clouds_in_frame;           /* their shell touches the frustum */
  double rings_radius_m;          /* of a body's rings; 0: none */
  bool rings_in_frame;            /* a sphere that holds them touches the frustum */
  double rings_axis[3];           /* their normal, root axes, unit */
  double rings_depth;             /* largest optical depth along it */
  double rings_light;             /* upper bound of their radiance, W m-2 sr-1 */
  const pl_view_laws *laws; /* of a body in the frame for whose law others may stand, or NULL */
} pl_view_thing;

/* What lies behind everything else. */
typedef struct pl_view_sky {
  bool catalogued;   /* there is a catalogue of stars */
  size_t star_count; /* in the frame */
  int star_levels;   /* tenths of a magnitude that they span, rounded up */
  /* Most that leaving out the stars beyond so many tenths takes from a pixel, W m-2 sr-1;
   * [star_levels + 1], borrowed. */
  const float *star_left;
  bool has_background;
  /* The least radiance that is shown as white: by the display, or by a sensor. */
  double white_radiance;
  double background_max; /* largest radiance of the background in any band, W m-2 sr-1 */
} pl_view_sky;

/* A bounded volume, in a sphere that holds it. */
typedef struct pl_view_volume {
  bool in_frame;      /* the sphere touches the frustum */
  double center_m[3]; /* camera-relative, root axes */
  double distance_m, radius_m;
  double depth;     /* upper bound of its optical depth along any line, in any band */
  double scattered; /* of the sunlight that it scatters into any direction, W m-2 sr-1 */
  double emitted;   /* of the light that it emits, W m-2 sr-1 */
} pl_view_volume;

struct pl_sensor;
typedef struct pl_view_tree pl_view_tree;

typedef struct pl_view {
  int width, height;        /* pixels */
  double pixel_rad;         /* angle of one pixel on the axis */
  double corner_tangent;    /* of the largest angle to the axis in the image, without a lens */
  double white_radiance;    /* W m-2 sr-1 encoded as 255 in the picture asked for; of several, the
                             * least */
  double display_white;     /* of the display's */
  double sun_radius_rad;    /* angular radius of the sun at the camera */
  double sun_position_m[3]; /* camera-relative, root axes */
  double sun_radius_m;
  double sun_axis_rad;   /* angle of the sun to the camera's axis */
  double sun_irradiance; /* unshadowed, at the camera, W m-2 per band */
  bool sun_in_frame;
  double lens_shift_px;        /* by which the lens moves the image at most */
  double defocus_px;           /* widest circle of confusion of what is in the frame; infinite of
                                * things at the lens */
  double blur_px;              /* by which anything moves in the image during the exposure at most,
                                * in pixels or in widths of its glints */
  double skew_px;              /* likewise from the first row's exposure to the last's */
  int samples;                 /* the user's ceiling of colour samples a pixel */
  int max_bounces;             /* the user's ceiling of bounces */
  int texture_filter;          /* the user's ceiling, a pl_filter */
  int volume_steps;            /* the user's ceiling of steps along rays through volumes */
  const pl_view_thing *things; /* borrowed */
  size_t thing_count;
  pl_view_tree *tree;            /* over the things, borrowed; NULL: of few, see view_tree.h */
  const bool *shadowed;          /* borrowed: pl_view_shadowed of each; NULL: not known yet */
  const pl_view_volume *volumes; /* borrowed */
  size_t volume_count;
  pl_view_sky sky;
  /* Borrowed, for the rows in sensor/ alone; NULL: no digital numbers are made. */
  const struct pl_sensor *sensor;
} pl_view;

/* Digital numbers (of 255, display-encoded) that a change of `radiance` can make at most: the sRGB
 * encoding is concave, so the change is largest on black. All from white_radiance on are 255:
 * bounds need not look any further then. */
double pl_view_dn(const pl_view *view, double radiance);
/* Digital numbers that dimming lit surfaces by a fraction can make at most. */
double pl_view_dn_dimming(double fraction);
/* Largest radiance of directly lit diffuse surfaces in the frame, W m-2 sr-1. */
double pl_view_radiance_max(const pl_view *view);
/* Largest radiance of a ray through all volumes and rings in the frame, W m-2 sr-1. */
double pl_view_veils_max(const pl_view *view);
/* Largest radiance that anything in the frame emits by itself, W m-2 sr-1. */
double pl_view_emission_max(const pl_view *view);
/* Largest step of radiance between two places of the frame, W m-2 sr-1: the display's white where
 * there may be glints or the sun. */
double pl_view_step(const pl_view *view);
/* Upper bound of what a pixel changes when the image that it is the mean of moves under it by
 * `shift_px`, digital numbers. A pixel's mean changes by no more than the step and pixel of motion
 * along each axis: what enters on one side and leaves on the other. */
double pl_view_dn_shift(const pl_view *view, double shift_px);
/* Largest radiance that the sky behind all things has in a pixel, W m-2 sr-1. */
double pl_view_sky_max(const pl_view *view);
/* As pl_view_dn, in the display and in a sensor's picture. */
double pl_view_sky_dn(const pl_view *view, double radiance);
/* Whether anything in the frame is glossy enough to mirror the sun. */
double pl_view_alpha_min(const pl_view *view);
/* Whether the shadow of `caster` (umbra and penumbra) can reach `receiver`. */
bool pl_view_shadow_reaches(const pl_view *view, const pl_view_thing *caster,
                            const pl_view_thing *receiver);
/* Upper bound of the fraction of the sun's disc that `caster` hides from anywhere on `receiver`. */
double pl_view_hidden_sun(const pl_view *view, const pl_view_thing *caster,
                          const pl_view_thing *receiver);
/* Whether the shadow of anything can reach things[i]. A body does not shadow itself: it is convex.
 */
bool pl_view_shadowed(const pl_view *view, size_t i);

/* Upper bound of the fraction of a receiver's sky that `source` fills: 1 when they may touch. */
double pl_view_factor(const pl_view_thing *receiver, const pl_view_thing *source);
/* Upper bound of the part of a source's radiance that the receiver sends on in any one direction,
 * by one reflection: 0..1. */
double pl_view_transfer(const pl_view_thing *receiver, const pl_view_thing *source);
/* The same of sources that together have so large a view factor, each less than 1. */
double pl_view_transfer_most(const pl_view_thing *receiver, double factor);
/* Upper bound of a thing's radiance as a light of others: the sun reflected, and its emission. */
double pl_view_light(const pl_view_thing *source);
/* Upper bound of the radiance that a thing sends on of the volumes' light. */
double pl_view_from_volumes(const pl_view *view, const pl_view_thing *receiver);
/* A body's rings as a thing: the sphere that holds them. */
pl_view_thing pl_view_rings(const pl_view_thing *body);
/* 1 + r + r^2 + ..., `bounces` terms: what further reflections between things make of one, where
 * r is the largest albedo in the scene. */
double pl_view_series(const pl_view *view, int bounces);
/* How a shell of that radius about a body, which is not seen itself, gets into the frame: by the
 * light that it sends to things there (a part of its radiance) or keeps from them (1); 0: not at
 * all. */
double pl_view_shell_share(const pl_view *view, const pl_view_thing *body, double radius_m);

/* Upper bound of the radiance that thing `i` sends on of what all others reflect or emit onto it
 * directly, W m-2 sr-1. */
double pl_view_received(const pl_view *view, size_t i);

#endif
