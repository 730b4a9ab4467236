/* Counts of what a frame does, in units whose number depends neither on threads nor on the machine,
 * nor on what is kept from frames before it: the input of the model of costs (plan/cost.h). */
#ifndef PL_BASE_WORK_H
#define PL_BASE_WORK_H

#include <stddef.h>
#include <stdint.h>

/* What is counted: name, and what one is. A unit should cost about the same in every scene. */
/* clang-format off */
#define PL_WORKS(X) \
  X(frames, "a frame: its snapshot, plan and culling") \
  X(entities, "an object or body of a snapshot that is realised") \
  X(pixels, "a pixel of an image that is rendered, metering included") \
  X(samples, "a sample of a pixel") \
  X(patches, "a surface in a pixel whose indirect light the irradiance filter shares") \
  X(closed, "a pixel of a body whose mean has a closed form") \
  X(packet_rays, "a ray of a packet that enters a mesh") \
  X(single_rays, "a ray that enters a mesh alone: light between surfaces") \
  X(shadow_rays, "a shadow ray that enters a mesh") \
  X(ground_rays, "a ray of a packet that enters ground") \
  X(single_ground_rays, "a ray that enters ground alone") \
  X(shadow_ground_rays, "a shadow ray that enters ground") \
  X(body_rays, "a ray beside bodies and other closed forms") \
  X(mesh_hits, "a hit on a mesh that is shaded") \
  X(body_hits, "a hit on the ellipsoid of a body that is shaded") \
  X(ground_hits, "a hit on ground or rocks that is shaded") \
  X(graph_steps, "an instruction of a material graph at a point") \
  X(air_rays, "a ray of which light and attenuation in air are integrated") \
  X(air_steps, "a node of these integrals") \
  X(cloud_octaves, "an octave of the noise of clouds at a place") \
  X(volume_steps, "a step through a volume") \
  X(noise_octaves, "an octave of fractal noise at a point") \
  X(texture_patches, "a patch of a ground texture at a point") \
  X(label_values, "a label channel in a pixel") \
  X(object_pixels, "a pixel of a frame with labels of objects") \
  X(sensor_values, "a stage of the sensor in a pixel")
/* clang-format on */

typedef enum pl_work {
#define PL_WORK_ID(name, doc) PL_WORK_##name,
  PL_WORKS(PL_WORK_ID)
#undef PL_WORK_ID
      PL_WORK_COUNT
} pl_work;

typedef struct pl_work_counts {
  uint64_t of[PL_WORK_COUNT];
} pl_work_counts;

/* Counts of the calling thread since it began; those of pl_parallel_for's threads are added to the
 * caller's. Nothing but the model of costs reads them. */
extern _Thread_local pl_work_counts pl_work_done;

/* To be called for many at once: a thread's own variable costs some nanoseconds to find. */
static inline void pl_work_add(pl_work what, size_t count) { pl_work_done.of[what] += count; }

/* Name and description of a unit. */
const char *pl_work_name(pl_work what);
const char *pl_work_doc(pl_work what);

/* What was done since `before`, by the calling thread and those that worked for it. */
pl_work_counts pl_work_since(const pl_work_counts *before);
/* Adds counts to the calling thread's. */
void pl_work_add_all(const pl_work_counts *counts);

#endif
