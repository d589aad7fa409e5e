#include "peerd/chaos/edit_maker.hpp"

#include <cassert>
#include <string>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "core/scene/scene.hpp"
#include "peerd/chaos/random_stream.hpp"

namespace peerd::chaos {
namespace {

using config::SceneEdit;

constexpr std::size_t kLargeText_bytes = 60'000;
constexpr std::size_t kBurst = 300;
constexpr double kGround_m = 10.0;

// The walls stay, so that there is something to meet.
bool is_wall(std::string_view name) { return name == "WEST" || name == "EAST" || name == "NORTH" || name == "SOUTH"; }

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
  EditMaker(const PlannedEdit& planned, const Scene& scene) : random_(planned.seed, 0) {
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
      const Instance& each = scene.instances[i];
      if (each.kind != NodeKind::kTransform || each.def.empty() || is_wall(each.def)) continue;
      transforms_.push_back(scene.path_of(scene.id_of(i)));
    }
    // Two peers that make the same planned edit add two nodes of one name, as people would.
    name_ = fmt::format("N{}", planned.number);
  }

  SceneEdit any() {
    switch (random_.below(10)) {
      case 0:
      case 1:
        return adding(block() + interest());
      case 2:
        return adding(moved_block());
      case 3:
        return removing();
      case 4:
      case 5:
        return moving();
      case 6: {
        const std::string path = some_transform();
        return setting(path, "velocityVector", vector(2.0));
      }
      case 7: {
        const std::string path = some_transform() + "_M";
        return setting(path, "diffuseColor", fmt::format("0.5 {:.2f} 0.5", random_.uniform()));
      }
      default:
        return position(some_transform());
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
  std::string interest() {
    return fmt::format("CollisionInterest {{ objectPath \"M1A\" collisionType 1 interests [ \"{}\" ] }}\n", name_);
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
  std::vector<std::string> transforms_;
  std::string name_;
};

}  // namespace

std::vector<SceneEdit> make_edits(const PlannedEdit& planned, const Scene& scene) {
  EditMaker make(planned, scene);
  std::vector<SceneEdit> edits;
  switch (planned.kind) {
    case EditKind::kAny:
      edits.push_back(make.any());
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
  }
  assert(!edits.empty());
  return edits;
}

}  // namespace peerd::chaos
