/* Reads glTF 2.0 (.gltf with external files, .glb) into a model. All use of tinygltf is behind this
 * interface. */
#ifndef PL_IO_GLTF_H
#define PL_IO_GLTF_H

#include "base/status.h"
#include "geom/model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Loads the default scene of a file, flattened (the first scene when there is no default; all root
 * nodes without a scene). `stretch`: positive scale factors along the model's axes, as if all root
 * nodes were below a node of that scale; NULL for none. Errors name the file and the fault. The
 * caller destroys *out. */
pl_status pl_gltf_load(const char *path, const double stretch[3], pl_model **out);

/* Returns the JSON text of an array with {"index", "name"} for each of the file's materials, named
 * as in pl_gltf_load, and `graph` for those that are used and have `extras.perilune_graph`:
 * unchanged from the file, nested at most as deep as glTF may be (see io/gltf_guard.cpp). The text
 * is `[]` when no material has a graph, and when the file cannot be opened. Returns PL_E_FORMAT for
 * an invalid file with graphs, PL_E_RANGE for more than 1 MB of text. The caller frees *out with
 * pl_free. */
pl_status pl_gltf_graphs(const char *path, char **out);

#ifdef __cplusplus
}
#endif
#endif
