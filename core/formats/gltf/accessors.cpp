#include "core/formats/gltf/accessors.hpp"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "core/formats/draft/bytes.hpp"

namespace peerd::formats::gltf {
namespace {

// Returns the number that the bytes of a component stand for; integers of a normalized accessor are shares of their
// type's largest (glTF 2.0, 3.6.2.2).
template <class T>
double decoded(std::string_view bytes, bool normalized) {
  const auto value = static_cast<double>(little_endian<T>(bytes));
  if (!normalized || !std::numeric_limits<T>::is_integer) return value;
  return std::max(value / static_cast<double>(std::numeric_limits<T>::max()), -1.0);
}

double component(int type, std::string_view bytes, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return decoded<std::int8_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return decoded<std::uint8_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return decoded<std::int16_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return decoded<std::uint16_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return decoded<std::uint32_t>(bytes, normalized);
    default:
      return decoded<float>(bytes, normalized);
  }
}

bool is_component_type(int type) {
  return type >= TINYGLTF_COMPONENT_TYPE_BYTE && type <= TINYGLTF_COMPONENT_TYPE_FLOAT &&
         type != TINYGLTF_COMPONENT_TYPE_INT;
}
bool is_index_type(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

std::size_t size_of(int type) {
  return static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type)));
}

std::string path_of(int accessor) { return "accessors/" + std::to_string(accessor) + ": "; }

}  // namespace

std::uint64_t Accessors::count(int accessor) const {
  const bool there = accessor >= 0 && static_cast<std::size_t>(accessor) < model_.accessors.size();
  return there ? model_.accessors[static_cast<std::size_t>(accessor)].count : 0;
}

std::size_t Accessors::width(int accessor) const {
  if (count(accessor) == 0) return 0;
  const int type = model_.accessors[static_cast<std::size_t>(accessor)].type;
  return static_cast<std::size_t>(std::max(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)), 0));
}

std::expected<Accessors::Strided, std::string> Accessors::strided(int view, std::uint64_t offset, std::uint64_t count,
                                                                  std::size_t size) const {
  const auto bytes = bytes_of_view(model_, buffers_, view);
  if (!bytes) return std::unexpected("it has no bufferView, or one that reaches beyond the bytes of its buffer");
  const std::size_t given = model_.bufferViews[static_cast<std::size_t>(view)].byteStride;
  const std::size_t stride = given == 0 ? size : given;
  if (stride < size) return std::unexpected("the stride of its bufferView is less than the size of a value");
  if (offset > bytes->size() || bytes->size() - offset < size || (bytes->size() - offset - size) / stride < count - 1) {
    return std::unexpected("its values reach beyond its bufferView");
  }
  return Strided{bytes->substr(offset), stride};
}

// Reads values whose numbers are T in the file, which most are.
template <class T>
void copy_numbers(std::string_view bytes, std::size_t stride, std::size_t numbers, std::vector<T>& out) {
  const std::size_t size = numbers * sizeof(T);
  if (stride == size) {
    const std::string_view all = bytes.substr(0, out.size() * sizeof(T));
    std::memcpy(out.data(), all.data(), all.size());
    return;
  }
  for (std::size_t i = 0; i * numbers < out.size(); ++i) {
    std::memcpy(out.data() + i * numbers, bytes.data() + i * stride, size);
  }
}

template <class T, class Decode>
std::expected<std::vector<T>, std::string> Accessors::values(int accessor, Decode decode) {
  const tinygltf::Accessor& a = model_.accessors[static_cast<std::size_t>(accessor)];
  const auto failed = [&](std::string why) { return std::unexpected(path_of(accessor) + std::move(why)); };
  const std::size_t numbers = width(accessor), bytes = size_of(a.componentType), size = numbers * bytes;
  if (!reading_.take(Asked::kValues, a.count * numbers)) return failed(std::string(kTooManyValues));
  std::vector<T> out;
  const auto read = [&](const Strided& from, std::size_t i, T* to) {
    for (std::size_t k = 0; k < numbers; ++k) to[k] = decode(a, from.bytes.substr(i * from.stride + k * bytes));
  };
  if (a.bufferView >= 0) {
    const auto from = strided(a.bufferView, a.byteOffset, a.count, size);
    if (!from) return failed(from.error());
    out.resize(a.count * numbers);
    constexpr int kSame =
        std::is_same_v<T, float> ? TINYGLTF_COMPONENT_TYPE_FLOAT : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    const bool same = a.componentType == kSame;
    if (same) copy_numbers(from->bytes, from->stride, numbers, out);
    for (std::size_t i = 0; !same && i < a.count; ++i) read(*from, i, out.data() + i * numbers);
  } else {
    out.resize(a.count * numbers);  // values without a buffer are zeros
  }
  if (!a.sparse.isSparse || a.sparse.count == 0) return out;
  const auto& sparse = a.sparse;
  if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0 ||
      !is_index_type(sparse.indices.componentType)) {
    return failed("its sparse values are none that glTF has");
  }
  const auto count = static_cast<std::uint64_t>(sparse.count);
  const auto places = strided(sparse.indices.bufferView, static_cast<std::uint64_t>(sparse.indices.byteOffset), count,
                              size_of(sparse.indices.componentType));
  if (!places) return failed("sparse indices: " + places.error());
  const auto from =
      strided(sparse.values.bufferView, static_cast<std::uint64_t>(sparse.values.byteOffset), count, size);
  if (!from) return failed("sparse values: " + from.error());
  for (std::size_t i = 0; i < count; ++i) {
    const double place = component(sparse.indices.componentType, places->bytes.substr(i * places->stride), false);
    if (place >= static_cast<double>(a.count)) return failed("a sparse index is out of range");
    read(*from, i, out.data() + static_cast<std::size_t>(place) * numbers);
  }
  return out;
}

std::expected<std::vector<float>, std::string> Accessors::floats(int accessor, std::size_t wanted) {
  if (accessor < 0 || static_cast<std::size_t>(accessor) >= model_.accessors.size()) {
    return std::unexpected(path_of(accessor) + "there is none");
  }
  const tinygltf::Accessor& a = model_.accessors[static_cast<std::size_t>(accessor)];
  const std::size_t numbers = width(accessor);
  if (a.count == 0) return std::unexpected(path_of(accessor) + "it has no values");
  if (!is_component_type(a.componentType))
    return std::unexpected(path_of(accessor) + "its componentType is none of glTF's");
  const bool fits = wanted == 0 ? a.type == TINYGLTF_TYPE_VEC3 || a.type == TINYGLTF_TYPE_VEC4
                                : numbers == wanted && a.type != TINYGLTF_TYPE_MAT2;
  if (!fits) return std::unexpected(path_of(accessor) + "its values are of another type than its use has");
  auto out = values<float>(accessor, [](const tinygltf::Accessor& of, std::string_view bytes) {
    return static_cast<float>(component(of.componentType, bytes, of.normalized));
  });
  if (out && !std::ranges::all_of(*out, [](float f) { return std::isfinite(f); })) {
    return std::unexpected(path_of(accessor) + "a value is no finite number");
  }
  return out;
}

std::expected<std::vector<std::uint32_t>, std::string> Accessors::indices(int accessor, std::uint64_t limit) {
  if (accessor < 0 || static_cast<std::size_t>(accessor) >= model_.accessors.size()) {
    return std::unexpected(path_of(accessor) + "there is none");
  }
  const tinygltf::Accessor& a = model_.accessors[static_cast<std::size_t>(accessor)];
  if (a.type != TINYGLTF_TYPE_SCALAR || !is_index_type(a.componentType) || a.normalized) {
    return std::unexpected(path_of(accessor) + "its values are no indices");
  }
  if (a.count == 0) return std::unexpected(path_of(accessor) + "it has no values");
  auto out = values<std::uint32_t>(accessor, [](const tinygltf::Accessor& of, std::string_view bytes) {
    switch (of.componentType) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return std::uint32_t{little_endian<std::uint8_t>(bytes)};
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return std::uint32_t{little_endian<std::uint16_t>(bytes)};
      default:
        return little_endian<std::uint32_t>(bytes);
    }
  });
  if (!out) return out;
  const auto bad = std::ranges::find_if(*out, [&](std::uint32_t index) { return index >= limit; });
  if (bad == out->end()) return out;
  return std::unexpected(path_of(accessor) + "index " + std::to_string(*bad) + " is out of range: there are " +
                         std::to_string(limit) + " points");
}

}  // namespace peerd::formats::gltf
