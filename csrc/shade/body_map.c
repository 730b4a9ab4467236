/* Sampling of maps of bodies, including at the poles. */
#include "shade/body_map.h"

/* A footprint that spans more than this part of a turn of longitude is sampled in parts: near the
 * poles, rows of the map are not straight lines. */
static const float POLAR_TURN = 0.125f;
enum { PARTS = 4, TAPS = 16 }; /* PARTS: per side of the footprint, PL_BODY_MAP_PARTS in all */

/* Limits the extent of a part along a row to the length that TAPS reads cover: a coarser mip level
 * would mix in rows outside the footprint. The other parts cover the other longitudes around the
 * pole. */
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

static bool is_polar(const float a[2], const float b[2], pl_filter filter) {
  return filter != PL_FILTER_NONE && fabsf(a[0]) + fabsf(b[0]) > POLAR_TURN;
}

static pl_body_place part_of(const pl_body_place *place, int i) {
  const double s = i % PARTS + 0.5 - 0.5 * PARTS, t = (double)(i / PARTS) + 0.5 - 0.5 * PARTS;
  const double part = 1.0 / PARTS;
  const pl_vec3 across = pl_vec3_scale(place->across, part);
  const pl_vec3 along = pl_vec3_scale(place->along, part);
  return (pl_body_place){pl_vec3_madd(pl_vec3_madd(place->point, s, across), t, along), across,
                         along, place->center_lon_rad, 0.0};
}

/* Converts the place to the map's latitudes; unchanged for planetocentric maps. */
static pl_body_place stretched(const pl_body_place *place) {
  const double oblate = place->oblate;
  return oblate == 0.0 ? *place
                       : (pl_body_place){pl_body_map_stretch(place->point, oblate),
                                         pl_body_map_stretch(place->across, oblate),
                                         pl_body_map_stretch(place->along, oblate),
                                         place->center_lon_rad, 0.0};
}

int pl_body_map_split(const pl_body_place *given, pl_filter filter,
                      pl_body_place parts[PL_BODY_MAP_PARTS]) {
  float a[2], b[2];
  const pl_body_place place = stretched(given);
  const pl_body_spot spot = pl_body_spot_of(place.point);
  pl_body_map_step(&spot, place.across, a);
  pl_body_map_step(&spot, place.along, b);
  if (!is_polar(a, b, filter)) {
    parts[0] = place;
    return 1;
  }
  for (int i = 0; i < PL_BODY_MAP_PARTS; i++)
    parts[i] = part_of(&place, i);
  return PL_BODY_MAP_PARTS;
}

void pl_body_map_read(const pl_texture *map, const pl_body_place *part, bool of_many,
                      pl_filter filter, float out[4]) {
  float uv[2], a[2], b[2];
  pl_body_map_uv(part->point, part->center_lon_rad, part->across, part->along, uv, a, b);
  if (of_many)
    shorten(map, a, b);
  pl_texture_sample(map, uv[0], uv[1], a, b, filter, out);
}

static void read_polar(const pl_texture *map, const pl_body_place *place, pl_filter filter,
                       float out[4]) {
  out[0] = out[1] = out[2] = out[3] = 0.0f;
  for (int i = 0; i < PL_BODY_MAP_PARTS; i++) {
    float value[4];
    const pl_body_place part = part_of(place, i);
    pl_body_map_read(map, &part, true, filter, value);
    for (int c = 0; c < 4; c++)
      out[c] += value[c] / (float)PL_BODY_MAP_PARTS;
  }
}

typedef void read_fn(const pl_texture *texture, float u, float v, const float a[2],
                     const float b[2], pl_filter filter, float out[4]);

static inline void read_map(const pl_texture *map, const pl_body_place *given, pl_filter filter,
                            read_fn *read, float out[4]) {
  float uv[2], a[2], b[2];
  const pl_body_place place = stretched(given);
  pl_body_map_uv(place.point, place.center_lon_rad, place.across, place.along, uv, a, b);
  if (is_polar(a, b, filter))
    read_polar(map, &place, filter, out);
  else
    read(map, uv[0], uv[1], a, b, filter, out);
}

void pl_body_map_sample(const pl_texture *map, const pl_body_place *place, pl_filter filter,
                        float out[4]) {
  read_map(map, place, filter, pl_texture_sample, out);
}

void pl_body_map_box(const pl_texture *map, const pl_body_place *place, pl_filter filter,
                     float out[4]) {
  read_map(map, place, filter, pl_texture_box, out);
}
