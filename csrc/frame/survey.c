/* From placements to views. */
#include "frame/survey.h"

#include "frame/effects.h"
#include "plan/effects.h"
#include "render/reflectance_lod.h"
#include "scene/shutter.h"

pl_status pl_survey_place(const pl_scene *scene, const pl_frame_request *request,
                          const pl_placement *placement, pl_arena *arena, pl_survey *out) {
  PL_TRY(pl_snapshot_build(scene, placement, arena, &out->shot));
  PL_TRY(pl_snapshot_view(&out->shot, arena, &out->view));
  out->sky = (pl_frame_sky){.width = out->shot.rays.camera.width};
  out->view.samples = request->samples;
  out->view.target_dn = request->target_dn;
  out->view.max_bounces = request->max_bounces;
  out->view.texture_filter = request->texture_filter;
  out->view.volume_steps = request->volume_steps;
  return PL_OK;
}

pl_status pl_survey_at(const pl_scene *scene, const pl_frame_request *request, double u,
                       const pl_view *middle, pl_arena *arena, pl_survey *out) {
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
  return PL_OK;
}

pl_detail pl_plan_detail(const pl_plan *plan) {
  return (pl_detail){.maps = pl_plan_value(plan, &pl_effect_surface_maps) > 0,
                     .bumps = pl_plan_value(plan, &pl_effect_bump_detail) > 0,
                     .relief = pl_plan_value(plan, &pl_effect_relief) > 0,
                     .sub_cell = pl_plan_value(plan, &pl_effect_sub_cell_normals) > 0,
                     .texture_slopes = pl_plan_value(plan, &pl_effect_texture_slopes) > 0,
                     .glint = pl_plan_value(plan, &pl_effect_glint) > 0,
                     .lights = pl_plan_value(plan, &pl_effect_night_lights) > 0,
                     .rays = pl_plan_value(plan, &pl_effect_crater_rays) > 0,
                     .filter = (pl_filter)pl_plan_value(plan, &pl_effect_texture_filter)};
}

pl_status pl_survey_plan(pl_survey *survey, const pl_plan_wish *wish, bool colour, pl_arena *arena,
                         pl_plan *plan) {
  PL_TRY(pl_plan_solve(pl_effects, pl_effect_count, &survey->view, wish, plan));
  if (!colour)
    return PL_OK;
  PL_TRY(pl_reflectance_lod_fit(&survey->shot, pl_plan_detail(plan), arena, &survey->view));
  pl_plan_solve_again(&pl_effect_regolith, &survey->view, wish, plan);
  return PL_OK;
}

pl_status pl_survey_fit(pl_survey *survey, const pl_plan *plan, pl_arena *arena) {
  if (pl_plan_value(plan, &pl_effect_regolith) >= PL_VIEW_LODS - 1)
    return PL_OK;
  return pl_reflectance_lod_fit(&survey->shot, pl_plan_detail(plan), arena, &survey->view);
}
