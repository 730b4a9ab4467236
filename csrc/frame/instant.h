/* One instant of the world, ready for rays: the same for still frames, the instants of an exposure,
 * metering and the pictures of small bodies. */
#ifndef PL_FRAME_INSTANT_H
#define PL_FRAME_INSTANT_H

#include "frame/survey.h"
#include "render/render.h"

/* What is made of a survey: of a frame by its plan, or by fixed values. */
typedef struct pl_choice {
  pl_render_settings settings; /* without what is borrowed */
  bool culls;                  /* what cannot matter is left out, by more than tolerance_dn */
  double tolerance_dn;
  bool distortion, depth_of_field;
  bool colour;   /* or else labels alone: nothing below is looked at */
  bool subpixel; /* bodies of a few pixels get pictures of their own, see subpixel_bodies.h */
  int emitters, air_steps, media[PL_MEDIUM_KINDS_MAX]; /* values of these effects */
  bool skylight, multiple_scattering, planetshine, caustics, limb_darkening;
} pl_choice;

/* That of a frame's plan. */
pl_choice pl_choice_of_plan(const pl_frame_request *request, const pl_frame_result *result,
                            bool colour);
/* The same for labels alone. */
pl_choice pl_choice_of_labels(const pl_choice *frame);
/* A quick look at everything, by direct light. */
pl_choice pl_choice_of_metering(const pl_frame_request *request, int samples);

/* Nothing in it changes once it is made; threads and frames' parts share it. */
typedef struct pl_instant {
  pl_snapshot shot;        /* what the choice leaves of the survey's */
  const pl_tracer *tracer; /* of it */
  pl_emitters emitters;
  pl_air_view air;
  pl_media media;
  pl_planetshine shine;
  pl_caustics caustics;
  pl_limb limb;
  pl_render_settings settings; /* the choice's, with those of the above that there are */
} pl_instant;

/* Builds what lights a survey and what rays meet. In `arena`; borrows what the survey does, which
 * itself is not needed any more. */
pl_status pl_realise(pl_accelerators *kept, const pl_survey *survey, const pl_choice *choice,
                     pl_arena *arena, const pl_instant **out);

#endif
