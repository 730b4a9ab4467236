/* Parameters from maps, and those that the frame sets in their place. */
#include "render/regolith.h"

#include <string.h>

#include "geom/ellipsoid.h"
#include "render/body_albedo.h"
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

void pl_regolith_shade(const pl_shot_body *body, const pl_beam *beam, bool maps, pl_vertex *vertex,
                       float color[3]) {
  pl_surface *surface = &vertex->surface;
  const pl_regolith *given = &body->state->regolith;
  pl_regolith_texel texel[3] = {0};
  if (body->body->regolith_map != NULL) {
    read_map(body, beam, maps, vertex, texel);
    for (int k = 0; body->body->map == NULL && k < 3; k++)
      color[k] = texel[k].w;
  }
  surface->regolith = *given;
  const pl_raster_mix roughness = pl_body_roughness(body, beam, maps, vertex);
  for (int k = 0; k < 3; k++) {
    surface->regolith.band[k] = texel[k].band;
    pl_regolith_band_take(&given->band[k], &surface->regolith.band[k]);
    float *own = &surface->regolith.band[k].roughness_rad;
    *own = (float)pl_raster_mixed(roughness, (double)*own);
  }
}
