/* From placements to views. */
#include "frame/survey.h"

#include "render/reflectance_lod.h"
#include "scene/shutter.h"

pl_status pl_survey_place(const pl_scene *scene, const pl_frame_request *request,
                          const pl_placement *placement, pl_arena *arena, pl_survey *out) {
  PL_TRY(pl_snapshot_build(scene, placement, arena, &out->shot));
  PL_TRY(pl_snapshot_view(&out->shot, arena, &out->view));
  out->sky = (pl_frame_sky){.width = out->shot.camera.width};
  out->view.samples = request->samples;
  out->view.max_bounces = request->max_bounces;
  out->view.texture_filter = request->texture_filter;
  out->view.volume_steps = request->volume_steps;
  return PL_OK;
}

pl_status pl_survey_at(const pl_scene *scene, const pl_frame_request *request, double u,
                       const pl_view *middle, bool lods, pl_arena *arena, pl_survey *out) {
  pl_placement *placement = pl_arena_alloc(arena, 1, sizeof *placement);
  if (placement == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for an instant of the exposure");
  PL_TRY(pl_placement_at(scene, &request->placement, u, arena, placement));
  PL_TRY(pl_survey_place(scene, request, placement, arena, out));
  out->view.white_radiance = middle->white_radiance;
  out->view.display_white = middle->display_white;
  out->view.sensor = middle->sensor;
  out->view.blur_px = middle->blur_px;
  out->view.skew_px = middle->skew_px;
  out->view.sky = middle->sky;
  return lods ? pl_reflectance_lod_fit(&out->shot, arena, &out->view) : PL_OK;
}
