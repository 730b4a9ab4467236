/* EXT_meshopt_compression, with meshoptimizer's decoders. They check reads against the end of the
 * stream, but their arguments only by assertions, so these are checked here. */
#include "io/gltf_decoded.hpp"

#include <meshoptimizer.h>

namespace pl_gltf {

namespace {

/* One compressed buffer view. */
struct Stream {
  Bytes bytes;
  size_t count, stride;
  std::string mode, filter;
};

std::string text_of(const tinygltf::Value &value, const char *key, const char *standard) {
  return value.Has(key) ? value.Get(key).Get<std::string>() : standard;
}

size_t size_of(const tinygltf::Value &value, const char *key) {
  return value.Has(key) ? static_cast<size_t>(value.Get(key).GetNumberAsInt()) : 0;
}

/* Precondition, checked by the guard: types and indices are valid. */
Stream open_stream(const Asset &asset, const tinygltf::Value &value, const std::string &what) {
  const Bytes &buffer = asset.buffers[size_of(value, "buffer")];
  const size_t offset = size_of(value, "byteOffset"), length = size_of(value, "byteLength");
  if (offset > buffer.size || length > buffer.size - offset)
    fail(PL_E_FORMAT, "%s: %zu bytes from %zu exceed buffers[%zu] of %zu bytes", what.c_str(),
         length, offset, size_of(value, "buffer"), buffer.size);
  return {{buffer.data + offset, length},
          size_of(value, "count"),
          size_of(value, "byteStride"),
          text_of(value, "mode", ""),
          text_of(value, "filter", "NONE")};
}

/* Checks strides and counts by the rules of the extension for mode and filter. */
void check_shape(const Stream &s, const std::string &what) {
  const bool attributes = s.mode == "ATTRIBUTES";
  if (attributes ? s.stride % 4 != 0 : s.stride != 2 && s.stride != 4)
    fail(PL_E_FORMAT, "%s.byteStride: %zu is not allowed for %s", what.c_str(), s.stride,
         s.mode.c_str());
  if (s.mode == "TRIANGLES" && s.count % 3 != 0)
    fail(PL_E_FORMAT, "%s.count: %zu indices make no whole triangles", what.c_str(), s.count);
  const bool fits = s.filter == "OCTAHEDRAL"   ? s.stride == 4 || s.stride == 8
                    : s.filter == "QUATERNION" ? s.stride == 8
                                               : true;
  if (!fits || (!attributes && s.filter != "NONE"))
    fail(PL_E_FORMAT, "%s.filter: %s is not allowed for %s with a stride of %zu", what.c_str(),
         s.filter.c_str(), s.mode.c_str(), s.stride);
}

std::vector<uint8_t> decode(const Stream &s, const std::string &what) {
  std::vector<uint8_t> out(s.count * s.stride);
  const uint8_t *from = s.bytes.data;
  const size_t size = s.bytes.size;
  int fault;
  if (s.mode == "ATTRIBUTES")
    fault = meshopt_decodeVertexBuffer(out.data(), s.count, s.stride, from, size);
  else if (s.mode == "TRIANGLES")
    fault = meshopt_decodeIndexBuffer(out.data(), s.count, s.stride, from, size);
  else
    fault = meshopt_decodeIndexSequence(out.data(), s.count, s.stride, from, size);
  if (fault != 0)
    fail(PL_E_FORMAT, "%s: broken meshopt data of mode %s", what.c_str(), s.mode.c_str());
  if (s.filter == "OCTAHEDRAL")
    meshopt_decodeFilterOct(out.data(), s.count, s.stride);
  else if (s.filter == "QUATERNION")
    meshopt_decodeFilterQuat(out.data(), s.count, s.stride);
  else if (s.filter == "EXPONENTIAL")
    meshopt_decodeFilterExp(out.data(), s.count, s.stride);
  return out;
}

} // namespace

void decode_meshopt(Asset &asset) {
  for (size_t i = 0; i < asset.model.bufferViews.size(); i++) {
    const tinygltf::BufferView &view = asset.model.bufferViews[i];
    const auto it = view.extensions.find("EXT_meshopt_compression");
    if (it == view.extensions.end())
      continue;
    const std::string what =
        "bufferViews[" + std::to_string(i) + "].extensions.EXT_meshopt_compression";
    const Stream stream = open_stream(asset, it->second, what);
    check_shape(stream, what);
    if (view.byteLength != stream.count * stream.stride)
      fail(PL_E_FORMAT, "%s: %zu elements of %zu bytes, but the view's byteLength is %zu",
           what.c_str(), stream.count, stream.stride, view.byteLength);
    take_decoded(asset, view.byteLength, what);
    asset.decoded[static_cast<int>(i)] = decode(stream, what);
  }
}

} // namespace pl_gltf
