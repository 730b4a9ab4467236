/* Intersects rays with bounding spheres and transforms them to mesh units, in double. */
#include "trace/instance.h"

#include "base/wide.h"
#include "math/affine.h"

/* Relative rounding error of doubles over the distance to a sphere; the radius is enlarged by it.
 */
static const double LOST = 1e-15;

void pl_instance_place(pl_instance *instance, const pl_mat3 *linear, pl_vec3 origin, pl_vec3 center,
                       double radius_m) {
  const pl_affine place = {*linear, {0.0, 0.0, 0.0}};
  instance->to_mesh = pl_affine_inverse(&place).m;
  instance->center = center;
  instance->radius_m = radius_m;
  instance->mesh_center = pl_mat3_mul_vec(instance->to_mesh, pl_vec3_sub(center, origin));
}

void pl_packet_fill(pl_packet *packet, const pl_ray *rays, size_t count) {
  for (size_t i = 0; i < PL_PACKET; i++) {
    const pl_ray *ray = &rays[i < count ? i : 0];
    packet->origin[0][i] = ray->origin.x;
    packet->origin[1][i] = ray->origin.y;
    packet->origin[2][i] = ray->origin.z;
    packet->direction[0][i] = ray->direction.x;
    packet->direction[1][i] = ray->direction.y;
    packet->direction[2][i] = ray->direction.z;
    packet->limit[i] = i < count ? ray->t_max : -1.0;
  }
}

/* The ray is closest to the sphere's centre at `along`. The interval from along - reach to along +
 * reach contains all its points inside the sphere; `beside` is reach squared minus the squared
 * distance from the centre to the line. */
PL_WIDE bool pl_packet_enter(const pl_packet *packet, pl_vec3 center, double radius_m,
                             pl_entry *entry) {
  double inside[PL_PACKET];
  for (int i = 0; i < PL_PACKET; i++) {
    const double dx = packet->direction[0][i], dy = packet->direction[1][i];
    const double dz = packet->direction[2][i];
    const double x = center.x - packet->origin[0][i], y = center.y - packet->origin[1][i];
    const double z = center.z - packet->origin[2][i];
    const double along = x * dx + y * dy + z * dz;
    const double px = x - along * dx, py = y - along * dy, pz = z - along * dz;
    const double reach = radius_m + LOST * fabs(along);
    const double start = along - reach;
    const double beside = reach * reach - (px * px + py * py + pz * pz);
    const double behind = along + reach, before = packet->limit[i] - start;
    double least = beside < behind ? beside : behind;
    least = before < least ? before : least;
    inside[i] = packet->limit[i] < 0.0 ? -1.0 : least;
    entry->start_m[i] = start > 0.0 ? start : 0.0;
  }
  int any = 0;
  for (int i = 0; i < PL_PACKET; i++) {
    entry->valid[i] = inside[i] >= 0.0 ? -1 : 0;
    any |= entry->valid[i];
  }
  return any != 0;
}

PL_WIDE void pl_packet_approach(const pl_packet *packet, const pl_instance *instance,
                                const pl_entry *entry, pl_approach *out) {
  const pl_mat3 m = instance->to_mesh;
  const pl_vec3 c = instance->center, q = instance->mesh_center;
  for (int i = 0; i < PL_PACKET; i++) {
    const double dx = packet->direction[0][i], dy = packet->direction[1][i];
    const double dz = packet->direction[2][i], start = entry->start_m[i];
    const double x = packet->origin[0][i] + start * dx - c.x;
    const double y = packet->origin[1][i] + start * dy - c.y;
    const double z = packet->origin[2][i] + start * dz - c.z;
    const double ex = m.row[0].x * dx + m.row[0].y * dy + m.row[0].z * dz;
    const double ey = m.row[1].x * dx + m.row[1].y * dy + m.row[1].z * dz;
    const double ez = m.row[2].x * dx + m.row[2].y * dy + m.row[2].z * dz;
    const double per_metre = sqrt(ex * ex + ey * ey + ez * ez), by = 1.0 / per_metre;
    out->origin[0][i] = (float)(q.x + (m.row[0].x * x + m.row[0].y * y + m.row[0].z * z));
    out->origin[1][i] = (float)(q.y + (m.row[1].x * x + m.row[1].y * y + m.row[1].z * z));
    out->origin[2][i] = (float)(q.z + (m.row[2].x * x + m.row[2].y * y + m.row[2].z * z));
    out->direction[0][i] = (float)(ex * by);
    out->direction[1][i] = (float)(ey * by);
    out->direction[2][i] = (float)(ez * by);
    out->per_metre[i] = per_metre;
  }
}

bool pl_ray_enter(const pl_ray *ray, double limit_m, pl_vec3 center, double radius_m,
                  double *start_m) {
  const pl_vec3 to = pl_vec3_sub(center, ray->origin);
  const double along = pl_vec3_dot(to, ray->direction);
  const pl_vec3 beside = pl_vec3_madd(to, -along, ray->direction);
  const double reach = radius_m + LOST * fabs(along), start = along - reach;
  *start_m = start > 0.0 ? start : 0.0;
  return along + reach >= 0.0 && start <= limit_m && pl_vec3_dot(beside, beside) <= reach * reach;
}

pl_lone_approach pl_ray_approach(const pl_ray *ray, const pl_instance *instance, double start_m) {
  const pl_vec3 from =
      pl_vec3_sub(pl_vec3_madd(ray->origin, start_m, ray->direction), instance->center);
  const pl_vec3 along = pl_mat3_mul_vec(instance->to_mesh, ray->direction);
  const double per_metre = pl_vec3_norm(along);
  return (pl_lone_approach){
      .origin = pl_vec3_to_float(
          pl_vec3_add(instance->mesh_center, pl_mat3_mul_vec(instance->to_mesh, from))),
      .direction = pl_vec3_to_float(pl_vec3_scale(along, 1.0 / per_metre)),
      .start_m = start_m,
      .per_metre = per_metre,
  };
}
