#include "annotate/surface_channels.h"

void pl_write_albedo(const pl_label_run *run, void *pixels) {
  const pl_camera *camera = &run->shot->rays.camera;
  const float spread = (float)(1.0 / fmax(camera->fx, camera->fy));
  float *out = pixels;
  for (size_t i = 0; i < run->count; i++) {
    pl_vertex vertex = pl_point_vertex(&run->points[i]);
    const pl_beam beam = {.direction = pl_vec3_unit(vertex.position), .spread = spread};
    /* Whatever the plan leaves out of the picture. */
    pl_vertex_shade(run->shot, &beam, PL_DETAIL_FULL, &vertex);
    out[3 * i] = vertex.surface.color.x;
    out[3 * i + 1] = vertex.surface.color.y;
    out[3 * i + 2] = vertex.surface.color.z;
  }
}
