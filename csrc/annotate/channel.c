/* Table of label channels. Labels are written in runs of pixels, with vectorised loops over each
 * run. */
#include "annotate/channel.h"

#include <string.h>

#include "annotate/ground_channels.h"
#include "annotate/surface_channels.h"
#include "base/wide.h"
#include "math/angle.h"

/* --- loops over the pixels of a run ----------------------------------------------------------- */

/* Component k of M^T v, i.e. of v in the axes that are the columns of M. */
#define COLUMN_DOT(m, k, x, y, z) ((m).row[0].k * (x) + (m).row[1].k * (y) + (m).row[2].k * (z))

/* Component along the third column of m. */
PL_WIDE static void fill_third(size_t count, const double (*restrict v)[PL_LABEL_RUN], pl_mat3 m,
                               float *restrict out) {
  for (size_t i = 0; i < count; i++)
    out[i] = (float)COLUMN_DOT(m, z, v[0][i], v[1][i], v[2][i]);
}

PL_WIDE static void fill_norm(size_t count, const double (*restrict v)[PL_LABEL_RUN],
                              float *restrict out) {
  for (size_t i = 0; i < count; i++)
    out[i] = (float)sqrt(v[0][i] * v[0][i] + v[1][i] * v[1][i] + v[2][i] * v[2][i]);
}

/* M^T (v - origin), three numbers per pixel. */
PL_WIDE static void fill_turned(size_t count, const double (*restrict v)[PL_LABEL_RUN],
                                pl_vec3 origin, pl_mat3 m, float *restrict out) {
  for (size_t i = 0; i < count; i++) {
    const double x = v[0][i] - origin.x, y = v[1][i] - origin.y, z = v[2][i] - origin.z;
    out[3 * i] = (float)COLUMN_DOT(m, x, x, y, z);
    out[3 * i + 1] = (float)COLUMN_DOT(m, y, x, y, z);
    out[3 * i + 2] = (float)COLUMN_DOT(m, z, x, y, z);
  }
}

PL_WIDE static void fill_moved(size_t count, const double (*restrict v)[PL_LABEL_RUN], pl_vec3 by,
                               double *restrict out) {
  for (size_t i = 0; i < count; i++) {
    out[3 * i] = by.x + v[0][i];
    out[3 * i + 1] = by.y + v[1][i];
    out[3 * i + 2] = by.z + v[2][i];
  }
}

PL_WIDE static void fill_angle(size_t count, const double (*restrict a)[PL_LABEL_RUN],
                               const double (*restrict b)[PL_LABEL_RUN], float *restrict out) {
  for (size_t i = 0; i < count; i++)
    out[i] = (float)pl_vec3_angle((pl_vec3){a[0][i], a[1][i], a[2][i]},
                                  (pl_vec3){b[0][i], b[1][i], b[2][i]});
}

/* --- the channels ----------------------------------------------------------------------------- */

/* Camera axes: x right, y down, z forward. */
static void write_depth(const pl_label_run *run, void *pixels) {
  fill_third(run->count, run->position, run->shot->camera_to_root, pixels);
}

static void write_range(const pl_label_run *run, void *pixels) {
  fill_norm(run->count, run->position, pixels);
}

static void write_normal(const pl_label_run *run, void *pixels) {
  fill_turned(run->count, run->normal, (pl_vec3){0.0, 0.0, 0.0}, run->shot->camera_to_root, pixels);
}

static void write_geometric_normal(const pl_label_run *run, void *pixels) {
  fill_turned(run->count, run->facet, (pl_vec3){0.0, 0.0, 0.0}, run->shot->camera_to_root, pixels);
}

static void write_position(const pl_label_run *run, void *pixels) {
  fill_moved(run->count, run->position, run->shot->camera_position, pixels);
}

static void write_object_coords(const pl_label_run *run, void *pixels) {
  fill_turned(run->count, run->position, run->label.origin, run->label.rotation, pixels);
}

/* Classes by graphs replace the part's. */
static void classify(const pl_label_run *run, uint16_t *out) {
  const pl_geometry_kind *kind = pl_geometry_of(run->surface_id);
  for (size_t i = 0; i < run->count; i++) {
    pl_vertex vertex = pl_point_vertex(&run->points[i]);
    const pl_beam beam = {.direction = pl_vec3_unit(vertex.position)};
    kind->classify(run->shot, &beam, &vertex, out + i * (size_t)run->shot->levels);
  }
}

static void write_semantic(const pl_label_run *run, void *pixels) {
  const size_t levels = (size_t)run->shot->levels;
  uint16_t *out = pixels;
  for (size_t level = 0; level < levels; level++)
    for (size_t i = 0; i < run->count; i++)
      out[i * levels + level] = run->label.class_ids[run->parts[i] * levels + level];
  if (run->label.classified)
    classify(run, out);
  const pl_ground_labels *ground = &run->label.on_ground;
  if (!ground->apart)
    return;
  for (size_t i = 0; i < run->count; i++) {
    uint16_t *at = out + i * levels + (size_t)ground->level;
    if (ground->rock != 0)
      *at = ground->rock;
    else if (run->craters[i] != 0 && ground->crater != 0)
      *at = ground->crater;
  }
}

static void write_part(const pl_label_run *run, void *pixels) {
  int32_t *out = pixels;
  for (size_t i = 0; i < run->count; i++)
    out[i] = run->label.part_ids[run->parts[i]];
}

static void write_instance(const pl_label_run *run, void *pixels) {
  int32_t *out = pixels;
  for (size_t i = 0; i < run->count; i++)
    out[i] = run->label.instance_id;
}

static void write_incidence(const pl_label_run *run, void *pixels) {
  fill_angle(run->count, run->normal, run->to_sun, pixels);
}

static void write_emission(const pl_label_run *run, void *pixels) {
  fill_angle(run->count, run->normal, run->to_viewer, pixels);
}

static void write_phase(const pl_label_run *run, void *pixels) {
  fill_angle(run->count, run->to_viewer, run->to_sun, pixels);
}

static void write_shadow(const pl_label_run *run, void *pixels) {
  uint8_t *out = pixels;
  for (size_t i = 0; i < run->count; i++)
    out[i] = run->points[i].in_shadow;
}

static void write_shadow_cause(const pl_label_run *run, void *pixels) {
  uint8_t *out = pixels;
  for (size_t i = 0; i < run->count; i++)
    out[i] = run->points[i].shadow_cause;
}

const pl_channel pl_channels[] = {
    {"depth", "float32", 4, 0, "m", "z along the optical axis; 0 where nothing is hit",
     PL_BLANK_ZERO, write_depth},
    {"range", "float32", 4, 0, "m", "distance along the ray; 0 where nothing is hit", PL_BLANK_ZERO,
     write_range},
    {"normal", "float32", 4, 3, "1",
     "unit shading normal (interpolated between vertices), camera axes, less than 90 degrees from "
     "the "
     "viewer; 0 where nothing is hit",
     PL_BLANK_ZERO, write_normal},
    {"geometric_normal", "float32", 4, 3, "1",
     "unit normal of the triangle or ellipsoid itself on the viewer's side, camera axes; 0 where "
     "nothing is hit",
     PL_BLANK_ZERO, write_geometric_normal},
    {"position", "float64", 8, 3, "m", "root frame; nan where nothing is hit", PL_BLANK_NAN,
     write_position},
    {"object_coords", "float32", 4, 3, "m",
     "coordinates in the object's or body's own frame; nan where nothing is hit", PL_BLANK_NAN,
     write_object_coords},
    {"semantic", "uint16", 2, -1, "id", "class at each level; 0 is background", PL_BLANK_ZERO,
     write_semantic},
    {"part", "int32", 4, 0, "id", "part of an object, or the body; 0 is background", PL_BLANK_ZERO,
     write_part},
    {"instance", "int32", 4, 0, "id", "object or body; 0 is background", PL_BLANK_ZERO,
     write_instance},
    {"incidence", "float32", 4, 0, "rad", "shading normal to sun; nan where nothing is hit",
     PL_BLANK_NAN, write_incidence},
    {"emission", "float32", 4, 0, "rad", "shading normal to viewer; nan where nothing is hit",
     PL_BLANK_NAN, write_emission},
    {"phase", "float32", 4, 0, "rad", "viewer to sun at the surface; nan where nothing is hit",
     PL_BLANK_NAN, write_phase},
    {"shadow", "uint8", 1, 0, "1",
     "1 where the surface does not see the sun's centre: it faces away, or something is between; 0 "
     "where it does, and where nothing is hit",
     PL_BLANK_ZERO, write_shadow},
    {"shadow_cause", "uint8", 1, 0, "id",
     "why shadow is 1, by what the sun's light meets first: 1 the surface itself, which faces away "
     "or hides the sun from itself, 2 another spacecraft, 3 a body without terrain, 4 terrain or "
     "its rocks; 0 where shadow is 0",
     PL_BLANK_ZERO, write_shadow_cause},
    {"coverage", "float32", 4, PL_COMPONENTS_LAYERS, "1",
     "parts of the pixel's area in which instances are seen, the largest first; 0 in layers that "
     "are not used",
     PL_BLANK_ZERO, NULL},
    {"coverage_instance", "int32", 4, PL_COMPONENTS_LAYERS, "id",
     "instances that the layers of coverage belong to; 0 in layers that are not used, -1 in the "
     "last one where it holds all instances that have no layer of their own",
     PL_BLANK_ZERO, NULL},
    {"cloud_opacity", "float32", 4, 0, "1",
     "part of the light from beyond, on the ray through the pixel's centre, that clouds take out "
     "of "
     "it; 0 where there are none, and before them",
     PL_BLANK_ZERO, NULL},
    {"albedo", "float32", 4, 3, "1",
     "base colour of the surface as materials and maps state it, over the pixel's footprint, "
     "linear: of matt surfaces their albedo, of metals their colour, of Hapke's law the "
     "single-scattering albedo; 0 where nothing is hit",
     PL_BLANK_ZERO, pl_write_albedo},
    {"elevation", "float32", 4, 0, "m",
     "height of the ground over the body's ellipsoid, along the radius; nan off the ground",
     PL_BLANK_NAN, pl_write_elevation},
    {"altitude", "float32", 4, 0, "m",
     "height of the camera over the point that is seen, along the radius; nan off the ground",
     PL_BLANK_NAN, pl_write_altitude},
    {"slope", "float32", 4, 0, "rad",
     "shading normal of the ground to its vertical, the radius; nan off the ground", PL_BLANK_NAN,
     pl_write_slope},
    {"slope_sobel", "float32", 4, 0, "rad",
     "slope from Sobel gradients of the elevation in view; nan off the ground and beside anything "
     "else, at the picture's edge too",
     PL_BLANK_NAN, NULL},
    {"roughness_laplacian", "float32", 4, 0, "m",
     "size of the Laplacian (four neighbours) of the elevation in view; nan as slope_sobel",
     PL_BLANK_NAN, NULL},
    {"slope_baseline", "float32", 4, PL_COMPONENTS_BASELINES, "rad",
     "slope of the ground itself at each baseline; nan off bodies with terrain", PL_BLANK_NAN,
     NULL},
    {"rms_height", "float32", 4, PL_COMPONENTS_BASELINES, "m",
     "RMS height of the ground over its plane at each baseline; nan off bodies with terrain",
     PL_BLANK_NAN, NULL},
    {"hazard", "uint8", 1, 0, "bits",
     "why a lander cannot stand here: 1 slope, 2 roughness, 4 rocks; 0 where it can, 128 off "
     "bodies "
     "with terrain",
     PL_BLANK_ZERO, NULL},
    {"rock_id", "int64", 8, 0, "id", "rock on the ground; 0 where there is none", PL_BLANK_ZERO,
     pl_write_rock_id},
    {"crater_id", "int64", 8, 0, "id",
     "smallest crater of the ground whose rim encloses the point, below 0 for those of a "
     "catalogue; 0 where there is none, and on "
     "rocks",
     PL_BLANK_ZERO, pl_write_crater_id},
    {"ground_mask", "int32", 4, 0, "id",
     "number of the ground in terrain.mask at the point; 0 where there is none", PL_BLANK_ZERO,
     pl_write_ground_mask},
    {"flow", "float32", 4, 2, "px",
     "from the pixel to where the next frame sees the same point: right, down; of the sky by the "
     "camera's rotation; nan where it has no image there, or there is no next frame in the scene",
     PL_BLANK_NAN, NULL},
    {"flow_backward", "float32", 4, 2, "px",
     "the same to the previous frame; nan where there is none", PL_BLANK_NAN, NULL},
    {"flow_occlusion", "uint8", 1, 0, "1",
     "0 where the next frame sees the same point; 1 where something hides it there, it turns away, "
     "lies outside of the picture, or flow is nan",
     PL_BLANK_ZERO, NULL},
    {"flow_occlusion_backward", "uint8", 1, 0, "1", "the same in the previous frame", PL_BLANK_ZERO,
     NULL},
    {"scene_flow", "float32", 4, 3, "m",
     "the point in the axes of the next frame's camera, less that in those of this one; nan where "
     "nothing is hit, or there is no next frame in the scene",
     PL_BLANK_NAN, NULL},
};
const size_t pl_channel_count = sizeof pl_channels / sizeof pl_channels[0];

size_t pl_channel_elements(const pl_channel *channel, int many) {
  if (channel->components < 0)
    return (size_t)many;
  return channel->components == 0 ? 1 : (size_t)channel->components;
}

/* --- runs ------------------------------------------------------------------------------------- */

/* Returns the address of pixel `first` in the image of a channel; *bytes is the size of a pixel. */
static void *place(const pl_channel *channel, const pl_snapshot *shot, size_t first, void *image,
                   size_t *bytes) {
  *bytes = pl_channel_elements(channel, shot->levels) * channel->element;
  return (unsigned char *)image + first * *bytes;
}

static void fill_blank(const pl_channel *channel, void *pixels, size_t bytes) {
  if (channel->blank == PL_BLANK_ZERO) {
    memset(pixels, 0, bytes);
  } else if (channel->element == sizeof(double)) {
    double *out = pixels;
    for (size_t i = 0; i < bytes / sizeof(double); i++)
      out[i] = NAN;
  } else {
    float *out = pixels;
    for (size_t i = 0; i < bytes / sizeof(float); i++)
      out[i] = NAN;
  }
}

void pl_channels_blank(const pl_snapshot *shot, size_t count, size_t first, void *const *images) {
  for (size_t i = 0; i < pl_channel_count; i++) {
    size_t bytes;
    if (images[i] == NULL || pl_channels[i].write == NULL)
      continue;
    void *out = place(&pl_channels[i], shot, first, images[i], &bytes);
    fill_blank(&pl_channels[i], out, bytes * count);
  }
}

/* Number of the area of a body at a point of a run, from its direction in body axes. */
static uint32_t area_at(const pl_label_run *run, size_t i) {
  const pl_geometry_label *label = &run->label;
  const pl_vec3 point = {run->position[0][i], run->position[1][i], run->position[2][i]};
  const pl_vec3 from = pl_vec3_sub(point, label->origin);
  return pl_area_map_at(label->areas, pl_mat3_mul_vec_t(label->rotation, from));
}

static void find_parts(const pl_point *points, pl_label_run *run) {
  const pl_object *parts = run->label.parts;
  run->points = points;
  for (size_t i = 0; i < run->count; i++)
    run->parts[i] = parts != NULL              ? pl_object_part(parts, points[i].triangle)
                    : run->label.areas != NULL ? area_at(run, i)
                                               : 0;
}

static void gather(const pl_point *points, pl_label_run *run) {
  for (size_t i = 0; i < run->count; i++) {
    const pl_vec3 p = points[i].position;
    const pl_vec3f n = points[i].n, facet = points[i].facet;
    run->position[0][i] = p.x;
    run->position[1][i] = p.y;
    run->position[2][i] = p.z;
    run->normal[0][i] = n.x;
    run->normal[1][i] = n.y;
    run->normal[2][i] = n.z;
    run->facet[0][i] = facet.x;
    run->facet[1][i] = facet.y;
    run->facet[2][i] = facet.z;
  }
  const pl_vec3 sun = run->shot->sun.position;
  const double to[3] = {sun.x, sun.y, sun.z};
  for (size_t k = 0; k < 3; k++)
    for (size_t i = 0; i < run->count; i++) {
      run->to_sun[k][i] = to[k] - run->position[k][i];
      run->to_viewer[k][i] = -run->position[k][i];
    }
  find_parts(points, run);
}

/* Returns the number of leading pixels with the same surface id, at most `count`. */
static size_t length_of(const pl_point *points, size_t count) {
  size_t length = 1;
  while (length < count && pl_surface_same(points[length].surface_id, points[0].surface_id))
    length++;
  return length;
}

static bool asks_for(void (*write)(const pl_label_run *, void *), void *const *images) {
  for (size_t i = 0; i < pl_channel_count; i++)
    if (images[i] != NULL && pl_channels[i].write == write)
      return true;
  return false;
}

unsigned pl_channels_need(void *const *images) {
  unsigned needs = 0;
  if (asks_for(write_shadow, images))
    needs |= PL_POINTS_SHADOWS;
  if (asks_for(write_shadow_cause, images))
    needs |= PL_POINTS_SHADOWS | PL_POINTS_SHADOW_CAUSES;
  if (asks_for(pl_write_albedo, images))
    needs |= PL_POINTS_ALBEDO;
  return needs;
}

void pl_channels_write(const pl_snapshot *shot, const pl_point *points, size_t count, size_t first,
                       void *const *images) {
  pl_label_run run;
  run.shot = shot;
  memset(run.craters, 0, sizeof run.craters);
  const bool asked = asks_for(pl_write_crater_id, images),
             classes = asks_for(write_semantic, images);
  for (size_t x = 0; x < count; x += run.count) {
    const size_t left = count - x;
    run.count = length_of(points + x, left < PL_LABEL_RUN ? left : PL_LABEL_RUN);
    const pl_surface_id id = points[x].surface_id;
    if (pl_surface_is_none(id)) {
      pl_channels_blank(shot, run.count, first + x, images);
      continue;
    }
    run.surface_id = id;
    pl_geometry_of(id)->label(shot, id, &run.label);
    gather(points + x, &run);
    if (asked || (classes && run.label.on_ground.crater != 0))
      pl_find_craters(&run);
    for (size_t i = 0; i < pl_channel_count; i++) {
      size_t bytes;
      if (images[i] != NULL && pl_channels[i].write != NULL)
        pl_channels[i].write(&run, place(&pl_channels[i], shot, first + x, images[i], &bytes));
    }
  }
}
