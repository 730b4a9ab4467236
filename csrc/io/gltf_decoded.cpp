/* Limits on the size of decoded content. */
#include "io/gltf_decoded.hpp"

namespace pl_gltf {

namespace {

constexpr size_t FREE_DECODED = size_t{1} << 26;
/* Expansion that the codec of EXT_meshopt_compression reaches: 4 bytes for 256 that do not
 * change. */
constexpr size_t DECODED_PER_BYTE = 64;

} // namespace

size_t decoded_room(const Asset &asset) {
  return FREE_DECODED + DECODED_PER_BYTE * asset.source->total_bytes() - asset.decoded_bytes;
}

void take_decoded(Asset &asset, size_t bytes, const std::string &what) {
  if (bytes > decoded_room(asset))
    fail(PL_E_RANGE, "%s: decodes to more bytes than a file of %zu bytes may have", what.c_str(),
         asset.source->total_bytes());
  asset.decoded_bytes += bytes;
}

} // namespace pl_gltf
