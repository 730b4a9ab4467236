/* Sensors that trace rays of their own: what they make of a chunk. */
#include "frame/scan.h"

#include <string.h>

#include "base/memory.h"
#include "frame/scan_trace.h"

static void copy3(const pl_vec3 v, double *out) {
  out[0] = v.x;
  out[1] = v.y;
  out[2] = v.z;
}

static void copy3f(const pl_vec3f v, float *out) {
  out[0] = v.x;
  out[1] = v.y;
  out[2] = v.z;
}

/* --- labels of rays --------------------------------------------------------------------------- */

static void blank_ray(const pl_scan_job *job, const pl_scan_labels *out, const pl_scan_ray *ray) {
  const size_t beam = ray->beam;
  pl_channels_blank(&job->instant->shot, 1, beam, out->channels);
  if (out->range_m != NULL)
    out->range_m[beam] = NAN;
  if (out->position != NULL)
    copy3((pl_vec3){NAN, NAN, NAN}, out->position + 3 * beam);
  if (out->normal != NULL)
    copy3f((pl_vec3f){NAN, NAN, NAN}, out->normal + 3 * beam);
  if (out->reflectance != NULL)
    out->reflectance[beam] = 0.0f;
  if (out->origin != NULL)
    copy3(pl_vec3_add(job->instant->shot.camera_position, ray->origin), out->origin + 3 * beam);
}

static void label_ray(const pl_scan_job *job, const pl_scan_labels *out, const pl_scan_chunk *chunk,
                      size_t i) {
  const pl_echo *echo = &chunk->echoes[i];
  const pl_vertex *point = &chunk->points[i];
  const pl_scan_ray *ray = &chunk->rays[echo->index];
  const size_t beam = ray->beam;
  const pl_point labelled = pl_point_of(point);
  pl_channels_write(&job->instant->shot, &labelled, 1, beam, out->channels);
  if (out->range_m != NULL)
    out->range_m[beam] = echo->range_m;
  if (out->position != NULL)
    copy3(pl_scan_position(job, ray, point), out->position + 3 * beam);
  if (out->normal != NULL)
    copy3f(pl_scan_vector(job, ray, point, point->surface.n), out->normal + 3 * beam);
  if (out->reflectance != NULL)
    out->reflectance[beam] = echo->reflectance;
}

static void take_labels(const pl_scan_job *job, pl_scan_chunk *chunk) {
  const pl_scan_labels *out = job->context;
  for (size_t i = 0; i < chunk->ray_count; i++)
    if (chunk->rays[i].beam != SIZE_MAX)
      blank_ray(job, out, &chunk->rays[i]);
  /* Of a ray that continues, the first surface counts, which comes first. */
  for (size_t i = 0; i < chunk->echo_count; i++)
    if (chunk->echoes[i].path == 0)
      label_ray(job, out, chunk, i);
}

pl_status pl_renderer_trace(pl_renderer *renderer, const pl_frame_request *request,
                            const pl_scan *scan, const pl_scan_labels *out) {
  if (scan->source.sub_rays != 1)
    return pl_fail(PL_E_ARGUMENT, "labels are of single rays: sub_rays must be 1, not %d",
                   scan->source.sub_rays);
  if (pl_channels_need(out->channels) != 0)
    return pl_fail(PL_E_ARGUMENT, "channels of shadows and of albedo are of pictures, not of rays");
  return pl_scan_run(renderer, request, scan, out->reflectance != NULL, take_labels, out);
}

/* --- LiDAR ------------------------------------------------------------------------------------ */

typedef struct lidar_job {
  const pl_lidar *lidar;
  pl_lidar_record *out;         /* a beam's returns at its number of slots */
  int instance, part, semantic; /* indices of channels */
} lidar_job;

static int channel_of(const char *name) {
  for (size_t i = 0; i < pl_channel_count; i++)
    if (strcmp(pl_channels[i].name, name) == 0)
      return (int)i;
  return -1;
}

static void write_labels(const pl_scan_job *job, const lidar_job *own, const pl_vertex *point,
                         pl_lidar_record *out) {
  void *channels[PL_FRAME_CHANNELS_MAX] = {NULL};
  channels[own->instance] = &out->instance;
  channels[own->part] = &out->part;
  channels[own->semantic] = out->semantic;
  const pl_point labelled = pl_point_of(point);
  pl_channels_write(&job->instant->shot, &labelled, 1, 0, channels);
}

static void write_return(const pl_scan_job *job, const lidar_job *own, const pl_scan_chunk *chunk,
                         const pl_scan_ray *axis, const pl_lidar_return *pulse,
                         pl_lidar_record *out) {
  const pl_echo *echo = &chunk->echoes[pulse->strongest];
  const pl_vec3 origin = pl_vec3_add(job->instant->shot.camera_position, axis->origin);
  *out = (pl_lidar_record){
      .time_s = axis->own.time_s,
      .range_m = pulse->range_m,
      .true_range_m = pulse->true_m,
      .intensity = (float)pulse->intensity,
      .reflectance = (float)pulse->reflectance,
      .incidence_rad = echo->incidence_rad,
      .beam = (int32_t)axis->beam,
      .line = axis->own.line,
      .return_number = (uint8_t)pulse->number,
      .return_count = (uint8_t)pulse->count,
      .path = echo->path,
  };
  copy3(origin, out->origin_m);
  copy3(axis->direction, out->direction);
  copy3(pl_vec3_madd(origin, pulse->range_m, axis->direction), out->position_m);
  copy3f(pl_vec3_to_float(axis->own.direction), out->sensor_direction);
  write_labels(job, own, &chunk->points[pulse->strongest], out);
}

/* The axis of a beam: its first ray, or with several the middle of all. */
static pl_scan_ray axis_of(const pl_scan_job *job, const pl_scan_chunk *chunk, size_t first) {
  pl_scan_ray axis = chunk->rays[first];
  if (job->scan->source.sub_rays == 1)
    return axis;
  job->scan->source.kind->ray(&job->scan->source, axis.beam, 0, &axis.own);
  pl_scan_place(job, &axis);
  return axis;
}

static void receive(const pl_scan_job *job, const lidar_job *own, pl_scan_chunk *chunk,
                    size_t first, size_t echoes) {
  const int slots = pl_lidar_slots(own->lidar);
  pl_lidar_return pulses[PL_LIDAR_RETURNS_MAX];
  const pl_scan_ray axis = axis_of(job, chunk, first);
  const int found = pl_lidar_receive(own->lidar, axis.beam, chunk->beam, echoes, pulses);
  for (int k = 0; k < found; k++)
    write_return(job, own, chunk, &axis, &pulses[k],
                 &own->out[axis.beam * (size_t)slots + (size_t)k]);
}

/* Collects the echoes of the beam whose rays begin at `first`. */
static size_t collect(const pl_scan_job *job, size_t first, pl_scan_chunk *chunk) {
  const size_t rays = (size_t)job->scan->source.sub_rays;
  size_t count = 0;
  for (size_t i = 0; i < chunk->echo_count; i++) {
    const pl_echo *echo = &chunk->echoes[i];
    if (echo->index >= first && echo->index < first + rays && echo->reflectance > 0.0f)
      chunk->beam[count++] =
          (pl_lidar_echo){echo->range_m, (double)echo->reflectance / (double)rays, (uint32_t)i};
  }
  return count;
}

static void take_lidar(const pl_scan_job *job, pl_scan_chunk *chunk) {
  const lidar_job *own = job->context;
  const size_t rays = (size_t)job->scan->source.sub_rays;
  for (size_t first = 0; first < chunk->ray_count; first += rays)
    receive(job, own, chunk, first, collect(job, first, chunk));
}

pl_status pl_renderer_lidar(pl_renderer *renderer, const pl_frame_request *request,
                            const pl_scan *scan, const pl_lidar *lidar, pl_lidar_record *out,
                            size_t *count) {
  PL_TRY(pl_lidar_check(lidar));
  PL_TRY(pl_ray_source_check(&scan->source));
  const size_t room = scan->source.kind->count(&scan->source) * (size_t)pl_lidar_slots(lidar);
  const lidar_job own = {lidar, out, channel_of("instance"), channel_of("part"),
                         channel_of("semantic")};
  for (size_t i = 0; i < room; i++)
    out[i].return_number = 0;
  PL_TRY(pl_scan_run(renderer, request, scan, true, take_lidar, &own));
  *count = 0;
  for (size_t i = 0; i < room; i++)
    if (out[i].return_number > 0)
      out[(*count)++] = out[i];
  return PL_OK;
}

/* --- time of flight --------------------------------------------------------------------------- */

typedef struct flight_job {
  const pl_time_of_flight *camera;
  pl_time_of_flight_pixel *out;
} flight_job;

static void take_flight(const pl_scan_job *job, pl_scan_chunk *chunk) {
  const flight_job *own = job->context;
  const size_t rays = (size_t)job->scan->source.sub_rays;
  pl_time_of_flight_echo echoes[PL_SUB_RAYS_MAX * PL_ECHO_DEPTH];
  for (size_t first = 0; first < chunk->ray_count; first += rays) {
    const size_t count = collect(job, first, chunk);
    const size_t pixel = chunk->rays[first].beam;
    for (size_t i = 0; i < count; i++)
      echoes[i] = (pl_time_of_flight_echo){
          chunk->beam[i].range_m, chunk->beam[i].reflectance,
          (uint64_t)pl_shot_slot(&job->instant->shot,
                                 chunk->points[chunk->beam[i].index].surface_id)};
    pl_time_of_flight_measure(own->camera, pixel, echoes, count, &own->out[pixel]);
  }
}

pl_status pl_renderer_time_of_flight(pl_renderer *renderer, const pl_frame_request *request,
                                     const pl_scan *scan, const pl_time_of_flight *camera,
                                     pl_time_of_flight_pixel *out) {
  const flight_job own = {camera, out};
  PL_TRY(pl_time_of_flight_check(camera));
  if (scan->source.kind != &pl_ray_source_pixels)
    return pl_fail(PL_E_ARGUMENT, "a time-of-flight camera has the rays of its pixels");
  return pl_scan_run(renderer, request, scan, true, take_flight, &own);
}
