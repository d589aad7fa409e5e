#include "core/formats/mesh/ply_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/formats/draft/bytes.hpp"
#include "core/formats/draft/shape_draft.hpp"
#include "core/formats/draft/words.hpp"
#include "core/formats/mesh/ply_header.hpp"

namespace peerd::formats {
namespace {

using vrml::quoted;

// Gives the numbers of the body one after the other. After one that is missing or wrong it is failed, and gives zeros.
class Numbers {
 public:
  Numbers(std::string_view bytes, const PlyHeader& header)
      : bytes_(bytes), words_(bytes, header.end), at_(header.end), encoding_(header.encoding) {}

  double next(PlyType type) {
    if (encoding_ == PlyEncoding::kText) {
      const auto number = number_of(words_.next());
      if (!number) failed_ = true;
      return number.value_or(0.0);
    }
    const std::size_t size = size_of(type);
    if (bytes_.size() - at_ < size) {
      failed_ = true;
      return 0.0;
    }
    const std::string_view bytes = bytes_.substr(at_, size);
    at_ += size;
    return encoding_ == PlyEncoding::kLittleEndian ? decoded<false>(type, bytes) : decoded<true>(type, bytes);
  }
  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] std::size_t place() const { return encoding_ == PlyEncoding::kText ? words_.begin() : at_; }
  [[nodiscard]] bool is_text() const { return encoding_ == PlyEncoding::kText; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - place(); }  // [bytes]

 private:
  template <bool kBigEndian, class T>
  static double as(std::string_view bytes) {
    return static_cast<double>(kBigEndian ? big_endian<T>(bytes) : little_endian<T>(bytes));
  }
  template <bool kBigEndian>
  static double decoded(PlyType type, std::string_view bytes) {
    switch (type) {
      case PlyType::kInt8:
        return as<kBigEndian, std::int8_t>(bytes);
      case PlyType::kUint8:
        return as<kBigEndian, std::uint8_t>(bytes);
      case PlyType::kInt16:
        return as<kBigEndian, std::int16_t>(bytes);
      case PlyType::kUint16:
        return as<kBigEndian, std::uint16_t>(bytes);
      case PlyType::kInt32:
        return as<kBigEndian, std::int32_t>(bytes);
      case PlyType::kUint32:
        return as<kBigEndian, std::uint32_t>(bytes);
      case PlyType::kFloat32:
        return as<kBigEndian, float>(bytes);
      case PlyType::kFloat64:
        return as<kBigEndian, double>(bytes);
    }
    return 0.0;
  }

  std::string_view bytes_;
  Words words_;
  std::size_t at_;
  PlyEncoding encoding_;
  bool failed_ = false;
};

// A Use is what a property gives to a mesh.
enum class Use : std::uint8_t { kNone, kX, kY, kZ, kRed, kGreen, kBlue, kIndices };

Use use_of(const PlyProperty& property, std::string_view element) {
  if (property.count_type) {
    const bool named = property.name == "vertex_indices" || property.name == "vertex_index";
    return named && element != "vertex" ? Use::kIndices : Use::kNone;
  }
  std::string_view name = property.name;
  if (name.starts_with("diffuse_")) name.remove_prefix(8);
  if (name == "red" || name == "r") return Use::kRed;
  if (name == "green" || name == "g") return Use::kGreen;
  if (name == "blue" || name == "b") return Use::kBlue;
  if (element != "vertex") return Use::kNone;
  return name == "x" ? Use::kX : name == "y" ? Use::kY : name == "z" ? Use::kZ : Use::kNone;
}

// Colours are shares of the largest number of their type.
double full_share(PlyType type) {
  switch (type) {
    case PlyType::kUint8:
      return std::numeric_limits<std::uint8_t>::max();
    case PlyType::kUint16:
      return std::numeric_limits<std::uint16_t>::max();
    case PlyType::kUint32:
      return std::numeric_limits<std::uint32_t>::max();
    default:
      return 1.0;
  }
}

class PlyReader {
 public:
  PlyReader(std::string_view bytes, const PlyHeader& header, Reading& reading)
      : header_(header), numbers_(bytes, header), reading_(reading) {}

  bool read();

 private:
  // The numbers of one element of the file that have a use.
  struct Values {
    std::array<double, 3> place{}, color{};
  };

  bool fail(std::string why) { return reading_.fail(numbers_.place(), std::move(why)); }
  bool fits(const PlyElement& element);
  bool prepare(const PlyElement& element);
  bool read_element(const PlyElement& element, std::uint64_t number);
  bool read_list(const PlyElement& element, const PlyProperty& property, Use use);
  bool add_color(const Values& values, std::vector<float>& colors);
  void end_strip();

  const PlyHeader& header_;
  Numbers numbers_;
  Reading& reading_;
  ShapeDraft shape_;
  std::vector<float> face_colors_;
  std::vector<Use> uses_;  // of the properties of the element that is read
  bool has_color_ = false, is_vertex_ = false, is_strip_ = false;
  std::uint64_t points_ = 0;
  std::vector<std::int32_t> indices_;  // of the list that is read
};

// A short file can claim any number of elements: each takes at least the bytes of its numbers.
bool PlyReader::fits(const PlyElement& element) {
  std::uint64_t least = 0;
  for (const PlyProperty& property : element.properties) {
    least += numbers_.is_text() ? 2 : size_of(property.count_type.value_or(property.type));
  }
  if (element.count == 0 || (least > 0 && element.count <= (numbers_.left() + 1) / least)) return true;
  return reading_.fail(element.begin, "the file is too short for " + std::to_string(element.count) + " elements " +
                                          quoted(element.name));
}

// Finds the use of each property of an element, and warns of properties that have none.
bool PlyReader::prepare(const PlyElement& element) {
  is_vertex_ = element.name == "vertex";
  is_strip_ = element.name == "tristrips";
  const bool known = is_vertex_ || is_strip_ || element.name == "face";
  uses_.clear();
  std::string unused;
  for (const PlyProperty& property : element.properties) {
    uses_.push_back(known ? use_of(property, element.name) : Use::kNone);
  }
  const auto has = [&](Use use) { return std::ranges::find(uses_, use) != uses_.end(); };
  has_color_ = has(Use::kRed) && has(Use::kGreen) && has(Use::kBlue) && !is_strip_;
  for (std::size_t i = 0; known && i < uses_.size(); ++i) {
    const bool is_color = uses_[i] >= Use::kRed && uses_[i] <= Use::kBlue;
    if (uses_[i] != Use::kNone && (!is_color || has_color_)) continue;
    unused += (unused.empty() ? "" : ", ") + std::string(element.properties[i].name);
  }
  if (!known && element.count > 0) reading_.warn(element.begin, "elements " + quoted(element.name) + " are not kept");
  if (!unused.empty() && element.count > 0) {
    reading_.warn(element.begin,
                  "these properties of the elements " + quoted(element.name) + " are not kept: " + unused);
  }
  if (is_vertex_ && element.count > 0 && !(has(Use::kX) && has(Use::kY) && has(Use::kZ))) {
    return reading_.fail(element.begin, "the points have no x, y and z");
  }
  if (known && !is_vertex_ && element.count > 0 && !has(Use::kIndices)) {
    return reading_.fail(element.begin, "the elements " + quoted(element.name) + " have no list vertex_indices");
  }
  if (is_vertex_) {
    points_ = element.count;
    if (points_ > static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max())) {
      return reading_.fail(element.begin, "more points than indices of 32 bits can name");
    }
    shape_.points.reserve(3 * points_);
    if (has_color_) shape_.colors.reserve(3 * points_);
  }
  return true;
}

bool PlyReader::read_list(const PlyElement& element, const PlyProperty& property, Use use) {
  const double length = numbers_.next(*property.count_type);
  if (!(length >= 0.0) || length > static_cast<double>(numbers_.left() + 1) || length != std::floor(length))
    return fail("the length of a list is wrong");
  const auto count = static_cast<std::uint64_t>(length);
  for (std::uint64_t i = 0; i < count && !numbers_.failed(); ++i) {
    const double index = numbers_.next(property.type);
    if (use != Use::kIndices || (is_strip_ && index == -1.0)) {
      if (use == Use::kIndices) end_strip();
      continue;
    }
    if (!(index >= 0.0 && index < static_cast<double>(points_) && index == std::floor(index))) {
      return fail("an index of " + quoted(element.name) + " names no point: there are " + std::to_string(points_));
    }
    indices_.push_back(static_cast<std::int32_t>(index));
  }
  if (use == Use::kIndices) end_strip();
  return true;
}

// Every second triangle of a strip runs the other way round.
void PlyReader::end_strip() {
  if (!is_strip_) {
    shape_.polygons.insert(shape_.polygons.end(), indices_.begin(), indices_.end());
    if (!indices_.empty()) shape_.polygons.push_back(-1);
  }
  for (std::size_t i = 2; is_strip_ && i < indices_.size(); ++i) {
    const std::size_t odd = i % 2;
    shape_.polygons.insert(shape_.polygons.end(), {indices_[i - 2 + odd], indices_[i - 1 - odd], indices_[i], -1});
  }
  indices_.clear();
}

bool PlyReader::add_color(const Values& values, std::vector<float>& colors) {
  for (const double share : values.color) {
    if (!(share >= 0.0 && share <= 1.0)) return fail("a colour is outside of its range");
    colors.push_back(static_cast<float>(share));
  }
  return true;
}

bool PlyReader::read_element(const PlyElement& element, std::uint64_t number) {
  Values values;
  const std::size_t before = shape_.polygons.size();
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    const Use use = uses_[i];
    if (property.count_type) {
      if (!read_list(element, property, use)) return false;
      continue;
    }
    const double value = numbers_.next(property.type);
    if (use >= Use::kX && use <= Use::kZ) values.place[static_cast<std::size_t>(use) - 1] = value;
    if (use >= Use::kRed && use <= Use::kBlue) {
      values.color[static_cast<std::size_t>(use) - 4] =
          value / (numbers_.is_text() && property.type == PlyType::kInt32 ? 255.0 : full_share(property.type));
    }
  }
  if (numbers_.failed()) {
    return fail("a number of element " + std::to_string(number) + " of " + quoted(element.name) +
                " is missing or wrong");
  }
  if (is_vertex_) {
    const auto& [x, y, z] = values.place;
    if (!reading_.add_point(x, y, z, shape_.points)) return fail(std::string(kBadPoint));
    return !has_color_ || add_color(values, shape_.colors);
  }
  // A face without corners is no polygon, and must not have a colour.
  const bool is_face = uses_.size() == element.properties.size() && shape_.polygons.size() > before;
  return !has_color_ || !is_face || add_color(values, face_colors_);
}

bool PlyReader::read() {
  std::uint64_t colored = 0, faces = 0;
  bool has_points = false;
  for (const PlyElement& element : header_.elements) {
    if (!fits(element) || !prepare(element)) return false;
    if (is_vertex_ && std::exchange(has_points, true)) return reading_.fail(element.begin, "a second list of points");
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (!read_element(element, i)) return false;
    }
    if (is_vertex_ || std::ranges::find(uses_, Use::kIndices) == uses_.end()) continue;
    ++faces;
    colored += has_color_ ? 1 : 0;
  }
  if (shape_.colors.empty() && colored > 0 && colored == faces) {
    shape_.colors = std::move(face_colors_);
    shape_.color_per_vertex = false;
  } else if (colored > 0) {
    reading_.warn(0, "the colours of faces are not kept: the file has others, too");
  }
  std::vector<vrml::NodeRef> children;
  if (points_ > 0) children.push_back(add_shape(reading_.document, reading_.at(0), std::move(shape_)));
  reading_.document.top_level.push_back(add_transform(reading_.document, reading_.at(0), {}, children));
  return true;
}

}  // namespace

bool read_ply(std::string_view bytes, Reading& reading) {
  const auto header = read_ply_header(bytes);
  if (!header) return reading.fail(header.error().offset, header.error().why);
  return PlyReader(bytes, *header, reading).read();
}

}  // namespace peerd::formats
