#include "annotate/flow.h"

#include <string.h>

#include "annotate/channel.h"
#include "annotate/clear_view.h"
#include "render/tile.h"

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

/* What the pixels of a row of a tile see, and where that is in another frame. */
typedef struct row {
  int x0, y, count;
  size_t at;              /* row-major index of the first pixel */
  bool any[PL_TILE_SIDE]; /* whether the pixel has a ray */
  pl_sight sights[PL_TILE_SIDE];
  pl_vec3 here[PL_TILE_SIDE]; /* points in camera axes */
} row;

/* Rays of a row that tell whether something hides what they lead to. */
typedef struct rays {
  size_t count;
  int x[PL_TILE_SIDE];
  bool meshes[PL_TILE_SIDE]; /* whether it may meet one */
  pl_sight_query queries[PL_TILE_SIDE];
} rays;

static uint8_t *hidden_of(const pl_flow *flow, pl_flow_to which) {
  return flow->images[which == PL_FLOW_NEXT ? PL_FLOW_OCCLUDED_FORWARD : PL_FLOW_OCCLUDED_BACKWARD];
}

/* Adds the ray to a sight at a point of the picture, unless the surface turns its other side. */
static void add_ray(const pl_sight_frame *to, const pl_sight *s, int x, const double pixel[2],
                    pl_sight_memo *memo, rays *rays) {
  rays->x[rays->count] = x;
  rays->meshes[rays->count] = pl_sight_may_meet_mesh(to, pixel);
  rays->count += pl_sight_look(to, s, memo, &rays->queries[rays->count]);
}

/* Writes a pixel of the images that lead to one frame. What a ray must tell of occlusion is added
 * to `rays`. */
static void write_pixel(const pl_flow *flow, pl_flow_to which, const row *row, int x,
                        pl_sight_memo *memo, rays *rays) {
  const pl_sight_frame *to = flow->frames[which];
  const pl_sight *s = &row->sights[x];
  const size_t at = row->at + (size_t)x;
  const double from[2] = {row->x0 + x, row->y};
  float *out = flow->images[which == PL_FLOW_NEXT ? PL_FLOW_FORWARD : PL_FLOW_BACKWARD];
  uint8_t *hidden = hidden_of(flow, which);
  float *moved = which == PL_FLOW_NEXT ? flow->images[PL_FLOW_SCENE] : NULL;
  double pixel[2] = {NAN, NAN};
  pl_vec3 there = {NAN, NAN, NAN};
  const bool exists = to != NULL && row->any[x] && pl_sight_is_there(to, s);
  const bool known = exists && pl_sight_project(to, s, memo, &there, pixel);
  for (size_t k = 0; out != NULL && k < 2; k++)
    out[2 * at + k] = known ? (float)(pixel[k] - from[k]) : NAN;
  if (hidden != NULL) {
    hidden[at] = true;
    if (known && pl_pixel_in_image(&to->shot->rays.camera, pixel))
      add_ray(to, s, x, pixel, memo, rays);
  }
  if (moved == NULL)
    return;
  const bool point = exists && s->is_point;
  moved[3 * at] = point ? (float)(there.x - row->here[x].x) : NAN;
  moved[3 * at + 1] = point ? (float)(there.y - row->here[x].y) : NAN;
  moved[3 * at + 2] = point ? (float)(there.z - row->here[x].z) : NAN;
}

/* Casts the rays. What a ray cannot meet is left out, but a packet that may meet a mesh keeps all
 * of its rays, since rounding depends on them. */
static void cast(const pl_sight_frame *to, const row *row, const rays *rays,
                 pl_hit hits[PL_TILE_SIDE]) {
  pl_ray asked[PL_TILE_SIDE];
  pl_bodies_near near;
  pl_bodies_near_find(to->shot, rays->queries, rays->count, &near);
  for (size_t i = 0; i < rays->count; i++) {
    asked[i] = rays->queries[i].ray;
    if (!pl_bodies_near_hide(to->shot, &near, &row->sights[rays->x[i]], &rays->queries[i]))
      asked[i].skip_body = PL_EVERY_ELLIPSOID;
  }
  for (size_t i = 0; i < rays->count; i += PL_TRACER_PACKET) {
    const size_t left = rays->count - i, count = left < PL_TRACER_PACKET ? left : PL_TRACER_PACKET;
    bool meshes = false;
    for (size_t k = i; k < i + count; k++)
      meshes |= rays->meshes[k];
    pl_tracer_closest(to->tracer, asked + i, hits + i, count, true, meshes);
  }
}

/* Writes which pixels of a row are hidden in another frame, as far as rays tell. */
static void trace(const pl_sight_frame *to, const row *row, const rays *rays, uint8_t *hidden) {
  pl_hit hits[PL_TILE_SIDE];
  cast(to, row, rays, hits);
  for (size_t i = 0; i < rays->count; i++) {
    const int x = rays->x[i];
    hidden[row->at + (size_t)x] =
        !pl_surface_is_none(pl_sight_hider(to, &row->sights[x], &rays->queries[i], &hits[i]));
  }
}

/* Finds what the pixels of a row see; `points` NULL: nothing is hit. */
static void look(const pl_snapshot *shot, const pl_point *points, pl_sight_memo *memo, row *out) {
  for (int x = 0; x < out->count; x++) {
    const bool hit = points != NULL && !pl_surface_is_none(points[x].surface_id);
    pl_sight *s = &out->sights[x];
    *s = hit ? pl_sight_of(shot, &points[x], memo)
             : pl_sight_towards(pl_snapshot_ray(shot, out->x0 + x, out->y));
    out->here[x] = hit ? pl_mat3_mul_vec_t(shot->camera_to_root, points[x].position)
                       : (pl_vec3){0.0, 0.0, 0.0};
    out->any[x] = hit || pl_vec3_dot(s->local, s->local) > 0.0;
  }
}

void pl_flow_write(const pl_flow *flow, const pl_snapshot *shot, const pl_point *points,
                   size_t stride, const int tile[4]) {
  pl_sight_memo here = {0}, memos[PL_FLOW_FRAMES] = {{0}};
  row row = {.x0 = tile[0], .count = tile[2]};
  for (int y = 0; y < tile[3]; y++) {
    row.y = tile[1] + y;
    row.at = (size_t)row.y * (size_t)shot->rays.camera.width + (size_t)row.x0;
    look(shot, points != NULL ? points + (size_t)y * stride : NULL, &here, &row);
    for (int to = 0; to < PL_FLOW_FRAMES; to++) {
      rays rays;
      rays.count = 0;
      for (int x = 0; flow->wanted[to] && x < row.count; x++)
        write_pixel(flow, (pl_flow_to)to, &row, x, &memos[to], &rays);
      if (rays.count > 0)
        trace(flow->frames[to], &row, &rays, hidden_of(flow, (pl_flow_to)to));
    }
  }
}
