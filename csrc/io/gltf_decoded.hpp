/* Compressed content of a glTF file, which is decoded before accessors can read it. Internal to io.
 *
 * Decoded content becomes the content of buffer views (Asset::decoded), so that the rest of the
 * reader is independent of it. Its size is limited in proportion to the size of the file. */
#ifndef PL_IO_GLTF_DECODED_HPP
#define PL_IO_GLTF_DECODED_HPP

#include <string>
#include <vector>

#include "io/gltf_access.hpp"

namespace pl_gltf {

/* Decodes the primitives of KHR_draco_mesh_compression and makes them refer to new accessors
 * (gltf_draco.cpp). */
void decode_draco(Asset &asset, Warnings &warnings);

/* Decodes the buffer views of EXT_meshopt_compression (gltf_meshopt.cpp). */
void decode_meshopt(Asset &asset);

/* Returns the number of bytes that may still be decoded: FREE_DECODED for any file, plus
 * DECODED_PER_BYTE per byte of it. */
size_t decoded_room(const Asset &asset);
/* Counts bytes that will be decoded; fails with PL_E_RANGE, naming `what`, when they exceed
 * decoded_room. */
void take_decoded(Asset &asset, size_t bytes, const std::string &what);

} // namespace pl_gltf

#endif
