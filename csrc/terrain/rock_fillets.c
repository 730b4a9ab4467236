#include "terrain/rock_fillets.h"

#include "base/memory.h"
#include "math/philox.h"
#include "terrain/cone.h"
#include "terrain/rock_parts.h"

/* What random numbers of a rock are for. */
enum { FOR_FILLET = 5 };
/* Width over the mean height: its foot at the rock is a slope of 32 degrees. */
#define WIDTH 3.2
/* Fillets have these shares of the mean, and differ by LEAN from one side to the other. */
#define LEAST 0.5
#define MOST 1.5
#define LEAN 0.4
/* Cells over the width of a fillet from which on it begins to show, and shows in full. */
#define FADE_FROM 1.0
#define FADE_TO 2.0
/* No point of a rock is further from its site, in diameters; as pl_rock_reach_m. */
#define REACH 2.0
/* Radius of a block, over the least rock at hand, beyond which it is halved. */
#define WIDEST_BLOCK 64.0

typedef struct fillet {
  pl_rock rock;
  pl_rock_shape shape;
  double height_m; /* with what its cells show of it */
  double width_m, reach_m;
  pl_vec3 lean; /* along the ground, LEAN long */
} fillet;

typedef struct gathered {
  const pl_rock_field *field;
  const pl_terrain *terrain;
  pl_vec3 axis;
  double radius_m, cell_m; /* of the block at hand */
  fillet *fillets;
  size_t count, capacity;
} gathered;

/* Bound of the width of a rock's fillet, from one of the rock's height. */
static double width_most(const pl_rock_field *field, double height_m) {
  return WIDTH * MOST * field->frame.fillet * height_m;
}

double pl_rock_fillets_bound_m(const pl_rock_field *field) {
  const double rock_m = field->scatter.last < 0 ? 0.0 : PL_ROCK_HEIGHT_MOST * field->frame.max_m;
  return (1.0 + LEAN) / WIDTH * width_most(field, rock_m);
}

static double smooth(double t) {
  const double x = fmin(fmax(t, 0.0), 1.0);
  return x * x * (3.0 - 2.0 * x);
}

static void draw(const gathered *all, fillet *out) {
  const pl_rock_field *field = all->field;
  uint64_t words[4];
  pl_scatter_words(&field->scatter, out->rock.id, FOR_FILLET, words);
  const double share = LEAST + (MOST - LEAST) * pl_philox_double(words[0]);
  const double mean_m = share * field->frame.fillet * out->rock.height_m;
  const double turn = 2.0 * PL_PI * pl_philox_double(words[1]);
  const pl_vec3 along = pl_vec3_unit(
      pl_vec3_cross(out->rock.up, pl_mat3_mul_vec(out->rock.rotation, (pl_vec3){1.0, 0.0, 0.0})));
  const pl_vec3 across = pl_vec3_cross(out->rock.up, along);
  out->width_m = WIDTH * mean_m;
  out->height_m = mean_m * smooth((out->width_m / all->cell_m - FADE_FROM) / (FADE_TO - FADE_FROM));
  out->reach_m = out->shape.radius * out->rock.diameter_m + out->width_m;
  out->lean = pl_vec3_madd(pl_vec3_scale(along, LEAN * cos(turn)), LEAN * sin(turn), across);
}

/* Whether cells may show something of a site's fillet in the block: fast. */
static bool may_show(const gathered *all, const pl_scatter_site *site) {
  const double width_m = width_most(all->field, pl_rock_height_bound_m(all->field, site));
  const double chord = pl_vec3_norm(pl_vec3_sub(site->direction, all->axis));
  return width_m > FADE_FROM * all->cell_m &&
         chord * all->field->frame.radius_m < all->radius_m + REACH * site->diameter_m + width_m;
}

static pl_status gather(void *context, const pl_scatter_site *site) {
  gathered *all = context;
  if (!may_show(all, site))
    return PL_OK;
  if (all->count == all->capacity) {
    const size_t more = all->capacity > 0 ? 2 * all->capacity : 8;
    fillet *grown = pl_realloc(all->fillets, more, sizeof *grown);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for the soil at %zu rocks", more);
    all->fillets = grown;
    all->capacity = more;
  }
  fillet *at = &all->fillets[all->count];
  if (!pl_rock_set(all->field, all->terrain, site, &at->rock, &at->shape))
    return PL_OK;
  draw(all, at);
  all->count += at->height_m > 0.0;
  return PL_OK;
}

/* Height of the soil at a point of the ground. */
static double height_at(const fillet *of, pl_vec3 point) {
  const pl_vec3 to = pl_vec3_sub(point, of->rock.center);
  const double away2_m2 = pl_vec3_dot(to, to);
  if (away2_m2 >= of->reach_m * of->reach_m)
    return 0.0;
  const double away_m = sqrt(away2_m2);
  const pl_vec3 own = pl_mat3_mul_vec_t(of->rock.rotation, to);
  const double depth =
      pl_rock_shape_depth(&of->shape, pl_vec3_scale(own, 1.0 / of->rock.diameter_m));
  const double beside_m = depth > 1.0 ? away_m * (1.0 - 1.0 / depth) : 0.0;
  const double left = 1.0 - beside_m / of->width_m;
  if (!(left > 0.0))
    return 0.0;
  const double side = away_m > 0.0 ? fmin(depth, 1.0) / away_m * pl_vec3_dot(of->lean, to) : 0.0;
  return of->height_m * (1.0 + side) * left * left;
}

static void raise(const gathered *all, const pl_vec3 *directions, size_t count, double *heights_m) {
  for (size_t k = 0; k < count; k++) {
    const double radius_m = pl_terrain_datum_m(all->terrain, directions[k]) + heights_m[k];
    const pl_vec3 point = pl_vec3_scale(directions[k], radius_m);
    double most_m = 0.0;
    for (size_t n = 0; n < all->count; n++)
      most_m = fmax(most_m, height_at(&all->fillets[n], point));
    heights_m[k] += most_m;
  }
}

pl_status pl_rock_fillets_add(const pl_rock_field *field, const pl_terrain *terrain,
                              const pl_vec3 *directions, size_t count, double cell_m,
                              double *heights_m) {
  const double widest = width_most(field, PL_ROCK_HEIGHT_MOST);
  const double least_m = fmax(PL_ROCK_CELLS * cell_m, field->frame.min_m);
  if (count == 0 || !(widest > 0.0) || field->scatter.last < 0 || least_m >= field->frame.max_m)
    return PL_OK;
  const pl_cone cone = pl_cone_of(directions, count);
  const double radius_m = cone.angle_rad * field->frame.radius_m;
  if (count > 1 && radius_m > WIDEST_BLOCK * least_m) {
    const size_t half = count / 2;
    PL_TRY(pl_rock_fillets_add(field, terrain, directions, half, cell_m, heights_m));
    return pl_rock_fillets_add(field, terrain, directions + half, count - half, cell_m,
                               heights_m + half);
  }
  gathered all = {.field = field,
                  .terrain = terrain,
                  .axis = cone.axis,
                  .radius_m = radius_m,
                  .cell_m = cell_m};
  const pl_rock_reach reach = {radius_m, REACH + widest, least_m, INFINITY};
  const pl_status status = pl_rock_sites_near(field, terrain, cone.axis, &reach, gather, &all);
  if (status == PL_OK)
    raise(&all, directions, count, heights_m);
  pl_free(all.fillets);
  return status;
}
