/* KHR_draco_mesh_compression, with libdraco. Its decoders allocate memory by the sizes that a
 * stream's header claims, so these are checked before each allocation. */
#include "io/gltf_decoded.hpp"

#include <cstring>

#include <draco/compression/config/decoder_options.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>

namespace pl_gltf {

namespace {

/* Bitstream version of the extension. Older versions use other code paths of libdraco and occur in
 * no known glTF file. */
constexpr int VERSION_MAJOR = 2, VERSION_MINOR = 2;
/* A decoder's work and memory grow with the number of faces times that of corner tables: one of the
 * mesh, and one for each group of attributes with its own seams. FREE_WORK is allowed for any file,
 * plus WORK_PER_BYTE per byte: a face takes at least about one bit, i.e. 8 faces per byte, in each
 * of a few tables. */
constexpr uint64_t FREE_WORK = uint64_t{1} << 21;
constexpr uint64_t WORK_PER_BYTE = 32;
/* Largest number of attributes of a mesh, and of components of an attribute (VEC4), that glTF can
 * use. The number of attributes is small because libdraco 1.5 trusts a count of orientations in
 * each (prediction by texture coordinates) and counts up to 2^31, which takes up to ten seconds. */
constexpr int MAX_ATTRIBUTES = 16, MAX_COMPONENTS = 4;

struct Limits {
  uint64_t work = 0;
  size_t attribute_bytes = 0;
};

/* A decoder of libdraco that checks the sizes which a stream claims before their memory is
 * allocated. Exceptions cannot pass through libdraco, so the reason of a refusal is stored. */
template <typename Decoder> class Limited final : public Decoder {
public:
  explicit Limited(const Limits &limits) : limits_(limits) {}
  const std::string &refusal() const { return refusal_; }

private:
  bool refuse(const char *reason) {
    refusal_ = reason;
    return false;
  }

  /* Both encodings begin with two numbers: vertices and faces of an edgebreaker stream, faces and
   * points of a sequential one. */
  bool DecodeConnectivity() override {
    draco::DecoderBuffer peek = *this->buffer();
    uint32_t first = 0, second = 0;
    uint8_t tables = 0;
    if (!draco::DecodeVarint(&first, &peek) || !draco::DecodeVarint(&second, &peek) ||
        !peek.Decode(&tables))
      return refuse("truncated");
    const bool edgebreaker = std::is_base_of<draco::MeshEdgebreakerDecoder, Decoder>::value;
    const uint64_t faces = edgebreaker ? second : first;
    if (faces * (edgebreaker ? uint64_t{1} + tables : 1) > limits_.work)
      return refuse("more faces than its bytes can hold");
    return Decoder::DecodeConnectivity();
  }

  /* At this point the attributes are known and their values are not yet allocated. */
  bool DecodeAllAttributes() override {
    const draco::PointCloud &cloud = *this->point_cloud();
    if (cloud.num_attributes() > MAX_ATTRIBUTES)
      return refuse("more than 16 attributes");
    uint64_t stride = 0;
    for (int i = 0; i < cloud.num_attributes(); i++) {
      if (cloud.attribute(i)->num_components() > MAX_COMPONENTS)
        return refuse("an attribute of more than 4 components");
      stride += static_cast<uint64_t>(cloud.attribute(i)->byte_stride());
    }
    if (stride * cloud.num_points() > limits_.attribute_bytes)
      return refuse("more values than its bytes can hold");
    return Decoder::DecodeAllAttributes();
  }

  const Limits limits_;
  std::string refusal_;
};

template <typename Decoder>
void run(const Limits &limits, draco::DecoderBuffer &buffer, draco::Mesh &mesh,
         const std::string &what) {
  Limited<Decoder> decoder(limits);
  const draco::DecoderOptions options;
  const draco::Status status = decoder.Decode(options, &buffer, &mesh);
  if (status.ok())
    return;
  const std::string reason =
      decoder.refusal().empty() ? status.error_msg_string() : decoder.refusal();
  fail(PL_E_FORMAT, "%s: broken Draco data: %s", what.c_str(), printable(reason).c_str());
}

void decode_mesh(Bytes bytes, const Limits &limits, draco::Mesh &mesh, const std::string &what) {
  draco::DecoderBuffer buffer, peek;
  buffer.Init(reinterpret_cast<const char *>(bytes.data), bytes.size);
  peek = buffer;
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&peek, &header).ok())
    fail(PL_E_FORMAT, "%s: broken Draco data: no header", what.c_str());
  if (header.version_major != VERSION_MAJOR || header.version_minor != VERSION_MINOR)
    fail(PL_E_UNSUPPORTED, "%s: Draco bitstream %d.%d; only %d.%d is read", what.c_str(),
         header.version_major, header.version_minor, VERSION_MAJOR, VERSION_MINOR);
  if (header.encoder_type != draco::TRIANGULAR_MESH)
    fail(PL_E_FORMAT, "%s: Draco data of no triangle mesh", what.c_str());
  if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING)
    run<draco::MeshEdgebreakerDecoder>(limits, buffer, mesh, what);
  else if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING)
    run<draco::MeshSequentialDecoder>(limits, buffer, mesh, what);
  else
    fail(PL_E_FORMAT, "%s: broken Draco data: unknown method", what.c_str());
}

/* Adds a buffer view with the given content; returns its index. */
int add_view(Asset &asset, std::vector<uint8_t> content) {
  tinygltf::BufferView view;
  view.byteLength = content.size();
  asset.model.bufferViews.push_back(view);
  const int index = static_cast<int>(asset.model.bufferViews.size() - 1);
  asset.decoded[index] = std::move(content);
  return index;
}

/* Adds an accessor like `from` for decoded values; returns its index. */
int add_accessor(Asset &asset, tinygltf::Accessor from, size_t count, std::vector<uint8_t> values) {
  from.bufferView = add_view(asset, std::move(values));
  from.byteOffset = 0;
  from.count = count;
  asset.model.accessors.push_back(std::move(from));
  return static_cast<int>(asset.model.accessors.size() - 1);
}

int add_indices(Asset &asset, const draco::Mesh &mesh, const std::string &what) {
  const size_t faces = mesh.num_faces();
  take_decoded(asset, 12 * faces, what);
  std::vector<uint8_t> values(12 * faces);
  for (uint32_t f = 0; f < faces; f++) {
    const draco::Mesh::Face &face = mesh.face(draco::FaceIndex(f));
    for (size_t k = 0; k < 3; k++) {
      const uint32_t point = face[k].value();
      if (point >= mesh.num_points())
        fail(PL_E_FORMAT, "%s: broken Draco data: a corner without a point", what.c_str());
      /* the accessor reads it byte by byte as little endian */
      memcpy(&values[12 * f + 4 * k], &point, 4);
    }
  }
  tinygltf::Accessor accessor;
  accessor.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  accessor.type = TINYGLTF_TYPE_SCALAR;
  return add_accessor(asset, accessor, 3 * faces, std::move(values));
}

/* Converts the values of all points to the accessor's type T. */
template <typename T>
std::vector<uint8_t> convert(const draco::PointAttribute &attribute, size_t points,
                             const std::string &what) {
  const int8_t components = static_cast<int8_t>(attribute.num_components());
  const size_t size = sizeof(T) * static_cast<size_t>(components);
  std::vector<uint8_t> values(size * points);
  for (uint32_t p = 0; p < points; p++) {
    const draco::AttributeValueIndex value = attribute.mapped_index(draco::PointIndex(p));
    T row[MAX_COMPONENTS];
    if (value.value() >= attribute.size() || !attribute.ConvertValue<T>(value, components, row))
      fail(PL_E_FORMAT, "%s: broken Draco data: value %u does not fit", what.c_str(), p);
    memcpy(&values[size * p], row, size);
  }
  return values;
}

bool is_integer(draco::DataType type) { return type >= draco::DT_INT8 && type <= draco::DT_UINT64; }

std::vector<uint8_t> convert_to(int component_type, const draco::PointAttribute &attribute,
                                size_t points, const std::string &what) {
  if (component_type != TINYGLTF_COMPONENT_TYPE_FLOAT && !is_integer(attribute.data_type()))
    fail(PL_E_FORMAT, "%s: Draco data of floats for an accessor of integers", what.c_str());
  switch (component_type) {
  case TINYGLTF_COMPONENT_TYPE_BYTE:
    return convert<int8_t>(attribute, points, what);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
    return convert<uint8_t>(attribute, points, what);
  case TINYGLTF_COMPONENT_TYPE_SHORT:
    return convert<int16_t>(attribute, points, what);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
    return convert<uint16_t>(attribute, points, what);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    return convert<uint32_t>(attribute, points, what);
  default:
    return convert<float>(attribute, points, what);
  }
}

int add_attribute(Asset &asset, const draco::Mesh &mesh, uint32_t id,
                  const tinygltf::Accessor &accessor, const std::string &what, Warnings &warnings) {
  const draco::PointAttribute *attribute = mesh.GetAttributeByUniqueId(id);
  if (attribute == nullptr)
    fail(PL_E_FORMAT, "%s: the Draco data have no attribute %u", what.c_str(), id);
  const size_t points = mesh.num_points();
  const int components = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type));
  if (attribute->num_components() != components)
    fail(PL_E_FORMAT, "%s: %d components in the Draco data, %d in the accessor", what.c_str(),
         attribute->num_components(), components);
  if (accessor.count != points)
    warnings.add("%s: %zu vertices in the Draco data, %zu in the accessor", what.c_str(), points,
                 accessor.count);
  const int size = tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(accessor.componentType));
  take_decoded(asset, static_cast<size_t>(components * size) * points, what);
  return add_accessor(asset, accessor, points,
                      convert_to(accessor.componentType, *attribute, points, what));
}

/* Precondition, checked by the guard: the extension's types and indices are valid. */
void decode_primitive(Asset &asset, tinygltf::Primitive &primitive, const std::string &what,
                      Warnings &warnings) {
  const auto it = primitive.extensions.find("KHR_draco_mesh_compression");
  if (it == primitive.extensions.end())
    return;
  if (primitive.mode != TINYGLTF_MODE_TRIANGLES && primitive.mode != TINYGLTF_MODE_TRIANGLE_STRIP)
    fail(PL_E_FORMAT, "%s: Draco data in mode %d; must be triangles or a strip", what.c_str(),
         primitive.mode);
  const Bytes bytes = view_bytes(asset, it->second.Get("bufferView").GetNumberAsInt(), what);
  draco::Mesh mesh;
  decode_mesh(bytes, {FREE_WORK + WORK_PER_BYTE * bytes.size, decoded_room(asset)}, mesh, what);
  const tinygltf::Value ids = it->second.Get("attributes");
  for (const std::string &name : ids.Keys()) {
    const auto attribute = primitive.attributes.find(name);
    if (attribute == primitive.attributes.end()) {
      warnings.add("%s: the Draco attribute %s is none of the primitive and left out", what.c_str(),
                   printable(name).c_str());
      continue;
    }
    const tinygltf::Accessor accessor =
        asset.model.accessors[static_cast<size_t>(attribute->second)];
    attribute->second =
        add_attribute(asset, mesh, static_cast<uint32_t>(ids.Get(name).GetNumberAsInt()), accessor,
                      what + "." + printable(name), warnings);
  }
  /* Decoded meshes are triangle lists, even if they were encoded from strips. */
  primitive.indices = add_indices(asset, mesh, what + ".indices");
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
}

} // namespace

void decode_draco(Asset &asset, Warnings &warnings) {
  for (size_t m = 0; m < asset.model.meshes.size(); m++) {
    std::vector<tinygltf::Primitive> &primitives = asset.model.meshes[m].primitives;
    for (size_t p = 0; p < primitives.size(); p++)
      decode_primitive(asset, primitives[p],
                       "meshes[" + std::to_string(m) + "].primitives[" + std::to_string(p) + "]",
                       warnings);
  }
}

} // namespace pl_gltf
