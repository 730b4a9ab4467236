/* A stage with all that instants of it are made and rendered with. */
#ifndef PL_TESTS_INSTANTS_H
#define PL_TESTS_INSTANTS_H

#include "frame/instant.h"
#include "scenes.h"

typedef struct studio {
  stage stage;
  pl_model *cube; /* half a side is given */
  pl_arena arena;
  pl_accelerators *kept;
  pl_render_scratch *scratch; /* of one thread */
} studio;

static inline void studio_init(studio *s, int side, double focal_px, double half_cube) {
  s->cube = cube_create(half_cube);
  stage_init(&s->stage, side, side, focal_px);
  pl_arena_init(&s->arena);
  assert_int_equal(pl_accelerators_create(&s->kept), PL_OK);
  assert_int_equal(pl_render_scratch_create(1, &s->scratch), PL_OK);
}

static inline void studio_clear(studio *s) {
  pl_render_scratch_destroy(s->scratch);
  pl_accelerators_destroy(s->kept);
  pl_arena_clear(&s->arena);
  stage_clear(&s->stage);
  pl_model_destroy(s->cube);
}

/* The survey of the stage as placed now; a radiance of 400 is white. */
static inline pl_survey studio_survey(studio *s, const pl_frame_request *request) {
  pl_survey survey;
  assert_int_equal(
      pl_survey_place(&s->stage.scene, request, &s->stage.placement, &s->arena, &survey), PL_OK);
  survey.view.white_radiance = 400.0;
  return survey;
}

/* The choice of metering, by a plan that keeps whatever changes anything. */
static inline pl_choice studio_choice(studio *s, const pl_frame_request *request, pl_survey *survey,
                                      int samples) {
  const pl_plan_wish wish = {.tolerance_dn = 0.0};
  pl_plan plan;
  assert_int_equal(pl_survey_plan(survey, &wish, false, &s->arena, &plan), PL_OK);
  return pl_choice_of_metering(request, &plan, samples);
}

static inline const pl_instant *studio_realise(studio *s, const pl_survey *survey,
                                               const pl_choice *choice) {
  const pl_instant *instant;
  assert_int_equal(pl_realise(s->kept, survey, choice, &s->arena, &instant), PL_OK);
  return instant;
}

#endif
