#include "render/fine_slopes.h"

#include "scene/shot_frame.h"
#include "shade/reflectance.h"
#include "terrain/sub_cell.h"

/* Views count as at least this steep: footprints are no longer than that. */
static const double LEAST_COSINE = 0.02;

double pl_fine_slopes_footprint_m(const pl_vertex *vertex, const pl_beam *beam) {
  const double cosine = fabs(pl_vec3_dot(beam->direction, pl_vec3f_to_double(vertex->ng)));
  return (double)pl_beam_width(beam, vertex->t) / sqrt(fmax(cosine, LEAST_COSINE));
}

static void share_roughness(pl_regolith *regolith, double less) {
  float given = -1.0f, left = 0.0f;
  for (int k = 0; k < 3; k++) {
    float *own = &regolith->band[k].roughness_rad;
    if (*own != given) {
      given = *own;
      left = (float)pl_roughness_without((double)given, less);
    }
    *own = left;
  }
}

/* Rocks that the ground stands for have the law without what their own relief is of it. */
static void set_stone_roughness(pl_surface *surface) {
  pl_regolith rock = surface->regolith;
  share_roughness(&rock, (double)surface->rough.stone_relief);
  for (int k = 0; k < 3; k++)
    surface->rough.stone_roughness_rad[k] = rock.band[k].roughness_rad;
}

void pl_fine_slopes_set(pl_vertex *vertex, const pl_rough *rough, double roughness_less) {
  pl_surface *surface = &vertex->surface;
  const bool photometric = surface->reflectance->photometric;
  if (photometric || surface->reflectance == &pl_reflectance_lambert)
    surface->rough = *rough;
  else
    pl_surface_set_frame(surface, pl_vec3f_unit(pl_vec3f_sub(surface->n, rough->slope)), surface->t,
                         1.0f);
  if (photometric && rough->stones > 0.0f)
    set_stone_roughness(surface);
  if (photometric)
    share_roughness(&surface->regolith, roughness_less);
}
