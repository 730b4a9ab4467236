/* Reading maps of bodies where meridians meet. */
#include "shade/body_map.h"

/* A footprint over more of a turn of longitude than this is read in parts: about the poles a map's
 * rows are no straight lines. */
static const float POLAR_TURN = 0.125f;
enum { PARTS = 4, TAPS = 16 };

/* Shortens a part's extent along a row to what taps cover without a coarser level, which would mix
 * rows that the footprint does not touch. The other parts lie elsewhere around the pole. */
static void shorten(const pl_texture *map, float a[2], float b[2]) {
  int width, height, channels;
  pl_texture_size(map, &width, &height, &channels);
  const float rows = (float)height * (fabsf(a[1]) + fabsf(b[1]));
  const float columns = (float)width * (fabsf(a[0]) + fabsf(b[0]));
  const float most = (float)TAPS * (rows > 1.0f ? rows : 1.0f);
  if (!(columns > most))
    return;
  a[0] *= most / columns;
  b[0] *= most / columns;
}

static void read_polar(const pl_texture *map, const pl_body_place *place, pl_filter filter,
                       float out[4]) {
  const double part = 1.0 / PARTS;
  const pl_vec3 across = pl_vec3_scale(place->across, part);
  const pl_vec3 along = pl_vec3_scale(place->along, part);
  out[0] = out[1] = out[2] = out[3] = 0.0f;
  for (int i = 0; i < PARTS * PARTS; i++) {
    float uv[2], a[2], b[2], value[4];
    const double s = i % PARTS + 0.5 - 0.5 * PARTS, t = (double)(i / PARTS) + 0.5 - 0.5 * PARTS;
    const pl_vec3 point = pl_vec3_madd(pl_vec3_madd(place->point, s, across), t, along);
    pl_body_map_uv(point, place->center_lon_rad, across, along, uv, a, b);
    shorten(map, a, b);
    pl_texture_sample(map, uv[0], uv[1], a, b, filter, value);
    for (int c = 0; c < 4; c++)
      out[c] += value[c] / (float)(PARTS * PARTS);
  }
}

void pl_body_map_sample(const pl_texture *map, const pl_body_place *place, pl_filter filter,
                        float out[4]) {
  float uv[2], a[2], b[2];
  pl_body_map_uv(place->point, place->center_lon_rad, place->across, place->along, uv, a, b);
  if (filter != PL_FILTER_NONE && fabsf(a[0]) + fabsf(b[0]) > POLAR_TURN)
    read_polar(map, place, filter, out);
  else
    pl_texture_sample(map, uv[0], uv[1], a, b, filter, out);
}
