#include "tests/sim/living/world.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/sim/chance.hpp"
#include "tests/sim/living/forms.hpp"

namespace peerd::living {
namespace {

using sim::testing_support::Chance;

constexpr double kFastest_m_s = 8.0, kFastestTurn_rad_s = 6.0, kHalfTurn_rad = 3.14159265358979;

double length_of(const Three& v) { return std::sqrt(double(v[0]) * v[0] + double(v[1]) * v[1] + double(v[2]) * v[2]); }
double distance(const Three& a, const Three& b) { return length_of({a[0] - b[0], a[1] - b[1], a[2] - b[2]}); }

std::array<double, 4> quaternion(const Turn& turn) {
  const double sine = std::sin(0.5 * turn[3]) / length_of({turn[0], turn[1], turn[2]});
  return {std::cos(0.5 * turn[3]), sine * turn[0], sine * turn[1], sine * turn[2]};
}
// The angle of the shorter way from one orientation to the other [rad].
double angle_between(const Turn& a, const Turn& b) {
  const auto p = quaternion(a), q = quaternion(b);
  const double dot = std::abs(p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3]);
  return 2.0 * std::acos(std::min(1.0, dot));
}

class Maker {
 public:
  explicit Maker(std::uint64_t seed) : chance_(seed) { world_.seed = seed; }

  World make() {
    world_.duration_s = chance_.one_of({6.0, 8.0, 10.0});
    world_.latency_ms = chance_.one_of({0, 20, 100, 200});
    world_.tick_hz = chance_.one_of({20, 33, 60, 60});
    const std::size_t most = 4 + chance_.below(9);
    for (std::size_t i = 0, walls = 1 + chance_.below(2); i < walls; ++i) add_wall();
    if (chance_.happens(0.5)) add_slider();
    if (chance_.happens(0.35)) add_bar();
    owners_ = chance_.below(3);
    for (std::size_t i = 0, flyers = owners_ + chance_.below(2); i < flyers; ++i) add_flyer(-1);
    for (int tree = 0; moving_ < most || tree < 2; ++tree) add_tree(most);
    add_owners();
    add_interests();
    add_decoration();
    return std::move(world_);
  }

 private:
  Three three(double half) {
    const float x = draw(chance_, -half, half), y = draw(chance_, -half, half), z = draw(chance_, -half, half);
    return {x, y, z};
  }
  Turn turn(double most_rad) {
    Three axis = three(1.0);
    if (length_of(axis) < 0.1) axis = {0, 1, 0};
    return {axis[0], axis[1], axis[2], draw(chance_, -most_rad, most_rad)};
  }
  int add(NodeKind kind, int parent) {
    world_.nodes.push_back({.kind = kind, .parent = parent});
    return int(world_.nodes.size()) - 1;
  }
  Node& at(int node) { return world_.nodes[std::size_t(node)]; }
  int add_shape(int parent, Form form) {
    const int shape = add(NodeKind::kShape, parent);
    at(shape).form = int(world_.forms.size());
    world_.forms.push_back(std::move(form));
    return shape;
  }
  int add_box(int parent, float x, float y, float z) {
    return add_shape(parent, {.kind = FormKind::kBox, .size = {x, y, z}});
  }

  // Clocks and paths
  int some_clock() {
    if (!world_.clocks.empty() && chance_.happens(0.35)) return int(chance_.below(world_.clocks.size()));
    Clock clock{.cycle_s = chance_.between(1.5, 6.0)};
    if (chance_.happens(0.15)) clock.start_s = chance_.between(0.3, 3.0);
    if (chance_.happens(0.1)) clock.stop_s = clock.start_s + chance_.between(1.5, 5.0);
    if (clock.start_s > 0.0 && chance_.happens(0.4)) {
      clock.loop = false;
      clock.cycle_s *= 1.5;
    }
    world_.clocks.push_back(clock);
    return int(world_.clocks.size()) - 1;
  }
  double cycle_s(int clock) const { return world_.clocks[std::size_t(clock)].cycle_s; }
  template <class V>
  Path<V> path_of_keys() {
    Path<V> path{.clock = some_clock()};
    const double cycle = cycle_s(path.clock);
    const auto most = std::size_t(std::clamp(cycle / 0.3, 2.0, 5.0));
    path.key = make_keys(chance_, 2 + chance_.below(most - 1), cycle);
    return path;
  }
  // Now and then the value jumps, at a key that is there twice.
  template <class V>
  void add_jump(Path<V>& path, const V& to) {
    const std::size_t i = 1 + chance_.below(path.key.size() - 2);
    path.key.insert(path.key.begin() + std::ptrdiff_t(i), path.key[i]);
    path.value.insert(path.value.begin() + std::ptrdiff_t(i), to);
  }
  template <class V>
  double seconds(const Path<V>& path, std::size_t i) const {
    return (double(path.key[i + 1]) - path.key[i]) * cycle_s(path.clock);
  }

  Path<Three> some_way(const Three& middle, double half_m) {
    auto path = path_of_keys<Three>();
    const double slow = chance_.happens(0.3) ? 0.25 : 1.0;
    for (std::size_t i = 0; i + 1 < path.key.size(); ++i) path.value.push_back(three(half_m * slow));
    path.value.push_back(path.value.front());
    double shrink = 1.0;
    for (std::size_t i = 0; i + 1 < path.key.size(); ++i) {
      const double way_m = distance(path.value[i], path.value[i + 1]);
      shrink = std::min(shrink, kFastest_m_s * seconds(path, i) / std::max(way_m, 1e-3));
    }
    for (Three& value : path.value) {
      for (std::size_t k = 0; k < 3; ++k) value[k] = middle[k] + float(shrink) * value[k];
    }
    if (chance_.happens(0.12)) add_jump(path, path.value[chance_.below(path.value.size())]);
    return path;
  }
  Path<Three> some_scale() {
    auto path = path_of_keys<Three>();
    for (std::size_t i = 0; i + 1 < path.key.size(); ++i) {
      const float x = draw(chance_, 0.6, 1.4), y = draw(chance_, 0.6, 1.4), z = draw(chance_, 0.6, 1.4);
      path.value.push_back({x, y, z});
    }
    path.value.push_back(path.value.front());
    return path;
  }
  // No piece turns by more than a right angle and a half, or by less than can be told from none.
  bool turns_well(const Path<Turn>& path) const {
    for (std::size_t i = 0; i + 1 < path.key.size(); ++i) {
      const double angle = angle_between(path.value[i], path.value[i + 1]);
      if (angle < 0.1 || angle > 0.75 * kHalfTurn_rad || angle > kFastestTurn_rad_s * seconds(path, i)) return false;
    }
    return true;
  }
  Path<Turn> some_turning() {
    auto path = path_of_keys<Turn>();
    if (chance_.happens(0.5)) {
      for (int tries = 0; tries < 30; ++tries) {
        const double most = 2.5 / (1.0 + 0.2 * tries);
        path.value.clear();
        for (std::size_t i = 0; i + 1 < path.key.size(); ++i) path.value.push_back(turn(most));
        path.value.push_back(path.value.front());
        if (turns_well(path)) {
          if (chance_.happens(0.2)) add_jump(path, turn(2.5));
          return path;
        }
      }
    }
    // To and fro, or around and around, about one axis.
    const Turn about = turn(1.0);
    const double whole = 2.0 * kHalfTurn_rad;
    const bool around = path.key.size() >= 4 && chance_.happens(0.6);
    path.value.clear();
    if (around) path.key = make_keys(chance_, std::max<std::size_t>(path.key.size() - 1, 3), 1e9);
    for (std::size_t i = 0; i < path.key.size(); ++i) {
      const double angle = around ? whole * path.key[i] : (i % 2 == 0 ? -0.5 : chance_.between(0.2, 0.9));
      path.value.push_back({about[0], about[1], about[2], float(angle)});
    }
    if (!around) path.value.back() = path.value.front();
    if (!turns_well(path)) return even_turning(path.clock, about);
    return path;
  }
  // A turn in equal parts, as fast as is allowed at most: the clock may be too fast for a whole one.
  Path<Turn> even_turning(int clock, const Turn& about) {
    const double most = std::min(0.9 * kFastestTurn_rad_s * 0.5 * cycle_s(clock), 2.0);
    const auto by = [&](double angle) { return Turn{about[0], about[1], about[2], float(angle)}; };
    const double angle = chance_.between(std::min(0.3, most), most);
    return {.clock = clock, .key = {0.0F, 0.5F, 1.0F}, .value = {by(0.0), by(angle), by(0.0)}};
  }

  // What stands
  void add_wall() {
    const int wall = add(NodeKind::kTransform, -1);
    at(wall).translation = three(1.5);
    if (chance_.happens(0.6)) at(wall).rotation = turn(2.0);
    const float x = draw(chance_, 1.5, 4.0), y = draw(chance_, 0.05, 0.3), z = draw(chance_, 1.5, 4.0);
    add_box(wall, x, y, z);
  }
  // A box that slides along a plate, deeper than its face by less than a tenth of a millimetre, or past it.
  void add_slider() {
    const int frame = add(NodeKind::kTransform, -1);
    at(frame).translation = three(3.0);
    at(frame).rotation = turn(2.0);
    const int plate = add(NodeKind::kTransform, frame);
    add_box(plate, draw(chance_, 0.5, 2.0), 0.25F, 1.0F);
    const int box = add(NodeKind::kTransform, frame);
    const double depth_m = chance_.happens(0.75) ? chance_.between(3e-6, 9e-5) : -chance_.between(4e-5, 9e-5);
    const float speed = draw(chance_, 0.3, 3.0);
    const double at_s = chance_.between(1.5, world_.duration_s - 1.5);
    at(box).translation = {float(-speed * at_s), float(0.25 - depth_m), draw(chance_, -0.3, 0.3)};
    at(box).velocity = {speed, 0, 0};
    add_box(box, draw(chance_, 0.2, 0.5), 0.25F, 0.25F);
    ++moving_;
    planted_.push_back({box, plate});
  }
  // A bar whose corner comes near to a plate as it goes around, and goes into it by less than a tenth of a millimetre.
  void add_bar() {
    const int frame = add(NodeKind::kTransform, -1);
    at(frame).translation = three(3.0);
    at(frame).rotation = turn(2.0);
    const float x = draw(chance_, 0.5, 1.5), y = draw(chance_, 0.1, 0.3);
    const double corner_m = 0.5 * std::sqrt(double(x) * x + double(y) * y);
    const int bar = add(NodeKind::kTransform, frame);
    add_box(bar, x, y, 0.25F);
    Path<Turn> path{.clock = int(world_.clocks.size())};
    world_.clocks.push_back({.cycle_s = chance_.between(2.5, 6.0)});
    path.key = {0.0F, 0.25F, 0.5F, 0.75F, 1.0F};
    for (const float key : path.key) path.value.push_back({0, 0, 1, float(2.0 * kHalfTurn_rad) * key});
    at(bar).rotations = path;
    const int plate = add(NodeKind::kTransform, frame);
    at(plate).translation = {0, float(-corner_m - 0.25 + chance_.between(-2e-5, 9e-5)), 0};
    add_box(plate, 1.0F, 0.5F, 1.0F);
    ++moving_;
    planted_.push_back({bar, plate});
  }
  // Moved by its velocity, through the middle of its parent's frame; now and then it turns by an interpolator.
  int add_flyer(int parent) {
    const int flyer = add(NodeKind::kTransform, parent);
    const double half_m = parent < 0 ? 1.2 : 0.5;
    const double speed = chance_.happens(0.75) ? chance_.between(0.15, 2.0) : chance_.between(2.0, 8.0);
    Three way = three(1.0);
    if (length_of(way) < 0.1) way = {1, 0, 0};
    const double length = length_of(way), at_s = chance_.between(0.25, 0.8) * world_.duration_s;
    const Three aim = three(half_m);
    for (std::size_t k = 0; k < 3; ++k) {
      at(flyer).velocity[k] = float(speed * way[k] / length);
      at(flyer).translation[k] = float(aim[k] - at_s * at(flyer).velocity[k]);
    }
    add_still_fields(flyer);
    if (chance_.happens(0.2)) at(flyer).rotations = some_turning();
    add_some_shape(flyer);
    ++moving_;
    return flyer;
  }

  // What lives
  void add_still_fields(int node) {
    if (chance_.happens(0.35)) at(node).rotation = turn(2.5);
    if (chance_.happens(0.3)) {
      const float x = draw(chance_, 0.7, 1.35), y = draw(chance_, 0.7, 1.35), z = draw(chance_, 0.7, 1.35);
      at(node).scale = {x, y, z};
      if (chance_.happens(0.25)) at(node).scale[chance_.below(3)] *= -1.0F;
      if (chance_.happens(0.4)) at(node).scale_orientation = turn(1.5);
    }
    if (chance_.happens(0.15)) at(node).center = three(0.5);
  }
  void add_some_shape(int parent) {
    const double size_m = chance_.happens(0.15) ? chance_.between(1.0, 2.0) : chance_.between(0.25, 1.0);
    if (chance_.happens(0.15)) {
      const int clock = some_clock();
      add_shape(parent, make_bending_form(chance_, size_m, clock, cycle_s(clock)));
    } else if (!still_forms_.empty() && chance_.happens(0.1)) {
      const int shape = add(NodeKind::kShape, parent);
      at(shape).form = still_forms_[chance_.below(still_forms_.size())];
      keep_from_a_sphere(parent, world_.forms[std::size_t(at(shape).form)]);
    } else {
      const Form form = make_form(chance_, size_m);
      keep_from_a_sphere(parent, form);
      still_forms_.push_back(at(add_shape(parent, form)).form);
    }
  }
  // A peer takes an object that is one Sphere, evenly scaled, for the exact one, and `collide` for its polygons.
  void keep_from_a_sphere(int parent, const Form& form) {
    if (form.kind == FormKind::kSphere && !at(parent).scales.drives()) at(parent).scale = {1.0F, 0.8F, 1.125F};
  }
  void add_tree(std::size_t most) {
    const int group = chance_.happens(0.25) ? add(NodeKind::kGroup, -1) : -1;
    const int depth = int(chance_.one_of<std::size_t>({1, 2, 2, 3, 3, 4, 5, 5}));
    for (std::size_t i = 0, trees = group < 0 ? 1 : 1 + chance_.below(2); i < trees; ++i) grow(group, depth, most);
  }
  // A Transform and what it carries: up to `levels` of them below each other.
  void grow(int parent, int levels, std::size_t most) {
    const bool is_root = parent < 0 || at(parent).kind == NodeKind::kGroup;
    if (!is_root && levels == 1 && use_another(parent)) return;
    const double half_m = is_root ? 1.7 : 0.9;
    const double role = moving_ < 14 ? chance_.between(0.0, 1.0) : 0.94;
    if (role < 0.15) {
      const int flyer = add_flyer(is_root ? -1 : parent);
      if (is_root) at(flyer).parent = parent;
      grow_children(flyer, levels, most);
      return;
    }
    const int node = add(NodeKind::kTransform, parent);
    at(node).translation = three(half_m);
    add_still_fields(node);
    if (role < 0.55 || role > 0.95) at(node).translations = some_way(three(0.5 * half_m), half_m);
    if (role > 0.45 && role < 0.85) {
      at(node).rotations = some_turning();
      if (chance_.happens(0.4)) at(node).center = three(0.4);
    }
    if (role > 0.85 && role < 0.93) at(node).scales = some_scale();
    moving_ += at(node).moves();
    if (levels == 1 || chance_.happens(0.5)) add_some_shape(node);
    grow_children(node, levels, most);
  }
  void grow_children(int node, int levels, std::size_t most) {
    if (levels == 1) return;
    grow(node, levels - 1, most);
    if (moving_ < most && chance_.happens(0.4)) grow(node, 1 + int(chance_.below(std::size_t(levels - 1))), most);
    if (chance_.happens(0.2)) {  // a part that is fixed to it
      const int part = add(NodeKind::kTransform, node);
      at(part).translation = three(0.8);
      add_still_fields(part);
      add_some_shape(part);
    }
  }
  // Another instance of a Transform that holds a Shape and no more.
  bool use_another(int parent) {
    if (!chance_.happens(0.15)) return false;
    std::vector<int> leaves;
    for (int i = 0; i + 1 < int(world_.nodes.size()); ++i) {
      const Node& node = at(i);
      const bool is_leaf = node.kind == NodeKind::kTransform && node.use_of < 0 && at(i + 1).parent == i &&
                           (i + 2 == int(world_.nodes.size()) || at(i + 2).parent <= i - 1) && node.parent != parent &&
                           node.velocity == Three{} && node.parent >= 0 && at(node.parent).kind != NodeKind::kGroup;
      if (is_leaf && i != parent && !is_below(parent, i) && at(i + 1).kind == NodeKind::kShape) leaves.push_back(i);
    }
    if (leaves.empty()) return false;
    const int leaf = leaves[chance_.below(leaves.size())];
    const auto is_here = [&](const Node& node) { return node.parent == parent && node.use_of == leaf; };
    if (std::ranges::any_of(world_.nodes, is_here)) return false;  // one path would name both
    const int use = int(world_.nodes.size());
    for (const int of : {leaf, leaf + 1}) {
      Node copy = at(of);
      copy.parent = of == leaf ? parent : use;
      copy.use_of = of;
      world_.nodes.push_back(copy);
    }
    moving_ += at(use).moves();
    return true;
  }

  // Peers and interests
  void add_owners() {
    world_.peers = {"a", "b"};
    if (chance_.happens(0.3)) world_.peers.emplace_back("c");
    if (owners_ == 0) return;
    const std::size_t first = chance_.below(2);
    std::vector<int> free;
    for (int i = 0; i < int(world_.nodes.size()); ++i) {
      if (at(i).velocity != Three{} && !at(i).rotations.drives()) free.push_back(i);
    }
    std::size_t given = 0;
    for (const int node : free) {
      if (given >= owners_ && chance_.happens(0.3)) continue;
      at(node).owner = owners_ == 1 ? int(first) : int((first + given) % owners_);
      ++given;
    }
  }
  int end_of(int node) const {
    int end = node + 1;
    while (end < int(world_.nodes.size()) && is_below(end, node)) ++end;
    return end;
  }
  bool is_below(int node, int above) const {
    for (int i = world_.nodes[std::size_t(node)].parent; i >= 0; i = world_.nodes[std::size_t(i)].parent) {
      if (i == above) return true;
    }
    return false;
  }
  std::size_t shapes_in(int node) const {
    std::size_t shapes = 0;
    for (int i = node; i < end_of(node); ++i) shapes += world_.nodes[std::size_t(i)].kind == NodeKind::kShape;
    return shapes;
  }
  // Whether anything moves one against the other.
  bool move_apart(int a, int b) const {
    const auto moves = [&](int node, int other) {
      for (int i = node; i >= 0 && i != other && !is_below(other, i); i = world_.nodes[std::size_t(i)].parent) {
        if (world_.nodes[std::size_t(i)].moves()) return true;
      }
      for (int i = node + 1; i < end_of(node); ++i) {
        const Node& below = world_.nodes[std::size_t(i)];
        if (below.moves() || (below.form >= 0 && world_.forms[std::size_t(below.form)].bend.drives())) return true;
      }
      return false;
    };
    return moves(a, b) || moves(b, a);
  }
  bool is_good_pair(int a, int b, InterestType type) const {
    if (a == b || !move_apart(a, b)) return false;
    const bool nested = is_below(a, b) || is_below(b, a);
    if (!nested) return true;
    // The boxes of what holds the other overlap always, and a Shape does not collide with itself.
    return type != InterestType::kBox && shapes_in(is_below(a, b) ? b : a) > shapes_in(is_below(a, b) ? a : b);
  }
  void add_interests() {
    for (const auto& [a, b] : planted_) {
      world_.interests.push_back({a, {b}, chance_.happens(0.5) ? InterestType::kWitness : InterestType::kAllPairs});
    }
    std::vector<int> ends;
    for (int i = 0; i < int(world_.nodes.size()); ++i) {
      if (shapes_in(i) > 0 && !(at(i).kind == NodeKind::kShape && chance_.happens(0.7))) ends.push_back(i);
    }
    std::size_t pairs = 9 + chance_.below(8);
    for (int tries = 0; pairs > 0 && tries < 300; ++tries) {
      Interest interest;
      interest.type =
          chance_.one_of({InterestType::kBox, InterestType::kWitness, InterestType::kWitness, InterestType::kAllPairs});
      interest.collider = ends[chance_.below(ends.size())];
      std::set<int> seen;
      for (std::size_t i = 0, count = 1 + chance_.below(3); i < count; ++i) {
        const int collidee = ends[chance_.below(ends.size())];
        if (!is_good_pair(interest.collider, collidee, interest.type) || !seen.insert(collidee).second) continue;
        interest.collidees.push_back(collidee);
      }
      if (interest.collidees.empty()) continue;
      pairs -= std::min(pairs, interest.collidees.size());
      world_.interests.push_back(std::move(interest));
    }
  }
  void add_decoration() {
    if (!chance_.happens(0.5)) return;
    const std::string clock = "CLOCK" + std::to_string(some_clock());
    const auto route = [&](const std::string& name, const std::string& field) {
      return "ROUTE " + clock + ".fraction_changed TO " + name + ".set_fraction\nROUTE " + name + ".value_changed TO " +
             field + '\n';
    };
    world_.decoration =
        "DEF LIGHT PointLight { on FALSE }\n"
        "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 50 0 0, 51 0 0, 50 1 0 ] } coordIndex [ 0 1 2 ]\n"
        "  normalPerVertex FALSE normal DEF NORMALS Normal { vector [ 0 0 1 ] } } }\n"
        "DEF GLOW ScalarInterpolator { key [ 0 0.5 1 ] keyValue [ 0 1 0 ] }\n"
        "DEF TINT ColorInterpolator { key [ 0 1 ] keyValue [ 1 0 0, 0 0 1 ] }\n"
        "DEF SHINE NormalInterpolator { key [ 0 1 ] keyValue [ 0 0 1, 0 1 0 ] }\n" +
        route("GLOW", "LIGHT.set_intensity") + route("TINT", "LIGHT.color") + route("SHINE", "NORMALS.set_vector");
  }

  Chance chance_;
  World world_;
  std::size_t moving_ = 0, owners_ = 0;
  std::vector<int> still_forms_;
  std::vector<std::pair<int, int>> planted_;
};

}  // namespace

World make_world(std::uint64_t seed) { return Maker(seed).make(); }

}  // namespace peerd::living
