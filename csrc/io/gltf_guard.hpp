/* Checks on the JSON of a glTF file before it is given to tinygltf. Internal to io.
 *
 * In some places tinygltf trusts its input (offsets of images, recursion, one copy of the binary
 * chunk per buffer), and it skips properties of the wrong type. All of that is checked here, with
 * errors that name the JSON path, so that tinygltf receives a valid document that refers to no
 * file. */
#ifndef PL_IO_GLTF_GUARD_HPP
#define PL_IO_GLTF_GUARD_HPP

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/gltf_access.hpp"
#include "io/gltf_internal.hpp"

namespace pl_gltf {

/* Parses the document and checks text depth, types, index ranges, extensions, version and node
 * hierarchy. */
nlohmann::json parse_and_check(const Source &source, Warnings &warnings);

/* Checks types and index ranges of every object that the reader uses (gltf_schema.cpp). May convert
 * integers written as floats to integers, and adds an empty `attributes` object to primitives that
 * have none. */
void check_schema(nlohmann::json &document);

/* Load the content of every buffer, and of every image outside the buffers. */
std::vector<Bytes> load_buffers(const nlohmann::json &document, Source &source);
std::vector<ImageRef> load_images(const nlohmann::json &document, Source &source);

/* Textures with EXT_texture_webp get the image that it names; their other image is a fallback.
 * Accessors without a buffer view get one that tinygltf accepts. Returns the index of that view,
 * the first one after those of the file. */
int strip_for_parser(nlohmann::json &document);

} // namespace pl_gltf

#endif
