/* No ray slips through the ground, not even exactly at its posts, where Embree alone misses some.
 */
#include "grounds.h"

#include "random.h"
#include "render/geometry.h"
#include "scene/snapshot.h"
#include "trace/embree.h"
#include "trace/height_field.h"
#include "trace/tracer.h"

static const double MOON_M = 1737400.0;

enum { RAYS = PL_DRAWS(30000, 1500), CELLS = PL_GROUND_TILE_CELLS };

/* The ground of a rough body under a camera at its root, and a tracer for it. */
typedef struct world {
  pl_terrain *terrain;
  pl_accelerators *kept;
  pl_arena arena;
  const pl_height_field *field;
  pl_shot_body body;
  pl_snapshot shot;
  const pl_tracer *tracer;
  pl_vec3 eye;
} world;

static void open_world(world *w, pl_vec3 direction, double height_m, double strength) {
  *w = (world){.terrain = ground_rough((pl_vec3){MOON_M, MOON_M, 0.95 * MOON_M}, strength)};
  assert_int_equal(pl_accelerators_create(&w->kept), PL_OK);
  pl_arena_init(&w->arena);
  pl_ground_tile_view view = ground_view(w->terrain, direction, height_m, 1.4, PL_DRAWS(48, 12));
  view.half_angle_rad = PL_PI;
  view.side_count = 0;
  w->eye = view.eye;
  assert_int_equal(pl_height_field_build(w->kept, w->terrain, &view, 2, NULL, &w->arena, &w->field),
                   PL_OK);
  w->body = (pl_shot_body){.field = w->field,
                           .has_terrain = true,
                           .rotation = {{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}},
                           .center = pl_vec3_scale(view.eye, -1.0),
                           .outer_m = w->field->radius_m};
  w->shot = (pl_snapshot){.bodies = &w->body, .body_count = 1};
  assert_int_equal(pl_geometry_tracer(w->kept, &w->shot, &w->arena, &w->tracer), PL_OK);
}

static void close_world(world *w) {
  pl_accelerators_destroy(w->kept);
  pl_arena_clear(&w->arena);
  pl_terrain_destroy(w->terrain);
}

static pl_vec3 post_of(const world *w, uint32_t tile, int i, int j) {
  const pl_ground_tile *of = w->field->tiles[tile];
  const float *p = of->positions[(j + 1) * PL_GROUND_TILE_SIDE + i + 1];
  return pl_vec3_add(of->origin, (pl_vec3){(double)p[0], (double)p[1], (double)p[2]});
}

/* A place that is hard to hit, of one of five kinds: a post, one of a tile's border, a corner of a
 * tile, where up to four tiles of two levels meet, on an edge of a cell, on a tile's border. */
static pl_vec3 hard_point(const world *w, test_random *random, uint32_t *tile) {
  *tile = (uint32_t)random_below(random, (int)w->field->count);
  const int kind = random_below(random, 5);
  int i = random_below(random, CELLS), j = random_below(random, CELLS);
  i = kind == 2 ? CELLS * (i & 1) : i;
  j = kind == 1 || kind == 2 || kind == 4 ? CELLS * (j & 1) : j;
  const pl_vec3 p = post_of(w, *tile, i, j);
  if (kind < 3)
    return p;
  return pl_vec3_madd(p, random_unit(random), pl_vec3_sub(post_of(w, *tile, i + 1, j), p));
}

/* From the camera, or from beside the place, up to `slant` cells for each cell of height. */
static pl_ray ray_to(const world *w, pl_vec3 p, double cell_m, double slant, test_random *random) {
  const pl_vec3 up = pl_vec3_unit(p);
  const pl_vec3 over = pl_vec3_madd(p, 30.0 * cell_m, up);
  const pl_vec3 beside =
      pl_vec3_madd(over, 30.0 * slant * cell_m * random_unit(random), random_direction(random));
  const pl_vec3 from = random_unit(random) < 0.3 ? w->eye : beside;
  return (pl_ray){.origin = pl_vec3_sub(from, w->eye),
                  .direction = pl_vec3_unit(pl_vec3_sub(p, from)),
                  .t_max = INFINITY,
                  .skip_body = UINT32_MAX};
}

/* The closest hit by Embree alone. */
static pl_hit meet(const world *w, const pl_ray *ray) {
  const pl_vec3f o =
      pl_vec3_to_float(pl_vec3_sub(pl_vec3_add(ray->origin, w->eye), w->field->origin));
  const pl_vec3f d = pl_vec3_to_float(ray->direction);
  struct RTCRayHit query = {.ray = {.org_x = o.x,
                                    .org_y = o.y,
                                    .org_z = o.z,
                                    .dir_x = d.x,
                                    .dir_y = d.y,
                                    .dir_z = d.z,
                                    .tfar = INFINITY,
                                    .mask = UINT32_MAX}};
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  pl_embree_intersect1(w->field->scene, NULL, &query);
  const bool met = query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  return (pl_hit){.surface_id = met ? pl_surface_make(PL_SURFACE_HEIGHT_FIELD, 0) : PL_NO_SURFACE,
                  .triangle = query.hit.instID[0],
                  .u = query.hit.u,
                  .v = query.hit.v,
                  .t = (double)query.ray.tfar};
}

/* Whether a ray has met the ground from below, beyond where it was aimed at, or nothing, but would
 * meet it if it were turned upwards by a hair: at the horizon posts stand before the sky. */
static bool is_through(const world *w, const pl_ray *ray, const pl_hit *hit, double aimed_m) {
  if (!pl_surface_is_none(hit->surface_id))
    return hit->t > aimed_m &&
           pl_vec3_dot(ground_facet_normal(w->field, hit->triangle, hit->u, hit->v),
                       ray->direction) > 0.0;
  pl_ray above = *ray;
  const pl_vec3 up = pl_vec3_unit(pl_vec3_add(ray->origin, w->eye));
  above.direction = pl_vec3_unit(pl_vec3_madd(ray->direction, 1e-5, up));
  return !pl_surface_is_none(meet(w, &above).surface_id);
}

static const struct place {
  pl_vec3 direction;
  double height_m, strength, slant;
} PLACES[] = {
    {{0.9, 0.35, 0.2}, 2.0, 1.0, 0.7},        /* from a mast */
    {{1.0, 1.0, 1.0}, 3e4, 1.0, 0.7},         /* over a corner of the cube, the whole body */
    {{-1.0, 0.3, -0.99999}, 300.0, 2.0, 0.2}, /* over an edge, twice as rough */
};

/* Casts packets of rays: numbers of those that get through by packets, alone, and by Embree alone.
 */
static void count_through(const world *w, const struct place *place, test_random *random,
                          int out[3]) {
  enum { N = PL_TRACER_PACKET };
  pl_ray rays[N];
  pl_hit hits[3][N];
  for (int k = 0; k < RAYS; k += N) {
    double aimed_m[N];
    for (int i = 0; i < N; i++) {
      uint32_t tile;
      const pl_vec3 p = hard_point(w, random, &tile);
      const double cell_m = w->field->tiles[tile]->cell_m;
      rays[i] = ray_to(w, p, cell_m, place->slant, random);
      aimed_m[i] =
          pl_vec3_norm(pl_vec3_sub(p, pl_vec3_add(rays[i].origin, w->eye))) + 0.01 * cell_m;
      hits[2][i] = meet(w, &rays[i]);
    }
    for (int way = 0; way < 2; way++)
      pl_tracer_closest(w->tracer, rays, hits[way], N, way == 0, true);
    for (int way = 0; way < 3; way++)
      for (int i = 0; i < N; i++)
        out[way] += is_through(w, &rays[i], &hits[way][i], aimed_m[i]);
  }
}

static void no_ray_slips_through_at_posts(void **state) {
  (void)state;
  int through[3] = {0, 0, 0};
  for (size_t n = 0; n < sizeof PLACES / sizeof *PLACES; n++) {
    world w;
    test_random random = {.seed = n};
    open_world(&w, PLACES[n].direction, PLACES[n].height_m, PLACES[n].strength);
    count_through(&w, &PLACES[n], &random, through);
    close_world(&w);
  }
  print_message("[          ] %d rays slip through Embree's grids alone\n", through[2]);
  assert_int_equal(through[0], 0);
  assert_int_equal(through[1], 0);
  assert_true(PL_SEEN(through[2], 0));
}

/* A ray of sunlight that grazes the ground: from a little above a post towards another of the tile.
 */
static pl_ray grazing_ray(const world *w, test_random *random) {
  const uint32_t tile = (uint32_t)random_below(random, (int)w->field->count);
  const pl_vec3 to =
      post_of(w, tile, random_below(random, CELLS + 1), random_below(random, CELLS + 1));
  pl_vec3 from = post_of(w, tile, random_below(random, CELLS + 1), random_below(random, CELLS + 1));
  from = pl_vec3_madd(from, 0.01 * w->field->tiles[tile]->cell_m, pl_vec3_unit(from));
  return (pl_ray){.origin = pl_vec3_sub(from, w->eye),
                  .direction = pl_vec3_unit(pl_vec3_sub(to, from)),
                  .t_max = INFINITY,
                  .skip_body = UINT32_MAX};
}

/* Whether rays a hair aside to all sides meet the ground. */
static bool is_dark_around(const world *w, const pl_ray *ray) {
  const pl_vec3 up = pl_vec3_unit(pl_vec3_add(ray->origin, w->eye));
  const pl_vec3 side = pl_vec3_cross(up, ray->direction);
  for (int k = 0; k < 4; k++) {
    pl_ray beside = *ray;
    beside.direction =
        pl_vec3_unit(pl_vec3_madd(ray->direction, k & 1 ? 1e-5 : -1e-5, k < 2 ? up : side));
    if (pl_surface_is_none(meet(w, &beside).surface_id))
      return false;
  }
  return true;
}

static void no_sunlight_slips_through_at_posts(void **state) {
  (void)state;
  enum { N = PL_TRACER_PACKET };
  int dark = 0;
  for (size_t n = 0; n < sizeof PLACES / sizeof *PLACES; n++) {
    world w;
    test_random random = {.seed = 10 + n};
    open_world(&w, PLACES[n].direction, PLACES[n].height_m, PLACES[n].strength);
    for (int k = 0; k < RAYS; k += N) {
      pl_ray rays[N];
      bool occluded[2][N];
      for (int i = 0; i < N; i++)
        rays[i] = grazing_ray(&w, &random);
      for (int coherent = 0; coherent < 2; coherent++)
        pl_tracer_occluded(w.tracer, rays, occluded[coherent], N, coherent);
      for (int i = 0; i < N; i++) {
        const bool is_dark = is_dark_around(&w, &rays[i]);
        dark += is_dark;
        assert_true(!is_dark || (occluded[0][i] && occluded[1][i]));
      }
    }
    close_world(&w);
  }
  assert_true(PL_SEEN(dark, RAYS / 2));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(no_ray_slips_through_at_posts),
      cmocka_unit_test(no_sunlight_slips_through_at_posts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
