/* The table of costs that ships. `perilune calibrate` measures the same on another machine. */
#include "plan/cost.h"

/* Fitted to the configurations that ship, at 96 pixels' width, on one thread of an AMD EPYC
 * (`perilune calibrate`). */
static const double ns[PL_WORK_COUNT] = {
    [PL_WORK_frames] = 2.4e6,
    [PL_WORK_entities] = 8300,
    [PL_WORK_pixels] = 0.27,
    [PL_WORK_samples] = 370,
    [PL_WORK_patches] = 9500,
    [PL_WORK_closed] = 27,
    [PL_WORK_packet_rays] = 500,
    [PL_WORK_single_rays] = 1500,
    [PL_WORK_shadow_rays] = 1100,
    [PL_WORK_ground_rays] = 2400,
    [PL_WORK_single_ground_rays] = 27,
    [PL_WORK_shadow_ground_rays] = 3500,
    [PL_WORK_body_rays] = 29,
    [PL_WORK_mesh_hits] = 7.3,
    [PL_WORK_body_hits] = 3500,
    [PL_WORK_ground_hits] = 1600,
    [PL_WORK_graph_steps] = 26,
    [PL_WORK_air_rays] = 6200,
    [PL_WORK_air_steps] = 92,
    [PL_WORK_cloud_octaves] = 140,
    [PL_WORK_volume_steps] = 1200,
    [PL_WORK_noise_octaves] = 1.1,
    [PL_WORK_texture_patches] = 200,
    [PL_WORK_label_values] = 5.5,
    [PL_WORK_object_pixels] = 36,
    [PL_WORK_sensor_values] = 36,
    [PL_WORK_posts] = 910,
};

double pl_cost_ns(pl_work what) { return ns[what]; }
