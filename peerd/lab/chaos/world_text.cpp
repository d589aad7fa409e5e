#include "peerd/lab/chaos/world_text.hpp"

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "core/scene/reader.hpp"
#include "peerd/lab/chaos/random_stream.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd::chaos {
namespace {

constexpr std::size_t kObjects = 50;
constexpr std::size_t kFree = 3;
constexpr std::size_t kColumns = 7;
constexpr double kApart_m = 2.6;    // of the places of a grid, on each of which one object stands at first
constexpr double kHalf_m = 12.0;    // half of the ground's side
constexpr double kLargest_m = 0.9;  // of a box: two on neighbouring places do not touch
constexpr const char* kWalls = "\"WEST\" \"EAST\" \"NORTH\" \"SOUTH\"";

std::string box(const std::string& name, const std::string& fields, const Vec3& size) {
  return fmt::format(
      "DEF {} Transform {{\n  {}\n  children Shape {{ appearance Appearance {{ material DEF {}_M Material {{ }} }} "
      "geometry Box {{ size {} {} {} }} }}\n}}\n",
      name, fields, name, size.x(), size.y(), size.z());
}

std::string wall(const char* name, double x, double z) {
  const Vec3 size(x != 0.0 ? 1.0 : 2.0 * kHalf_m + 2.0, 3.0, z != 0.0 ? 1.0 : 2.0 * kHalf_m);
  return box(name, fmt::format("translation {} 0 {}", x, z), size);
}

// Writes the objects one after the other.
class WorldWriter {
 public:
  WorldWriter(std::uint64_t seed, std::size_t peers) : random_(stream_of(seed, Stream::kWorld)) {
    world_.owned.resize(peers);
    for (std::size_t i = 0; i < kColumns * kColumns + kColumns; ++i) places_.push_back(i);
    for (std::size_t i = places_.size(); i > 1; --i) std::swap(places_[i - 1], places_[random_.below(i)]);
    text_ = "#VRML V2.0 utf8\n";
    const double at = kHalf_m + 0.5;
    text_ += wall("WEST", -at, 0.0) + wall("EAST", at, 0.0) + wall("NORTH", 0.0, -at) + wall("SOUTH", 0.0, at);
  }

  ChaosWorld all() {
    for (std::size_t peer = 0; peer < world_.owned.size(); ++peer) {
      for (const char* which : {"A", "B"}) world_.owned[peer].push_back(mover(fmt::format("M{}{}", peer + 1, which)));
    }
    const std::size_t nobodys = 4 + random_.below(6);
    for (std::size_t i = 0; i < nobodys; ++i) loose_.push_back(loose(fmt::format("L{}", i + 1)));
    for (std::size_t i = 1; i <= kFree; ++i) free_one(fmt::format("F{}", i));
    for (std::size_t i = 1; used_ < kObjects; ++i) standing_.push_back(standing(fmt::format("S{}", i)));
    interests();
    world_.text = std::move(text_);
    return std::move(world_);
  }

 private:
  std::string place() {
    assert(used_ < places_.size());
    const std::size_t at = places_[used_++];
    const std::size_t column = at % kColumns, row = at / kColumns;
    const double x = (static_cast<double>(column) - 3.0) * kApart_m;
    const double z = (static_cast<double>(row) - 3.5) * kApart_m;
    return fmt::format("translation {:.3f} 0 {:.3f}", x, z);
  }
  Vec3 size() {
    const double x = random_.uniform(0.3, kLargest_m), y = random_.uniform(0.3, kLargest_m);
    return {x, y, random_.uniform(0.3, kLargest_m)};
  }
  std::string mover(const std::string& name) {
    const std::string response =
        random_.chance(0.5) ? "" : fmt::format("responseType 2 restitution {:.2f}", random_.uniform(0.6, 1.0));
    const double vx = random_.uniform(-3.0, 3.0), vz = random_.uniform(-3.0, 3.0);
    text_ += box(name,
                 fmt::format("{} velocityVector {:.3f} 0 {:.3f} distanceThreshold 0.1 collisionResponse "
                             "CollisionResponse {{ {} }}",
                             place(), vx, vz, response),
                 size());
    movers_.push_back(name);
    return name;
  }
  std::string loose(const std::string& name) {
    const double mass = random_.uniform(0.5, 3.0), friction = random_.uniform(0.2, 1.0);
    text_ += box(name,
                 fmt::format("{} collisionResponse CollisionResponse {{ responseType 2 mass {:.2f} restitution 0.8 "
                             "friction {:.2f} }}",
                             place(), mass, friction),
                 size());
    return name;
  }
  // Nothing meets it, and a key moves it. Where its owner leaves it behind an operation says.
  void free_one(const std::string& name) {
    text_ += box(name, place(), size());
    const double vx = random_.uniform(-1.0, 1.0), vz = random_.uniform(-1.0, 1.0);
    text_ += fmt::format(
        "KeySensor {{ recipient \"{}\" keyValue {} consume FALSE absoluteValue TRUE value {:.3f} 0 {:.3f} }}\n", name,
        kMovingKey, vx, vz);
  }
  // Some have a part that stands beside them, so that there is a tree.
  std::string standing(const std::string& name) {
    const std::string where = place();
    if (!random_.chance(0.3)) {
      text_ += box(name, where, size());
      return name;
    }
    const Vec3 below = size(), above = size();
    text_ += fmt::format("DEF {} Transform {{ {} children [\n{}{}] }}\n", name, where, box(name + "P", "", below),
                         box(name + "Q", "translation 0 0.9 0", above));
    return name;
  }
  void interest(const std::string& in, const std::string& others) {
    text_ += fmt::format("CollisionInterest {{ objectPath \"{}\" collisionType 1 interests [ {} ] }}\n", in, others);
  }
  void interests() {
    const auto list = [](const std::vector<std::string>& names) {
      std::string all;
      for (const std::string& name : names) all += fmt::format("\"{}\" ", name);
      return all;
    };
    for (std::size_t i = 0; i < movers_.size(); ++i) {
      const std::vector<std::string> rest(movers_.begin() + static_cast<std::ptrdiff_t>(i) + 1, movers_.end());
      interest(movers_[i], kWalls + (" " + list(rest)) + list(loose_) + list(standing_));
    }
    for (const std::string& each : loose_) interest(each, kWalls);
  }

  Random random_;
  ChaosWorld world_;
  std::string text_;
  std::vector<std::size_t> places_;
  std::size_t used_ = 0;
  std::vector<std::string> movers_, loose_, standing_;
};

}  // namespace

ChaosWorld draw_world(std::uint64_t seed, std::size_t peers) { return WorldWriter(seed, peers).all(); }

std::unique_ptr<const SharedWorld> share(const ChaosWorld& world) {
  ReadOptions reading;
  reading.name = "chaos";
  const ReadResult read = read_world(world.text, reading);
  if (!read.scene) {
    std::string problems;
    for (const Diagnostic& d : read.diagnostics) problems += render(read, d);
    throw std::logic_error("the generated world can't be read: " + problems);
  }
  auto shared = std::make_unique<SharedWorld>();
  shared->world = {"chaos.wrl", content_hash(read), *read.scene, {}};
  std::vector<ObjectId> owned;
  for (const auto& of_peer : world.owned) {
    for (const std::string& path : of_peer) owned.push_back(shared->world.scene.find(path).value());
  }
  std::ranges::sort(owned);
  shared->model = replication::make_world_model(shared->world.scene, owned);
  return shared;
}

}  // namespace peerd::chaos
