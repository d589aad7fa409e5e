#pragma once
#include <algorithm>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/ids.hpp"
#include "core/math.hpp"

namespace peerd::cluster {

// The bytes of plain values, little-endian and without padding: a whole number has those of its type, a double those of
// its IEEE 754 form, so that it comes back bit for bit. A list and a text are the number of their items as 64 bits,
// then these. A struct is the row of its fields, which an overload of
//   template <class A> void fields(A& a, typename A::template Of<S>& s) { a(s.first, s.second); }
// in this namespace names once for both directions.
static_assert(std::endian::native == std::endian::little);

// Numbers whose bytes are those in memory.
template <class T>
concept PlainNumber = (std::integral<T> || std::floating_point<T>)&&!std::same_as<T, bool>;

// JSON within JSON is no deeper than this in what this program writes; deeper input is refused.
inline constexpr int kJsonDepthMax = 16;

class ByteWriter {
 public:
  template <class T>
  using Of = const T;

  template <class... Ts>
  void operator()(const Ts&... values) {
    (put(values), ...);
  }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  template <PlainNumber T>
  void put(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void put(bool value) { put(static_cast<std::uint8_t>(value ? 1 : 0)); }
  template <class T>
  requires std::is_enum_v<T>
  void put(T value) { put(static_cast<std::underlying_type_t<T>>(value)); }
  template <class Tag, class Rep>
  void put(const Strong<Tag, Rep>& id) {
    put(id.value);
  }
  template <class Tag>
  void put(const LastingId<Tag>& id) {
    put(id.packed());
  }
  template <int kRows>
  void put(const Eigen::Matrix<double, kRows, 1>& v) {
    for (const double x : v) put(x);
  }
  void put(const Pose& pose) { (*this)(pose.position, Eigen::Vector4d(pose.orientation.coeffs())); }
  void put(const std::string& text) {
    put(std::uint64_t{text.size()});
    bytes_ += text;
  }
  template <class T>
  void put(const std::vector<T>& list) {
    put(std::uint64_t{list.size()});
    for (const T& item : list) put(item);
  }
  template <class K, class V>
  void put(const std::pair<K, V>& pair) {
    (*this)(pair.first, pair.second);
  }
  template <class K, class V>
  void put(const std::map<K, V>& map) {
    put(std::uint64_t{map.size()});
    for (const auto& [key, value] : map) (*this)(key, value);
  }
  template <class T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  void put(const nlohmann::ordered_json& json);
  template <class T>
  requires std::is_class_v<T>
  void put(const T& value) { fields(*this, value); }

  std::string bytes_;
};

// Reads hostile bytes. After the first that are not what was asked for, it reads nothing more and `good` is false; what
// has been read is to be thrown away then. It makes no list that is longer than the bytes that are left.
class ByteReader {
 public:
  template <class T>
  using Of = T;

  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  template <class... Ts>
  void operator()(Ts&... values) {
    (get(values), ...);
  }
  // For a value that is out of its range.
  void refuse() { good_ = false; }
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] std::string_view rest() const { return rest_; }
  [[nodiscard]] bool complete() const { return good_ && rest_.empty(); }

 private:
  template <PlainNumber T>
  void get(T& value) {
    if (!good_ || rest_.size() < sizeof value) return refuse();
    const std::string_view bytes = rest_.substr(0, sizeof value);
    rest_.remove_prefix(sizeof value);
    std::ranges::copy(bytes, reinterpret_cast<char*>(&value));
  }
  void get(bool& value) {
    std::uint8_t byte = 0;
    get(byte);
    if (byte > 1) refuse();
    value = byte == 1;
  }
  // Whoever reads an enumeration checks its range.
  template <class T>
  requires std::is_enum_v<T>
  void get(T& value) {
    std::underlying_type_t<T> number{};
    get(number);
    value = static_cast<T>(number);
  }
  template <class Tag, class Rep>
  void get(Strong<Tag, Rep>& id) {
    get(id.value);
  }
  template <class Tag>
  void get(LastingId<Tag>& id) {
    std::uint64_t packed = 0;
    get(packed);
    id = LastingId<Tag>::unpacked(packed);
  }
  template <int kRows>
  void get(Eigen::Matrix<double, kRows, 1>& v) {
    for (double& x : v) get(x);
  }
  void get(Pose& pose) {
    Eigen::Vector4d coefficients = Eigen::Vector4d::Zero();
    (*this)(pose.position, coefficients);
    pose.orientation.coeffs() = coefficients;
  }
  // Each item of a list has one byte at least.
  [[nodiscard]] std::size_t get_count() {
    std::uint64_t count = 0;
    get(count);
    if (count > rest_.size()) refuse();
    return good_ ? static_cast<std::size_t>(count) : 0;
  }
  void get(std::string& text) {
    const std::size_t size = get_count();
    text = rest_.substr(0, size);
    rest_.remove_prefix(size);
  }
  template <class T>
  void get(std::vector<T>& list) {
    for (std::size_t left = get_count(); left > 0 && good_; --left) get(list.emplace_back());
  }
  template <class K, class V>
  void get(std::pair<K, V>& pair) {
    (*this)(pair.first, pair.second);
  }
  template <class K, class V>
  void get(std::map<K, V>& map) {
    for (std::size_t left = get_count(); left > 0 && good_; --left) {
      std::pair<K, V> entry;
      get(entry);
      if (!map.empty() && !(map.rbegin()->first < entry.first)) return refuse();
      map.insert(map.end(), std::move(entry));
    }
  }
  template <class T>
  void get(std::optional<T>& value) {
    bool there = false;
    get(there);
    value.reset();
    if (there) get(value.emplace());
  }
  void get(nlohmann::ordered_json& json) { get_json(json, 0); }
  void get_json(nlohmann::ordered_json& json, int depth);
  template <class T>
  requires std::is_class_v<T>
  void get(T& value) { fields(*this, value); }

  std::string_view rest_;
  bool good_ = true;
};

// A result whose bytes begin with the number of their format. `of` is the word for its item; `read(reader, result)`
// reads the rest. The error is one sentence.
template <class Result, class Read>
[[nodiscard]] std::expected<Result, std::string> read_result(std::string_view bytes, std::uint32_t format,
                                                             const std::string& of, Read read) {
  ByteReader reader(bytes);
  std::uint32_t found = 0;
  reader(found);
  if (reader.good() && found != format) {
    return std::unexpected("it is of format " + std::to_string(found) + ", and this program reads " +
                           std::to_string(format));
  }
  Result result;
  read(reader, result);
  if (!reader.complete()) return std::unexpected("it is no result of a " + of + ", or only a part of one");
  return result;
}

}  // namespace peerd::cluster
