#include "core/formats/mesh/obj_reader.hpp"

#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/formats/draft/shape_draft.hpp"
#include "core/formats/draft/words.hpp"
#include "core/formats/mesh/mtl_reader.hpp"

namespace peerd::formats {
namespace {

using vrml::NodeRef;
using vrml::quoted;

// A part becomes a Shape, its geometry and Coordinate, and most have a Transform.
constexpr std::uint64_t kNodesOfPart = 4;

// The elements of one material in one group. Indices are those of the file's points until the end.
struct Part {
  std::string_view material;
  std::size_t begin = 0;  // of its first element in the file
  std::vector<std::int32_t> polygons, lines, dots;
  std::vector<std::int32_t> texture_index;  // of `polygons`, while all corners have one
  bool textured = true;
};

struct Group {
  std::string_view name;
  std::size_t begin = 0;
  std::vector<Part> parts;
};

class ObjReader {
 public:
  ObjReader(std::string_view text, Reading& reading) : lines_(text), reading_(reading) {}

  bool read();

 private:
  bool fail(std::string why) { return reading_.fail(place_, std::move(why)); }
  bool read_line(std::string_view keyword, Words words);
  bool read_vertex(Words words);
  bool read_texture_point(Words words);
  bool read_polygon(Words words);
  bool read_indices(Words words, bool lines);
  bool read_materials(Words words);
  std::optional<std::int32_t> index_of(std::string_view word, std::size_t count) const;
  void name_unread(std::string_view key, std::string_view what);  // warns once for each key
  Part& part();
  bool add_group(Group& group);
  NodeRef image_of(const MaterialDraft& material, std::size_t place);
  void add_part(Part& part, std::vector<NodeRef>& shapes);
  void take_points(std::vector<std::int32_t>& list, ShapeDraft& shape);
  const MaterialDraft* material_of(const Part& part) const;

  Lines lines_;
  Reading& reading_;
  std::size_t place_ = 0;  // of the line that is read
  std::string joined_;     // that line, where backslashes continue it

  std::vector<float> points_, colors_, texture_points_;
  std::size_t normals_ = 0;
  std::vector<Group> groups_;
  std::unordered_map<std::string_view, std::size_t> group_of_name_;
  std::map<std::pair<std::string_view, std::string_view>, std::size_t> part_of_names_;  // in its group
  std::string_view name_, material_;
  std::size_t part_count_ = 0;
  Part* part_ = nullptr;  // where elements go; null until the first one behind a name or a material
  Materials materials_;
  std::map<std::string, NodeRef, std::less<>> appearances_;
  std::map<std::string, NodeRef, std::less<>> images_;  // by URL
  std::set<std::string, std::less<>> unread_;  // what is not kept of statements that are read, as name_unread() has it
  std::set<std::string_view> unknown_;         // keywords that are not read at all
  std::set<const char*> read_libraries_;       // their texts
  std::set<std::string_view> libraries_;       // URLs of the libraries of materials that were asked for
  // For each point of the file, its index in the part that is being added, or -1. `taken_` lists the part's points.
  std::vector<std::int32_t> place_of_point_, place_of_texture_point_, taken_;
};

// Indices count from 1; negative ones count back from the element that was read last.
std::optional<std::int32_t> ObjReader::index_of(std::string_view word, std::size_t count) const {
  const auto number = integer_of(word);
  if (!number || *number == 0) return std::nullopt;
  const std::int64_t index = *number > 0 ? *number - 1 : static_cast<std::int64_t>(count) + *number;
  if (index < 0 || index >= static_cast<std::int64_t>(count)) return std::nullopt;
  return static_cast<std::int32_t>(index);
}

bool ObjReader::read_vertex(Words words) {
  double numbers[7];
  std::size_t count = 0;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    const auto number = number_of(word);
    if (!number || count == 7) return fail("expected a coordinate, found " + quoted(word));
    numbers[count++] = *number;
  }
  if (count < 3) return fail("a point needs three coordinates");
  // A fourth number is a weight, which only rational curves use; three behind the place or the weight are a colour.
  if ((count == 4 || count == 7) && numbers[3] != 1.0)
    name_unread("v", "the weights of points are not kept: nothing that is read uses them");
  if (count == 5) name_unread("v 5", "the fourth and fifth numbers of points are not kept: five have no meaning");
  if (!reading_.add_point(numbers[0], numbers[1], numbers[2], points_)) return fail(std::string(kBadPoint));
  if (points_.size() / 3 > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    return fail("more points than indices of 32 bits can name");
  }
  if (count >= 6) {
    colors_.resize(points_.size() - 3, 1.0F);
    for (std::size_t i = count - 3; i < count; ++i) {
      if (!(numbers[i] >= 0.0 && numbers[i] <= 1.0)) return fail("a colour has three numbers from 0 to 1");
      colors_.push_back(static_cast<float>(numbers[i]));
    }
  }
  return true;
}

bool ObjReader::read_texture_point(Words words) {
  for (int i = 0; i < 2; ++i) {
    const std::string_view word = words.next();
    const auto number = word.empty() && i == 1 ? std::optional(0.0) : number_of(word);
    if (!number || !std::isfinite(static_cast<float>(*number))) {
      return fail("expected a texture coordinate, found " + quoted(word));
    }
    texture_points_.push_back(static_cast<float>(*number));
  }
  if (const std::string_view third = words.next(); !third.empty() && number_of(third) != 0.0) {
    name_unread("vt 3", "the third number of texture coordinates (vt) is not kept: images have two dimensions");
  }
  if (!words.next().empty()) name_unread("vt 4", "more than three numbers of texture coordinates (vt) have no meaning");
  return true;
}

Part& ObjReader::part() {
  if (part_ != nullptr) return *part_;
  const auto [group, is_new_group] = group_of_name_.try_emplace(name_, groups_.size());
  if (is_new_group) groups_.push_back({name_, place_, {}});
  std::vector<Part>& parts = groups_[group->second].parts;
  const auto [place, is_new] = part_of_names_.try_emplace({name_, material_}, parts.size());
  if (is_new) {
    parts.push_back({material_, place_, {}, {}, {}, {}, true});
    ++part_count_;
  }
  part_ = &parts[place->second];
  return *part_;
}

bool ObjReader::read_polygon(Words words) {
  Part& part = this->part();
  std::size_t corners = 0;
  for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++corners) {
    const std::size_t slash = std::min(word.find('/'), word.size());
    const auto point = index_of(word.substr(0, slash), points_.size() / 3);
    if (!point)
      return fail(quoted(word) + " names no point: there are " + std::to_string(points_.size() / 3) + " so far");
    part.polygons.push_back(*point);
    const std::string_view rest = word.substr(std::min(slash + 1, word.size()));
    const std::string_view texture = rest.substr(0, rest.find('/'));
    if (texture.empty()) {
      part.textured = false;
    } else if (const auto index = index_of(texture, texture_points_.size() / 2)) {
      if (part.textured) part.texture_index.push_back(*index);
    } else {
      return fail(quoted(word) + " names no texture coordinate");
    }
    if (const std::size_t second = rest.find('/'); second != std::string_view::npos) {
      if (!index_of(rest.substr(second + 1), normals_)) return fail(quoted(word) + " names no normal");
    }
  }
  if (corners == 0) return fail("a face without corners");
  part.polygons.push_back(-1);
  if (part.textured) {
    part.texture_index.push_back(-1);
  } else if (!part.texture_index.empty()) {
    part.texture_index = {};
  }
  return true;
}

bool ObjReader::read_indices(Words words, bool lines) {
  Part& part = this->part();
  std::vector<std::int32_t>& list = lines ? part.lines : part.dots;
  const std::size_t before = list.size();
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    const auto point = index_of(word.substr(0, word.find('/')), points_.size() / 3);
    if (!point)
      return fail(quoted(word) + " names no point: there are " + std::to_string(points_.size() / 3) + " so far");
    list.push_back(*point);
  }
  if (list.size() == before) return fail("expected indices of points");
  if (lines) list.push_back(-1);
  return true;
}

bool ObjReader::read_materials(Words words) {
  const std::string_view url = words.rest_of_line();
  if (!libraries_.insert(url).second) return true;
  const auto text = reading_.load(url, TextKind::kLines);
  if (text && !read_libraries_.insert(text->data()).second) return true;  // it has another URL, too
  if (text) return read_mtl(*text, url, place_, reading_, materials_);
  reading_.warn(place_, "the materials of " + quoted(url) + " are not read: " + text.error());
  return true;
}

void ObjReader::name_unread(std::string_view key, std::string_view what) {
  if (unread_.emplace(key).second) reading_.warn(place_, std::string(what));
}

bool ObjReader::read_line(std::string_view keyword, Words words) {
  if (keyword == "v") return read_vertex(words);
  if (keyword == "f") return read_polygon(words);
  if (keyword == "vt") return read_texture_point(words);
  if (keyword == "l" || keyword == "p") return read_indices(words, keyword == "l");
  if (keyword == "mtllib") return read_materials(words);
  if (keyword == "o" || keyword == "g") {
    name_ = words.rest_of_line();
    part_ = nullptr;
  } else if (keyword == "usemtl") {
    material_ = words.rest_of_line();
    part_ = nullptr;
  } else if (keyword == "vn") {
    ++normals_;
    name_unread(keyword, "the normals of points (vn) are not kept: faces are shaded flat");
  } else if (keyword == "s") {
    if (const std::string_view group = words.next(); group != "off" && group != "0" && normals_ == 0) {
      name_unread(keyword, "smoothing groups (s) are not kept: faces are shaded flat");
    }
  } else if (unknown_.size() <= kMostNamed && unknown_.insert(keyword).second) {
    reading_.warn(place_, "the statement " + quoted(keyword) +
                              (unknown_.size() > kMostNamed ? " and others are not read" : " is not read") +
                              ", here and further on");
  }
  return true;
}

const MaterialDraft* ObjReader::material_of(const Part& part) const {
  const auto it = materials_.find(part.material);
  return it == materials_.end() ? nullptr : &it->second;
}

// Copies the entries of `all` that the list names, `width` numbers each and in the order in which they are named first,
// and makes the list one of indices of those. `place` has an entry of -1 for each entry of `all`, before and after.
void take_entries(std::vector<std::int32_t>& list, const std::vector<float>& all, std::size_t width,
                  std::vector<std::int32_t>& place, std::vector<std::int32_t>& taken, std::vector<float>& out) {
  taken.clear();
  for (std::int32_t& entry : list) {
    if (entry < 0) continue;
    std::int32_t& index = place[static_cast<std::size_t>(entry)];
    if (index < 0) {
      index = static_cast<std::int32_t>(taken.size());
      taken.push_back(entry);
    }
    entry = index;
  }
  out.reserve(width * taken.size());
  for (const std::int32_t entry : taken) {
    const float* const first = all.data() + width * static_cast<std::size_t>(entry);
    out.insert(out.end(), first, first + width);
    place[static_cast<std::size_t>(entry)] = -1;
  }
}

void ObjReader::take_points(std::vector<std::int32_t>& list, ShapeDraft& shape) {
  if (groups_.size() == 1 && groups_.front().parts.size() == 1 && &list == &groups_.front().parts.front().polygons &&
      groups_.front().parts.front().lines.empty() && groups_.front().parts.front().dots.empty()) {
    shape.points = std::move(points_);
    shape.colors = std::move(colors_);
    return;
  }
  take_entries(list, points_, 3, place_of_point_, taken_, shape.points);
  for (const std::int32_t point : colors_.empty() ? std::vector<std::int32_t>{} : taken_) {
    const float* const first = colors_.data() + 3 * static_cast<std::size_t>(point);
    shape.colors.insert(shape.colors.end(), first, first + 3);
  }
}

// Returns the node of a material's image, one for all materials with the same image; none where there is none.
NodeRef ObjReader::image_of(const MaterialDraft& material, std::size_t place) {
  if (material.texture.empty()) return {};
  const auto [it, is_new] = images_.try_emplace(material.texture);
  if (!is_new) return it->second;
  const auto url = reading_.load_image(material.texture);
  if (url) {
    it->second = add_image(reading_.document, reading_.at(place), *url);
  } else {
    reading_.warn(place, vrml::quoted(material.texture) + " is not shown: " + url.error());
  }
  return it->second;
}

void ObjReader::add_part(Part& part, std::vector<NodeRef>& shapes) {
  NodeRef appearance;
  const MaterialDraft* const material = material_of(part);
  if (material != nullptr) {
    const auto [it, is_new] = appearances_.try_emplace(std::string(part.material));
    if (is_new) {
      it->second =
          add_appearance(reading_.document, reading_.at(part.begin), *material, image_of(*material, part.begin));
    }
    appearance = it->second;
  } else if (!part.material.empty()) {
    reading_.warn(part.begin, "there is no material " + quoted(part.material) + ": this part has the usual one");
  }
  for (std::vector<std::int32_t>* const list : {&part.polygons, &part.lines, &part.dots}) {
    if (list->empty()) continue;
    ShapeDraft shape;
    shape.appearance = appearance;
    take_points(*list, shape);
    const bool has_image = list == &part.polygons && material != nullptr && !material->texture.empty();
    if (has_image && !part.textured) {
      reading_.warn(part.begin,
                    "not all corners of this part have a texture coordinate (vt), so none is kept: its image "
                    "lies on it as VRML97 puts images by default");
    }
    if (has_image && part.textured) {
      take_entries(part.texture_index, texture_points_, 2, place_of_texture_point_, taken_, shape.texture_points);
      shape.texture_index = std::move(part.texture_index);
    }
    if (list == &part.polygons) shape.polygons = std::move(*list);
    if (list == &part.lines) shape.lines = std::move(*list);
    shapes.push_back(add_shape(reading_.document, reading_.at(part.begin), std::move(shape)));
  }
}

bool ObjReader::add_group(Group& group) {
  std::vector<NodeRef> shapes;
  for (Part& part : group.parts) {
    add_part(part, shapes);
    part = {};
    if (!reading_.has_room()) return reading_.fail(group.begin, std::string(kTooManyNodes));
  }
  auto& document = reading_.document;
  document.top_level.push_back(add_transform(document, reading_.at(group.begin), group.name, shapes));
  return true;
}

bool ObjReader::read() {
  while (auto line = lines_.next()) {
    place_ = lines_.begin();
    if (line->ends_with('\\')) {
      joined_.clear();
      while (line && line->ends_with('\\')) {
        joined_ += line->substr(0, line->size() - 1);
        joined_ += ' ';
        line = lines_.next();
      }
      if (line) joined_ += *line;
      // Names are kept as views, and a line that is continued has no place in the text as a whole.
      line = reading_.document.arena.copy(std::string_view(joined_));
    }
    Words words(line->substr(0, line->find('#')));
    const std::string_view keyword = words.next();
    if (!keyword.empty() && !read_line(keyword, words)) return false;
    if (!reading_.has_room(kNodesOfPart * part_count_)) return fail(std::string(kTooManyNodes));
  }
  if (groups_.empty()) return fail("this OBJ file has no faces, lines or points");
  if (!colors_.empty()) colors_.resize(points_.size(), 1.0F);
  place_of_point_.assign(points_.size() / 3, -1);
  place_of_texture_point_.assign(texture_points_.size() / 2, -1);
  for (Group& group : groups_) {
    if (!add_group(group)) return false;
  }
  return true;
}

}  // namespace

bool read_obj(std::string_view text, Reading& reading) { return ObjReader(text, reading).read(); }

}  // namespace peerd::formats
