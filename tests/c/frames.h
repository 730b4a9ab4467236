/* Frames of test stages with memory for every output. */
#ifndef PL_TESTS_FRAMES_H
#define PL_TESTS_FRAMES_H

#include <stdlib.h>

#include "frame/effects.h"
#include "frame/frame.h"
#include "scenes.h"

/* Outputs of one frame: one block, so that two frames compare with memcmp. */
typedef struct film {
  size_t pixels, bytes;
  unsigned char *memory; /* owned; malloc, so that the allocation hook does not see it */
  uint8_t *rgb;
  float *radiance;
  void *channels[PL_FRAME_CHANNELS_MAX];
  pl_object_label *objects;
  uint8_t *masks;
} film;

static inline void *film_take(film *f, size_t *used, size_t bytes) {
  void *at = f->memory == NULL ? NULL : f->memory + *used;
  *used += (bytes + 63) / 64 * 64;
  return at;
}

static inline size_t film_lay_out(film *f, const stage *s) {
  size_t used = 0;
  f->rgb = film_take(f, &used, 3 * f->pixels);
  f->radiance = film_take(f, &used, 3 * f->pixels * sizeof(float));
  for (size_t i = 0; i < pl_channel_count; i++)
    f->channels[i] = film_take(f, &used,
                               f->pixels * pl_channels[i].element *
                                   pl_channel_elements(&pl_channels[i], s->scene.levels));
  f->objects = film_take(f, &used, s->scene.object_count * sizeof(pl_object_label));
  f->masks = film_take(f, &used, s->scene.object_count * f->pixels);
  return used;
}

static inline void film_init(film *f, const stage *s) {
  *f = (film){.pixels = (size_t)s->placement.camera.width * (size_t)s->placement.camera.height};
  f->bytes = film_lay_out(f, s);
  f->memory = calloc(1, f->bytes);
  assert_non_null(f->memory);
  film_lay_out(f, s);
}
static inline void film_clear(film *f) { free(f->memory); }

static inline const void *film_channel(const film *f, const char *name) {
  for (size_t i = 0; i < pl_channel_count; i++)
    if (strcmp(pl_channels[i].name, name) == 0)
      return f->channels[i];
  fail_msg("no channel '%s'", name);
  return NULL;
}

/* Everything asked for; white is a sunlit white surface at 1 AU; one thread. */
static inline pl_frame_request request_all(const stage *s, const film *f) {
  pl_frame_request request = {
      .seed = 1,
      .placement = s->placement,
      .samples = 16,
      .max_bounces = 3,
      .texture_filter = PL_FILTER_FINEST,
      .volume_steps = 16,
      .wish = {.tolerance_dn = 0.5},
      .exposure = {.white_radiance = 1361.0 / PL_PI},
      .threads = 1,
      .rgb = f->rgb,
      .radiance = f->radiance,
      .objects = f->objects,
      .masks = f->masks,
      .amodal = true,
      .ground = {.baselines_m = {10.0, 40.0}, /* as many as levels: pl_channel_elements */
                 .baseline_count = 2,
                 .disc_points = 16,
                 .hazard = {5.0, 0.2, 0.1, 0.3}},
      .coverage = {.samples = 4, .layers = 2}, /* likewise */
  };
  for (size_t i = 0; i < pl_channel_count; i++)
    request.channels[i] = f->channels[i];
  return request;
}

static inline pl_frame_result render(pl_renderer *renderer, const pl_frame_request *request) {
  pl_frame_result result;
  const pl_status status = pl_renderer_frame(renderer, request, &result);
  if (status != PL_OK)
    fail_msg("%s: %s", pl_status_name(status), pl_error_text());
  return result;
}

static inline void add_effect(pl_effect_set *set, const char *name) {
  const int index = pl_effect_find(name);
  assert_true(index >= 0);
  pl_effect_set_add(set, (size_t)index);
}
static inline pl_effect_set no_effects(void) { return (pl_effect_set){0}; }
static inline pl_effect_set one_effect(const char *name) {
  pl_effect_set set = {0};
  add_effect(&set, name);
  return set;
}
static inline pl_effect_set two_effects(const char *name, const char *other) {
  pl_effect_set set = one_effect(name);
  add_effect(&set, other);
  return set;
}
static inline pl_effect_set effects_without(pl_effect_set set, pl_effect_set left_out) {
  for (size_t i = 0; i < sizeof set.words / sizeof set.words[0]; i++)
    set.words[i] &= ~left_out.words[i];
  return set;
}
static inline pl_effect_set all_effects(void) {
  pl_effect_set set = {0};
  for (size_t i = 0; i < pl_effect_count; i++)
    pl_effect_set_add(&set, i);
  return set;
}
static inline pl_effect_set all_effects_but(const char *name) {
  return effects_without(all_effects(), one_effect(name));
}

#endif
