/* Chunks of a scan's rays, traced at one instant: shared by the sensors of frame/scan.h. */
#ifndef PL_FRAME_SCAN_TRACE_H
#define PL_FRAME_SCAN_TRACE_H

#include "frame/renderer.h"
#include "frame/scan.h"
#include "render/echo.h"

/* Rays of a chunk, and surfaces that these may meet. */
enum { PL_SCAN_RAYS = PL_TILE_PIXELS, PL_SCAN_ECHOES = PL_SCAN_RAYS };

/* A ray where and when it leaves. */
typedef struct pl_scan_ray {
  pl_sensor_ray own;
  pl_vec3 origin, direction; /* root axes; origin relative to the instant's camera, m */
  double u;                  /* fraction of the frame's time */
  size_t beam;               /* SIZE_MAX: of no beam, it only fills a packet */
} pl_scan_ray;

/* Memory of a worker. */
typedef struct pl_scan_chunk {
  pl_scan_ray rays[PL_SCAN_RAYS];
  size_t ray_count;
  pl_echo_ray ways[PL_SCAN_RAYS];
  pl_ray queries[PL_SCAN_RAYS];
  pl_hit hits[PL_SCAN_RAYS];
  /* What the rays met: vertices at the instant, moved with the surface. */
  pl_vertex points[PL_SCAN_ECHOES];
  pl_echo echoes[PL_SCAN_ECHOES];
  size_t echo_count;
  pl_lidar_echo beam[PL_SUB_RAYS_MAX * PL_ECHO_DEPTH];
} pl_scan_chunk;

/* What is constant for an instant. */
typedef struct pl_scan_job pl_scan_job;
typedef void (*pl_scan_fn)(const pl_scan_job *job, pl_scan_chunk *chunk);
struct pl_scan_job {
  const pl_scene *scene;
  const pl_frame_request *request;
  const pl_scan *scan;
  const pl_instant *instant;
  double u;            /* of the instant */
  bool moves;          /* something moves within the frame's time */
  bool tiled;          /* chunks are tiles of pixels, in packets as the labels of a frame */
  bool shades;         /* surfaces are shaded, and rays continue */
  const size_t *beams; /* of the instant */
  size_t beam_count;
  pl_scan_chunk *chunks; /* one per worker */
  pl_scan_fn take;       /* called once per chunk, on any thread */
  const void *context;   /* of `take` */
};

/* Traces all rays of a scan. `take` gets whole beams. `shades`: with the echoes of mirrors and
 * clear walls; without, one point per ray that hits something. */
pl_status pl_scan_run(pl_renderer *renderer, const pl_frame_request *request, const pl_scan *scan,
                      bool shades, pl_scan_fn take, const void *context);

/* Sets where a ray leaves, from `own`. */
void pl_scan_place(const pl_scan_job *job, pl_scan_ray *ray);

/* Position of the instant's vertex at the time of its ray, root frame; and a vector there. */
pl_vec3 pl_scan_position(const pl_scan_job *job, const pl_scan_ray *ray, const pl_vertex *vertex);
pl_vec3f pl_scan_vector(const pl_scan_job *job, const pl_scan_ray *ray, const pl_vertex *vertex,
                        pl_vec3f v);

#endif
