/* One instant of the world, ready for ray tracing. Still frames, the instants of an exposure,
 * metering and the images of sub-pixel bodies all use it. */
#ifndef PL_FRAME_INSTANT_H
#define PL_FRAME_INSTANT_H

#include "frame/survey.h"
#include "render/render.h"

/* Directions in which rays leave that are not those of the camera's pixels. */
typedef struct pl_beam_cone {
  pl_vec3 axis;          /* of a cone that contains them, unit, camera axes */
  double half_angle_rad; /* of the cone */
  double pixel_rad;      /* angle that a ray stands for; 0: rays are those of pixels */
} pl_beam_cone;

/* Settings for making an instant from a survey: derived from a frame's plan, or fixed. */
typedef struct pl_choice {
  pl_render_settings settings; /* with the plan's effects, without the borrowed pointers */
  bool culls;                  /* leave out what changes no pixel by more than tolerance_dn */
  double tolerance_dn;
  int threads;        /* that build height fields; the result is the same for any number */
  pl_cancel *cancel;  /* borrowed; may be NULL */
  pl_beam_cone beams; /* all zero: rays are those of pixels */
  int terrain_levels; /* up to which meshes of terrain are refined; 0: ellipsoids */
  bool albedo;        /* labels show the ground's albedo */
  bool colour;        /* false: labels only, and the fields below are ignored */
  bool subpixel;      /* render sub-pixel bodies in images of their own, see subpixel_bodies.h */
  int media[PL_MEDIUM_KINDS_MAX]; /* values of the rows of their effects */
} pl_choice;

/* Returns the choice that a frame's plan makes. */
pl_choice pl_choice_of_plan(const pl_frame_request *request, const pl_frame_result *result,
                            bool colour);
/* Returns the same choice, reduced to labels. */
pl_choice pl_choice_of_labels(const pl_choice *frame);
/* Returns the choice of the plan for metering, see pl_frame_meter: at most a fast preview. */
pl_choice pl_choice_of_metering(const pl_frame_request *request, const pl_plan *plan, int samples);

/* Immutable once it is made; shared by threads and by the stages of a frame. */
typedef struct pl_instant {
  pl_snapshot shot;        /* the survey's snapshot after culling */
  const pl_tracer *tracer; /* of this snapshot */
  pl_emitters emitters;
  pl_air_view air;
  pl_media media;
  pl_planetshine planetshine;
  pl_caustics caustics;
  pl_limb limb;
  /* those of the choice, with pointers to the structs above that are in use */
  pl_render_settings settings;
} pl_instant;

/* Culls the snapshot and builds its tracer, lights and media. Allocated in `arena`; borrows what
 * the survey borrows, but not the survey itself. */
pl_status pl_realise(pl_accelerators *kept, const pl_survey *survey, const pl_choice *choice,
                     pl_arena *arena, const pl_instant **out);

#endif
