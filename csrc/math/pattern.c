/* Box filters: the mean over a box is the difference of the pattern's integral at its ends, over
 * its width (the filtered checker of Apodaca and Gritz, "Advanced RenderMan", 2000, chapter 11).
 * Integrals start at the point's own period, which avoids cancellation at large coordinates. */
#include "math/pattern.h"

#include "math/lattice.h"

static inline double clamp(double x, double low, double high) {
  return x > low ? (x < high ? x : high) : low;
}

/* A box about a point, in coordinates relative to the start of the point's own period. */
typedef struct box {
  int64_t cell;
  double low, high, width;
  /* Too narrow to divide by its width; so wide that the mean is the pattern's. */
  bool point, everything;
} box;

static box make_box(double x, float width) {
  double rest;
  const int64_t cell = pl_lattice_floor(x, &rest);
  const double w = width > 0.0f ? (double)width : 0.0;
  const bool point = w < 1e-6;
  const double half = point ? 0.0 : 0.5 * w;
  return (box){cell, rest - half, rest + half, w, point, w > (double)PL_PATTERN_WIDEST};
}

/* --- white noise ------------------------------------------------------------------------------ */

float pl_white_noise(pl_vec3 point, float width, uint32_t seed) {
  enum { MOST = 2 };
  const double x[3] = {point.x, point.y, point.z};
  const float full = pl_minf(pl_maxf(width, 0.0f), 1.0f);
  const float left = width > 1.0f ? pl_maxf(0.5f * (3.0f - width), 0.0f) : 1.0f;
  if (!(left > 0.0f))
    return 0.5f;
  uint32_t first[3];
  double fraction[3]; /* part of the box in the second cell */
  for (int i = 0; i < 3; i++) {
    const box b = make_box(x[i], full);
    const int64_t start = b.cell - (b.low < 0.0);
    const double inside = (b.low < 0.0 ? b.high : b.high - 1.0);
    fraction[i] = b.point ? 0.0 : clamp(inside / b.width, 0.0, 1.0);
    first[i] = (uint32_t)start;
  }
  double sum = 0.0;
  for (uint32_t k = 0; k < MOST * MOST * MOST; k++) {
    const uint32_t dx = k & 1u, dy = (k >> 1) & 1u, dz = k >> 2;
    const double weight = (dx ? fraction[0] : 1.0 - fraction[0]) *
                          (dy ? fraction[1] : 1.0 - fraction[1]) *
                          (dz ? fraction[2] : 1.0 - fraction[2]);
    if (weight > 0.0)
      sum += weight * (double)pl_lattice_uniform(
                          pl_lattice_hash3(seed, first[0] + dx, first[1] + dy, first[2] + dz), 0);
  }
  return 0.5f + left * left * ((float)sum - 0.5f);
}

/* --- checker ---------------------------------------------------------------------------------- */

/* Integral from 0 of the square wave that is 1 on [0, 1) and -1 on [1, 2): a triangle wave. */
static double square_integral(double x) {
  const double t = x - 2.0 * floor(0.5 * x);
  return t < 1.0 ? t : 2.0 - t;
}

static double square_mean(double x, float width) {
  const box b = make_box(x, width);
  if (b.everything)
    return 0.0;
  const double sign = b.cell & 1 ? -1.0 : 1.0;
  return b.point ? sign : sign * (square_integral(b.high) - square_integral(b.low)) / b.width;
}

float pl_checker(pl_vec3 point, float width) {
  return (float)(0.5 + 0.5 * square_mean(point.x, width) * square_mean(point.y, width) *
                           square_mean(point.z, width));
}

/* --- waves ------------------------------------------------------------------------------------ */

/* Integrals from 0 of wave - 1/2. */
static double saw_integral(double x) {
  const double t = x - floor(x);
  return 0.5 * t * (t - 1.0);
}
static double triangle_integral(double x) { /* of 2 t - 1/2 up to t = 1/2, 3/2 - 2 t after */
  const double t = x - floor(x);
  return t < 0.5 ? t * (t - 0.5) : (t - 0.5) * (1.0 - t);
}

float pl_wave(pl_wave_shape shape, double phase, float width) {
  const box b = make_box(phase, width);
  if (b.everything)
    return 0.5f;
  const double t = 0.5 * (b.low + b.high); /* in [0, 1) */
  if (shape == PL_WAVE_SINE) {
    const double half = PL_PI * b.width;
    return (float)(0.5 + 0.5 * sin(2.0 * PL_PI * t) * (b.point ? 1.0 : sin(half) / half));
  }
  if (shape == PL_WAVE_SAW)
    return (float)(b.point ? t : 0.5 + (saw_integral(b.high) - saw_integral(b.low)) / b.width);
  if (b.point)
    return (float)(t < 0.5 ? 2.0 * t : 2.0 - 2.0 * t);
  return (float)(0.5 + (triangle_integral(b.high) - triangle_integral(b.low)) / b.width);
}

/* --- bricks ----------------------------------------------------------------------------------- */

/* Integral from 0 to x of the pulses [low, high), one per `period`; low and high in [0, period]. */
static double pulse_integral(double x, double period, double low, double high) {
  const double turns = floor(x / period);
  return turns * (high - low) + clamp(x - turns * period - low, 0.0, high - low);
}

static double pulse_mean(const box *b, double period, double low, double high) {
  if (b->everything)
    return (high - low) / period;
  if (b->point)
    return b->low >= low && b->low < high ? 1.0 : 0.0;
  return (pulse_integral(b->high, period, low, high) - pulse_integral(b->low, period, low, high)) /
         b->width;
}

/* A box may cover even and odd rows: each parity is a product of two pulse trains. */
float pl_brick_cover(const pl_bricks *bricks, double u, double v, float width_u, float width_v) {
  const double joint_u = 0.5 * clamp((double)bricks->mortar_u, 0.0, 1.0);
  const double joint_v = 0.5 * clamp((double)bricks->mortar_v, 0.0, 1.0);
  const box rows = make_box(v, width_v);
  double cover = 0.0;
  for (int odd = 0; odd < 2; odd++) {
    box pair = rows; /* relative to the start of the even row at or below the box */
    const double shift = rows.cell & 1 ? 1.0 : 0.0;
    pair.low += shift;
    pair.high += shift;
    const double row = pulse_mean(&pair, 2.0, odd + joint_v, odd + 1.0 - joint_v);
    const box along = make_box(u - (odd ? (double)bricks->shift : 0.0), width_u);
    if (row > 0.0)
      cover += row * pulse_mean(&along, 1.0, joint_u, 1.0 - joint_u);
  }
  return (float)cover;
}

uint32_t pl_brick_id(const pl_bricks *bricks, double u, double v, uint32_t seed) {
  double rest;
  const int64_t row = pl_lattice_floor(v, &rest);
  const int64_t brick = pl_lattice_floor(u - (row & 1 ? (double)bricks->shift : 0.0), &rest);
  return pl_lattice_hash3(seed, (uint32_t)brick, (uint32_t)row, 0);
}

/* --- solar panels ----------------------------------------------------------------------------- */

/* One axis of a solar cell: the cell is [margin, 1 - margin], with lines of width `line` at
 * `pitch`. */
typedef struct cells {
  double margin, inside, pitch, line;
} cells;

static cells make_cells(float gap, float count, float line) {
  const double margin = 0.5 * clamp((double)gap, 0.0, 1.0), inside = 1.0 - 2.0 * margin;
  const double lines = floor(clamp((double)count, 0.0, 1e6));
  const double pitch = lines >= 1.0 ? inside / lines : 0.0;
  return (cells){margin, inside, pitch, clamp((double)line, 0.0, pitch)};
}

/* Integral of the lines from 0 to x. */
static double lines_integral(const cells *c, double x) {
  if (!(c->line > 0.0))
    return 0.0;
  const double each = c->line / c->pitch, whole = floor(x);
  const double within = clamp(x - whole - c->margin, 0.0, c->inside);
  const double side = 0.5 * (c->pitch - c->line);
  return whole * c->inside * each + pulse_integral(within, c->pitch, side, side + c->line);
}

static double lines_mean(const cells *c, const box *b) {
  if (!(c->line > 0.0))
    return 0.0;
  if (b->everything)
    return c->inside * c->line / c->pitch;
  if (!b->point)
    return (lines_integral(c, b->high) - lines_integral(c, b->low)) / b->width;
  const double within = b->low - c->margin, side = 0.5 * (c->pitch - c->line);
  const double at = within - c->pitch * floor(within / c->pitch);
  return within >= 0.0 && within < c->inside && at >= side && at < side + c->line ? 1.0 : 0.0;
}

pl_panel_cover pl_panel_covers(const pl_panel *panel, double u, double v, float width_u,
                               float width_v) {
  const cells along_u = make_cells(panel->gap_u, panel->busbars, panel->busbar_width);
  const cells along_v = make_cells(panel->gap_v, panel->fingers, panel->finger_width);
  const box box_u = make_box(u, width_u), box_v = make_box(v, width_v);
  const double cover_u = pulse_mean(&box_u, 1.0, along_u.margin, 1.0 - along_u.margin);
  const double cover_v = pulse_mean(&box_v, 1.0, along_v.margin, 1.0 - along_v.margin);
  /* Bare cell: neither busbar nor finger. This is a product, because each depends on one axis only.
   */
  const double bare = clamp(cover_u - lines_mean(&along_u, &box_u), 0.0, 1.0) *
                      clamp(cover_v - lines_mean(&along_v, &box_v), 0.0, 1.0);
  const double cell = clamp(cover_u * cover_v, bare, 1.0);
  return (pl_panel_cover){(float)bare, (float)(cell - bare), (float)(1.0 - cell)};
}

uint32_t pl_panel_id(double u, double v, uint32_t seed) {
  double rest;
  const int64_t x = pl_lattice_floor(u, &rest), y = pl_lattice_floor(v, &rest);
  return pl_lattice_hash3(seed, (uint32_t)x, (uint32_t)y, 0);
}
