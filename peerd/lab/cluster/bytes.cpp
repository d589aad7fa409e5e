#include "peerd/lab/cluster/bytes.hpp"

#include <array>

namespace peerd::cluster {
namespace {

// The first byte of a JSON value. The numbers are part of the format.
enum class JsonKind : std::uint8_t { kNull, kBoolean, kSigned, kUnsigned, kDouble, kText, kArray, kObject };

}  // namespace

// A value of another kind, which no JSON text has, is null.
void ByteWriter::put(const nlohmann::ordered_json& json) {
  using Type = nlohmann::detail::value_t;
  switch (json.type()) {
    case Type::boolean:
      return (*this)(JsonKind::kBoolean, json.get<bool>());
    case Type::number_integer:
      return (*this)(JsonKind::kSigned, json.get<std::int64_t>());
    case Type::number_unsigned:
      return (*this)(JsonKind::kUnsigned, json.get<std::uint64_t>());
    case Type::number_float:
      return (*this)(JsonKind::kDouble, json.get<double>());
    case Type::string:
      return (*this)(JsonKind::kText, json.get_ref<const std::string&>());
    case Type::array:
      (*this)(JsonKind::kArray, std::uint64_t{json.size()});
      for (const auto& item : json) put(item);
      return;
    case Type::object:
      (*this)(JsonKind::kObject, std::uint64_t{json.size()});
      for (const auto& [key, value] : json.items()) (*this)(key, value);
      return;
    default:
      return put(JsonKind::kNull);
  }
}

void ByteReader::get_json(nlohmann::ordered_json& json, int depth) {
  const auto read = [&]<class T>(T value) {
    get(value);
    json = value;
  };
  JsonKind kind = JsonKind::kNull;
  get(kind);
  if (depth > kJsonDepthMax) refuse();
  if (!good_) return;
  switch (kind) {
    case JsonKind::kNull:
      json = nullptr;
      return;
    case JsonKind::kBoolean:
      return read(false);
    case JsonKind::kSigned:
      return read(std::int64_t{});
    case JsonKind::kUnsigned:
      return read(std::uint64_t{});
    case JsonKind::kDouble:
      return read(0.0);
    case JsonKind::kText:
      return read(std::string());
    case JsonKind::kArray:
      json = nlohmann::ordered_json::array();
      for (std::size_t left = get_count(); left > 0 && good_; --left) {
        get_json(json.emplace_back(), depth + 1);
      }
      return;
    case JsonKind::kObject:
      json = nlohmann::ordered_json::object();
      for (std::size_t left = get_count(); left > 0 && good_; --left) {
        std::string key;
        get(key);
        if (json.contains(key)) return refuse();
        get_json(json[key], depth + 1);
      }
      return;
  }
  refuse();
}

}  // namespace peerd::cluster
