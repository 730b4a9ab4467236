/* Bounds-checked reading of accessors (glTF 2.0, section 3.6). */
#include "io/gltf_access.hpp"

#include <algorithm>
#include <cstring>

namespace pl_gltf {

namespace {

uint32_t little_endian(const uint8_t *bytes, size_t size) {
  uint32_t value = 0;
  for (size_t i = 0; i < size; i++)
    value |= static_cast<uint32_t>(bytes[i]) << (8 * i);
  return value;
}

size_t size_of(int component_type) {
  switch (component_type) {
  case TINYGLTF_COMPONENT_TYPE_BYTE:
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
    return 1;
  case TINYGLTF_COMPONENT_TYPE_SHORT:
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
    return 2;
  default:
    return 4;
  }
}

/* Checks that `count` elements of `size` bytes, `stride` apart and starting at `offset`, end within
 * `available`. */
void check_fits(size_t available, size_t offset, size_t count, size_t stride, size_t size,
                const std::string &what) {
  const bool fits = offset <= available && size <= available - offset &&
                    count - 1 <= (available - offset - size) / stride;
  if (!fits)
    fail(PL_E_FORMAT,
         "%s: %zu elements of %zu bytes do not fit into the %zu bytes of its bufferView",
         what.c_str(), count, size, available);
}

} // namespace

Bytes view_bytes(const Asset &asset, int view, const std::string &what) {
  const auto decoded = asset.decoded.find(view);
  if (decoded != asset.decoded.end())
    return {decoded->second.data(), decoded->second.size()};
  const tinygltf::BufferView &v = asset.model.bufferViews.at(static_cast<size_t>(view));
  const Bytes &buffer = asset.buffers.at(static_cast<size_t>(v.buffer));
  if (v.byteOffset > buffer.size || v.byteLength > buffer.size - v.byteOffset)
    fail(PL_E_FORMAT, "%s: bufferViews[%d] (%zu bytes from %zu) exceeds buffers[%d] of %zu bytes",
         what.c_str(), view, v.byteLength, v.byteOffset, v.buffer, buffer.size);
  return {buffer.data + v.byteOffset, v.byteLength};
}

Accessor::Accessor(const Asset &asset, int index, const std::string &what) {
  const tinygltf::Accessor &accessor = asset.model.accessors.at(static_cast<size_t>(index));
  const std::string name = what + " (accessors[" + std::to_string(index) + "])";
  count_ = accessor.count;
  components_ = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type));
  component_type_ = accessor.componentType;
  component_size_ = size_of(component_type_);
  element_size_ = component_size_ * static_cast<size_t>(components_);
  normalized_ = accessor.normalized;
  if (accessor.bufferView != asset.no_view)
    open_dense(asset, accessor, name);
  if (accessor.sparse.isSparse)
    open_sparse(asset, accessor, name);
}

void Accessor::open_dense(const Asset &asset, const tinygltf::Accessor &accessor,
                          const std::string &what) {
  const Bytes view = view_bytes(asset, accessor.bufferView, what);
  const size_t stride =
      asset.model.bufferViews[static_cast<size_t>(accessor.bufferView)].byteStride;
  stride_ = stride != 0 ? stride : element_size_;
  if (stride_ < element_size_)
    fail(PL_E_FORMAT, "%s: byteStride %zu is less than its elements' %zu bytes", what.c_str(),
         stride_, element_size_);
  check_fits(view.size, accessor.byteOffset, count_, stride_, element_size_, what);
  base_ = view.data + accessor.byteOffset;
}

/* Indices must increase strictly (section 3.6.2.3). Some exporters violate this. They are sorted,
 * and the last of several values for one element is used, as if all were written in order. */
void Accessor::open_sparse(const Asset &asset, const tinygltf::Accessor &accessor,
                           const std::string &what) {
  const auto &sparse = accessor.sparse;
  const size_t count = static_cast<size_t>(sparse.count);
  const Bytes indices = view_bytes(asset, sparse.indices.bufferView, what);
  const Bytes values = view_bytes(asset, sparse.values.bufferView, what);
  const size_t size = size_of(sparse.indices.componentType);
  check_fits(indices.size, static_cast<size_t>(sparse.indices.byteOffset), count, size, size,
             what + " sparse indices");
  check_fits(values.size, static_cast<size_t>(sparse.values.byteOffset), count, element_size_,
             element_size_, what + " sparse values");
  sparse_values_ = values.data + sparse.values.byteOffset;
  for (size_t k = 0; k < count; k++) {
    const uint32_t i = little_endian(
        indices.data + static_cast<size_t>(sparse.indices.byteOffset) + k * size, size);
    if (i >= count_)
      fail(PL_E_FORMAT, "%s: sparse index %u, but there are %zu elements", what.c_str(), i, count_);
    sparse_.push_back({i, static_cast<uint32_t>(k)});
  }
  std::sort(sparse_.begin(), sparse_.end(), [](const Replacement &a, const Replacement &b) {
    return a.index != b.index ? a.index < b.index : a.order > b.order;
  });
  const auto same = [](const Replacement &a, const Replacement &b) { return a.index == b.index; };
  sparse_.erase(std::unique(sparse_.begin(), sparse_.end(), same), sparse_.end());
}

bool Accessor::is_float() const { return component_type_ == TINYGLTF_COMPONENT_TYPE_FLOAT; }

bool Accessor::is_unsigned_integer() const {
  return component_type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
         component_type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         component_type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

const uint8_t *Accessor::element(size_t i) const {
  const auto found =
      std::lower_bound(sparse_.begin(), sparse_.end(), i,
                       [](const Replacement &r, size_t index) { return r.index < index; });
  if (found != sparse_.end() && found->index == i)
    return sparse_values_ + found->order * element_size_;
  return base_ != nullptr ? base_ + i * stride_ : nullptr;
}

/* Conversions of section 3.6.2.2, and of section 3.11 for integers that are not normalised. */
float Accessor::component(const uint8_t *at) const {
  const uint32_t bits = little_endian(at, component_size_);
  switch (component_type_) {
  case TINYGLTF_COMPONENT_TYPE_FLOAT: {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
  }
  case TINYGLTF_COMPONENT_TYPE_BYTE: {
    const float value = static_cast<float>(static_cast<int8_t>(bits));
    return normalized_ ? std::max(value / 127.0f, -1.0f) : value;
  }
  case TINYGLTF_COMPONENT_TYPE_SHORT: {
    const float value = static_cast<float>(static_cast<int16_t>(bits));
    return normalized_ ? std::max(value / 32767.0f, -1.0f) : value;
  }
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
    return normalized_ ? static_cast<float>(bits) / 255.0f : static_cast<float>(bits);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
    return normalized_ ? static_cast<float>(bits) / 65535.0f : static_cast<float>(bits);
  default:
    return static_cast<float>(bits);
  }
}

void Accessor::read(size_t i, float out[4]) const {
  const uint8_t *at = element(i);
  const int n = std::min(components_, 4);
  for (int c = 0; c < n; c++)
    out[c] = at == nullptr ? 0.0f : component(at + static_cast<size_t>(c) * component_size_);
}

uint32_t Accessor::read_index(size_t i) const {
  const uint8_t *at = element(i);
  return at == nullptr ? 0 : little_endian(at, component_size_);
}

uint32_t Accessor::restart_value() const {
  return static_cast<uint32_t>((uint64_t{1} << (8 * component_size_)) - 1);
}

} // namespace pl_gltf
