/* Survey: the content of a placement before the plan. It holds everything that a plan is made from,
 * and is cheap to build. */
#ifndef PL_FRAME_SURVEY_H
#define PL_FRAME_SURVEY_H

#include "frame/frame.h"
#include "frame/sky.h"

typedef struct pl_survey {
  pl_snapshot shot; /* not culled, with all features of the camera */
  pl_view view;     /* of the snapshot */
  pl_frame_sky sky; /* stars and background before the plan */
} pl_survey;

/* Places the scene and copies the request's limits into the view; exposures, shutter and sky are
 * filled in later. Allocated in `arena`; borrows scene and placement. */
pl_status pl_survey_place(const pl_scene *scene, const pl_frame_request *request,
                          const pl_placement *placement, pl_arena *arena, pl_survey *out);

/* Survey at the fraction `u` of the frame's time, with the exposures of its middle. */
pl_status pl_survey_at(const pl_scene *scene, const pl_frame_request *request, double u,
                       const pl_view *middle, pl_arena *arena, pl_survey *out);

/* The detail with which a plan has surfaces shaded. */
pl_detail pl_plan_detail(const pl_plan *plan);
/* Makes the plan of a survey. `colour`: reflectance levels of detail are then fitted with the
 * detail that the other rows keep, stored in the survey's view, and the row that chooses among them
 * is decided last. */
pl_status pl_survey_plan(pl_survey *survey, const pl_plan_wish *wish, bool colour, pl_arena *arena,
                         pl_plan *plan);
/* Fits the levels for an instant of a frame that has a plan already; nothing if this one uses the
 * bodies' own laws. */
pl_status pl_survey_fit(pl_survey *survey, const pl_plan *plan, pl_arena *arena);

#endif
