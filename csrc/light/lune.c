/* With z to the centre of the unit sphere at a distance d, a direction of sine y/d across and of
 * turn atan(t/g) meets the limb where t^2 + y^2 = 1. The plane of the terminator, whose normal is
 * the sun's direction (sine, 0, -cosine), meets the sphere where
 *
 *   (sine^2 + cosine^2 (d/g)^2/c) t^2 + 2 cosine sine/g t = cosine^2 (1 - y^2/c),  c = 1 - y^2/d^2:
 *
 * what is left of the quadratic for the two intersections with the sphere, after the terms of d
 * that cancel. Of its roots one is on the side that is seen. */
#include "light/lune.h"

#include "math/sampling.h"

/* Lit parts that are thinner than this, in turns, are left to chance. */
static const double THIN_RAD = 1e-9;

static pl_vec3 across(pl_vec3 z, pl_vec3 sun) {
  const pl_vec3 x = pl_vec3_madd(sun, -pl_vec3_dot(sun, z), z);
  if (pl_vec3_norm(x) > 1e-9)
    return pl_vec3_unit(x);
  return pl_vec3_unit(pl_vec3_cross(z, fabs(z.x) < 0.5 ? (pl_vec3){1, 0, 0} : (pl_vec3){0, 1, 0}));
}

/* Radii of the body that air reaches to: it shines beyond the ground's limb. Within it the ground
 * alone counts. */
static double swelling(const pl_shot_body *body, double d) {
  const pl_air *air = body->body->air;
  const double out = air != NULL ? pl_air_reach_m(air, body->radius_m) / body->radius_m : 1.0;
  return d > out ? out : 1.0;
}

bool pl_lune_make(const pl_shot_body *body, pl_vec3 sun, pl_vec3 point, pl_lune *out) {
  const pl_vec3 from = pl_vec3_add(body->camera_unit, pl_mat3_mul_vec(body->to_unit, point));
  const pl_vec3 at = pl_vec3_scale(from, 1.0 / swelling(body, pl_vec3_norm(from)));
  const pl_vec3 s = pl_vec3_unit(pl_mat3_mul_vec(body->to_unit, sun));
  const double d = pl_vec3_norm(at), least = 1e-9;
  if (!(d > 1.0 + least))
    return false;
  const pl_vec3 z = pl_vec3_scale(at, -1.0 / d), x = across(z, s);
  *out = (pl_lune){.body = body,
                   .x = x,
                   .y = pl_vec3_cross(z, x),
                   .z = z,
                   .d = d,
                   .g = sqrt((d - 1.0) * (d + 1.0)),
                   .cosine = -pl_vec3_dot(s, z),
                   .sine = fmax(pl_vec3_dot(s, x), 0.0),
                   .high = 1.0};
  /* The place on the limb where the terminator goes out of sight. */
  const double reach = out->sine * out->g, cut = fabs(out->cosine);
  const double sine = cut < reach ? sqrt(1.0 - (cut / reach) * (cut / reach)) : 0.0;
  if (out->cosine > 0.0)
    out->touch = sine;
  else
    out->high = out->touch = sine;
  return out->high > least;
}

/* The turns of what is lit at sine y/d; 0 if nothing is. */
static double chord(const pl_lune *l, double y, double *from_rad) {
  const double to = sqrt(fmax(1.0 - y * y, 0.0));
  double from = -to;
  if (fabs(y) < l->touch) {
    const double c = 1.0 - y * y / (l->d * l->d), ratio = l->cosine * l->d / l->g;
    const double a = l->sine * l->sine + ratio * ratio / c, b = l->sine / l->g;
    const double root = sqrt(fmax(b * b + a * (1.0 - y * y / c), 0.0));
    from = fmin(fmax(-l->cosine * (b + root) / a, -to), to);
  }
  *from_rad = atan(from / l->g);
  return atan(to / l->g) - *from_rad;
}

/* Of a direction in scaled axes: sines as those of an even disc's points, turns evenly. */
static double density(const pl_lune *l, double y, double turns_rad) {
  const double part = y / l->high;
  return 2.0 / PL_PI * sqrt(fmax(1.0 - part * part, 0.0)) * l->d / (l->high * turns_rad);
}

/* Solid angle of scaled axes over that of root axes, where `length` is what scaling makes of a unit
 * vector of root axes: |det M|/|M v|^3. */
static double stretch(const pl_lune *l, double length) {
  const pl_vec3 radii = l->body->state->radii_m;
  return 1.0 / (radii.x * length * (radii.y * length) * (radii.z * length));
}

bool pl_lune_sample(const pl_lune *l, const float u[2], pl_vec3f *direction, float *pdf) {
  const pl_vec3f disc = pl_sample_disc(u[0], u[1]);
  const double y = l->high * (double)disc.y;
  const double half = sqrt(fmax(1.0 - (double)disc.y * (double)disc.y, 1e-12));
  const double part = fmin(fmax(0.5 + 0.5 * (double)disc.x / half, 0.0), 1.0);
  double from_rad;
  const double turns_rad = chord(l, y, &from_rad);
  if (!(turns_rad > THIN_RAD / l->d))
    return false;
  const double turn = from_rad + part * turns_rad, sine = y / l->d;
  const double cosine = sqrt(1.0 - sine * sine);
  const pl_vec3 w = pl_vec3_madd(
      pl_vec3_madd(pl_vec3_scale(l->z, cosine * cos(turn)), cosine * sin(turn), l->x), sine, l->y);
  const pl_vec3 radii = l->body->state->radii_m;
  const pl_vec3 v =
      pl_mat3_mul_vec(l->body->rotation, (pl_vec3){radii.x * w.x, radii.y * w.y, radii.z * w.z});
  const double length = pl_vec3_norm(v);
  *direction = pl_vec3_to_float(pl_vec3_scale(v, 1.0 / length));
  *pdf = (float)(density(l, y, turns_rad) * stretch(l, 1.0 / length));
  return *pdf > 0.0f;
}

float pl_lune_pdf(const pl_lune *l, pl_vec3f direction) {
  const pl_vec3 v = pl_mat3_mul_vec(l->body->to_unit, pl_vec3f_to_double(direction));
  const double ahead = pl_vec3_dot(v, l->z), aside = pl_vec3_dot(v, l->y);
  const double length = pl_vec3_norm(v), y = aside / length * l->d;
  if (!(ahead > 0.0) || !(fabs(y) < l->high))
    return 0.0f;
  double from_rad;
  const double turns_rad = chord(l, y, &from_rad);
  const double turn = atan(pl_vec3_dot(v, l->x) / ahead);
  if (!(turns_rad > THIN_RAD / l->d) || turn < from_rad || turn > from_rad + turns_rad)
    return 0.0f;
  return (float)(density(l, y, turns_rad) * stretch(l, length));
}
