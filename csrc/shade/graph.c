/* Runs compiled material graphs and converts their outputs to surfaces. */
#include "shade/graph.h"

#include <math.h>
#include <string.h>

#include "base/work.h"
#include "math/sampling.h"
#include "shade/body_map.h"
#include "shade/graph_program.h"
#include "shade/node_rows.h"

/* Points that a program is run at. */
typedef struct batch {
  const pl_graph_point *points;
  size_t count; /* 1..PL_LANES */
  const pl_value *params;
} batch;

/* Lanes of an operand; `room`: where those of a parameter are put. */
static const pl_lanes *operand_lanes(const pl_graph *graph, const pl_value *params,
                                     const pl_lanes *registers, pl_operand operand,
                                     pl_lanes *room) {
  if (operand.bank == PL_BANK_REGISTER)
    return &registers[operand.index];
  if (operand.bank == PL_BANK_CONSTANT)
    return (const pl_lanes *)&graph->spread[operand.index];
  pl_value_spread(params[operand.index], *room);
  return (const pl_lanes *)room;
}

static const pl_slopes LEVEL = {{{0.0f}}};

/* Sets what an instruction reads and writes of slopes. */
static void set_slopes(const pl_instruction *instruction, pl_slopes *slopes, pl_node_call *call) {
  for (size_t k = 0; k < instruction->kind->input_count; k++)
    call->in_slopes[k] = (const pl_slopes *)((instruction->uniform >> k & 1u) != 0
                                                 ? &LEVEL
                                                 : &slopes[instruction->in[k].index]);
  call->out_slopes = slopes + instruction->out;
}

/* Evaluates all instructions of a program, each at all points; results are in `registers`.
 * slopes: those of the results, for registers that are not the same everywhere; NULL: without. */
static void run(const pl_graph *graph, const pl_program *program, const batch *at,
                pl_lanes registers[PL_GRAPH_REGISTERS], pl_slopes *slopes) {
  pl_node_call call = {.points = at->points, .graph = graph, .params = at->params};
  pl_lanes room[PL_NODE_SOCKETS];
  pl_work_add(PL_WORK_graph_steps, program->count * at->count * (slopes != NULL ? 3 : 1));
  for (size_t n = 0; n < program->count; n++) {
    const pl_instruction *instruction = &program->instructions[n];
    const pl_node_kind *kind = instruction->kind;
    for (size_t k = 0; k < kind->input_count; k++)
      call.in[k] = (kind->lazy >> k & 1u) != 0
                       ? NULL
                       : operand_lanes(graph, at->params, registers, instruction->in[k], &room[k]);
    for (size_t k = kind->input_count; k < PL_NODE_SOCKETS; k++)
      call.in[k] = NULL;
    call.count = pl_instruction_is_uniform(instruction) ? 1 : at->count;
    call.constants = instruction->constants;
    call.instruction = instruction;
    call.given = instruction->given;
    call.uniform = instruction->uniform;
    call.out = registers + instruction->out;
    if (slopes == NULL || pl_instruction_is_uniform(instruction)) {
      kind->evaluate(&call);
      continue;
    }
    set_slopes(instruction, slopes, &call);
    kind->evaluate_slopes(&call);
  }
}

/* Evaluates a program that has a single output. */
static void run_lazy(const pl_graph *graph, pl_operand input, const batch *at, pl_lanes out) {
  pl_lanes registers[PL_GRAPH_REGISTERS], room;
  const pl_program *program = &graph->programs[input.index];
  run(graph, program, at, registers, NULL);
  memcpy(out, operand_lanes(graph, at->params, registers, program->outputs[0], &room), sizeof room);
}

void pl_node_input_at(const pl_node_call *call, size_t input, const pl_graph_point *points,
                      size_t count, pl_lanes out) {
  const batch at = {points, count, call->params};
  run_lazy(call->graph, call->instruction->in[input], &at, out);
}

static const pl_program *lazy_program(const pl_node_call *call, size_t input) {
  return &call->graph->programs[call->instruction->in[input].index];
}

bool pl_node_input_has_slopes(const pl_node_call *call, size_t input) {
  return lazy_program(call, input)->slopes;
}

void pl_node_input_slopes(const pl_node_call *call, size_t input, const pl_graph_point *points,
                          size_t count, float out[2][PL_LANES]) {
  pl_lanes registers[PL_GRAPH_REGISTERS];
  pl_slopes slopes[PL_GRAPH_REGISTERS];
  const pl_program *program = lazy_program(call, input);
  const batch at = {points, count, call->params};
  run(call->graph, program, &at, registers, slopes);
  for (size_t axis = 0; axis < 2; axis++)
    memcpy(out[axis], slopes[program->outputs[0].index][axis][0], sizeof out[axis]);
}

bool pl_graph_cuts(const pl_graph *graph) { return graph->cuts; }
bool pl_graph_absent(const pl_graph *graph) { return graph->absent; }

float pl_graph_alpha(const pl_graph *graph, const pl_graph_point *point, const pl_value *params) {
  pl_lanes alpha;
  const batch at = {point, 1, params};
  run_lazy(graph, graph->programs[0].outputs[PL_SURFACE_ALPHA], &at, alpha);
  return alpha[0][0];
}

bool pl_graph_is_there(const pl_graph *graph, const pl_graph_point *point, const pl_value *params) {
  return pl_graph_alpha(graph, point, params) >= PL_ALPHA_CUT;
}

void pl_graph_evaluate(const pl_graph *graph, const pl_graph_point *point, const pl_value *params,
                       pl_value out[PL_NODE_SOCKETS]) {
  pl_lanes registers[PL_GRAPH_REGISTERS];
  const pl_program *program = &graph->programs[0];
  const batch at = {point, 1, params};
  run(graph, program, &at, registers, NULL);
  for (size_t k = 0; k < pl_node_input_count(graph->surface); k++)
    if ((graph->surface->lazy >> k & 1u) != 0) {
      pl_lanes value;
      run_lazy(graph, program->outputs[k], &at, value);
      for (size_t i = 0; i < 4; i++)
        out[k][i] = value[i][0];
    } else {
      pl_operand_value(graph, params, registers, program->outputs[k], 0, out[k]);
    }
}

bool pl_graph_wraps(const pl_graph *graph) { return graph->wrap; }
size_t pl_graph_parameter_count(const pl_graph *graph) { return graph->parameter_count; }
size_t pl_graph_instruction_count(const pl_graph *graph) { return graph->programs[0].count; }

/* True if an input of the surface is set by the graph rather than by the model's material. */
static bool gives(const pl_graph *graph, pl_surface_socket socket) {
  return (graph->sets >> socket & 1u) != 0;
}

bool pl_graph_sets_emission(const pl_graph *graph) {
  return gives(graph, PL_SURFACE_EMISSION_COLOR) || gives(graph, PL_SURFACE_EMISSION_STRENGTH);
}

static pl_vec3f cut3(const float *v, float factor, float high) {
  return pl_vec3f_make(pl_clipped(factor * v[0], high), pl_clipped(factor * v[1], high),
                       pl_clipped(factor * v[2], high));
}

bool pl_graph_emits(const pl_graph *graph) { return graph->emission != 0; }

bool pl_graph_emits_evenly(const pl_graph *graph) {
  return graph->programs[graph->emission].count == 0;
}

pl_vec3f pl_graph_emission(const pl_graph *graph, const pl_graph_point *point,
                           const pl_value *params) {
  pl_lanes registers[PL_GRAPH_REGISTERS];
  pl_value color, strength;
  const pl_program *program = &graph->programs[graph->emission];
  const batch at = {point, 1, params};
  run(graph, program, &at, registers, NULL);
  pl_operand_value(graph, params, registers, program->outputs[0], 0, color);
  pl_operand_value(graph, params, registers, program->outputs[1], 0, strength);
  return cut3(color, strength[0], (float)PL_EMISSION_MAX);
}

/* Rotates the frame to a normal, which is kept on the surface's side as with normal maps. */
static void bend(const float *normal, pl_surface *surface) {
  static const float COSINE_MIN = 0.05f;
  pl_vec3f n = pl_vec3f_unit(pl_value_vec(normal));
  const float length = pl_vec3f_norm(n);
  if (!(length > 0.5f) || !isfinite(length)) /* zero, or not a number */
    return;
  const float cosine = pl_vec3f_dot(n, surface->n);
  if (cosine < COSINE_MIN)
    n = pl_vec3f_unit(pl_vec3f_madd(n, COSINE_MIN - cosine, surface->n));
  const pl_vec3f t = pl_vec3f_madd(surface->t, -pl_vec3f_dot(surface->t, n), n);
  surface->n = n;
  surface->t = pl_vec3f_dot(t, t) > 1e-12f ? pl_vec3f_unit(t) : pl_basis_make(n).t;
  surface->b = pl_vec3f_cross(n, surface->t);
}

static pl_surface_inputs own_inputs(const pl_graph *graph) {
  return (pl_surface_inputs){.set = graph->sets >> PL_SURFACE_SOCKETS,
                             .differs = graph->differs >> PL_SURFACE_SOCKETS};
}

/* Sets the inputs of the reflectance model; the frame already has the bumped normal.
 * v: values of the surface's inputs. */
static void set_own(const pl_graph *graph, pl_value *v, pl_surface *surface) {
  const pl_reflectance *row = graph->surface->reflectance;
  pl_surface_inputs in = own_inputs(graph);
  in.had_lobes = surface->reflectance != NULL && surface->reflectance->layered;
  in.had_regolith = surface->reflectance != NULL && surface->reflectance->photometric;
  surface->reflectance = row;
  if (row->set == NULL)
    return;
  for (size_t k = 0; k < row->input_count; k++)
    in.value[k] = v[PL_SURFACE_SOCKETS + k];
  row->set(&in, surface);
}

/* The surface from the values of its inputs. */
static void set_surface(const pl_graph *graph, pl_value *v, pl_surface *surface) {
  if (!graph->wrap)
    *surface = (pl_surface){
        .t = surface->t, .b = surface->b, .n = surface->n, .ng = surface->ng, .alpha = 1.0f};
  if (gives(graph, PL_SURFACE_BASE_COLOR))
    surface->color = cut3(v[PL_SURFACE_BASE_COLOR], 1.0f, 1.0f);
  if (pl_graph_sets_emission(graph))
    surface->emission = cut3(v[PL_SURFACE_EMISSION_COLOR], v[PL_SURFACE_EMISSION_STRENGTH][0],
                             (float)PL_EMISSION_MAX);
  if (gives(graph, PL_SURFACE_NORMAL))
    bend(v[PL_SURFACE_NORMAL], surface);
  set_own(graph, v, surface);
}

void pl_graph_surfaces(const pl_graph *graph, const pl_graph_point *points, size_t count,
                       const pl_value *params, pl_surface *const *surfaces) {
  pl_lanes registers[PL_GRAPH_REGISTERS];
  pl_value v[PL_NODE_SOCKETS];
  const batch at = {points, count, params};
  run(graph, &graph->programs[0], &at, registers, NULL);
  for (size_t i = 0; i < count; i++) {
    for (size_t k = 0; k < pl_node_input_count(graph->surface); k++)
      if ((graph->surface->lazy >> k & 1u) == 0)
        pl_operand_value(graph, params, registers, graph->programs[0].outputs[k], i, v[k]);
    set_surface(graph, v, surfaces[i]);
  }
}

void pl_graph_colors(const pl_graph *graph, const pl_graph_point *points, size_t count,
                     const pl_value *params, pl_surface *const *surfaces) {
  pl_lanes registers[PL_GRAPH_REGISTERS];
  const pl_program *program = &graph->programs[graph->color];
  const batch at = {points, count, params};
  if (graph->color == 0)
    return;
  run(graph, program, &at, registers, NULL);
  for (size_t i = 0; i < count; i++) {
    pl_value color;
    pl_operand_value(graph, params, registers, program->outputs[0], i, color);
    surfaces[i]->color = cut3(color, 1.0f, 1.0f);
  }
}

void pl_graph_surface(const pl_graph *graph, const pl_graph_point *point, const pl_value *params,
                      pl_surface *surface) {
  pl_graph_surfaces(graph, point, 1, params, &surface);
}

/* Value of an input of the surface if it is a folded constant, or NULL. */
static const float *constant_of(const pl_graph *graph, size_t socket) {
  const pl_operand operand = graph->programs[0].outputs[socket];
  return operand.bank == PL_BANK_CONSTANT ? graph->constants[operand.index] : NULL;
}

/* own: maximum emission of the object's own material. */
static double emission_max(const pl_graph *graph, double own) {
  const float *color = constant_of(graph, PL_SURFACE_EMISSION_COLOR);
  const float *strength = constant_of(graph, PL_SURFACE_EMISSION_STRENGTH);
  if (!pl_graph_sets_emission(graph) || (strength != NULL && strength[0] == 0.0f))
    return 0.0;
  const double strength_of_own = pl_graph_own_emission(graph);
  if (strength_of_own > 0.0)
    return strength_of_own * own;
  if (color == NULL || strength == NULL)
    return PL_EMISSION_MAX;
  return (double)pl_vec3f_max(cut3(color, strength[0], (float)PL_EMISSION_MAX));
}

void pl_graph_summarise(const pl_graph *graph, pl_model_summary *summary) {
  const pl_reflectance *row = graph->surface->reflectance;
  pl_surface_inputs in = own_inputs(graph);
  summary->albedo_max = fmax(summary->albedo_max, 1.0);
  summary->emission_max = fmax(summary->emission_max, emission_max(graph, summary->emission_max));
  for (size_t k = 0; k < row->input_count; k++)
    in.value[k] = constant_of(graph, PL_SURFACE_SOCKETS + k);
  if (row->summarise != NULL)
    row->summarise(&in, summary);
  pl_graph_summarise_detail(graph, summary);
}

/* Map coordinates and footprint on a body; the footprint is at most as wide as the map. */
static void body_uv(const pl_graph_point *point, float uv[2], float a[2], float b[2]) {
  const double oblate = point->map_oblate;
  pl_body_map_uv(pl_body_map_stretch(point->place, oblate), point->map_center_lon_rad,
                 pl_body_map_stretch(point->across, oblate),
                 pl_body_map_stretch(point->along, oblate), uv, a, b);
  a[0] = pl_maxf(-1.0f, pl_minf(a[0], 1.0f));
  b[0] = pl_maxf(-1.0f, pl_minf(b[0], 1.0f));
}

void pl_graph_point_uv(const pl_graph_point *point, int set, float uv[2], float a[2], float b[2]) {
  if (point->body != NULL) {
    body_uv(point, uv, a, b);
    return;
  }
  uv[0] = uv[1] = a[0] = a[1] = b[0] = b[1] = 0.0f;
  if (point->model != NULL)
    pl_material_uv(point->model, &point->triangle, set, uv, a, b);
}

const pl_reflectance *pl_graph_reflectance(const pl_graph *graph) {
  return graph->surface->reflectance;
}

bool pl_graph_is_uniform(const pl_graph *graph) {
  const float *n = constant_of(graph, PL_SURFACE_NORMAL);
  return graph->programs[0].count == 0 && n != NULL && n[0] == 0.0f && n[1] == 0.0f && n[2] == 0.0f;
}

pl_vec3f pl_graph_point_object(const pl_graph_point *point) {
  const float *w = point->triangle.w;
  const uint32_t *corner = point->model->indices + 3 * (size_t)point->triangle.triangle;
  double p[3] = {-point->offset.x, -point->offset.y, -point->offset.z};
  for (size_t k = 0; k < 3; k++)
    for (size_t axis = 0; axis < 3; axis++)
      p[axis] += (double)w[k] * (double)point->model->positions[3 * (size_t)corner[k] + axis];
  return pl_vec3f_scale(pl_vec3f_make((float)p[0], (float)p[1], (float)p[2]), point->scale);
}

pl_graph_point pl_graph_point_move(const pl_graph_point *point, float along_t, float along_b) {
  const pl_vec3f step = pl_vec3f_madd(pl_vec3f_scale(point->t, along_t), along_b, point->b);
  pl_graph_point moved = *point;
  moved.world = pl_vec3f_add(point->world, step);
  if (point->body != NULL) {
    moved.place =
        pl_vec3_add(point->place, pl_mat3_mul_vec_t(*point->body, pl_vec3f_to_double(step)));
    moved.object = pl_vec3_to_float(moved.place);
    return moved;
  }
  if (point->model == NULL) {
    moved.object = pl_vec3f_add(point->object, step);
    return moved;
  }
  float w[3];
  pl_triangle_point_step(&point->triangle, step, w);
  for (int k = 0; k < 3; k++)
    moved.triangle.w[k] += w[k];
  moved.object = pl_graph_point_object(&moved);
  return moved;
}
