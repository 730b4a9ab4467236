/* Parameters from maps, and those that the frame sets in their place. */
#include "render/regolith.h"

#include <string.h>

#include "geom/ellipsoid.h"
#include "shade/body_map.h"

/* Reads the map at a vertex. */
static void read_map(const pl_shot_body *body, const pl_beam *beam, bool maps,
                     const pl_vertex *vertex, pl_regolith_texel out[3]) {
  const pl_grid *map = body->body->regolith_map;
  if (!maps) {
    memcpy(out, pl_grid_mean(map), 3 * sizeof *out);
    return;
  }
  const pl_vec3 local =
      pl_mat3_mul_vec_t(body->rotation, pl_vec3_sub(vertex->position, body->center));
  const double cosine = fabs(pl_vec3_dot(beam->direction, pl_vec3f_to_double(vertex->ng)));
  const double width = (double)beam->width_m + (double)beam->spread * vertex->t;
  double lon, lat;
  const double oblate = body->body->geodetic ? pl_body_map_oblate(body->state->radii_m) : 0.0;
  pl_ellipsoid_lon_lat(pl_body_map_stretch(local, oblate), &lon, &lat);
  /* A circle with the area of the pixel's ellipse on the ground. */
  pl_grid_sample(map, lon, lat, width / (body->radius_m * sqrt(fmax(cosine, 0.02))), (float *)out);
}

static float times(float factor, float value) { return pl_minf(factor * value, 1.0f); }

void pl_regolith_shade(const pl_shot_body *body, const pl_beam *beam, bool maps,
                       pl_vertex *vertex) {
  pl_surface *surface = &vertex->surface;
  const pl_regolith *given = &body->state->regolith;
  const float *albedo = body->state->albedo;
  pl_regolith_texel texel[3] = {0};
  if (body->body->regolith_map != NULL) {
    read_map(body, beam, maps, vertex, texel);
    if (body->body->map == NULL)
      surface->color = pl_vec3f_make(times(albedo[0], texel[0].w), times(albedo[1], texel[1].w),
                                     times(albedo[2], texel[2].w));
  }
  surface->regolith = *given;
  for (int k = 0; k < 3; k++) {
    surface->regolith.band[k] = texel[k].band;
    pl_regolith_band_take(&given->band[k], &surface->regolith.band[k]);
  }
}
