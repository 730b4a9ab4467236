/* Checks on the JSON of a glTF file before it is given to tinygltf. Internal to io.
 *
 * tinygltf trusts its input in places (offsets of images, recursion, one copy of the binary chunk a
 * buffer) and skips what has the wrong type. So all of that is settled here, with an error that
 * names the JSON path, and tinygltf receives a document that is known to be sound and refers to no
 * file. */
#ifndef PL_IO_GLTF_GUARD_HPP
#define PL_IO_GLTF_GUARD_HPP

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/gltf_access.hpp"
#include "io/gltf_internal.hpp"

namespace pl_gltf {

/* Parses and checks: text depth, types, index ranges, extensions, version, node hierarchy. */
nlohmann::json parse_and_check(const Source &source, Warnings &warnings);

/* Types and index ranges of every object the reader uses (gltf_schema.cpp). May turn integers
 * written as floats into integers, and gives primitives without attributes empty ones. */
void check_schema(nlohmann::json &document);

/* Content of every buffer and of every image outside the buffers. */
std::vector<Bytes> load_buffers(const nlohmann::json &document, Source &source);
std::vector<ImageRef> load_images(const nlohmann::json &document, Source &source);

/* Textures are given the image of EXT_texture_webp where they name one; the other is a fallback.
 * Accessors without a buffer view are given one that tinygltf accepts; its index, of the first view
 * that does not exist in the file, is returned. */
int strip_for_parser(nlohmann::json &document);

} // namespace pl_gltf

#endif
