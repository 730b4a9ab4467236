/* Reading glTF 2.0 (.gltf with files beside it, .glb) into a model; the only door to tinygltf. */
#ifndef PL_IO_GLTF_H
#define PL_IO_GLTF_H

#include "base/status.h"
#include "geom/model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Loads the default scene (or, when none is named, the first; or all root nodes) of a file,
 * flattened. Errors name the file and the fault. The caller destroys *out. */
pl_status pl_gltf_load(const char *path, pl_model **out);

#ifdef __cplusplus
}
#endif
#endif
