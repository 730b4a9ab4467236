/* Reading glTF 2.0 (.gltf with files beside it, .glb) into a model; the only door to tinygltf. */
#ifndef PL_IO_GLTF_H
#define PL_IO_GLTF_H

#include "base/status.h"
#include "geom/model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Loads the default scene (or, when none is named, the first; or all root nodes) of a file,
 * flattened. `stretch`: factors along the model's axes, positive, as if all root nodes were below a
 * node of that scale; NULL for none. Errors name the file and the fault. The caller destroys
 * *out. */
pl_status pl_gltf_load(const char *path, const double stretch[3], pl_model **out);

/* JSON text of an array with {"index", "name"} of each of the file's materials, named as
 * pl_gltf_load names them, and `graph` of those that are used and have `extras.perilune_graph`: as
 * it is in the file, nested at most as deep as glTF may be (see io/gltf_guard.cpp). `[]` when no
 * material has one, and when the file cannot be opened. PL_E_FORMAT for a file with graphs that is
 * broken, PL_E_RANGE for more than 1 MB of text. The caller frees *out by pl_free. */
pl_status pl_gltf_graphs(const char *path, char **out);

#ifdef __cplusplus
}
#endif
#endif
