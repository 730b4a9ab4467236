#include "annotate/surface_channels.h"

#include <string.h>

/* Everything that colours a surface, whatever the plan leaves out of the picture; nothing that only
 * bends or lights it. Graphs bend what they colour by it. */
static pl_detail detail_of_colors(void) {
  pl_detail detail = PL_DETAIL_FULL;
  detail.relief = detail.sub_cell = detail.lights = false;
  detail.color_only = true;
  return detail;
}

/* Sets what the colour of a vertex depends on; the rest stays as it is. */
static void set_vertex(const pl_point *p, pl_vertex *out) {
  out->position = p->position;
  out->t = p->t;
  out->surface_id = p->surface_id;
  out->triangle = p->triangle;
  memcpy(out->w, p->w, sizeof out->w);
  out->edge1 = p->edge1;
  out->edge2 = p->edge2;
  out->ng = p->ng;
  out->surface.n = p->n;
  out->surface.ng = p->facet;
}

/* Vertices are shaded together, as in a picture. */
void pl_write_albedo(const pl_label_run *run, void *pixels) {
  const pl_camera *camera = &run->shot->rays.camera;
  const float spread = (float)(1.0 / fmax(camera->fx, camera->fy));
  const pl_detail detail = detail_of_colors();
  pl_vertex vertices[PL_SHADE_RUN] = {0};
  pl_beam beams[PL_SHADE_RUN];
  pl_vertex_view views[PL_SHADE_RUN];
  float *out = pixels;
  for (size_t from = 0; from < run->count; from += PL_SHADE_RUN) {
    const size_t left = run->count - from, count = left < PL_SHADE_RUN ? left : PL_SHADE_RUN;
    for (size_t i = 0; i < count; i++) {
      set_vertex(&run->points[from + i], &vertices[i]);
      beams[i] = (pl_beam){.direction = pl_vec3_unit(vertices[i].position), .spread = spread};
      views[i] = (pl_vertex_view){&beams[i], &vertices[i]};
    }
    pl_vertex_shade_run(run->shot, detail, views, count);
    for (size_t i = 0; i < count; i++, out += 3) {
      out[0] = vertices[i].surface.color.x;
      out[1] = vertices[i].surface.color.y;
      out[2] = vertices[i].surface.color.z;
    }
  }
}
