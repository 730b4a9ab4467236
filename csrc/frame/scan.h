/* Rays that are no pixels: traces the rays of a source through the instants of a frame's time. What
 * the rays find is the same that the frame's labels are made of. */
#ifndef PL_FRAME_SCAN_H
#define PL_FRAME_SCAN_H

#include "frame/frame.h"
#include "scan/lidar.h"
#include "scan/time_of_flight.h"
#include "scene/ray_source.h"

enum { PL_SCAN_INSTANTS_MAX = 4096 };
/* Terrain is as fine as a beam is wide, or as this angle. */
#define PL_SCAN_PIXEL_RAD 1e-4

typedef struct pl_scan {
  pl_ray_source
      source; /* times are within the request's exposure; its camera is that of the request */
  /* Instants of the exposure. Each ray leaves at its own time and meets every surface where that is
   * then. Only articulated parts, the choice of the ground's tiles, and what mirrors and clear
   * walls lead to are those of the nearest instant. */
  int instants;
  int band; /* of colours that the sensor's light has, 0..2 */
} pl_scan;

/* What rays hit; arrays have an element per beam of the source, which must have one ray each. NULL:
 * not asked for. Channels are those of a picture of one row; blank where nothing is hit. */
typedef struct pl_scan_labels {
  void *channels[PL_FRAME_CHANNELS_MAX]; /* indexed as pl_channels; with a writer only */
  double *range_m;                       /* NAN where nothing is hit */
  double *origin, *position;             /* 3 each, root frame, m, at the ray's time */
  float *normal;                         /* 3, shading normal on the sensor's side, root axes */
  float *reflectance;                    /* see pl_echo */
} pl_scan_labels;
pl_status pl_renderer_trace(pl_renderer *renderer, const pl_frame_request *request,
                            const pl_scan *scan, const pl_scan_labels *out);

/* A return of a LiDAR. Root frame and axes; all at the time of its beam. */
typedef struct pl_lidar_record {
  double time_s, range_m, true_range_m;
  double origin_m[3], direction[3], position_m[3]; /* position: origin + range_m direction */
  float sensor_direction[3];
  float intensity, reflectance, incidence_rad;
  int32_t beam, line, instance, part;
  uint16_t semantic[PL_LEVELS_MAX];
  uint8_t return_number, return_count, path, unused[5];
} pl_lidar_record;

/* Scans with a LiDAR. `out` has room for all returns of all beams; *count is how many there are, in
 * the order of beams. */
pl_status pl_renderer_lidar(pl_renderer *renderer, const pl_frame_request *request,
                            const pl_scan *scan, const pl_lidar *lidar, pl_lidar_record *out,
                            size_t *count);
/* Returns of a beam that a record is kept for. */
static inline int pl_lidar_slots(const pl_lidar *lidar) {
  return lidar->keep == PL_LIDAR_ALL ? lidar->most : 1;
}

/* Takes a picture with a time-of-flight camera; arrays have an element per pixel. */
pl_status pl_renderer_time_of_flight(pl_renderer *renderer, const pl_frame_request *request,
                                     const pl_scan *scan, const pl_time_of_flight *camera,
                                     pl_time_of_flight_pixel *out);

#endif
