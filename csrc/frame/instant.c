/* Makes an instant from a survey and a choice. */
#include "frame/instant.h"

#include "frame/height_fields.h"
#include "frame/subpixel_bodies.h"
#include "frame/effects.h"
#include "plan/effects.h"
#include "render/geometry.h"
#include "terrain/cube.h"

/* --- choices ---------------------------------------------------------------------------------- */

/* Rays that `coverage` casts in a pixel. */
static int label_rays_of(const pl_frame_request *request) {
  pl_instance_coverage coverage;
  return pl_instance_coverage_init(&request->coverage, request->channels, &coverage)
             ? request->coverage.samples
             : 0;
}

static pl_render_settings settings_of(const pl_frame_request *request,
                                      const pl_frame_result *result) {
  const pl_plan *plan = &result->plan;
  const int samples = pl_plan_value(plan, &pl_effect_antialiasing);
  const unsigned needs = pl_channels_need(request->channels);
  /* All samples in every pixel: if the effect is forced on by name, or at a tolerance of 0. */
  const bool exact = request->wish.tolerance_dn == 0.0;
  const bool all_by_name = pl_effect_set_has(&request->wish.force_on, PL_EFFECT_INDEX_antialiasing);
  const bool all_samples = exact || all_by_name;
  return (pl_render_settings){
      .seed = request->seed,
      .frame = request->index,
      .samples = samples > 0 ? samples : 1,
      .label_rays = label_rays_of(request),
      .bounces = pl_plan_value(plan, &pl_effect_bounces),
      .effects = pl_plan_values(plan),
      .detail = pl_plan_detail(plan),
      .shadow_mask = needs & PL_POINTS_SHADOWS,
      .shadow_cause = needs & PL_POINTS_SHADOW_CAUSES,
      .exact = exact,
      .pilot = request->pilot,
      .lods_down = PL_VIEW_LODS - 1 - pl_plan_value(plan, &pl_effect_regolith),
      .noise_dn = all_samples ? 0.0f : (float)request->wish.tolerance_dn,
      .target_dn = all_by_name ? 0.0f : (float)request->target_dn,
      .target_sigmas = (float)request->target_sigmas,
      .white_radiance = (float)result->whites[0],
      .white_other = (float)result->whites[1],
  };
}

/* Where the plan leaves no level out, meshes are as fine as each instant of the exposure asks. */
static int terrain_levels(const pl_plan *plan) {
  const pl_plan_row *row = pl_plan_row_of(plan, &pl_effect_terrain);
  if (row == NULL || row->value == 0)
    return 0;
  return row->residual_dn > 0.0 ? row->value : PL_CUBE_LEVELS;
}

pl_choice pl_choice_of_labels(const pl_choice *frame) {
  pl_choice labels = *frame;
  labels.colour = false;
  labels.settings.samples = 0;
  return labels;
}

pl_choice pl_choice_of_plan(const pl_frame_request *request, const pl_frame_result *result,
                            bool colour) {
  const pl_plan *plan = &result->plan;
  pl_choice out = {
      .settings = settings_of(request, result),
      .culls = true,
      .threads = request->threads,
      .cancel = request->cancel,
      .tolerance_dn = request->wish.tolerance_dn,
      .terrain_levels = terrain_levels(plan),
      .albedo = (pl_channels_need(request->channels) & PL_POINTS_ALBEDO) != 0,
      .colour = true,
      .subpixel = true,
  };
  for (size_t k = 0; k < pl_medium_kind_count; k++)
    out.media[k] = pl_plan_value(plan, pl_medium_kinds[k]->effect);
  return colour ? out : pl_choice_of_labels(&out);
}

/* Metering: most steps along rays through air, with an error of a few per cent; most values of the
 * rows of media and of emitters. */
enum { METER_AIR_STEPS = 6, METER_MEDIA = 4, METER_EMITTERS = 2 };

static int at_most(int value, int limit) { return value < limit ? value : limit; }

pl_choice pl_choice_of_metering(const pl_frame_request *request, const pl_plan *plan, int samples) {
  const pl_frame_result result = {.plan = *plan};
  pl_choice out = pl_choice_of_plan(request, &result, true);
  out.settings.samples = samples;
  out.settings.label_rays = 0;
  out.settings.exact = out.settings.pilot = false;
  out.settings.target_dn = 0.0f;
  out.settings.noise_dn = 0.0f;
  out.settings.shadow_mask = out.settings.shadow_cause = false;
  out.tolerance_dn = 0.0;
  out.subpixel = out.albedo = false;
  out.settings.effects.emitters = at_most(out.settings.effects.emitters, METER_EMITTERS);
  out.settings.effects.atmosphere = at_most(out.settings.effects.atmosphere, METER_AIR_STEPS);
  for (size_t k = 0; k < pl_medium_kind_count; k++)
    out.media[k] = at_most(out.media[k], METER_MEDIA);
  return out;
}

/* --- realising -------------------------------------------------------------------------------- */

/* Takes away what the choice leaves out of a camera. */
static void strip_camera(const pl_choice *choice, pl_camera *camera) {
  if (!choice->settings.effects.distortion)
    camera->lens = (pl_lens){0};
  if (!choice->settings.effects.depth_of_field)
    camera->aperture_m = 0.0;
}

static pl_status cull(const pl_survey *survey, const pl_choice *choice, pl_arena *arena,
                      pl_snapshot *out) {
  pl_snapshot placed = survey->shot;
  pl_culling culling = {.view = &survey->view, .tolerance_dn = choice->tolerance_dn};
  strip_camera(choice, &placed.rays.camera);
  *out = placed;
  if (choice->colour && choice->subpixel)
    PL_TRY(pl_subpixel_find(&placed, culling.view, choice->tolerance_dn, arena, &culling.subpixel));
  return choice->culls ? pl_snapshot_cull(&placed, &culling, arena, out) : PL_OK;
}

static pl_status add_air(const pl_choice *choice, pl_arena *arena, pl_instant *out) {
  if (choice->settings.effects.atmosphere == 0)
    return PL_OK;
  PL_TRY(pl_air_view_build(&out->shot, choice->settings.effects.atmosphere, arena, &out->air));
  out->air.skylight = choice->settings.effects.skylight > 0;
  out->air.multiple = choice->settings.effects.multiple_scattering > 0;
  out->settings.air = out->air.count > 0 ? &out->air : NULL;
  return PL_OK;
}

static pl_status add_media(const pl_choice *choice, pl_arena *arena, pl_instant *out) {
  bool any;
  PL_TRY(pl_media_build(&out->shot, choice->media, out->settings.air, arena, &out->media, &any));
  out->media.emitted_light = choice->settings.effects.emitted_light > 0;
  out->settings.media = any ? &out->media : NULL;
  return PL_OK;
}

static pl_status add_emitters(const pl_choice *choice, pl_arena *arena, pl_instant *out) {
  if (choice->settings.effects.emitters == 0)
    return PL_OK;
  PL_TRY(pl_emitters_build(&out->shot, out->settings.detail, arena, &out->emitters));
  out->settings.emitters = out->emitters.count > 0 ? &out->emitters : NULL;
  out->settings.emitters_on_bodies =
      out->emitters.count > 0 && choice->settings.effects.emitters > 1;
  return PL_OK;
}

static pl_status add_planetshine(const pl_choice *choice, pl_arena *arena, pl_instant *out) {
  if (!choice->settings.effects.planetshine || out->shot.body_count == 0)
    return PL_OK;
  PL_TRY(pl_planetshine_build(&out->shot, &out->settings, arena, &out->planetshine));
  out->settings.planetshine = out->planetshine.any ? &out->planetshine : NULL;
  return PL_OK;
}

static void add_caustics(const pl_choice *choice, pl_instant *out) {
  if (!choice->settings.effects.caustics || choice->settings.bounces == 0)
    return;
  pl_caustics_build(&out->shot, out->tracer, out->settings.detail, &out->caustics);
  out->settings.caustics = out->caustics.count > 0 ? &out->caustics : NULL;
}

/* Limb darkening also counts where the disc itself is in the frame, even if nothing is lit by it.
 */
static void add_limb(const pl_choice *choice, pl_instant *out) {
  if (!choice->settings.effects.limb_darkening ||
      !(choice->settings.effects.soft_sun || out->shot.sun.in_frame))
    return;
  out->limb = pl_limb_make(out->shot.sun.wavelengths_um);
  out->settings.limb = &out->limb;
}

pl_status pl_realise(pl_accelerators *kept, const pl_survey *survey, const pl_choice *choice,
                     pl_arena *arena, const pl_instant **out) {
  pl_instant *made = pl_arena_alloc(arena, 1, sizeof *made);
  if (made == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for an instant");
  made->settings = choice->settings;
  pl_work_add(PL_WORK_entities, survey->view.entity_count);
  PL_TRY(cull(survey, choice, arena, &made->shot));
  PL_TRY(pl_height_fields_place(kept, choice, arena, &made->shot));
  PL_TRY(pl_geometry_tracer(kept, &made->shot, arena, &made->tracer));
  if (choice->colour) {
    add_limb(choice, made);
    PL_TRY(add_emitters(choice, arena, made));
    PL_TRY(add_air(choice, arena, made));
    PL_TRY(add_media(choice, arena, made));
    PL_TRY(add_planetshine(choice, arena, made));
    add_caustics(choice, made);
  }
  *out = made;
  return PL_OK;
}
