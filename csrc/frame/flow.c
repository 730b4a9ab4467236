#include "frame/flow.h"

#include "frame/moving.h"

/* Whether marking where meshes may be costs less than the rays that it spares: not of models with
 * many triangles in a small picture. Changes no bits. */
static bool mask_pays(const pl_snapshot *shot) {
  enum { PIXELS_EACH = 4 };
  const pl_camera *camera = &shot->rays.camera;
  size_t triangles = 0;
  for (size_t i = 0; i < shot->object_count; i++)
    if (shot->objects[i].in_frame)
      triangles += shot->objects[i].object->model->triangle_count;
  return PIXELS_EACH * triangles <= (size_t)camera->width * (size_t)camera->height;
}

static pl_status make_frame(pl_renderer *renderer, const pl_frame_request *request,
                            const pl_other_frame *other, const pl_choice *choice, bool rolls,
                            pl_coverage *meshes, const pl_sight_frame **out) {
  pl_choice labels = pl_choice_of_labels(choice);
  labels.settings.effects.far_casters = 0; /* nothing is lit */
  labels.culls = false;                    /* what is hidden there is looked for */
  pl_arena *arena = &renderer->arena;
  pl_survey survey;
  const pl_instant *instant;
  PL_TRY(pl_placement_check(renderer->scene, &other->placement));
  PL_TRY(pl_survey_place(renderer->scene, request, &other->placement, arena, &survey));
  PL_TRY(pl_realise(renderer->accelerators, &survey, &labels, arena, &instant));
  if (meshes != NULL && !mask_pays(&instant->shot))
    meshes = NULL;
  if (meshes != NULL)
    PL_TRY(pl_coverage_update(meshes, &instant->shot, 0, instant->shot.rays.camera.height, 1,
                              request->threads));
  pl_sight_frame *made = pl_arena_alloc(arena, 1, sizeof *made);
  if (made == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for another frame");
  *made = (pl_sight_frame){.placement = &other->placement,
                           .changed = other->changed,
                           .rows = rolls && other->placement.shutter.line_s > 0.0,
                           .shot = &instant->shot,
                           .tracer = instant->tracer,
                           .meshes = meshes};
  *out = made;
  return PL_OK;
}

pl_status pl_frame_flow(pl_renderer *renderer, const pl_frame_request *request, const pl_plan *plan,
                        const pl_choice *choice, const pl_flow **out) {
  pl_flow found;
  *out = NULL;
  if (!pl_flow_init(request->channels, &found))
    return PL_OK;
  /* As in this frame: where its plan takes all rows at once, so does the other. */
  const bool rolls = pl_moving_rolls(request, plan);
  for (int to = 0; to < PL_FLOW_FRAMES; to++) {
    pl_coverage *meshes =
        pl_flow_wants_hidden(&found, (pl_flow_to)to) ? &renderer->label_tools.others[to] : NULL;
    if (found.wanted[to] && request->others[to] != NULL)
      PL_TRY(make_frame(renderer, request, request->others[to], choice, rolls, meshes,
                        &found.frames[to]));
  }
  pl_flow *made = pl_arena_alloc(&renderer->arena, 1, sizeof *made);
  if (made == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for labels of motion");
  *made = found;
  *out = made;
  return PL_OK;
}

pl_status pl_frame_keypoints(const pl_scene *scene, const pl_frame_request *request,
                             const pl_plan *plan, const pl_instant *instant) {
  const pl_sight_frame frame = {.placement = &request->placement,
                                .rows = pl_moving_rolls(request, plan),
                                .shot = &instant->shot,
                                .tracer = instant->tracer};
  if (request->keypoint_labels == NULL)
    return PL_OK;
  PL_TRY(pl_keypoints_check(scene, request->keypoints, request->keypoint_count));
  for (size_t i = 0; i < request->keypoint_count; i++)
    pl_keypoint_find(scene, &frame, &request->keypoints[i], &request->keypoint_labels[i]);
  return PL_OK;
}
