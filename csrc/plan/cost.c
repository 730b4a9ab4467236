/* The table of costs that ships. `perilune calibrate` measures the same on another machine. */
#include "plan/cost.h"

/* Fitted to the configurations that ship, at 72 to 128 pixels' width, on one thread of a busy EPYC
 * (`perilune calibrate`). */
static const double ns[PL_WORK_COUNT] = {
    [PL_WORK_frames] = 910000,
    [PL_WORK_entities] = 8000,
    [PL_WORK_pixels] = 21,
    [PL_WORK_samples] = 280,
    [PL_WORK_patches] = 6700,
    [PL_WORK_closed] = 26,
    [PL_WORK_packet_rays] = 370,
    [PL_WORK_single_rays] = 1200,
    [PL_WORK_shadow_rays] = 850,
    [PL_WORK_ground_rays] = 2600,
    [PL_WORK_single_ground_rays] = 26,
    [PL_WORK_shadow_ground_rays] = 3100,
    [PL_WORK_body_rays] = 19,
    [PL_WORK_mesh_hits] = 6.8,
    [PL_WORK_body_hits] = 3900,
    [PL_WORK_ground_hits] = 26,
    [PL_WORK_graph_steps] = 11,
    [PL_WORK_air_rays] = 3100,
    [PL_WORK_air_steps] = 110,
    [PL_WORK_cloud_octaves] = 150,
    [PL_WORK_volume_steps] = 1600,
    [PL_WORK_noise_octaves] = 93,
    [PL_WORK_texture_patches] = 140,
    [PL_WORK_label_values] = 5.2,
    [PL_WORK_object_pixels] = 35,
    [PL_WORK_sensor_values] = 35,
};

double pl_cost_ns(pl_work what) { return ns[what]; }
