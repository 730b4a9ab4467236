/* Direction, size and strength of the sun's disc. */
#include "light/sun.h"

#include "math/sampling.h"

/* 1 - cos a = sin^2 a / (1 + cos a) avoids cancellation for a small disc. Up to this sine a series
 * is used instead, accurate to 2e-9 without a square root. */
static const double SMALL_SINE = 0.01;
static double one_minus_cos(double sine) {
  const double s2 = sine * sine;
  return sine < SMALL_SINE ? 0.5 * s2 * (1.0 + 0.25 * s2) : s2 / (1.0 + sqrt(fmax(0.0, 1.0 - s2)));
}

pl_sun_view pl_sun_view_at(const pl_shot_sun *sun, pl_vec3 point) {
  const pl_vec3 to_sun = pl_vec3_sub(sun->position, point);
  const double distance = pl_vec3_norm(to_sun);
  const double per_metre = distance > 0.0 ? 1.0 / distance : 0.0;
  const double sine = distance > sun->radius_m ? sun->radius_m * per_metre : 1.0;
  const double irradiance = pl_shot_sun_irradiance(sun, point);
  return (pl_sun_view){
      .direction = pl_vec3_to_float(pl_vec3_scale(to_sun, per_metre)),
      .sin_radius = (float)sine,
      .one_minus_cos = (float)one_minus_cos(sine),
      .irradiance = (float)irradiance,
      /* A uniform disc of radius a gives the irradiance pi sin^2(a) L on a plate facing it. */
      .radiance = (float)(irradiance / (PL_PI * sine * sine)),
      .distance_m = (float)distance,
  };
}

pl_vec3f pl_sun_sample(const pl_sun_view *view, const float u[2]) {
  const pl_basis basis = pl_basis_make(view->direction);
  return pl_basis_to_world(&basis, pl_sample_cone(u[0], u[1], view->one_minus_cos));
}

float pl_sun_pdf(const pl_sun_view *view) { return pl_cone_pdf(view->one_minus_cos); }

bool pl_sun_covers(const pl_sun_view *view, pl_vec3f direction) {
  /* Uses the sine: in float, the cosine of a quarter of a degree has no significant digits left. */
  const pl_vec3f across = pl_vec3f_cross(view->direction, direction);
  return pl_vec3f_dot(view->direction, direction) > 0.0f &&
         pl_vec3f_dot(across, across) < view->sin_radius * view->sin_radius;
}

/* The angle to the sphere's centre is less than the sum of both angular radii. Compares sines and
 * cosines of that sum, because the cosine alone has too few digits for a distant sun. */
bool pl_sun_behind_sphere(const pl_sun_view *view, pl_vec3 point, pl_vec3 center, double radius_m) {
  const pl_vec3 to_center = pl_vec3_sub(center, point);
  const double besides2 = pl_vec3_dot(to_center, to_center) - radius_m * radius_m;
  if (!(besides2 > 0.0))
    return true;
  const pl_vec3 toward = pl_vec3f_to_double(view->direction);
  const pl_vec3 across = pl_vec3_cross(to_center, toward);
  const double besides = sqrt(besides2), sine = view->sin_radius,
               cosine = 1.0 - view->one_minus_cos;
  /* maximum distance of the sphere's centre from the line to the sun's centre */
  const double most = radius_m * cosine + besides * sine;
  const bool ahead = pl_vec3_dot(to_center, toward) > 0.0;
  const bool less = pl_vec3_dot(across, across) < most * most;
  return besides * cosine > radius_m * sine ? ahead && less : ahead || !less;
}

uint32_t pl_sun_next_sphere(const pl_sun_view *view, const pl_sphere_tree *tree, pl_vec3 point,
                            double margin_m, size_t *k) {
  while (*k < tree->count) {
    const pl_sphere *sphere = &tree->nodes[*k];
    const bool behind =
        pl_sun_behind_sphere(view, point, sphere->center, sphere->radius_m + margin_m);
    *k = pl_sphere_next(tree, *k, behind);
    if (behind && sphere->item != PL_INNER_NODE)
      return sphere->item;
  }
  return PL_NO_ITEM;
}
