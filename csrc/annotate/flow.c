#include "annotate/flow.h"

#include <string.h>

#include "annotate/channel.h"

static const struct {
  const char *name;
  pl_flow_to to;
} images[PL_FLOW_IMAGES] = {
    [PL_FLOW_FORWARD] = {"flow", PL_FLOW_NEXT},
    [PL_FLOW_BACKWARD] = {"flow_backward", PL_FLOW_PREVIOUS},
    [PL_FLOW_OCCLUDED_FORWARD] = {"flow_occlusion", PL_FLOW_NEXT},
    [PL_FLOW_OCCLUDED_BACKWARD] = {"flow_occlusion_backward", PL_FLOW_PREVIOUS},
    [PL_FLOW_SCENE] = {"scene_flow", PL_FLOW_NEXT},
};

bool pl_flow_init(void *const *channels, pl_flow *out) {
  bool any = false;
  *out = (pl_flow){.frames = {NULL}};
  for (size_t i = 0; i < pl_channel_count; i++)
    for (size_t k = 0; k < PL_FLOW_IMAGES && channels[i] != NULL; k++)
      if (strcmp(pl_channels[i].name, images[k].name) == 0) {
        out->images[k] = channels[i];
        out->wanted[images[k].to] = any = true;
      }
  return any;
}

/* Writes a pixel of the images that lead to one frame; `at` is its row-major index, `here` the
 * point in camera axes. `s` NULL: the pixel has no ray. */
static void write_pixel(const pl_flow *flow, pl_flow_to which, const pl_sight *s, pl_vec3 here,
                        const double from[2], size_t at, pl_sight_memo *memo) {
  const pl_sight_frame *to = flow->frames[which];
  float *out = flow->images[which == PL_FLOW_NEXT ? PL_FLOW_FORWARD : PL_FLOW_BACKWARD];
  uint8_t *hidden =
      flow->images[which == PL_FLOW_NEXT ? PL_FLOW_OCCLUDED_FORWARD : PL_FLOW_OCCLUDED_BACKWARD];
  float *moved = which == PL_FLOW_NEXT ? flow->images[PL_FLOW_SCENE] : NULL;
  double pixel[2] = {NAN, NAN};
  pl_vec3 there = {NAN, NAN, NAN};
  const bool exists = to != NULL && s != NULL && pl_sight_is_there(to, s);
  const bool known = exists && pl_sight_project(to, s, memo, &there, pixel);
  for (size_t k = 0; out != NULL && k < 2; k++)
    out[2 * at + k] = known ? (float)(pixel[k] - from[k]) : NAN;
  if (hidden != NULL)
    hidden[at] = !known || !pl_pixel_in_image(&to->shot->rays.camera, pixel) ||
                 !pl_surface_is_none(pl_sight_hidden_by(to, s, memo));
  if (moved == NULL)
    return;
  const bool point = exists && s->is_point;
  moved[3 * at] = point ? (float)(there.x - here.x) : NAN;
  moved[3 * at + 1] = point ? (float)(there.y - here.y) : NAN;
  moved[3 * at + 2] = point ? (float)(there.z - here.z) : NAN;
}

void pl_flow_write(const pl_flow *flow, const pl_snapshot *shot, const pl_point *points,
                   size_t stride, const int tile[4]) {
  pl_sight_memo here_memo = {0}, memos[PL_FLOW_FRAMES] = {{0}};
  for (int y = 0; y < tile[3]; y++)
    for (int x = 0; x < tile[2]; x++) {
      const double from[2] = {tile[0] + x, tile[1] + y};
      const size_t at =
          (size_t)(tile[1] + y) * (size_t)shot->rays.camera.width + (size_t)(tile[0] + x);
      const pl_point *point = points != NULL ? &points[(size_t)y * stride + (size_t)x] : NULL;
      const bool hit = point != NULL && !pl_surface_is_none(point->surface_id);
      const pl_sight s = hit ? pl_sight_of(shot, point, &here_memo)
                             : pl_sight_towards(pl_snapshot_ray(shot, from[0], from[1]));
      const pl_vec3 here =
          hit ? pl_mat3_mul_vec_t(shot->camera_to_root, point->position) : (pl_vec3){0.0, 0.0, 0.0};
      const bool any = hit || pl_vec3_dot(s.local, s.local) > 0.0;
      for (int to = 0; to < PL_FLOW_FRAMES; to++)
        if (flow->wanted[to])
          write_pixel(flow, (pl_flow_to)to, any ? &s : NULL, here, from, at, &memos[to]);
    }
}
