/* Derivatives of heights beside differences of them: every node that has derivatives, in random
 * graphs, on nothing, on a mesh and on a body.
 *
 * Points at kinks are left out: where differences forwards and backwards disagree by more than a
 * twentieth, or from those over two steps by more than 0.4 %. So are heights that floats cannot
 * resolve. */
#include "random_graphs.h"

#include "shade/graph_program.h"
#include "shade/node_rows.h"

/* A height, as colour and as bump. */
typedef struct height_graph {
  pl_graph *graph;
  pl_value params[PARAMETERS];
} height_graph;

static const pl_node_kind *draw_kind(draws *d, const pl_node_kind *other_than) {
  const pl_node_kind *kind = NULL;
  while (kind == NULL || kind->evaluate_slopes == NULL || kind == other_than || kind->hidden)
    kind = pl_node_kinds[draw(d, (uint32_t)pl_node_kind_count)];
  return kind;
}

/* Number of choices of a kind's first constant. */
static size_t choices_of(const pl_node_kind *kind) {
  size_t count = 0;
  while (kind->constant_count > 0 && kind->constants[0].type == PL_CHOICE &&
         kind->constants[0].choices[count] != NULL)
    count++;
  return count > 0 ? count : 1;
}

/* Coordinates, some random nodes, and one of `kind`, whose first constant is `choice` if it is one.
 */
static void draw_nodes(test_graph *g, const pl_node_kind *kind, size_t choice, draws *d) {
  const size_t nodes = 1 + draw(d, 4);
  for (size_t i = 0; i <= nodes; i++) {
    const pl_node_kind *chosen = i == 0      ? pl_node_kind_find("coordinates")
                                 : i < nodes ? draw_kind(d, kind)
                                             : kind;
    const size_t node = graph_add(g, chosen->name);
    if (i > 0 || chosen == kind)
      draw_constants(g, node, d);
    for (size_t k = 0; k < chosen->input_count; k++)
      draw_input(g, node, k, d);
    if (i == nodes && chosen->input_count > 0) /* so that it depends on the point */
      g->inputs[node][0] =
          (pl_graph_input){.source = PL_INPUT_LINK, .index = draw(d, 2) ? 0 : i - 1};
  }
  if (choices_of(kind) > 1)
    g->constants[nodes][0].number = (double)choice;
}

/* False if the height has no derivatives. */
static bool draw_height(const pl_node_kind *kind, size_t choice, draws *d, height_graph *out) {
  test_graph g = {.parameters = PARAMETERS};
  bool slopes = false;
  draw_nodes(&g, kind, choice, d);
  const size_t last = g.count - 1, height = graph_add(&g, "value"), bump = graph_add(&g, "bump"),
               surface = graph_add(&g, "principled");
  graph_link(&g, height, "value", last, draw(d, (uint32_t)kind->output_count));
  graph_link(&g, bump, "height", height, 0);
  graph_set(&g, bump, "distance_m", 1.0f, 1.0f, 1.0f);
  graph_link(&g, surface, "base_color", height, 0);
  graph_link(&g, surface, "normal", bump, 0);
  assert_int_equal(graph_make(&g, &out->graph), PL_OK);
  for (size_t p = 0; p < out->graph->program_count; p++)
    slopes |= out->graph->programs[p].slopes;
  if (!slopes)
    pl_graph_destroy(out->graph);
  for (size_t k = 0; k < PARAMETERS; k++)
    for (size_t i = 0; i < 4; i++)
      out->params[k][i] = i == 3 ? 0.0f : draw_within(d, -2.0f, 2.0f);
  return slopes;
}

/* --- points ----------------------------------------------------------------------------------- */

static const float POSITIONS[] = {0.1f, -0.4f, 0.2f, 2.1f, 0.3f, -0.5f, -0.3f, 1.7f, 1.4f};
static const uint32_t CORNERS[] = {0, 1, 2};
/* A turn by 90 degrees about z, then one about x. */
static const pl_mat3 TURN = {{{0.0, -1.0, 0.0}, {0.0, 0.0, -1.0}, {1.0, 0.0, 0.0}}};

static pl_vec3f corner_at(size_t k) {
  const float *at = POSITIONS + 3 * k;
  return pl_vec3_to_float(
      pl_mat3_mul_vec(TURN, pl_vec3_make((double)at[0], (double)at[1], (double)at[2])));
}

/* On the triangle, with a frame that is slightly askew, as that of smooth normals. */
static pl_graph_point mesh_point(const pl_model *model, draws *d) {
  pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, 0.0f);
  const float u = draw_within(d, 0.0f, 0.5f), v = draw_within(d, 0.0f, 0.5f);
  const pl_vec3f edge1 = pl_vec3f_sub(corner_at(1), corner_at(0));
  const pl_vec3f edge2 = pl_vec3f_sub(corner_at(2), corner_at(0));
  p.model = model;
  p.triangle = (pl_triangle_point){.w = {1.0f - u - v, u, v}, .edge1 = edge1, .edge2 = edge2};
  p.n = pl_vec3f_unit(pl_vec3f_madd(pl_vec3f_unit(pl_vec3f_cross(edge1, edge2)), 0.1f, edge1));
  p.t = pl_vec3f_unit(pl_vec3f_cross(edge2, p.n));
  p.b = pl_vec3f_cross(p.n, p.t);
  p.object = pl_graph_point_object(&p);
  p.world = pl_vec3f_madd(pl_vec3f_madd(corner_at(0), u, edge1), v, edge2);
  return p;
}

static pl_graph_point draw_place(const pl_model *model, draws *d) {
  const uint32_t where = draw(d, 3);
  if (where == 0)
    return mesh_point(model, d);
  pl_graph_point p = graph_point(draw_within(d, -3.0f, 3.0f), draw_within(d, -3.0f, 3.0f),
                                 draw_within(d, -3.0f, 3.0f), 0.0f);
  if (where == 1) {
    p.body = &TURN;
    p.place = pl_vec3f_to_double(p.object);
    p.world = pl_vec3_to_float(pl_mat3_mul_vec(TURN, p.place));
  }
  return p;
}

/* --- comparison ------------------------------------------------------------------------------- */

static double height_at(const height_graph *h, const pl_graph_point *point, float t, float b) {
  pl_value sockets[PL_NODE_SOCKETS];
  pl_graph_point moved = pl_graph_point_move(point, t, b);
  moved.bumps = false;
  pl_graph_evaluate(h->graph, &moved, h->params, sockets);
  return (double)sockets[PL_SURFACE_BASE_COLOR][0];
}

enum { ODD, LEVEL, RIGHT, WRONG, RESULTS };
static const float STEP = 0x1p-12f;

/* A slope along one axis beside differences. */
static int compare_slope(const height_graph *h, const pl_graph_point *point, bool along_b,
                         double slope) {
  double at[5]; /* -2 to 2 steps */
  for (int k = 0; k < 5; k++) {
    const float by = (float)(k - 2) * STEP;
    at[k] = height_at(h, point, along_b ? 0.0f : by, along_b ? by : 0.0f);
  }
  const double step = (double)STEP, near = (at[3] - at[1]) / (2.0 * step);
  const double backwards = (at[2] - at[1]) / step, forwards = (at[3] - at[2]) / step;
  const double wide = (at[4] - at[0]) / (4.0 * step), size = 1.0 + fabs(near);
  const double rounding = 1e-7 * fabs(at[2]) / step;
  if (!(fabs(forwards - backwards) < 0.05 * size) || !(fabs(near - wide) < 0.004 * size) ||
      !(rounding < 2e-3 * size))
    return ODD;
  if (!(fabs(slope - near) < 0.01 * size)) {
    print_message("slope %g, not %g (%g over two steps)\n", slope, near, wide);
    return WRONG;
  }
  return fabs(near) > 0.05 ? RIGHT : LEVEL;
}

static void compare_height(const height_graph *h, const pl_graph_point *point,
                           size_t count[RESULTS]) {
  pl_value sockets[PL_NODE_SOCKETS];
  pl_graph_evaluate(h->graph, point, h->params, sockets);
  const pl_vec3f n = pl_value_vec(sockets[PL_SURFACE_NORMAL]);
  const double by = -1.0 / (double)pl_vec3f_dot(n, point->n);
  const double slope[2] = {by * (double)pl_vec3f_dot(n, point->t),
                           by * (double)pl_vec3f_dot(n, point->b)};
  for (int axis = 0; axis < 2; axis++)
    count[compare_slope(h, point, axis == 1, slope[axis])]++;
}

enum { ENOUGH = 100, MOST = 2000, POINTS = 4 };

static void compare_graphs(const pl_node_kind *kind, size_t choice, draws *d,
                           size_t count[RESULTS]) {
  const pl_model model = {.positions = (float *)(uintptr_t)POSITIONS,
                          .indices = (uint32_t *)(uintptr_t)CORNERS};
  for (int k = 0; k < MOST && count[RIGHT] < ENOUGH; k++) {
    height_graph h;
    if (!draw_height(kind, choice, d, &h))
      continue;
    for (int i = 0; i < POINTS; i++) {
      const pl_graph_point point = draw_place(&model, d);
      compare_height(&h, &point, count);
    }
    pl_graph_destroy(h.graph);
  }
}

static void compare_kind(const pl_node_kind *kind, uint32_t seed) {
  draws d = {seed};
  for (size_t choice = 0; choice < choices_of(kind); choice++) {
    const pl_constant constants[PL_NODE_CONSTANTS] = {{.number = (double)choice}};
    size_t count[RESULTS] = {0};
    /* Inputs that are the same everywhere, and one output: choices alone decide. */
    if (kind->has_slopes != NULL && !kind->has_slopes(constants, ~0u, 1u))
      continue;
    compare_graphs(kind, choice, &d, count);
    print_message("%s %zu: %zu slopes, %zu level, %zu odd, %zu wrong\n", kind->name, choice,
                  count[RIGHT], count[LEVEL], count[ODD], count[WRONG]);
    assert_true(count[RIGHT] >= ENOUGH);
    assert_true(2 * count[ODD] < count[RIGHT]);
    assert_int_equal(count[WRONG], 0);
  }
}

static void test_slopes_are_those_of_differences(void **state) {
  (void)state;
  for (size_t i = 0; i < pl_node_kind_count; i++)
    if (pl_node_kinds[i]->evaluate_slopes != NULL && !pl_node_kinds[i]->hidden)
      compare_kind(pl_node_kinds[i], (uint32_t)(i + 1));
}

/* What has steps is left to differences. */
static void test_steps_have_no_derivatives(void **state) {
  static const char *const STEPS[] = {"checker", "brick", "panel", "white_noise", "image"};
  (void)state;
  for (size_t i = 0; i < sizeof STEPS / sizeof STEPS[0]; i++)
    assert_null(pl_node_kind_find(STEPS[i])->evaluate_slopes);
  const pl_node_kind *voronoi = pl_node_kind_find("voronoi");
  const pl_constant first = {.number = 0.0};
  assert_true(voronoi->has_slopes(&first, ~0u, 1u));
  assert_false(voronoi->has_slopes(&first, ~0u, 2u));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_slopes_are_those_of_differences),
      cmocka_unit_test(test_steps_have_no_derivatives),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
