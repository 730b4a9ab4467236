/* Intersection of a ray's cone with the ring plane. The plane through the ray and the ring normal
 * intersects the ring plane in a line; x is the coordinate along this line, from the foot of the
 * ray's origin. The coordinate q, -1/2..1/2, identifies a line of the cone within that vertical
 * plane by its position across the cone. The q of the line that meets the ring plane at x is a
 * quotient of two linear functions of x. */
#include "rings/table.h"

/* Smallest spread of a ray. A ray without a width then deviates by at most a billionth of its
 * length. */
static const double SPREAD_MIN = 1e-9;
/* Longest piece of the line that one part of the cone covers, as a fraction of the outer radius. */
static const double STEP = 0.25;

typedef struct fan {
  double height;      /* of the origin above the ring plane, m */
  double start;       /* position of x = 0 along the line, from the point closest to the axis, m */
  double lateral;     /* distance of the line from the axis, m */
  double across, up;  /* components of the direction along the line and along the normal */
  double width, grow; /* width and spread of the cone, as in pl_rings_ray */
  pl_vec3 foot, along;
} fan;

static fan fan_of(const pl_rings_ray *ray) {
  const pl_vec3 o = ray->origin, d = ray->direction;
  const double across = hypot(d.x, d.y);
  const pl_vec3 along =
      across > 0.0 ? (pl_vec3){d.x / across, d.y / across, 0.0} : (pl_vec3){1.0, 0.0, 0.0};
  return (fan){.height = o.z,
               .start = o.x * along.x + o.y * along.y,
               .lateral = o.y * along.x - o.x * along.y,
               .across = across,
               .up = d.z,
               .width = ray->width_m,
               .grow = fmax(ray->spread, SPREAD_MIN),
               .foot = {o.x, o.y, 0.0},
               .along = along};
}

/* Distance along the ray to the point at x, m. */
static double way(const fan *f, double x) { return f->across * x - f->up * f->height; }

static double width_at(const fan *f, double x) { return f->width + f->grow * way(f, x); }

/* q of the line that meets the ring plane at x, times the width of the cone there. */
static double aside(const fan *f, double x) { return -f->up * x - f->across * f->height; }

static double place(const fan *f, double x) {
  const double q = aside(f, x) / width_at(f, x);
  return fmin(0.5, fmax(-0.5, q));
}

/* Restricts the span to x with a x <= b. */
static void keep(double a, double b, double span[2]) {
  if (a > 0.0)
    span[1] = fmin(span[1], b / a);
  else if (a < 0.0)
    span[0] = fmax(span[0], b / a);
  else if (!(b >= 0.0))
    span[1] = -INFINITY;
}

/* Range of x that lies within the cone, before the ray's end and within the outer radius. False if
 * it is empty. */
static bool span_of(const pl_rings *rings, const fan *f, double end_m, double span[2]) {
  const double outer = pl_rings_outer_m(rings);
  const double chord2 = (outer - f->lateral) * (outer + f->lateral);
  if (!(chord2 > 0.0))
    return false;
  span[0] = -sqrt(chord2) - f->start;
  span[1] = sqrt(chord2) - f->start;
  const double lost = f->up * f->height, side = f->across * f->height;
  const double half = 0.5 * (f->width - f->grow * lost), slope = 0.5 * f->grow * f->across;
  keep(-f->across, -lost, span);       /* in front of the origin */
  keep(f->across, end_m + lost, span); /* before the end of the ray */
  keep(-f->up - slope, side + half, span);
  keep(f->up - slope, -side + half, span);
  return span[0] < span[1];
}

/* The part of the cone between two positions on the same side of the point closest to the axis. */
static bool piece_of(const fan *f, double x0, double x1, pl_rings_piece *out) {
  const double fraction = fabs(place(f, x1) - place(f, x0)), x = 0.5 * (x0 + x1);
  if (!(fraction > 0.0))
    return false;
  const double r0 = hypot(f->start + x0, f->lateral), r1 = hypot(f->start + x1, f->lateral);
  const double r = 0.5 * (r0 + r1);
  /* Half the cone's width across the line, projected onto the radius. */
  const double aside_m = r > 0.0 ? 0.5 * width_at(f, x) * fabs(f->lateral) / r : 0.0;
  *out = (pl_rings_piece){
      .fraction = fraction,
      .t = hypot(x, f->height),
      .point = pl_vec3_madd(f->foot, x, f->along),
      .low_m = fmax(0.0, fmin(r0, r1) - aside_m),
      .high_m = fmax(r0, r1) + aside_m,
      .sine = fabs(f->height) / hypot(x, f->height),
      .side = f->height < 0.0 ? -1.0 : 1.0,
  };
  return out->sine > 0.0;
}

static size_t cut_side(const pl_rings *rings, const fan *f, double x0, double x1,
                       pl_rings_piece *out) {
  const double parts = ceil((x1 - x0) / (STEP * pl_rings_outer_m(rings)));
  const int count = (int)fmin(fmax(parts, 1.0), PL_RINGS_PIECES / 2);
  size_t found = 0;
  for (int i = 0; i < count && x0 < x1; i++) {
    const double from = x0 + (x1 - x0) * i / count, to = x0 + (x1 - x0) * (i + 1) / count;
    found += piece_of(f, from, to, &out[found]);
  }
  return found;
}

size_t pl_rings_cut(const pl_rings *rings, const pl_rings_ray *ray,
                    pl_rings_piece out[PL_RINGS_PIECES]) {
  const fan f = fan_of(ray);
  double span[2];
  if (!span_of(rings, &f, ray->end_m, span))
    return 0;
  const double middle = fmin(fmax(-f.start, span[0]), span[1]);
  const size_t first = cut_side(rings, &f, span[0], middle, out);
  return first + cut_side(rings, &f, middle, span[1], out + first);
}
