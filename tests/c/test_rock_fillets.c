/* Soil at the feet of rocks: the same bits alone and in blocks, at both ends of the body. */
#include "harness.h"

#include <math.h>
#include <string.h>

#include "terrain/cube.h"
#include "terrain/rock_fillets.h"

static const double MOON_M = 1737400.0;
enum { NODES = 40, LEVEL = 26 }; /* cells of 4 cm */

typedef struct fixture {
  pl_rock_field *rocks;
  pl_terrain *terrain;
} fixture;

static fixture open_fixture(double fillet) {
  fixture out;
  pl_rock_frame frame = pl_rock_frame_default(MOON_M);
  frame.law = (pl_rock_law){.kind = PL_ROCKS_HAWORTH, .factor = 8.0};
  frame.min_m = 0.3;
  frame.fillet = fillet;
  assert_int_equal(pl_rock_field_create(&frame, &out.rocks), PL_OK);
  const pl_terrain_frame ground = {.radii_m = {MOON_M, MOON_M, MOON_M},
                                   .detail = pl_terrain_detail_default(MOON_M),
                                   .rocks = out.rocks};
  assert_int_equal(pl_terrain_create(&ground, &out.terrain), PL_OK);
  return out;
}

static void close_fixture(fixture *f) {
  pl_terrain_destroy(f->terrain);
  pl_rock_field_destroy(f->rocks);
}

static void test_blocks(void **state) {
  (void)state;
  static double together[NODES * NODES], below[NODES * NODES];
  static pl_vec3 directions[NODES * NODES];
  fixture f = open_fixture(0.3);
  int raised = 0;
  for (int face = 0; face < PL_CUBE_FACES; face += 3) {
    const pl_terrain_nodes nodes = {face, LEVEL, 12345678, 23456789, NODES, NODES};
    assert_int_equal(pl_terrain_block(f.terrain, &nodes, together, directions), PL_OK);
    assert_int_equal(
        pl_terrain_heights_below_fillets(f.terrain, directions, NODES * NODES, LEVEL, below),
        PL_OK);
    for (int k = 0; k < NODES * NODES; k++) {
      assert_true(together[k] >= below[k]);
      raised += together[k] > below[k];
      if (k % 37 == 0) {
        const double alone = pl_terrain_height(f.terrain, directions[k], LEVEL);
        assert_memory_equal(&alone, &together[k], sizeof alone);
      }
    }
  }
  assert_in_range(raised, 20, 2 * NODES * NODES - 20);
  close_fixture(&f);
}

static void test_none(void **state) {
  (void)state;
  fixture f = open_fixture(0.0);
  double height = 1.0;
  const pl_vec3 up = {0.0, 0.0, 1.0};
  assert_true(pl_rock_fillets_bound_m(f.rocks) == 0.0);
  assert_int_equal(pl_rock_fillets_add(f.rocks, f.terrain, &up, 1, 0.01, &height), PL_OK);
  assert_int_equal(pl_rock_fillets_add(f.rocks, f.terrain, &up, 0, 0.01, &height), PL_OK);
  assert_true(height == 1.0);
  close_fixture(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_blocks), cmocka_unit_test(test_none)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
