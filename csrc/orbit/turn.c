/* The table of kinds of axes, and the fixed rotation and spin relative to them. */
#include "orbit/turn.h"

#include <string.h>

#include "orbit/attitude.h"
#include "orbit/orientation.h"

static pl_status inertial(const pl_turn *turn, const pl_turn_view *view, pl_quat *out) {
  (void)turn, (void)view;
  *out = PL_QUAT_IDENTITY;
  return PL_OK;
}

static pl_status body(const pl_turn *turn, const pl_turn_view *view, pl_quat *out) {
  *out = pl_celestial_orientation(turn->body, view->tdb_day, view->tdb_fraction);
  return PL_OK;
}

static pl_status parent(const pl_turn *turn, const pl_turn_view *view, pl_quat *out) {
  (void)turn;
  *out = view->parent;
  return PL_OK;
}

static pl_status lvlh(const pl_turn *turn, const pl_turn_view *view, pl_quat *out) {
  (void)turn;
  return pl_attitude_lvlh(&view->relative, out);
}

static pl_status rsw(const pl_turn *turn, const pl_turn_view *view, pl_quat *out) {
  (void)turn;
  return pl_attitude_rsw(&view->relative, out);
}

static pl_status velocity(const pl_turn *turn, const pl_turn_view *view, pl_quat *out) {
  (void)turn;
  return pl_attitude_velocity(&view->relative, out);
}

static pl_vec3 up_of(const pl_turn *turn, const pl_turn_view *view) {
  return pl_vec3_norm(turn->up) > 0.0 ? turn->up : pl_attitude_normal(&view->relative);
}

static pl_status sun(const pl_turn *turn, const pl_turn_view *view, pl_quat *out) {
  return pl_attitude_aim_x(view->aim_m, up_of(turn, view), out);
}

static pl_status target(const pl_turn *turn, const pl_turn_view *view, pl_quat *out) {
  return pl_attitude_aim_z(view->aim_m, up_of(turn, view), out);
}

static pl_status tumble(const pl_turn *turn, const pl_turn_view *view, pl_quat *out) {
  *out = pl_tumble_at(&turn->tumble, view->t_s, NULL);
  return PL_OK;
}

static pl_status table(const pl_turn *turn, const pl_turn_view *view, pl_quat *out) {
  return pl_attitude_table_at(&turn->table, view->t_s, out);
}

static pl_status given(const pl_turn *turn, const pl_turn_view *view, pl_quat *out) {
  (void)turn;
  *out = view->given;
  return PL_OK;
}

static const pl_turn_kind kinds[] = {
    {"inertial", "The axes of ICRF.", 0, inertial},
    {"body", "Axes of a body of the table: x to longitude 0, z to the north pole.", PL_TURN_BODY,
     body},
    {"parent", "The axes of the parent.", PL_TURN_PARENT, parent},
    {"lvlh", "z to the parent's centre, y against the orbit normal.", PL_TURN_PARENT, lvlh},
    {"rsw", "x away from the parent's centre, z along the orbit normal.", PL_TURN_PARENT, rsw},
    {"velocity", "x along the velocity about the parent, y against the orbit normal.",
     PL_TURN_PARENT, velocity},
    {"sun", "x along a direction or to another node, z towards the orbit normal or `up`.",
     PL_TURN_AIM, sun},
    {"target", "z along a direction or to another node, y against the orbit normal or `up`.",
     PL_TURN_AIM, target},
    {"tumble", "The principal axes of a rigid body that turns freely.", PL_TURN_TUMBLE, tumble},
    {"table", "Axes interpolated between the rows of a table.", PL_TURN_TABLE, table},
    {"given", "Axes that the caller gives with the times.", PL_TURN_GIVEN, given},
};
static const size_t kind_count = sizeof kinds / sizeof kinds[0];

const pl_turn_kind *pl_turn_kinds(size_t *count) {
  *count = kind_count;
  return kinds;
}

pl_status pl_turn_require(const char *name, const pl_turn_kind **out) {
  char names[160] = "";
  for (size_t i = 0; i < kind_count; i++) {
    if (strcmp(kinds[i].name, name) == 0) {
      *out = &kinds[i];
      return PL_OK;
    }
    pl_names_append(names, sizeof names, kinds[i].name);
  }
  return pl_fail(PL_E_ARGUMENT, "frame is '%s'; allowed: %s", name, names);
}

pl_status pl_turn_prepare(pl_turn *turn) {
  if (!turn->kind)
    turn->kind = &kinds[0];
  PL_TRY(pl_attitude_check(turn->q, "q"));
  turn->q = pl_quat_unit(turn->q);
  if (!isfinite(turn->rate_rad_s))
    return pl_fail(PL_E_RANGE, "rate_rad_s is not finite");
  if (turn->rate_rad_s != 0.0 && (!pl_vec3_finite(turn->axis) || !(pl_vec3_norm(turn->axis) > 0.0)))
    return pl_fail(PL_E_RANGE, "the spin axis must be finite and not zero");
  turn->axis = pl_vec3_unit(turn->axis);
  if ((turn->kind->needs & PL_TURN_BODY) && !turn->body)
    return pl_fail(PL_E_ARGUMENT, "no body to turn with");
  if ((turn->kind->needs & PL_TURN_TUMBLE) && !(turn->tumble.scale_rad_s > 0.0))
    return pl_fail(PL_E_ARGUMENT, "no tumbling body");
  if (turn->kind->needs & PL_TURN_TABLE)
    PL_TRY(pl_attitude_table_check(&turn->table));
  if (!(turn->kind->needs & PL_TURN_AIM))
    return PL_OK;
  if (turn->towards < 0 &&
      (!pl_vec3_finite(turn->direction) || !(pl_vec3_norm(turn->direction) > 0.0)))
    return pl_fail(PL_E_RANGE, "the direction to point along must be finite and not zero");
  if (!pl_vec3_finite(turn->up))
    return pl_fail(PL_E_RANGE, "up is not finite");
  return PL_OK;
}

pl_status pl_turn_at(const pl_turn *turn, const pl_turn_view *view, pl_quat *out) {
  pl_quat q;
  PL_TRY(turn->kind->axes(turn, view, &q));
  const bool plain = turn->q.w == 1.0 && turn->rate_rad_s == 0.0; /* keeps the axes bit for bit */
  if (!plain)
    q = pl_attitude_spin(pl_quat_mul(q, turn->q), turn->axis, turn->rate_rad_s, view->t_s);
  *out = q;
  return PL_OK;
}
