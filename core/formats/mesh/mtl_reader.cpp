#include "core/formats/mesh/mtl_reader.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <utility>

#include "core/formats/draft/words.hpp"

namespace peerd::formats {
namespace {

using vrml::quoted;

// Statements that change nothing in a picture with diffuse, specular and emissive light.
constexpr std::array<std::string_view, 3> kWithoutMeaning{"Ka", "illum", "Ni"};
// The largest exponent of a highlight that VRML97 can say: shininess * 128.
constexpr double kLargestExponent = 128.0;

// Loss says which part of a statement a Material cannot hold.
enum class Loss : std::uint8_t { kNothing, kSurplus, kRange, kAll };

// Returns a number clamped to 0..1; `loss` becomes kRange where that changes it.
float share_of(double number, Loss& loss) {
  const double share = std::clamp(number, 0.0, 1.0);
  if (share != number) loss = Loss::kRange;
  return static_cast<float>(share);
}

// Reads a statement of a material.
Loss read_statement(std::string_view keyword, Words words, MaterialDraft& material) {
  Loss loss = Loss::kNothing;
  if (keyword == "map_Kd") {
    const std::string_view url = words.rest_of_line();
    if (url.empty() || url.starts_with('-')) return Loss::kAll;  // options change where the image is put
    material.texture = url;
    std::ranges::replace(material.texture, '\\', '/');
    return loss;
  }
  const bool is_color = keyword == "Kd" || keyword == "Ks" || keyword == "Ke";
  if (!is_color && keyword != "d" && keyword != "Tr" && keyword != "Ns") return Loss::kAll;
  std::array<double, 3> numbers{};
  for (std::size_t i = 0; i < (is_color ? numbers.size() : 1); ++i) {
    const auto number = number_of(words.next());
    if (!number) return Loss::kAll;
    numbers[i] = *number;
  }
  if (!words.next().empty()) loss = Loss::kSurplus;
  if (is_color) {
    auto& color = keyword == "Kd" ? material.diffuse : keyword == "Ks" ? material.specular : material.emissive;
    std::ranges::transform(numbers, color.begin(), [&](double number) { return share_of(number, loss); });
  } else if (keyword == "d") {
    material.transparency = share_of(1.0 - numbers[0], loss);
  } else if (keyword == "Tr") {
    material.transparency = share_of(numbers[0], loss);
  } else {
    material.shininess = share_of(numbers[0] / kLargestExponent, loss);
  }
  return loss;
}

}  // namespace

bool read_mtl(std::string_view text, std::string_view url, std::size_t offset, Reading& reading, Materials& materials) {
  Lines lines(text);
  MaterialDraft* material = nullptr;
  std::set<std::string, std::less<>> unread, limited;
  while (const auto line = lines.next()) {
    Words words(line->substr(0, line->find('#')));
    const std::string_view keyword = words.next();
    if (keyword.empty()) continue;
    if (keyword == "newmtl") {
      material = &materials[std::string(words.rest_of_line())];
      *material = {};
      continue;
    }
    if (material == nullptr) {
      return reading.fail(offset, quoted(url) + ": expected newmtl, found " + quoted(keyword));
    }
    if (std::ranges::find(kWithoutMeaning, keyword) != kWithoutMeaning.end()) continue;
    const Loss loss = read_statement(keyword, words, *material);
    if ((loss == Loss::kRange || loss == Loss::kSurplus) && limited.emplace(keyword).second) {
      reading.warn(offset, quoted(url) + ": " + quoted(keyword) +
                               (loss == Loss::kRange ? " is outside of a Material's range, and is clamped"
                                                     : " has more numbers than are read"));
    }
    if (loss != Loss::kAll || unread.size() > kMostNamed || !unread.emplace(keyword).second) continue;
    const bool is_last = unread.size() > kMostNamed;
    reading.warn(offset, quoted(url) + ": what " + quoted(keyword) + (is_last ? " and others say" : " says") +
                             " of a material is not shown");
  }
  return true;
}

}  // namespace peerd::formats
