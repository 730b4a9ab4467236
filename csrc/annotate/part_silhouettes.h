/* Full (amodal) silhouettes of groups of an object's parts, such as the nodes of its model: of all
 * groups at once, as a ray tells all parts that it meets. */
#ifndef PL_ANNOTATE_PART_SILHOUETTES_H
#define PL_ANNOTATE_PART_SILHOUETTES_H

#include "annotate/silhouette.h"
#include "base/memory.h"

/* Sets boxes, counts, pose and ids of the labels of groups that have one object; `extent` and
 * `outline` are those of the object. What it needs is allocated in `arena`. The result does not
 * depend on the number of threads. */
pl_status pl_part_silhouettes_label(const pl_silhouette_job *job, const pl_part_group *groups,
                                    size_t count, const pl_outline *outline,
                                    const pl_extent *extent, pl_arena *arena,
                                    pl_object_label *labels);

#endif
