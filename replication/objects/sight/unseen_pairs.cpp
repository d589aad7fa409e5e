#include "replication/objects/sight/unseen_pairs.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "replication/physics/laws/swept_bound.hpp"
#include "replication/wire/codec.hpp"

namespace peerd::replication {
namespace {

// Room [m] for the rounding of places and for what a contact time leaves between two surfaces; all tests here are
// conservative, and decide nothing but what is computed.
constexpr double kRoom_m = 1e-3;
// Of what is in doubt for longer than this the contacts are found: timelines end MotionWorld::kHistory ago.
constexpr Duration kDoubtMax = std::chrono::seconds(5);
static_assert(kDoubtMax < MotionWorld::kHistory);
// A contact of two peers' objects that was so long ago is known by its decision, or was none: latencies above this do
// not count (codec.hpp).
constexpr Duration kDecidedBy = kLatencyMax;

void keep_each_once(std::vector<std::uint32_t>& all) {
  std::ranges::sort(all);
  all.erase(std::ranges::unique(all).begin(), all.end());
}

}  // namespace

UnseenPairs::UnseenPairs(const WorldModel& model)
    : model_(&model), unit_of_node_(model.nodes.size(), kNone), pairs_(model.part_pairs.size()) {}

std::uint32_t UnseenPairs::unit_with(std::uint32_t node) {
  if (unit_of_node_[node] != kNone) return unit_of_node_[node];
  std::uint32_t top = node;
  while (model_->nodes[top].carrier != kNone) top = model_->nodes[top].carrier;
  assert(unit_of_node_[top] == kNone && "a unit is taken in whole");
  const auto number = static_cast<std::uint32_t>(units_.size());
  Unit& unit = units_.emplace_back();
  const auto add = [&](std::uint32_t i) {
    unit_of_node_[i] = number;
    unit.nodes.push_back({i});
    unit.is_scripted |= std::ranges::binary_search(model_->moving, model_->nodes[i].object);
  };
  add(top);
  std::ranges::for_each(model_->carried_by[top], add);
  for (const FlexiblePart& part : model_->flexible) {
    if (part.carrier != kNone) unit.flexes |= unit_of_node_[part.carrier] == number;
  }
  return number;
}

void UnseenPairs::take_in(MotionWorld& world) {
  const auto known = world.known_pairs();
  assert(known.size() >= pairs_.numbers().size());
  for (std::size_t k = pairs_.numbers().size(); k < known.size(); ++k) take_in_pair(known[k]);
}

void UnseenPairs::take_in_pair(std::uint32_t i) {
  const PartPair& parts = model_->part_pairs[i];
  PartPairState& pair = pairs_.add(i, {.units = {}, .can_wait = !parts.fixed});
  const auto add_part = [&](std::uint32_t part) {
    if (model_->is_flexible(part)) pair.can_wait = false;
    if (model_->frame_of(part) != kNone) pair.units.push_back(unit_with(model_->frame_of(part)));
  };
  for (const bool collider : {true, false}) {
    const std::uint32_t node = node_of_end(i, collider), end = unit_with(node), part = collider ? parts.a : parts.b;
    pair.units.push_back(end);
    if (part != kNone) {
      add_part(part);
    } else {
      for (const std::uint32_t each : model_->parts_of_node[node]) add_part(each);
    }
    if (!answers(i, collider)) continue;
    units_[end].answering.push_back(node);
    keep_each_once(units_[end].answering);
  }
  keep_each_once(pair.units);
  for (const std::uint32_t unit : pair.units) {
    units_[unit].pairs.push_back(i);
    units_[unit].applied.reset();
  }
}

std::uint32_t UnseenPairs::node_of_end(std::uint32_t i, bool collider) const {
  const CollisionPair& pair = model_->pairs[model_->part_pairs[i].pair];
  return model_->index_of(collider ? pair.collider : pair.collidee);
}

std::uint32_t UnseenPairs::unit_of(ObjectId object) const {
  return model_->node(object) == nullptr ? kNone : unit_of_node_[model_->index_of(object)];
}

UnseenPairs::Standing UnseenPairs::standing_of(std::uint32_t node) const {
  assert(unit_of_node_[node] != kNone);
  return std::ranges::lower_bound(units_[unit_of_node_[node]].nodes, node, {}, &UnitNode::index)->standing;
}

bool UnseenPairs::answers(std::uint32_t i, bool collider) const {
  const CollisionPair& pair = model_->pairs[model_->part_pairs[i].pair];
  return model_->answers(pair, collider ? pair.collider : pair.collidee);
}

void UnseenPairs::restart(SimTime t) {
  last_ = before_ = t;
  put_off_count_ = 0;
  woken_.clear();
  std::ranges::fill(unit_of_node_, kNone);
  units_.clear();
  pairs_ = SparseTable<PartPairState>(pairs_.size());
}

bool UnseenPairs::touch(const Ball& a, const Ball& b, double margin_m) {
  const double least = a.radius_m + b.radius_m + margin_m + kRoom_m;
  return (a.center - b.center).squaredNorm() <= least * least;
}

// The deceleration [m/s^2] with which the object slides to rest after any contact; 0: it may go on (law_after()).
double UnseenPairs::friction_of(const MotionWorld& world, ObjectId object, SimTime t) const {
  const CollisionResponse* const response = model_->response_of(object);
  if (response == nullptr || response->type != ResponseType::kImpulse || world.is_carried(object)) return 0.0;
  if (const auto free = world.free_acceleration(object); free && !free->isZero(0.0)) return 0.0;
  return world.unborne_acceleration(object, t).isZero(0.0) ? response->friction_m_s2 : 0.0;
}

double UnseenPairs::reach_m_s(const Unit& unit) {
  assert(unit.speed_m_s >= 0.0);
  // What a contact turns round in its carrier is faster in the world by twice its speed relative to that.
  const bool is_hit_within = !unit.answering.empty() && unit.answering.back() != unit.nodes.front().index;
  return (is_hit_within ? 5.0 : 1.0) * unit.speed_m_s;
}

// The unit is certain at `from`, or where it is in doubt: at the begin of that. It is in the ball until `to`.
void UnseenPairs::grow_ball(const MotionWorld& world, Unit& unit, SimTime to) const {
  assert(!unit.nodes.empty());
  SimTime from = last_;
  Duration on_its_way = std::max(to - last_, last_ - to);  // a frame may show the time before the last tick
  on_its_way += last_ - unit.certain_until;
  double may_gain_m_s = 0.0;
  if (unit.doubt) {
    from = unit.doubt->since;
    on_its_way = std::max(on_its_way, std::max(to, last_) - from);
    may_gain_m_s = 2.0 * unit.doubt->hit_by_m_s;  // no answer to one hit adds more (response.hpp)
  }
  bool first = true;
  double speed_m_s = 0.0, acceleration_m_s2 = 0.0, friction_m_s2 = std::numeric_limits<double>::infinity();
  for (const UnitNode& node : unit.nodes) {
    const ObjectId object = model_->nodes[node.index].object;
    const KinematicState state = world.at(object, from);
    if (std::exchange(first, false)) unit.ball = {state.position, 0.0};
    const double extent_m = radius_about_origin_m(model_->bodies[node.index]);
    const double away_m = (state.position - unit.ball.center).norm();
    unit.ball.radius_m = std::max(unit.ball.radius_m, kBoxReach * away_m + extent_m);
    speed_m_s = std::max({speed_m_s, state.velocity.norm(), world.at(object, last_).velocity.norm()});
    friction_m_s2 = std::min(friction_m_s2, friction_of(world, object, from));
    acceleration_m_s2 =
        std::max({acceleration_m_s2, state.acceleration.norm(), world.unborne_acceleration(object, from).norm(),
                  world.free_acceleration(object).value_or(Vec3::Zero()).norm()});
  }
  unit.acceleration_m_s2 = acceleration_m_s2;
  unit.speed_m_s = speed_m_s + may_gain_m_s;
  const double h = to_seconds(on_its_way);
  const double reach_m_s = UnseenPairs::reach_m_s(unit);
  if (friction_m_s2 > 0.0) {  // however it is hit, it slides to rest
    const double slides_s = std::min(h, reach_m_s / friction_m_s2);
    unit.ball.radius_m += slides_s * (reach_m_s - 0.5 * slides_s * friction_m_s2);
  } else {
    unit.ball.radius_m += h * reach_m_s + 0.5 * h * h * acceleration_m_s2;
  }
  assert(h >= 0.0 && unit.ball.radius_m >= 0.0);
}

SimTime UnseenPairs::certain_until(const MotionWorld& world, Unit& unit) const {
  assert(before_ <= last_);
  SimTime certain = last_;
  for (UnitNode& node : unit.nodes) {
    const ObjectId object = model_->nodes[node.index].object;
    const std::uint64_t revision = world.revision(object);
    if (std::exchange(node.revision, revision) != revision) certain = std::min(certain, world.base_time(object));
  }
  return certain;
}

// Whether some of the unit meets what nobody owns, and nobody owns that end of it either, and one of them answers.
bool UnseenPairs::carries_an_end_of_the_scene(const Unit& unit) const {
  return unit.nodes.size() > 1 && std::ranges::any_of(unit.pairs, [&](std::uint32_t i) {
           const auto of_nobody = [&](bool collider) {
             return standing_of(node_of_end(i, collider)) <= Standing::kFree;
           };
           return (answers(i, true) || answers(i, false)) && of_nobody(true) && of_nobody(false);
         });
}

void UnseenPairs::find_standing(const Peer& peer) {
  for (Unit& unit : units_) {
    unit.standing = Standing::kScene;
    for (UnitNode& node : unit.nodes) {
      node.standing = peer.standing(model_->nodes[node.index].object);
      unit.standing = std::max(unit.standing, node.standing);
    }
  }
  for (Unit& unit : units_) {
    if (unit.standing != Standing::kRemote) continue;
    if (unit.flexes || carries_an_end_of_the_scene(unit)) unit.standing = Standing::kKept;
  }
}

void UnseenPairs::measure(const MotionWorld& world, SimTime to, const Peer& peer) {
  find_standing(peer);
  fastest_m_s_ = 0.0;
  for (Unit& unit : units_) {
    unit.certain_until = certain_until(world, unit);
    if (!is_predicted(unit)) unit.doubt.reset();
    if (unit.doubt) {  // an update of all of it is certain
      const bool updated = std::ranges::all_of(unit.answering, [&](std::uint32_t i) {
        return world.base_time(model_->nodes[i].object) > unit.doubt->since;
      });
      if (updated || unit.awake) unit.doubt.reset();
    }
    if (!moves(unit)) continue;
    for (const UnitNode& node : unit.nodes) {
      fastest_m_s_ = std::max(fastest_m_s_, world.at(model_->nodes[node.index].object, last_).velocity.norm());
    }
  }
  for (Unit& unit : units_) {
    if (moves(unit)) grow_ball(world, unit, to);
  }
}

void UnseenPairs::note_doubt(std::uint32_t index, SimTime since, double hit_by_m_s, const MotionWorld& world,
                             SimTime to) {
  Unit& unit = units_[index];
  assert(is_predicted(unit) && hit_by_m_s >= 0.0);
  const Doubt before = unit.doubt.value_or(Doubt{SimTime::max()});
  if (since >= before.since && hit_by_m_s <= before.hit_by_m_s) return;
  unit.doubt = Doubt{std::min(since, before.since), std::max(hit_by_m_s, before.hit_by_m_s)};
  grow_ball(world, unit, to);
}

void UnseenPairs::note_stops(MotionWorld& world, SimTime to, const Peer& peer) {
  const std::vector<std::uint32_t> stopped(world.stopped().begin(), world.stopped().end());
  for (const std::uint32_t i : stopped) {
    const SimTime since = world.stopped_since(i);
    const CollisionPair& pair = model_->pairs[model_->part_pairs[i].pair];
    bool answered = false, in_doubt = false;
    const bool decided = since < last_ - kDecidedBy && peer.is_decided(pair.collider, pair.collidee);
    for (const bool collider : {true, false}) {
      const std::uint32_t unit = unit_of_end(i, collider);
      if (!answers(i, collider) || !is_predicted(units_[unit])) continue;
      answered = true;
      if (decided || world.base_time(collider ? pair.collider : pair.collidee) > since) continue;
      in_doubt = true;
      double hit_by_m_s = 0.0;
      for (const std::uint32_t other : pairs_[i].units) {
        if (other != unit && moves(units_[other])) hit_by_m_s = std::max(hit_by_m_s, reach_m_s(units_[other]));
      }
      note_doubt(unit, since, hit_by_m_s, world, to);
    }
    if (!answered || in_doubt) continue;
    world.put_off(i, false, decided);  // no contact so far matters any more
    world.put_off(i, true);
  }
}

// What may meet what is kept until `to`, or what does so, is searched before it does: the world does not find contacts
// of what is kept again in the past.
void UnseenPairs::wake_what_is_near_kept(SimTime to) {
  const double gained_m = 2.0 * fastest_m_s_ * to_seconds(std::max(to, last_) - last_);
  std::vector<std::uint32_t> near;
  for (std::uint32_t u = 0; u < units_.size(); ++u) {
    if (units_[u].standing == Standing::kKept) near.push_back(u);
  }
  for (std::size_t next = 0; next < near.size(); ++next) {
    const std::uint32_t unit = near[next];
    for (const std::uint32_t i : units_[unit].pairs) {
      for (const std::uint32_t other : pairs_[i].units) {
        Unit& o = units_[other];
        if (o.awake || !is_predicted(o) || !touch(units_[unit].ball, o.ball, gained_m)) continue;
        o.awake = true;
        near.push_back(other);
      }
    }
  }
}

void UnseenPairs::follow_doubts(const MotionWorld& world, SimTime to, double ahead_s) {
  std::vector<std::uint32_t> in_doubt;
  for (std::uint32_t u = 0; u < units_.size(); ++u) {
    if (units_[u].doubt) in_doubt.push_back(u);
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t next = 0; next < in_doubt.size(); ++next) {
      const std::uint32_t unit = in_doubt[next];
      Unit& u = units_[unit];
      if (u.awake) continue;
      for (const std::uint32_t i : u.pairs) {
        for (const std::uint32_t other : pairs_[i].units) {
          Unit& o = units_[other];
          if (other == unit || !moves(o)) continue;
          const bool kept = o.standing == Standing::kKept;
          if (!kept && o.answering.empty()) continue;  // it goes on as it does
          if (!kept && !o.awake && (o.doubt || !is_predicted(o))) continue;
          const double margin_m = kept ? ahead_s * (reach_m_s(u) + reach_m_s(o)) : 0.0;
          if (!touch(u.ball, o.ball, margin_m)) continue;
          changed = true;
          if (kept || o.awake) {
            u.awake = true;
            break;
          }
          note_doubt(other, std::max(u.doubt->since, std::min(before_, o.certain_until)), reach_m_s(u), world, to);
          in_doubt.push_back(other);
        }
        if (u.awake) break;
      }
    }
  }
}

bool UnseenPairs::can_wait(const PartPairState& pair) const {
  bool remote = false;
  for (const std::uint32_t unit : pair.units) {
    const Unit& u = units_[unit];
    if (u.standing == Standing::kKept || (is_predicted(u) && u.awake)) return false;
    remote |= u.standing == Standing::kRemote;
  }
  return pair.can_wait && remote;
}

bool UnseenPairs::apply(MotionWorld& world) {
  bool taken_up = false;
  for (Unit& unit : units_) {
    const std::pair now(unit.standing, unit.awake);
    if (std::exchange(unit.applied, now) == now) continue;
    for (const std::uint32_t i : unit.pairs) {
      PartPairState& pair = pairs_[i];
      const bool waits = can_wait(pair);
      if (pair.put_off == waits) continue;
      assert(put_off_count_ + (waits ? 1 : 0) <= pairs_.size() && (waits || put_off_count_ > 0));
      pair.put_off = waits;
      waits ? ++put_off_count_ : --put_off_count_;
      taken_up |= !waits && world.stopped().contains(i);
      world.put_off(i, waits);
    }
  }
  return taken_up;
}

bool UnseenPairs::update(MotionWorld& world, SimTime to, const Peer& peer, std::optional<ObjectId> awake) {
  assert(peer.standing && peer.is_decided && peer.ahead_s >= 0.0);
  take_in(world);
  measure(world, to, peer);
  note_stops(world, to, peer);
  was_awake_.assign(units_.size(), false);
  for (std::size_t i = 0; i < units_.size(); ++i) {
    Unit& unit = units_[i];
    was_awake_[i] = unit.awake;
    if (unit.standing == Standing::kScene) {
      unit.awake = false;
      continue;
    }
    const bool old = unit.doubt && unit.doubt->since < last_ - kDoubtMax;
    const bool seen = peer.in_sight && peer.in_sight(unit.ball.center, unit.ball.radius_m);
    unit.awake = unit.standing == Standing::kKept || old || seen;
  }
  if (awake && unit_of(*awake) != kNone) units_[unit_of(*awake)].awake = true;
  wake_what_is_near_kept(to);
  follow_doubts(world, to, peer.ahead_s);
  for (std::size_t i = 0; i < units_.size(); ++i) {
    if (was_awake_[i] || !units_[i].awake || !units_[i].doubt) continue;
    for (const UnitNode& node : units_[i].nodes) woken_.push_back(model_->nodes[node.index].object);
  }
  if (to > last_) before_ = std::exchange(last_, to);
  return apply(world);
}

bool UnseenPairs::take_up_all(MotionWorld& world) {
  bool taken_up = false;
  for (Unit& unit : units_) {
    if (unit.doubt) {
      for (const UnitNode& node : unit.nodes) woken_.push_back(model_->nodes[node.index].object);
    }
    unit.awake = true;
    unit.doubt.reset();
    unit.applied.reset();
  }
  for (const std::uint32_t i : pairs_.numbers()) {
    if (!std::exchange(pairs_[i].put_off, false)) continue;
    taken_up |= world.stopped().contains(i);
    world.put_off(i, false);
  }
  assert(world.stopped().empty());
  put_off_count_ = 0;
  return taken_up;
}

bool UnseenPairs::is_in_doubt(ObjectId object) const {
  const std::uint32_t unit = unit_of(object);
  return unit != kNone && units_[unit].doubt && !units_[unit].awake;
}

bool UnseenPairs::others_depend_on(const MotionWorld& world, ObjectId object) const {
  if (unit_of(object) == kNone) return false;
  const Unit& unit = units_[unit_of(object)];
  if (unit.awake || !is_predicted(unit) || unit.answering.empty()) return false;
  return std::ranges::any_of(unit.pairs, [&](std::uint32_t i) {
    const bool stopped = world.stopped().contains(i);
    // What bears it counts beyond its next base.
    if (stopped && unit.acceleration_m_s2 > 0.0 && world.model_at(object, last_).kind != MotionKind::kSliding)
      return true;
    return std::ranges::any_of(pairs_[i].units, [&](std::uint32_t other) {
      const Unit& o = units_[other];
      if (&o == &unit || !moves(o) || o.answering.empty()) return false;
      return stopped || (o.doubt && !o.awake && touch(unit.ball, o.ball, 0.0));
    });
  });
}

}  // namespace peerd::replication
