#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "replication/wire/codec.hpp"
#include "replication/wire/record.hpp"
#include "tests/replication/peer/worlds.hpp"

// Random messages as a peer could send them, and what every decoded message must keep.
namespace peerd::replication::test {

class MessageMaker {
 public:
  explicit MessageMaker(std::uint64_t seed) : rng_(seed) {}

  Message message(std::size_t updates, std::size_t decisions, bool with_hello) {
    Message m;
    m.sender = PeerId{1 + number<std::uint32_t>() % 0xFFFF'FFFEU};
    m.incarnation = number<std::uint64_t>();
    if (with_hello) m.hello = hello();
    if (m.introduction() == nullptr) m.incarnation = incarnation_low(m.incarnation);
    for (std::size_t i = 0; i < updates; ++i) m.updates.push_back(update());
    for (std::size_t i = 0; i < decisions; ++i) {
      m.decisions.push_back(decision());
      const SimTime near = m.updates.empty() ? m.decisions.front().contact : m.updates.front().at;
      m.decisions.back().contact = near + std::chrono::milliseconds(rng_() % 1000);
    }
    m.leaving = coin();
    const SimTime latest{coin() ? 0ns : 12345678901234567ns};
    for (std::uint32_t i = number<std::uint32_t>() % 3; i > 0; --i) {
      const auto age = std::chrono::milliseconds(m.subscriptions.empty() ? 0 : number<std::uint32_t>());
      m.subscriptions.push_back({RegionId{number<std::uint32_t>()}, latest - age});
    }
    for (std::uint32_t i = number<std::uint32_t>() % 3; i > 0; --i) {
      m.handovers.push_back({ObjectId{number<std::uint32_t>()}, 1 + number<std::uint32_t>() % 0xFFFF'FFFEU,
                             RegionId{number<std::uint32_t>()}});
    }
    for (std::uint32_t i = number<std::uint32_t>() % 3; i > 0; --i) {
      m.scene.since = latest;
      m.scene.states.push_back(update());
      m.scene.states.back().position_step_log2.reset();
    }
    return m;
  }

  // The number is rounded to any tolerance, or exact.
  UpdateRecord update() {
    UpdateRecord u{ObjectId{number<std::uint32_t>()}, 1 + number<std::uint32_t>() % 0xFFFF'FFFEU, SimTime{time()},
                   model(), SimTime{coin() ? time() : 0ns}};
    if (coin()) u.drive = Drive{coin() ? vector() : Vec3(Vec3::Zero()), std::min(u.at, SimTime{time()})};
    return quantised(u, {coin() ? 0.0 : std::ldexp(1.0, -static_cast<int>(rng_() % 24)), 0.05});
  }
  // A record of any kind, with the fields that this kind has.
  MotionModel model() {
    MotionModel m = state();
    m.kind = kMotionKinds[number<std::size_t>() % std::size(kMotionKinds)];
    if (m.kind == MotionKind::kFirst) m.state.acceleration.setZero();
    if (m.kind == MotionKind::kThird || m.kind == MotionKind::kOscillating) m.jerk = vector().normalized() * 1e3;
    if (m.kind == MotionKind::kTurning) m.rate_rad_s = vector().normalized() * (0.99 * kRateMax_rad_s);
    if (m.kind == MotionKind::kOscillating) m.rate_rad_s = vector().normalized().cwiseAbs() * kRateMax_rad_s * 0.99;
    if (coin()) m.angular_acceleration_body = vector().normalized() * 20.0;
    return m;
  }
  DecisionRecord decision() {
    DecisionRecord d{ObjectId{number<std::uint32_t>()},
                     ObjectId{number<std::uint32_t>()},
                     SimTime{time()},
                     vector().normalized(),
                     state(),
                     state(),
                     state(),
                     state(),
                     static_cast<DecisionRule>(1 + number<std::uint32_t>() % 5),
                     SimTime{coin() ? time() : 0ns}};
    if (coin()) d.collider_after = d.collider_before;
    if (coin()) d.collidee_after.position = d.collidee_before.position;
    d.rests = coin();
    if (d.rests && coin()) d.collider_free = d.collider_before.acceleration + Vec3::UnitY();
    if (d.rests && coin()) d.collidee_free = Vec3(0, 1 - d.collidee_before.acceleration.y(), -9.81);
    return d;
  }
  Hello hello() {
    Hello h;
    if (coin()) h.session_tx = SimTime{time()};
    if (coin()) h.clock_error = std::chrono::microseconds(number<std::uint32_t>());
    if (coin()) h.os_clock = {time(), std::chrono::microseconds(number<std::uint32_t>() % 16'000'001)};
    h.sessions = number<std::uint32_t>();
    if (coin()) h.scene_digest = number<std::uint64_t>();
    h.latency = std::chrono::milliseconds(number<std::uint32_t>() % 2001);
    for (std::uint32_t i = number<std::uint32_t>() % 5; i > 0; --i) {
      const std::uint32_t heard = 1 + number<std::uint32_t>() / 2;
      h.echoes.push_back({PeerId{number<std::uint32_t>()}, heard, Duration{number<std::uint32_t>()},
                          received(heard + number<std::uint32_t>() / 4), 1e-3 * (rng_() % 1001)});
    }
    for (std::uint32_t i = number<std::uint32_t>() % 5; i > 0; --i) {
      h.notes.push_back(
          {ObjectId{number<std::uint32_t>()}, ObjectId{number<std::uint32_t>()}, SimTime{time()}, coin()});
    }
    if (coin()) h.introduction = introduction();
    return h;
  }
  Received received(std::uint32_t highest) {
    Received r{highest, 1 + number<std::uint32_t>() % std::min(highest, Received::kRunMax), ~std::uint64_t{0}};
    if (coin()) r.run %= std::min(highest, 70U);
    if (r.run >= std::min(highest, Received::kWindow)) return r;
    r.last = rng_() | ((std::uint64_t{1} << r.run) - 1);
    if (highest < Received::kWindow) r.last |= ~std::uint64_t{0} << highest;
    r.last &= ~(std::uint64_t{1} << r.run);
    return r;
  }
  Introduction introduction() {
    Introduction n;
    n.name = std::string(1 + number<std::uint32_t>() % kNameMax_bytes, 'x');
    n.world_hash = number<std::uint64_t>();
    for (std::uint32_t i = number<std::uint32_t>() % 9; i > 0; --i)
      n.owned.push_back(ObjectId{number<std::uint32_t>()});
    std::ranges::sort(n.owned);
    n.owned_as_founder = number<std::uint64_t>();
    if (coin()) n.start = SimTime{time()};
    if (coin()) n.world_zero = SimTime{time()};
    if (coin()) {
      Viewpoint& v = n.viewpoint.emplace();
      if (coin()) v.object = ObjectId{number<std::uint32_t>()};
      v.pose = state().pose();
      v.field_of_view = 0.1 + 0.001 * (number<std::uint32_t>() % 3000);
      v.aspect = 1e-3 * (1 + number<std::uint32_t>() % 4000);
    }
    return n;
  }
  // Parts that stand still or are the identity come often, because the wire format omits them.
  KinematicState state() {
    KinematicState s;
    s.position = vector();
    if (coin()) s.velocity = vector();
    if (coin()) s.acceleration = vector();
    if (coin()) s.orientation = Quat(size(), size(), size(), size() + 1e-3).normalized();
    if (coin()) s.angular_velocity_body = 1e4 / std::max(1e4, s.velocity.norm()) * vector().normalized();
    return s;
  }

 private:
  template <class Number>
  Number number() {
    return static_cast<Number>(rng_());
  }
  bool coin() { return rng_() % 2 == 0; }
  Duration time() { return Duration{static_cast<std::int64_t>(rng_() >> 1) - (std::int64_t{1} << 62)}; }
  // Numbers of any magnitude that is allowed, and exact zeros.
  double size() {
    if (rng_() % 8 == 0) return 0.0;
    const double mantissa = std::uniform_real_distribution<double>(-1.0, 1.0)(rng_);
    return std::ldexp(mantissa, static_cast<int>(rng_() % 60) - 21);
  }
  Vec3 vector() {
    const double x = size(), y = size();
    return {x, y, size() + 1e-6};
  }

  std::mt19937_64 rng_;
};

// Decodes as a receiver whose own time is that of the first update or else of the first decision.
inline std::expected<Message, DecodeError> received(const Bytes& bytes, const Message& sent) {
  if (!sent.updates.empty()) return decode(bytes, sent.updates.front().at);
  return decode(bytes, sent.decisions.empty() ? SimTime{} : sent.decisions.front().contact);
}

// The size of the message's records, from the message's bytes with other records, which are few, before and behind
// them.
inline Bytes with_records(const Message& m, const std::vector<int>& before, const std::vector<int>& behind) {
  const Bytes bytes = encode(m);
  std::size_t size = 0;
  for (const UpdateRecord& u : m.updates) size += encoded_size_bytes(u, m.updates.front().at);
  const auto records = bytes.end() - static_cast<long>(size), field = records - 5;  // it begins with the base time
  EXPECT_EQ(field[-1], static_cast<std::byte>(size + 5));
  EXPECT_EQ(field[-2], std::byte{8 << 3 | 2});
  Bytes out(bytes.begin(), field - 1);
  const std::size_t size_now = 5 + size + before.size() + behind.size();
  EXPECT_LT(size_now, 128u);
  out.push_back(static_cast<std::byte>(size_now));
  out.insert(out.end(), field, records);
  for (const int b : before) out.push_back(static_cast<std::byte>(b));
  out.insert(out.end(), records, bytes.end());
  for (const int b : behind) out.push_back(static_cast<std::byte>(b));
  return out;
}

inline bool same_bits(const Message& a, const Message& b) {
  const auto same_vector = [](const Vec3& v, const Vec3& w) { return same_bits(moving(v), moving(w)); };
  const auto same_free = [&](const std::optional<Vec3>& v, const std::optional<Vec3>& w) {
    return v.has_value() == w.has_value() && (!v || same_vector(*v, *w));
  };
  const auto same_drive = [&](const std::optional<Drive>& d, const std::optional<Drive>& e) {
    return d.has_value() == e.has_value() &&
           (!d || (same_vector(d->acceleration, e->acceleration) && d->since == e->since));
  };
  const auto same_update = [&](const UpdateRecord& u, const UpdateRecord& v) {
    return u.object == v.object && u.sequence == v.sequence && u.at == v.at && u.model.kind == v.model.kind &&
           u.decision == v.decision && u.carrier == v.carrier && u.position_step_log2 == v.position_step_log2 &&
           same_bits(u.model.state, v.model.state) && same_vector(u.model.jerk, v.model.jerk) &&
           same_vector(u.model.rate_rad_s, v.model.rate_rad_s) &&
           same_vector(u.model.angular_acceleration_body, v.model.angular_acceleration_body) &&
           same_drive(u.drive, v.drive);
  };
  const auto same_decision = [&](const DecisionRecord& d, const DecisionRecord& e) {
    return d.collider == e.collider && d.collidee == e.collidee && d.contact == e.contact && d.rule == e.rule &&
           d.known == e.known && same_vector(d.normal, e.normal) && same_bits(d.collider_before, e.collider_before) &&
           same_bits(d.collidee_before, e.collidee_before) && same_bits(d.collider_after, e.collider_after) &&
           same_bits(d.collidee_after, e.collidee_after) && d.rests == e.rests &&
           same_free(d.collider_free, e.collider_free) && same_free(d.collidee_free, e.collidee_free);
  };
  const auto same_echo = [](const Echo& e, const Echo& f) {
    return e.peer == f.peer && e.hello == f.hello && e.hold_time == f.hold_time && e.received == f.received &&
           e.loss == f.loss;
  };
  const auto same_note = [](const ContactNote& n, const ContactNote& o) {
    return n.collider == o.collider && n.collidee == o.collidee && n.contact == o.contact && n.deferred == o.deferred;
  };
  const auto same_subscription = [](const Subscription& e, const Subscription& f) {
    return e.region == f.region && e.since == f.since;
  };
  const auto same_handover = [](const Handover& one, const Handover& other) {
    return one.object == other.object && one.sequence == other.sequence && one.to == other.to;
  };
  const auto same_viewpoint = [](const std::optional<Viewpoint>& v, const std::optional<Viewpoint>& w) {
    if (!v || !w) return !v && !w;
    return v->object == w->object && v->field_of_view == w->field_of_view && v->aspect == w->aspect &&
           same_bits(at_rest(v->pose), at_rest(w->pose));
  };
  const auto same_introduction = [&](const std::optional<Introduction>& i, const std::optional<Introduction>& j) {
    if (!i || !j) return !i && !j;
    return i->name == j->name && i->world_hash == j->world_hash && i->owned == j->owned &&
           i->owned_as_founder == j->owned_as_founder && i->start == j->start && i->world_zero == j->world_zero &&
           same_viewpoint(i->viewpoint, j->viewpoint);
  };
  const auto same_os_clock = [](const std::optional<OsClockNote>& o, const std::optional<OsClockNote>& p) {
    if (!o || !p) return !o && !p;
    return o->minus_session == p->minus_session && o->error == p->error;
  };
  const auto same_hello = [&](const std::optional<Hello>& h, const std::optional<Hello>& g) {
    if (!h || !g) return !h && !g;
    return h->session_tx == g->session_tx && h->sessions == g->sessions && h->latency == g->latency &&
           h->scene_digest == g->scene_digest && h->clock_error == g->clock_error &&
           same_os_clock(h->os_clock, g->os_clock) && std::ranges::equal(h->echoes, g->echoes, same_echo) &&
           std::ranges::equal(h->notes, g->notes, same_note) && same_introduction(h->introduction, g->introduction);
  };
  return std::ranges::equal(a.subscriptions, b.subscriptions, same_subscription) &&
         std::ranges::equal(a.handovers, b.handovers, same_handover) && a.sender == b.sender &&
         a.incarnation == b.incarnation && a.number == b.number && a.leaving == b.leaving &&
         same_hello(a.hello, b.hello) && std::ranges::equal(a.updates, b.updates, same_update) &&
         std::ranges::equal(a.decisions, b.decisions, same_decision) && a.scene.since == b.scene.since &&
         std::ranges::equal(a.scene.states, b.scene.states, same_update);
}

inline bool is_sound(const KinematicState& s) {
  const auto good = [](const Vec3& v) { return v.allFinite() && v.cwiseAbs().maxCoeff() <= 1e12; };
  return good(s.position) && good(s.velocity) && good(s.acceleration) && good(s.angular_velocity_body) &&
         std::abs(s.orientation.norm() - 1.0) <= 1e-6;
}
inline bool is_sound(const MotionModel& m) {
  return is_sound(m.state) && std::ranges::find(kMotionKinds, m.kind) != std::end(kMotionKinds) &&
         m.jerk.norm() <= 1e9 && m.rate_rad_s.cwiseAbs().maxCoeff() <= kRateMax_rad_s &&
         m.angular_acceleration_body.norm() <= 2e3;
}
inline bool is_sound(std::chrono::nanoseconds t) { return std::abs(to_seconds(t)) < 4.7e9; }

// Checks what codec.hpp promises of every message that decode() lets through.
inline bool is_sound(const Message& m) {
  bool sound = m.sender.value != 0;
  if (m.hello) {
    const Hello& h = *m.hello;
    sound = sound && h.latency <= kLatencyMax && is_sound(h.session_tx.value_or(SimTime{}).time_since_epoch());
    sound = sound && h.clock_error.value_or(0s) >= 0s && h.clock_error.value_or(0s) <= kClockErrorMax;
    if (h.os_clock) sound = sound && is_sound(h.os_clock->minus_session) && h.os_clock->error <= kOsErrorMax;
    for (const Echo& e : h.echoes) sound = sound && e.hold_time >= 0s && e.hold_time <= 10s && e.loss <= 1.0;
    for (const Echo& e : h.echoes)
      sound = sound && e.received.highest >= e.hello && e.received.run <= e.received.highest;
    for (const ContactNote& n : h.notes) sound = sound && is_sound(n.contact.time_since_epoch());
  }
  if (const Introduction* i = m.introduction()) {
    sound = sound && is_name(i->name) && is_sound(i->start.value_or(SimTime{}).time_since_epoch()) &&
            is_sound(i->world_zero.value_or(SimTime{}).time_since_epoch()) && std::ranges::is_sorted(i->owned);
  }
  for (const UpdateRecord& u : m.updates) {
    sound = sound && u.sequence != 0 && is_sound(u.at.time_since_epoch()) && is_sound(u.decision.time_since_epoch()) &&
            is_sound(u.model);
  }
  sound = sound && is_sound(m.scene.since.time_since_epoch());
  for (const UpdateRecord& u : m.scene.states) {
    sound = sound && u.sequence != 0 && is_sound(u.at.time_since_epoch()) && is_sound(u.decision.time_since_epoch()) &&
            is_sound(u.model) && !u.position_step_log2;
  }
  for (const DecisionRecord& d : m.decisions) {
    sound = sound && is_sound(d.contact.time_since_epoch()) && std::abs(d.normal.norm() - 1.0) <= 1e-6 &&
            is_sound(d.collider_before) && is_sound(d.collidee_before) && is_sound(d.collider_after) &&
            is_sound(d.collidee_after);
  }
  return sound;
}

}  // namespace peerd::replication::test
