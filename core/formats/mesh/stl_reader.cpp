#include "core/formats/mesh/stl_reader.hpp"

#include <string>
#include <utility>
#include <vector>

#include "core/formats/draft/bytes.hpp"
#include "core/formats/draft/shape_draft.hpp"
#include "core/formats/draft/words.hpp"
#include "core/formats/mesh/point_welder.hpp"

namespace peerd::formats {
namespace {

using vrml::NodeRef;
using vrml::quoted;

// A word as an error shows it; it is empty at the end of the file.
std::string shown(std::string_view word) { return word.empty() ? "the end of the file" : quoted(word); }

class TextReader {
 public:
  TextReader(std::string_view text, Reading& reading) : words_(text), reading_(reading) {}

  bool read() {
    std::string_view word = words_.next();
    while (word == "solid") {
      if (!read_solid()) return false;
      word = words_.next();
    }
    return word.empty() || fail("expected 'solid' or the end of the file, found " + shown(word));
  }

 private:
  bool fail(std::string why) { return reading_.fail(words_.begin(), std::move(why)); }
  bool expect(std::string_view word) {
    const std::string_view found = words_.next();
    return found == word || fail("expected " + quoted(word) + ", found " + shown(found));
  }

  bool read_solid() {
    const std::size_t begin = words_.begin();
    ShapeDraft shape;
    PointWelder welder;
    const std::string_view name = words_.rest_of_line();
    std::string_view word = words_.next();
    for (; word == "facet"; word = words_.next()) {
      if (!read_facet(shape, welder)) return false;
    }
    if (word != "endsolid") return fail("expected 'facet' or 'endsolid', found " + shown(word));
    static_cast<void>(words_.rest_of_line());
    std::vector<NodeRef> children;
    if (!shape.polygons.empty()) children.push_back(add_shape(reading_.document, reading_.at(begin), std::move(shape)));
    if (!reading_.has_room()) return fail(std::string(kTooManyNodes));
    reading_.document.top_level.push_back(add_transform(reading_.document, reading_.at(begin), name, children));
    return true;
  }

  bool read_facet(ShapeDraft& shape, PointWelder& welder) {
    if (!expect("normal")) return false;
    for (int i = 0; i < 3; ++i) {
      if (const std::string_view word = words_.next(); !number_of(word) && word != "nan" && word != "-nan") {
        return fail("expected a number of the facet's normal, found " + shown(word));
      }
    }
    if (!expect("outer") || !expect("loop")) return false;
    std::string_view word = words_.next();
    for (; word == "vertex"; word = words_.next()) {
      double place[3];
      for (double& coordinate : place) {
        word = words_.next();
        const auto number = number_of(word);
        if (!number) return fail("expected a coordinate, found " + shown(word));
        coordinate = *number;
      }
      if (!reading_.add_point(place[0], place[1], place[2], shape.points)) return fail(std::string(kBadPoint));
      shape.polygons.push_back(welder.weld(shape.points));
    }
    if (word != "endloop") return fail("expected 'vertex' or 'endloop', found " + shown(word));
    shape.polygons.push_back(-1);
    return expect("endfacet");
  }

  Words words_;
  Reading& reading_;
};

}  // namespace

bool read_stl_text(std::string_view text, Reading& reading) { return TextReader(text, reading).read(); }

bool read_stl_binary(std::string_view bytes, Reading& reading) {
  if (bytes.size() < kStlHeader_bytes) {
    return reading.fail(
        0, "this is no STL file: a binary one has a header of 84 bytes, and one of text begins with solid");
  }
  const std::size_t facets = little_endian<std::uint32_t>(bytes.substr(kStlHeader_bytes - 4));
  const std::size_t wanted = kStlHeader_bytes + facets * kStlFacet_bytes;
  if (bytes.size() != wanted) {
    return reading.fail(0, "this STL file of " + std::to_string(facets) + " facets must have " +
                               std::to_string(wanted) + " bytes, and it has " + std::to_string(bytes.size()));
  }
  ShapeDraft shape;
  PointWelder welder;
  shape.polygons.reserve(4 * facets);
  std::size_t attributes = 0;
  for (std::size_t facet = 0; facet < facets; ++facet) {
    const std::size_t begin = kStlHeader_bytes + facet * kStlFacet_bytes;
    const auto number = [&](std::size_t i) { return double{little_endian<float>(bytes.substr(begin + 4 * i))}; };
    for (std::size_t corner = 1; corner <= 3; ++corner) {
      if (!reading.add_point(number(3 * corner), number(3 * corner + 1), number(3 * corner + 2), shape.points)) {
        return reading.fail(begin, "facet " + std::to_string(facet) + ": " + std::string(kBadPoint));
      }
      shape.polygons.push_back(welder.weld(shape.points));
    }
    shape.polygons.push_back(-1);
    attributes += little_endian<std::uint16_t>(bytes.substr(begin + 48)) != 0 ? 1 : 0;
  }
  if (attributes > 0) {
    reading.warn(0, "the attribute bytes of " + std::to_string(attributes) +
                        " facets are not read: programs mean different things by them, such as colours");
  }
  std::vector<NodeRef> children;
  if (facets > 0) children.push_back(add_shape(reading.document, reading.at(0), std::move(shape)));
  reading.document.top_level.push_back(add_transform(reading.document, reading.at(0), {}, children));
  return true;
}

}  // namespace peerd::formats
