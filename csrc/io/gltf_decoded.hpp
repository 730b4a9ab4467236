/* Content of a glTF file that must be decoded before accessors can read it. Internal to io.
 *
 * What is decoded becomes the content of buffer views (Asset::decoded), so that the rest of the
 * reader does not know of it. What it may cost is measured by the bytes of the file. */
#ifndef PL_IO_GLTF_DECODED_HPP
#define PL_IO_GLTF_DECODED_HPP

#include <string>
#include <vector>

#include "io/gltf_access.hpp"

namespace pl_gltf {

/* Decodes the primitives of KHR_draco_mesh_compression and points them to new accessors
 * (gltf_draco.cpp). */
void decode_draco(Asset &asset, Warnings &warnings);

/* Decodes the buffer views of EXT_meshopt_compression (gltf_meshopt.cpp). */
void decode_meshopt(Asset &asset);

/* Bytes that may still be decoded: files of any size may have FREE_DECODED, and then
 * DECODED_PER_BYTE a byte. */
size_t decoded_room(const Asset &asset);
/* Counts bytes that are to be decoded; PL_E_RANGE beyond the room, naming `what`. */
void take_decoded(Asset &asset, size_t bytes, const std::string &what);

} // namespace pl_gltf

#endif
