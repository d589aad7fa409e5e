#include "bench/scale/world_run.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <variant>

#include "bench/wire_objects.hpp"
#include "collision/broad_phase/broad_phase.hpp"
#include "replication/physics/laws/swept_bound.hpp"
#include "replication/physics/laws/timeline.hpp"
#include "replication/physics/world/motion_world.hpp"
#include "replication/physics/world/part_contact.hpp"

namespace peerd::bench {
namespace {

using namespace replication;

SimTime tick_time(std::int64_t tick) { return SimTime{} + tick * Duration{std::chrono::seconds(1)} / 60; }

struct Update {
  SimTime at;
  std::size_t body = 0, leg = 0;
};

std::vector<Update> updates_of(const MovingBodies& bodies) {
  std::vector<Update> all;
  for (std::size_t body = 0; body < bodies.legs.size(); ++body) {
    const auto legs = bodies.legs[body].all();
    for (std::size_t leg = 0; leg < legs.size(); ++leg) all.push_back({legs[leg].from, body, leg});
  }
  std::ranges::sort(all, {}, [](const Update& u) { return std::pair(u.at, u.body); });
  return all;
}

class Finder {
 public:
  virtual ~Finder() = default;
  virtual void set(std::size_t body, SimTime t, const MotionModel& law) = 0;
  virtual void advance(SimTime t) = 0;
  // Adds what was found to the cost, outside of the time that is measured.
  virtual void collect(WorldCost& cost) = 0;
};

class ByMotionWorld final : public Finder {
 public:
  explicit ByMotionWorld(const MovingBodies& bodies) : bodies_(bodies), world_(*bodies.model, SimTime{}) {
    for (std::size_t i = 0; i < bodies.legs.size(); ++i) world_.declare(bodies.object(i), Role::kPredicted);
  }
  void set(std::size_t body, SimTime t, const MotionModel& law) override {
    world_.set_base(bodies_.object(body), std::max(t, SimTime{}),
                    t < SimTime{} ? rebased(law, to_seconds(SimTime{} - t)) : law);
  }
  void advance(SimTime t) override { world_.advance(t); }
  void collect(WorldCost& cost) override {
    while (const auto event = world_.poll_event()) {
      const auto* const contact = std::get_if<ContactEvent>(&*event);
      if (contact == nullptr) continue;
      for (const std::uint32_t number : bodies_.model->pairs_of(contact->collider)) {
        if (bodies_.model->pairs[number].collidee == contact->collidee) cost.contacts.push_back({number, contact->at});
      }
    }
    cost.checks = world_.counters().searches_far + world_.counters().contact_searches;
    cost.searches = world_.counters().contact_searches;
  }

 private:
  const MovingBodies& bodies_;
  MotionWorld world_;
};

// The other methods: bounds of the bodies' ways within a tick, where they have any, and a search of each pair that
// those leave.
class TickByTick final : public Finder {
 public:
  TickByTick(const MovingBodies& bodies, Method method)
      : bodies_(bodies), method_(method), pairs_(bodies.model->pairs.size()), bounds_(bodies.legs.size()) {
    for (std::size_t i = 0; i < bodies.legs.size(); ++i) {
      const ObjectId id = bodies.object(i);
      timelines_.emplace_back(SimTime{}, at_rest(bodies.scene.rigid_pose(id)));
      bodies_of_.push_back(bodies.model->body(id));
    }
    if (method == Method::kBroadPhase) make_broad_phase();
  }
  void set(std::size_t body, SimTime t, const MotionModel& law) override {
    const SimTime from = std::max(t, SimTime{});
    timelines_[body].replace_from(from, t < from ? rebased(law, to_seconds(from - t)) : law, std::nullopt);
  }
  void advance(SimTime t) override {
    if (t == now_) return;
    if (method_ != Method::kSearches) make_bounds(t);
    const std::vector<std::uint32_t> before = std::exchange(inside_, {});
    if (method_ == Method::kBroadPhase) {
      for (std::uint32_t i = 0; i < bounds_.size(); ++i) broad_phase_->move(i, {bounds_[i].low, bounds_[i].high});
      for (const collision::BroadPair& pair : broad_phase_->tick()) check(number_of(pair), t);
    } else {
      for (std::uint32_t number = 0; number < pairs_.size(); ++number) {
        const CollisionPair& pair = bodies_.model->pairs[number];
        if (method_ == Method::kBoxes) {
          ++checks_;
          const std::size_t a = bodies_.index(pair.collider), b = bodies_.index(pair.collidee);
          if (apart(bounds_[a], bounds_[b], CollisionType::kBox)) continue;
        }
        check(number, t);
      }
    }
    for (const std::uint32_t number : before) {  // their boxes are apart
      if (pairs_[number].checked < t) pairs_[number].inside = false;
    }
    now_ = t;
  }
  void collect(WorldCost& cost) override {
    cost.contacts.insert(cost.contacts.end(), found_.begin(), found_.end());
    found_.clear();
    cost.checks = checks_ + (broad_phase_ ? broad_phase_->counters().box_tests : 0);
    cost.searches = searches_;
  }

 private:
  struct Pair {
    bool inside = false;
    SimTime checked = SimTime::min();
  };

  void make_broad_phase() {
    broad_phase_ = collision::make_broad_phase();
    for (std::uint32_t i = 0; i < bounds_.size(); ++i) broad_phase_->add(i, WorldBox{});
    for (std::uint32_t number = 0; number < bodies_.model->pairs.size(); ++number) {
      const CollisionPair& pair = bodies_.model->pairs[number];
      const auto a = static_cast<std::uint32_t>(bodies_.index(pair.collider));
      const auto b = static_cast<std::uint32_t>(bodies_.index(pair.collidee));
      broad_phase_->register_interest(a, b);
      numbers_.push_back({collision::make_broad_pair(a, b), number});
    }
    std::ranges::sort(numbers_);
  }
  [[nodiscard]] std::uint32_t number_of(const collision::BroadPair& pair) const {
    return std::ranges::lower_bound(numbers_, std::pair(pair, std::uint32_t{0}))->second;
  }

  // Boxes of the ways from the last tick until t.
  void make_bounds(SimTime t) {
    for (std::size_t i = 0; i < bounds_.size(); ++i) {
      bounds_[i] = as_box(swept_bound(timelines_[i], *bodies_of_[i], now_, now_, t));
      while (bounds_[i].next_change && *bounds_[i].next_change < t) {
        const SimTime s = *bounds_[i].next_change;
        const SweptBound more = as_box(swept_bound(timelines_[i], *bodies_of_[i], s, s, t));
        bounds_[i] = merged(bounds_[i], more);
        bounds_[i].next_change = more.next_change;
      }
    }
  }

  void check(std::uint32_t number, SimTime until) {
    const CollisionPair& model_pair = bodies_.model->pairs[number];
    const std::size_t a = bodies_.index(model_pair.collider), b = bodies_.index(model_pair.collidee);
    const Timeline *const of_a = &timelines_[a], *const of_b = &timelines_[b];
    const MovingPart part_a{{&of_a, 1}, bodies_of_[a]}, part_b{{&of_b, 1}, bodies_of_[b]};
    const PartQuery query{{&part_a, 1}, {&part_b, 1}, model_pair.type, collision::MeetAs::kPolygons};
    Pair& pair = pairs_[number];
    pair.checked = until;
    for (SimTime s = now_; s < until;) {
      SimTime end = until;
      for (const Timeline* of : {of_a, of_b}) {
        if (const auto change = of->next_change_after(s)) end = std::min(end, *change);
      }
      if (pair.inside) {
        if (parts_touch(query, s)) {
          s = parts_touch_until(query, s, end);
          continue;
        }
        pair.inside = false;
      }
      const PartContact contact = first_part_contact(query, s, s, end, searches_);
      if (contact.contact.state == collision::ContactState::kSeparated ||
          (contact.contact.state == collision::ContactState::kContact && contact.at >= end)) {
        s = end;
        continue;
      }
      pair.inside = true;
      if (contact.contact.state == collision::ContactState::kContact) found_.push_back({number, contact.at});
      s = std::max(contact.at, s + Duration{1});
    }
    if (pair.inside) inside_.push_back(number);
  }

  const MovingBodies& bodies_;
  Method method_;
  std::vector<Timeline> timelines_;
  std::vector<const collision::Body*> bodies_of_;
  std::vector<Pair> pairs_;
  std::vector<SweptBound> bounds_;
  std::unique_ptr<collision::BroadPhase> broad_phase_;
  std::vector<std::pair<collision::BroadPair, std::uint32_t>> numbers_;
  std::vector<std::uint32_t> inside_;  // pairs that touched in the last tick
  SimTime now_{};
  std::vector<FoundContact> found_;
  std::uint64_t checks_ = 0, searches_ = 0;
};

// Whether the two touched at some instant of the last kTouchCheck before the contact.
bool has_parted_shortly(const MovingBodies& bodies, const FoundContact& contact) {
  constexpr int kSamples = 256;
  const CollisionPair& pair = bodies.model->pairs[contact.pair];
  for (int i = 1; i <= kSamples; ++i) {
    const SimTime t = contact.at - kTouchCheck * i / kSamples;
    const auto moving = [&](ObjectId id) {
      return collision::MovingBody{*bodies.model->body(id), bodies.legs[bodies.index(id)].at(t)};
    };
    if (collision::touching(moving(pair.collider), moving(pair.collidee), pair.type,
                            {.as = collision::MeetAs::kPolygons})) {
      return true;
    }
  }
  return false;
}

}  // namespace

const char* name_of(Method method) {
  switch (method) {
    case Method::kMotionWorld:
      return "schedule";
    case Method::kBroadPhase:
      return "broad_phase";
    case Method::kBoxes:
      return "all_boxes";
    case Method::kSearches:
      return "all_searches";
  }
  return "";
}

WorldCost run_world(const MovingBodies& bodies, Method method, Duration warm, Duration until) {
  std::unique_ptr<Finder> finder;
  if (method == Method::kMotionWorld) {
    finder = std::make_unique<ByMotionWorld>(bodies);
  } else {
    finder = std::make_unique<TickByTick>(bodies, method);
  }
  const std::vector<Update> updates = updates_of(bodies);
  std::size_t next = 0;
  WorldCost cost, warmed;
  double second_s = 0.0;
  for (std::int64_t tick = 0; tick_time(tick) <= SimTime{} + until; ++tick) {
    const SimTime t = tick_time(tick);
    const std::size_t first = next;
    const double updates_s = seconds_of([&] {
      for (; next < updates.size() && updates[next].at <= t; ++next) {
        const Update& u = updates[next];
        finder->set(u.body, u.at, bodies.legs[u.body].all()[u.leg].law);
      }
    });
    const double tick_s = seconds_of([&] { finder->advance(t); });
    finder->collect(cost);
    if (t <= SimTime{} + warm) {
      warmed.checks = cost.checks;
      warmed.searches = cost.searches;
      continue;
    }
    cost.updates += next - first;
    cost.updates_s += updates_s;
    cost.ticks_s += tick_s;
    second_s += updates_s + tick_s;
    if (tick % 60 == 0) cost.shares.push_back(std::exchange(second_s, 0.0));
  }
  cost.simulated_s = to_seconds(until - warm);
  cost.checks -= warmed.checks;
  cost.searches -= warmed.searches;
  std::ranges::sort(cost.contacts, {}, [](const FoundContact& c) { return std::pair(c.pair, c.at); });
  return cost;
}

std::vector<std::string> differences(const MovingBodies& bodies, const std::vector<FoundContact>& a,
                                     const std::vector<FoundContact>& b) {
  constexpr Duration kSame = std::chrono::milliseconds(1);
  std::vector<std::string> all;
  const auto lacks = [&](const std::vector<FoundContact>& some, const std::vector<FoundContact>& others,
                         const char* which) {
    for (const FoundContact& c : some) {
      const auto near = std::ranges::lower_bound(others, std::pair(c.pair, c.at - kSame), {},
                                                 [](const FoundContact& o) { return std::pair(o.pair, o.at); });
      if (near != others.end() && near->pair == c.pair && near->at <= c.at + kSame) continue;
      if (has_parted_shortly(bodies, c)) continue;
      all.push_back(std::string("only ") + which + ": pair " + std::to_string(c.pair) + " at " +
                    std::to_string(to_seconds(c.at - SimTime{})) + " s");
    }
  };
  lacks(a, b, "the first");
  lacks(b, a, "the second");
  return all;
}

}  // namespace peerd::bench
