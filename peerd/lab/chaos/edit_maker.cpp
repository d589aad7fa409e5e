#include "peerd/lab/chaos/edit_maker.hpp"

#include <algorithm>
#include <cassert>
#include <string>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "core/scene/scene.hpp"
#include "core/vrml/document.hpp"
#include "peerd/lab/chaos/random_stream.hpp"
#include "peerd/lab/chaos/world_text.hpp"
#include "replication/objects/replica/owners.hpp"

namespace peerd::chaos {
namespace {

using config::SceneEdit;

constexpr std::size_t kLargeText_bytes = 60'000;
constexpr std::size_t kBurst = 300;
constexpr double kGround_m = 10.0;
// Few keys, so that peers set the same ones.
constexpr std::uint64_t kDataKeys = 2;
// The stream of an edit's key, apart from that of what the edit is.
constexpr std::uint64_t kKeyItem = 1;

// The walls stay, so that there is something to meet.
bool is_wall(std::string_view name) { return name == "WEST" || name == "EAST" || name == "NORTH" || name == "SOUTH"; }

constexpr std::string_view kInterestEnd = "_CI";
bool is_free(std::string_view name) { return name.starts_with(kFreeBegin); }

SceneEdit setting(std::string path, std::string field, std::string value) {
  SceneEdit edit;
  edit.kind = SceneEdit::Kind::kSet;
  edit.path = std::move(path);
  edit.field = std::move(field);
  edit.value = std::move(value);
  return edit;
}

class EditMaker {
 public:
  EditMaker(const PlannedEdit& planned, const EditView& view) : random_(planned.seed, 0) {
    const Scene& scene = view.scene;
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
      const Instance& each = scene.instances[i];
      if (each.kind != NodeKind::kTransform || each.def.empty() || is_wall(each.def)) continue;
      const ObjectId object = scene.id_of(i);
      transforms_.push_back(scene.path_of(object));
      const PeerId owner = view.owners.of(object);
      if (owner != kNobody) (owner == view.self ? own_ : others_).push_back(transforms_.back());
      if (is_free(each.def)) free_.push_back(transforms_.back());
    }
    for (const ObjectId object : view.locked) {
      if (scene.contains(object)) locked_.push_back(scene.path_of(object));
    }
    for (const vrml::Node& node : scene.document->nodes) {
      if (node.def.ends_with(kInterestEnd)) interests_.emplace_back(node.def);
    }
    // Two peers that make the same planned edit add two nodes of one name, as people would.
    name_ = fmt::format("N{}", planned.number);
  }

  std::vector<SceneEdit> any() {
    switch (random_.below(25)) {
      case 0:
      case 1:
        return {adding(block() + interest())};
      case 2:
        return {adding(moved_block())};
      case 3:
      case 4:
        return {adding(free_block())};
      case 5:
        return {removing()};
      case 6:
      case 7:
        return {moving()};
      case 8: {
        const std::string path = some_transform();
        return {setting(path, "velocityVector", vector(2.0))};
      }
      case 9: {
        const std::string path = some_transform() + "_M";
        return {setting(path, "diffuseColor", fmt::format("0.5 {:.2f} 0.5", random_.uniform()))};
      }
      case 10:
      case 11:
        return {position(some_transform())};
      case 12:
        return {interest_change()};
      case 13:
      case 14:
        return {about(SceneEdit::Kind::kOwn, some_object_to_own())};
      case 15:
        return {about(SceneEdit::Kind::kGrab, some_object_to_own())};
      case 16:
        return {about(SceneEdit::Kind::kRelease, own_.empty() ? some_object() : own_[random_.below(own_.size())])};
      case 17:
      case 18:
        return {datum(some_object())};
      case 19:
        return {message()};
      case 20:
        return {about(SceneEdit::Kind::kLock, some_object())};
      case 21:
      case 22:  // what is locked does not stay so for long, or edits would do little else than be refused
        return {
            about(SceneEdit::Kind::kUnlock, locked_.empty() ? some_object() : locked_[random_.below(locked_.size())])};
      default:
        return undoing();
    }
  }
  SceneEdit large() {
    std::string text = block();
    const std::size_t end = text.size() + kLargeText_bytes;
    while (text.size() < end)
      text += fmt::format("DEF {}_{} WorldInfo {{ title \"{:x}\" }}\n", name_, text.size(), random_.bits());
    return adding(std::move(text));
  }
  SceneEdit one_field() { return position("S1"); }
  SceneEdit one_owner() {
    const bool holds = random_.chance(0.3);
    return about(holds ? SceneEdit::Kind::kGrab : SceneEdit::Kind::kOwn, contested());
  }
  SceneEdit one_datum() { return datum(contested()); }
  // One of them, or more, remove what the others change.
  SceneEdit one_removal() {
    const std::string path = "S2";
    switch (random_.below(5)) {
      case 0:
        return about(SceneEdit::Kind::kRemove, path);
      case 1:
        return datum(path);
      case 2: {
        SceneEdit edit = about(SceneEdit::Kind::kMove, path);
        edit.under = some_transform();
        return edit;
      }
      case 3: {
        SceneEdit edit = adding(block());
        edit.under = path;
        return edit;
      }
      default:
        return position(path);
    }
  }
  SceneEdit position(const std::string& path) { return setting(path, "translation", vector(kGround_m)); }
  [[nodiscard]] std::string some_transform() {
    return transforms_.empty() ? "WEST" : transforms_[random_.below(transforms_.size())];
  }

 private:
  std::string vector(double most) {
    const double x = random_.uniform(-most, most), z = random_.uniform(-most, most);
    return fmt::format("{:.3f} 0 {:.3f}", x, z);
  }
  std::string block() {
    const std::string place = vector(kGround_m);
    const double width_m = random_.uniform(0.2, 0.9), depth_m = random_.uniform(0.2, 0.9);
    return fmt::format(
        "DEF {0} Transform {{ translation {1} children Shape {{ appearance Appearance {{ material DEF {0}_M Material "
        "{{ }} }} geometry Box {{ size {2:.2f} 0.8 {3:.2f} }} }} }}\n",
        name_, place, width_m, depth_m);
  }
  std::string interest() { return interest_in("M1A", name_); }
  std::string interest_in(const std::string& object, const std::string& other) {
    return fmt::format("DEF {}{} CollisionInterest {{ objectPath \"{}\" collisionType 1 interests [ \"{}\" ] }}\n",
                       name_, kInterestEnd, object, other);
  }
  // The world itself moves it.
  std::string moved_block() {
    const std::string moved = block() + interest();
    const double cycle_s = random_.uniform(2.0, 9.0);
    const std::string from = vector(kGround_m), to = vector(kGround_m);
    return moved + fmt::format(
                       "DEF {0}_T TimeSensor {{ loop TRUE cycleInterval {1:.2f} }}\n"
                       "DEF {0}_I PositionInterpolator {{ key [ 0 0.5 1 ] keyValue [ {2}, {3}, {2} ] }}\n"
                       "ROUTE {0}_T.fraction_changed TO {0}_I.set_fraction\n"
                       "ROUTE {0}_I.value_changed TO {0}.set_translation\n",
                       name_, cycle_s, from, to);
  }
  // Nothing meets it, and a key moves it: where its owner leaves it behind an operation says.
  std::string free_block() {
    name_.front() = kFreeBegin;
    const std::string moved = block(), velocity = vector(1.0);
    return moved +
           fmt::format("KeySensor {{ recipient \"{}\" keyValue {} consume FALSE absoluteValue TRUE value {} }}\n",
                       name_, kMovingKey, velocity);
  }
  static SceneEdit about(SceneEdit::Kind kind, std::string path) {
    SceneEdit edit;
    edit.kind = kind;
    edit.path = std::move(path);
    return edit;
  }
  // Many want the same few things.
  [[nodiscard]] static std::string contested() { return "S1"; }
  std::string some_object() {
    const std::uint64_t which = random_.below(4);
    if (which == 0) return contested();
    if (which == 1 && !free_.empty()) return free_[random_.below(free_.size())];
    return some_transform();
  }
  // Where others own something, half of the time that, so that it is asked for.
  std::string some_object_to_own() {
    const bool asks = random_.chance(0.5);
    return asks && !others_.empty() ? others_[random_.below(others_.size())] : some_object();
  }
  SceneEdit datum(std::string path) {
    SceneEdit edit = about(SceneEdit::Kind::kData, std::move(path));
    edit.key = fmt::format("k{}", random_.below(kDataKeys));
    edit.removes = random_.chance(0.25);
    if (!edit.removes) edit.data = fmt::format("{} {:x}", name_, random_.bits());
    return edit;
  }
  SceneEdit message() {
    SceneEdit edit;
    edit.kind = SceneEdit::Kind::kSend;
    edit.key = "chaos";
    edit.data = fmt::format("{} {:x}", name_, random_.bits());
    return edit;
  }
  // An interest gets another partner, is of another type, or goes.
  SceneEdit interest_change() {
    if (interests_.empty()) return adding(interest_in("M1A", "S1"));
    const std::string path = interests_[random_.below(interests_.size())];
    const std::uint64_t what = random_.below(3);
    if (what == 0) return about(SceneEdit::Kind::kRemove, path);
    if (what == 1) return setting(path, "collisionType", fmt::format("{}", random_.below(3)));
    return setting(path, "interests", fmt::format("[ \"{}\" ]", some_transform()));
  }
  // One or more steps back, and some of them on again.
  std::vector<SceneEdit> undoing() {
    std::vector<SceneEdit> edits;
    const std::uint64_t back = 1 + random_.below(3), forward = random_.below(3);
    for (std::uint64_t i = 0; i < back; ++i) edits.push_back(about(SceneEdit::Kind::kUndo, ""));
    for (std::uint64_t i = 0; i < forward; ++i) edits.push_back(about(SceneEdit::Kind::kRedo, ""));
    return edits;
  }
  static SceneEdit adding(std::string text) {
    SceneEdit edit;
    edit.kind = SceneEdit::Kind::kAdd;
    edit.text = std::move(text);
    return edit;
  }
  SceneEdit removing() {
    SceneEdit edit;
    edit.kind = SceneEdit::Kind::kRemove;
    edit.path = some_transform();
    return edit;
  }
  SceneEdit moving() {
    SceneEdit edit;
    edit.kind = SceneEdit::Kind::kMove;
    edit.path = some_transform();
    if (random_.chance(0.6)) edit.under = some_transform();
    return edit;
  }

  Random random_;
  std::vector<std::string> transforms_, own_, others_, free_, interests_, locked_;
  std::string name_;
};

}  // namespace

std::vector<SceneEdit> make_edits(const PlannedEdit& planned, const EditView& view) {
  EditMaker make(planned, view);
  std::vector<SceneEdit> edits;
  switch (planned.kind) {
    case EditKind::kAny:
      edits = make.any();
      break;
    case EditKind::kLarge:
      edits.push_back(make.large());
      break;
    case EditKind::kBurst:
      while (edits.size() < kBurst) edits.push_back(make.position(make.some_transform()));
      break;
    case EditKind::kOneField:
      edits.push_back(make.one_field());
      break;
    case EditKind::kOneOwner:
      edits.push_back(make.one_owner());
      break;
    case EditKind::kOneDatum:
      edits.push_back(make.one_datum());
      break;
    case EditKind::kOneRemoval:
      edits.push_back(make.one_removal());
      break;
  }
  assert(!edits.empty());
  return edits;
}

std::optional<KeyEvent> make_key(const PlannedEdit& planned, const EditView& view) {
  if (planned.kind != EditKind::kAny) return std::nullopt;
  const bool owns_free = std::ranges::any_of(view.owners, [&](const auto& owned) {
    return owned.second == view.self && view.scene.contains(owned.first) && is_free(view.scene.at(owned.first).def);
  });
  Random random(planned.seed, kKeyItem);
  return random.chance(owns_free ? 0.7 : 0.05) ? std::optional(KeyEvent{kMovingKey, 0}) : std::nullopt;
}

}  // namespace peerd::chaos
