#include "core/formats/mesh/off_reader.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/formats/draft/shape_draft.hpp"
#include "core/formats/draft/words.hpp"

namespace peerd::formats {
namespace {

using vrml::quoted;

class OffReader {
 public:
  OffReader(std::string_view text, Reading& reading) : lines_(text), reading_(reading) {}

  bool read();

 private:
  bool fail(std::string why) { return reading_.fail(place_, std::move(why)); }
  // Returns the words of the next line that has some, comments left out; empty at the end of the file.
  const std::vector<std::string_view>& next_line();
  bool read_header();
  bool read_counts();
  bool read_point();
  bool read_face(std::size_t face);
  bool read_color(std::size_t first, std::vector<float>& colors);
  // Warns of the first line that has words from that one on, which nothing reads.
  void name_surplus(std::size_t first, bool& named, std::string_view what);

  Lines lines_;
  Reading& reading_;
  std::vector<std::string_view> words_;
  std::size_t place_ = 0;
  bool has_colors_ = false, has_normals_ = false, has_texture_ = false;
  std::int64_t points_ = 0, faces_ = 0;
  std::size_t colored_faces_ = 0;
  double least_opacity_ = 255.0;
  bool named_of_point_ = false, named_of_face_ = false;
  ShapeDraft shape_;
};

const std::vector<std::string_view>& OffReader::next_line() {
  words_.clear();
  while (words_.empty()) {
    const auto line = lines_.next();
    place_ = line ? lines_.begin() : lines_.after();
    if (!line) break;
    Words words(line->substr(0, line->find('#')));
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) words_.push_back(word);
  }
  return words_;
}

bool OffReader::read_header() {
  if (next_line().empty()) return fail("this OFF file is empty");
  std::string_view header = words_.front();
  const auto take = [&](std::string_view prefix) {
    const bool there = header.starts_with(prefix);
    if (there) header.remove_prefix(prefix.size());
    return there;
  };
  if (header.starts_with("\xEF\xBB\xBF")) header.remove_prefix(3);
  has_texture_ = take("ST");
  has_colors_ = take("C");
  has_normals_ = take("N");
  if (take("4") || take("n"))
    return fail("OFF files of points in another space than that of three dimensions are not read");
  if (header != "OFF") return fail("expected the header OFF, found " + quoted(words_.front()));
  words_.erase(words_.begin());
  if (!words_.empty() && words_.front() == "BINARY") return fail("binary OFF files are not read, only those of text");
  return true;
}

bool OffReader::read_counts() {
  if (words_.empty() && next_line().empty()) return fail("the counts of points, faces and edges are missing");
  const auto points = integer_of(words_[0]);
  const auto faces = words_.size() > 1 ? integer_of(words_[1]) : std::nullopt;
  if (!points || !faces || *points < 0 || *faces < 0) return fail("expected the counts of points, faces and edges");
  points_ = *points;
  faces_ = *faces;
  return true;
}

// Colours are shares to 1, or of 255 where any in the file is more than 1; a fourth number says how opaque they are.
bool OffReader::read_color(std::size_t first, std::vector<float>& colors) {
  if (words_.size() < first + 3) return false;
  for (std::size_t i = first; i < first + 3; ++i) {
    const auto number = number_of(words_[i]);
    if (!number || *number < 0.0 || *number > 255.0) return false;
    colors.push_back(static_cast<float>(*number));
  }
  if (words_.size() > first + 3) {
    const auto opacity = number_of(words_[first + 3]);
    if (!opacity) return false;
    least_opacity_ = std::min(least_opacity_, *opacity);
  }
  return true;
}

void OffReader::name_surplus(std::size_t first, bool& named, std::string_view what) {
  if (words_.size() <= first || std::exchange(named, true)) return;
  reading_.warn(place_, std::string(what));
}

bool OffReader::read_point() {
  if (next_line().size() < 3) return fail("expected a point of three coordinates");
  double place[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const auto number = number_of(words_[i]);
    if (!number) return fail("expected a coordinate, found " + quoted(words_[i]));
    place[i] = *number;
  }
  if (!reading_.add_point(place[0], place[1], place[2], shape_.points)) return fail(std::string(kBadPoint));
  // The coordinates are followed by a normal, a colour and two texture coordinates, if the header names them.
  const std::size_t color = has_normals_ ? 6 : 3;
  if (has_colors_ && !read_color(color, shape_.colors)) return fail("expected the colour of the point");
  name_surplus(color + (has_colors_ ? 4 : 0) + (has_texture_ ? 2 : 0), named_of_point_,
               has_colors_ || has_normals_ || has_texture_
                   ? "numbers behind what the header says of points are not kept"
                   : "numbers behind the coordinates of points are not kept: with the header COFF they are "
                     "colours");
  return true;
}

bool OffReader::read_face(std::size_t face) {
  if (next_line().empty()) {
    return fail("the file ends at face " + std::to_string(face) + " of " + std::to_string(faces_));
  }
  const auto corners = integer_of(words_[0]);
  if (!corners || *corners < 1 || static_cast<std::uint64_t>(*corners) >= words_.size()) {
    return fail("expected a number of corners and the index of each");
  }
  const auto count = static_cast<std::size_t>(*corners);
  for (std::size_t i = 1; i <= count; ++i) {
    const auto index = integer_of(words_[i]);
    if (!index || *index < 0 || *index >= points_) {
      return fail(quoted(words_[i]) + " is no index of a point: the file has points 0 to " +
                  std::to_string(points_ - 1));
    }
    shape_.polygons.push_back(static_cast<std::int32_t>(*index));
  }
  shape_.polygons.push_back(-1);
  if (!has_colors_ && words_.size() >= count + 4) {
    if (!read_color(count + 1, shape_.colors)) return fail("expected a colour behind the indices");
    ++colored_faces_;
    name_surplus(count + 5, named_of_face_, "numbers behind the colours of faces are not kept");
  } else {
    name_surplus(count + 1, named_of_face_,
                 has_colors_ ? "numbers behind the corners of faces are not kept: the points have colours"
                             : "numbers behind the corners of faces are not kept: a colour has three or four");
  }
  return true;
}

bool OffReader::read() {
  if (!read_header() || !read_counts()) return false;
  // A point is a line of at least six bytes.
  if (static_cast<std::uint64_t>(points_) > lines_.size() / 6 + 1) {
    return fail("the file is too short for " + std::to_string(points_) + " points");
  }
  for (std::int64_t i = 0; i < points_; ++i) {
    if (!read_point()) return false;
  }
  for (std::int64_t i = 0; i < faces_; ++i) {
    if (!read_face(static_cast<std::size_t>(i))) return false;
  }
  if (!next_line().empty()) return fail("expected the end of the file behind its faces");
  if (has_normals_) reading_.warn(0, "the normals of points (N) are not kept: faces are shaded flat");
  if (has_texture_) reading_.warn(0, "texture coordinates (ST) are not kept: an OFF file names no image");
  shape_.color_per_vertex = has_colors_;
  const bool is_of_255 = std::ranges::any_of(shape_.colors, [](float share) { return share > 1.0F; });
  if (is_of_255) {
    for (float& share : shape_.colors) share /= 255.0F;
  }
  if (least_opacity_ < (is_of_255 ? 255.0 : 1.0)) {
    reading_.warn(0, "the opacity of colours is not kept: a Shape has one for all of it");
  }
  if (!has_colors_ && colored_faces_ != 0 && colored_faces_ != static_cast<std::size_t>(faces_)) {
    reading_.warn(0, "only some faces have a colour: none is kept");
    shape_.colors.clear();
  }
  std::vector<vrml::NodeRef> children;
  if (points_ > 0) children.push_back(add_shape(reading_.document, reading_.at(0), std::move(shape_)));
  reading_.document.top_level.push_back(add_transform(reading_.document, reading_.at(0), {}, children));
  return true;
}

}  // namespace

bool read_off(std::string_view text, Reading& reading) { return OffReader(text, reading).read(); }

}  // namespace peerd::formats
