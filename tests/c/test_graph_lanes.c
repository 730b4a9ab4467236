/* Batches of points: every node and random graphs, in lanes and one at a time, equal to the bit. */
#include "random_graphs.h"

#include <pthread.h>
#include <stdlib.h>

#include "cellular_points.h"
#include "math/fractal.h"

static pl_graph_point draw_point(draws *d) {
  const float size = draw(d, 3) == 0 ? 0.0f : draw_within(d, 0.0f, 2.0f);
  pl_graph_point p = graph_point(draw_number(d), draw_number(d), draw_number(d),
                                 draw(d, 9) == 0 ? INFINITY : size);
  p.bumps = draw(d, 5) != 0;
  return p;
}

/* --- graphs ----------------------------------------------------------------------------------- */

/* A graph of a few random nodes, then one of `kind`, which a surface shows. NULL if it is refused,
 * as bumps within bumps are. */
static pl_graph *draw_graph(const pl_node_kind *kind, draws *d) {
  test_graph g = {.parameters = PARAMETERS};
  pl_graph *graph;
  const size_t nodes = 1 + draw(d, 6);
  for (size_t i = 0; i <= nodes; i++) {
    const pl_node_kind *chosen = i == 0 ? pl_node_kind_find("coordinates") : kind;
    while (i > 0 && i < nodes && (chosen == kind || chosen->evaluate == NULL))
      chosen = pl_node_kinds[draw(d, (uint32_t)pl_node_kind_count)];
    const size_t node = graph_add(&g, chosen->name);
    draw_constants(&g, node, d);
    for (size_t k = 0; k < chosen->input_count; k++)
      draw_input(&g, node, k, d);
  }
  const size_t last = g.count - 1, bump = graph_add(&g, "bump"),
               surface = graph_add(&g, "principled");
  graph_link(&g, bump, "height", last, 0);
  graph_set(&g, bump, "distance_m", 0.1f, 0.1f, 0.1f);
  graph_link(&g, surface, "base_color", last, draw(d, (uint32_t)kind->output_count));
  graph_link(&g, surface, "roughness", last, 0);
  graph_link(&g, surface, "normal", draw(d, 2) ? bump : last, 0);
  return graph_make(&g, &graph) == PL_OK ? graph : NULL;
}

static pl_surface plain(void) {
  pl_surface s;
  memset(&s, 0, sizeof s);
  s.t = (pl_vec3f){1.0f, 0.0f, 0.0f};
  s.b = (pl_vec3f){0.0f, 1.0f, 0.0f};
  s.n = s.ng = (pl_vec3f){0.0f, 0.0f, 1.0f};
  return s;
}

static bool same_surface(const pl_surface *a, const pl_surface *b) {
  return memcmp(&a->t, &b->t, sizeof a->t) == 0 && memcmp(&a->b, &b->b, sizeof a->b) == 0 &&
         memcmp(&a->n, &b->n, sizeof a->n) == 0 &&
         memcmp(&a->color, &b->color, sizeof a->color) == 0 && a->alpha == b->alpha &&
         a->metallic == b->metallic && a->reflectance == b->reflectance;
}

/* One graph at random points: batches of every size beside batches of one. */
static void compare_batches(const pl_graph *graph, const char *name, draws *d) {
  pl_graph_point points[PL_LANES];
  pl_surface alone[PL_LANES], together[PL_LANES], tinted[PL_LANES];
  pl_surface *surfaces[PL_LANES], *colored[PL_LANES];
  pl_value params[PARAMETERS];
  for (size_t k = 0; k < PARAMETERS; k++)
    for (size_t i = 0; i < 4; i++)
      params[k][i] = i == 3 ? 0.0f : draw_number(d);
  for (size_t count = 1; count <= PL_LANES; count++) {
    for (size_t i = 0; i < count; i++) {
      points[i] = draw_point(d);
      alone[i] = together[i] = tinted[i] = plain();
      surfaces[i] = &together[i];
      colored[i] = &tinted[i];
      pl_graph_surface(graph, &points[i], params, &alone[i]);
    }
    pl_graph_surfaces(graph, points, count, params, surfaces);
    pl_graph_colors(graph, points, count, params, colored);
    for (size_t i = 0; i < count; i++) {
      if (!same_surface(&alone[i], &together[i]))
        fail_msg("%s: lane %zu of %zu differs", name, i, count);
      if (memcmp(&alone[i].color, &tinted[i].color, sizeof tinted[i].color) != 0)
        fail_msg("%s: the colour alone differs in lane %zu of %zu", name, i, count);
    }
  }
}

enum { GRAPHS = 40 }; /* of each kind */

static void compare_kind(const pl_node_kind *kind, uint32_t seed) {
  draws d = {seed};
  size_t made = 0;
  for (int k = 0; k < GRAPHS; k++) {
    pl_graph *graph = draw_graph(kind, &d);
    if (graph == NULL)
      continue;
    made++;
    compare_batches(graph, kind->name, &d);
    pl_graph_destroy(graph);
  }
  assert_true(made > GRAPHS / 4);
}

static void test_lanes_equal_points_alone_for_every_node(void **state) {
  (void)state;
  for (size_t i = 0; i < pl_node_kind_count; i++)
    if (pl_node_kinds[i]->evaluate != NULL)
      compare_kind(pl_node_kinds[i], (uint32_t)i);
}

/* Batches of other threads do not mix. */
static void *compare_in_thread(void *seed) {
  compare_kind(pl_node_kind_find("voronoi"), *(const uint32_t *)seed);
  compare_kind(pl_node_kind_find("musgrave"), *(const uint32_t *)seed);
  return NULL;
}

static void test_lanes_equal_points_alone_in_threads(void **state) {
  (void)state;
  pthread_t threads[2];
  uint32_t seeds[2] = {101, 102};
  for (size_t i = 0; i < 2; i++)
    assert_int_equal(pthread_create(&threads[i], NULL, compare_in_thread, &seeds[i]), 0);
  for (size_t i = 0; i < 2; i++)
    assert_int_equal(pthread_join(threads[i], NULL), 0);
}

/* --- patterns --------------------------------------------------------------------------------- */

static void draw_places(draws *d, pl_point_lanes *points) {
  static const double ODD[] = {0.0, -3.0, 1e10, -1e300, (double)NAN, (double)INFINITY, 0x1p31};
  for (size_t axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < PL_LANES; i++)
      points->at[axis][i] =
          draw(d, 20) == 0 ? ODD[draw(d, 7)] : (double)draw_within(d, -40.0f, 40.0f);
}

static pl_vec3 place_at(const pl_point_lanes *points, size_t i) {
  return pl_vec3_make(points->at[0][i], points->at[1][i], points->at[2][i]);
}

static void test_noise_of_lanes_is_that_of_points(void **state) {
  (void)state;
  draws d = {1};
  for (uint32_t seed = 0; seed < 2000; seed++) {
    pl_point_lanes points;
    float lanes[PL_LANES];
    draw_places(&d, &points);
    pl_noise_lanes(&points, seed, lanes);
    for (size_t i = 0; i < PL_LANES; i++) {
      const pl_vec3 p = place_at(&points, i);
      assert_true(lanes[i] == pl_noise(p, seed));
      assert_true(lanes[i] == pl_noise_gradient(p, seed).value);
    }
  }
}

static void test_noise_of_lanes_has_a_seed_for_each(void **state) {
  (void)state;
  draws d = {4};
  for (uint32_t round = 0; round < 2000; round++) {
    pl_point_lanes points;
    uint32_t seeds[PL_LANES];
    float alone[PL_LANES], value[PL_LANES], gradient[3][PL_LANES];
    draw_places(&d, &points);
    for (size_t i = 0; i < PL_LANES; i++)
      seeds[i] = pl_sampler_mix(round * PL_LANES + (uint32_t)i);
    pl_noise_seeds_lanes(&points, seeds, alone);
    pl_noise_gradient_seeds_lanes(&points, seeds, value, gradient);
    for (size_t i = 0; i < PL_LANES; i++) {
      const pl_noise_value noise = pl_noise_gradient(place_at(&points, i), seeds[i]);
      assert_true(alone[i] == noise.value && value[i] == noise.value);
      assert_true(gradient[0][i] == noise.gradient.x && gradient[1][i] == noise.gradient.y &&
                  gradient[2][i] == noise.gradient.z);
    }
  }
}

static void test_fractals_of_lanes_are_those_of_points(void **state) {
  (void)state;
  draws d = {2};
  for (uint32_t seed = 0; seed < 300; seed++) {
    pl_point_lanes points;
    float width[PL_LANES], lanes[PL_LANES];
    const pl_fractal shape = {.octaves = draw_within(&d, 0.0f, seed % 2 == 0 ? 5.0f : 17.0f),
                              .roughness = draw_within(&d, 0.0f, 1.2f),
                              .lacunarity = draw_within(&d, 0.7f, 2.5f),
                              .offset = draw_within(&d, 0.0f, 1.0f),
                              .gain = draw_within(&d, 0.0f, 3.0f),
                              .seed = seed};
    draw_places(&d, &points);
    for (size_t i = 0; i < PL_LANES; i++)
      width[i] = draw(&d, 3) == 0   ? 0.0f
                 : draw(&d, 9) == 0 ? INFINITY
                                    : draw_within(&d, 0.0f, 4.0f);
    for (size_t k = 0; k < PL_FRACTAL_KINDS; k++) {
      pl_fractal_rows[k].evaluate_lanes(&shape, &points, width, lanes);
      for (size_t i = 0; i < PL_LANES; i++) {
        const float alone = pl_fractal_rows[k].evaluate(&shape, place_at(&points, i), width[i]);
        assert_memory_equal(&lanes[i], &alone, sizeof alone);
      }
    }
  }
}

static void test_cells_of_lanes_are_those_of_points(void **state) {
  (void)state;
  draws d = {3};
  for (uint32_t seed = 0; seed < 300; seed++) {
    pl_point_lanes points;
    pl_cellular_lanes cell, other;
    float randomness[PL_LANES], smoothness[PL_LANES], edge[PL_LANES], smooth[PL_LANES];
    draw_places(&d, &points);
    for (size_t i = 0; i < PL_LANES; i++) {
      randomness[i] = draw(&d, 3) == 0 ? 1.0f : draw_number(&d);
      smoothness[i] = draw_number(&d);
    }
    pl_cellular_edge_lanes(&points, randomness, seed, &cell, edge, NULL);
    pl_cellular_smooth_lanes(PL_LANES, &points, randomness, smoothness, seed, &other, smooth, NULL);
    for (size_t i = 0; i < PL_LANES; i++) {
      const pl_vec3 p = place_at(&points, i);
      cellular alone;
      assert_true(edge[i] == cellular_edge(p, randomness[i], seed, &alone));
      assert_true(smooth[i] == cellular_smooth(p, randomness[i], smoothness[i], seed));
      assert_true(cell.first[i] == alone.first && cell.second[i] == alone.second);
      assert_true(cell.id[i] == alone.id && other.id[i] == alone.id);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_lanes_equal_points_alone_for_every_node),
      cmocka_unit_test(test_lanes_equal_points_alone_in_threads),
      cmocka_unit_test(test_noise_of_lanes_is_that_of_points),
      cmocka_unit_test(test_noise_of_lanes_has_a_seed_for_each),
      cmocka_unit_test(test_fractals_of_lanes_are_those_of_points),
      cmocka_unit_test(test_cells_of_lanes_are_those_of_points),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
