#include "peerd/scenario/assemble.hpp"

#include <algorithm>
#include <limits>

namespace peerd {
namespace {

// A peer's time in the session. A peer that leaves and comes back has several.
struct Presence {
  HostTime from, until;  // in true time
  SimTime first_row, last_row;
};
using Presences = std::map<PeerId, std::vector<Presence>>;

// A peer that was there from the start was there before its first row, and a peer that nothing has ended stays after
// its last row.
Presences presences_of(const config::RunSettings& run, const std::vector<PeerLog>& logs) {
  Presences presences;
  for (const PeerLog& log : logs) {
    const bool first_life = !presences.contains(log.peer);
    std::vector<Presence>& own = presences[log.peer];
    const bool from_the_start = first_life && config::starts_with(run.events, log.name);
    if (!log.start || (log.object_samples.empty() && !from_the_start)) continue;
    own.push_back({from_the_start ? HostTime::min() : log.object_samples.front().true_at,
                   log.ended_at.value_or(HostTime::max()),
                   from_the_start ? SimTime::min() : log.object_samples.front().at,
                   log.ended_at && !log.object_samples.empty() ? log.object_samples.back().at : SimTime::max()});
  }
  return presences;
}

bool alive(const std::vector<Presence>& presences, HostTime t) {
  return std::ranges::any_of(presences,
                             [&](const Presence& presence) { return presence.from <= t && t <= presence.until; });
}

report::PeerInfo peer_info(const config::PeerSettings& peer, const std::vector<Presence>& presences, SimTime start) {
  report::PeerInfo info{PeerId{peer.id}, peer.name};
  const auto since_start = [&](SimTime t) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    return t == SimTime::min() ? -kNever : t == SimTime::max() ? kNever : to_seconds(t - start);
  };
  for (const Presence& presence : presences)
    info.there_s.emplace_back(since_start(presence.first_row), since_start(presence.last_row));
  if (presences.empty()) info.there_s.emplace_back(1.0, 0.0);  // an interval that no time is in
  return info;
}

// The truth of one object as its owner logged it, in true time.
struct Truth {
  const config::MotionSource* motion = nullptr;     // motion of a driven object; null: none
  std::vector<const PeerLog::ObjectSample*> ticks;  // sorted by true_at

  [[nodiscard]] const PeerLog::ObjectSample* last_not_after(HostTime t) const {
    const auto next = std::ranges::upper_bound(ticks, t, {}, [](const auto* b) { return b->true_at; });
    return next == ticks.begin() ? nullptr : *(next - 1);
  }
  // The owner's session time at a true instant.
  [[nodiscard]] SimTime session_time(HostTime t) const {
    const PeerLog::ObjectSample* b = last_not_after(t);
    if (b == nullptr) b = ticks.front();
    return b->at + (t - b->true_at);
  }
  [[nodiscard]] Pose pose(HostTime t, SimTime start) const {
    if (motion != nullptr) return motion->pose(to_seconds(session_time(t) - start));
    const PeerLog::ObjectSample* before = last_not_after(t);
    const bool last = before == ticks.back();
    if (before != nullptr && last) return advance(before->state, to_seconds(t - before->true_at)).pose();
    return between(t, [](const PeerLog::ObjectSample& b) { return b.state.pose(); });
  }
  // The pose that is displayed at the owner.
  [[nodiscard]] Pose seen(HostTime t, SimTime start) const {
    const PeerLog::ObjectSample* b = last_not_after(t);
    if (b == nullptr || b->shown.position == b->state.position) return pose(t, start);
    return between(t, [](const PeerLog::ObjectSample& tick) { return tick.shown; });
  }

 private:
  template <class PoseOf>
  [[nodiscard]] Pose between(HostTime t, PoseOf pose_of) const {
    const auto next = std::ranges::upper_bound(ticks, t, {}, [](const auto* b) { return b->true_at; });
    if (next == ticks.begin()) return pose_of(**next);
    const PeerLog::ObjectSample& before = **(next - 1);
    if (next == ticks.end() || before.true_at == t) return pose_of(before);
    const double s = to_seconds(t - before.true_at) / to_seconds((*next)->true_at - before.true_at);
    const Pose a = pose_of(before), b = pose_of(**next);
    return {a.position + s * (b.position - a.position), a.orientation.slerp(s, b.orientation)};  // exact at rest
  }
};

// A peer that was to be there from the start and never met the others. One that has left before it met them, or came
// back to a network that loses too much, was not there.
std::optional<InputError> never_met(const config::RunSettings& run, const std::vector<PeerLog>& logs) {
  std::set<PeerId> known;
  for (const PeerLog& log : logs) {
    const bool first_life = known.insert(log.peer).second;
    if (log.start || !first_life || log.ended_at || !config::starts_with(run.events, log.name)) continue;
    return InputError{"error: peer " + log.name + " never met all the others", 3};
  }
  return std::nullopt;
}

}  // namespace

Result<report::RunRecord> assemble(const config::RunSettings& run, const SharedWorld& shared,
                                   const std::vector<PeerLog>& logs) {
  const Scene& scene = shared.world.scene;
  report::RunRecord record;
  record.params = run.params;
  record.seed = run.seed;
  record.duration_s = run.duration_s;
  for (const config::ScenarioEvent& e : run.events) record.events.push_back({e.at_s, e.name});

  std::map<ObjectId, Truth> truths;
  std::map<ObjectId, PeerId> owners;
  const auto objects = config::resolve(run, scene);
  if (!objects) return std::unexpected(objects.error());
  if (const auto error = never_met(run, logs)) return std::unexpected(*error);
  std::optional<SimTime> start;  // session time of the lowest peer, which the others follow
  for (const PeerLog& log : logs) {
    if (!start) start = log.start;
    for (const PeerLog::ObjectSample& b : log.object_samples) {
      if (b.owner == log.peer) truths[b.object].ticks.push_back(&b);
    }
  }
  if (!start) return std::unexpected(InputError{"error: nobody's log says when the motions began", 3});
  Presences presences = presences_of(run, logs);
  for (std::size_t i = 0; i < run.peers.size(); ++i) {
    const PeerId peer{run.peers[i].id};
    record.peers.push_back(peer_info(run.peers[i], presences[peer], *start));
    for (const ObjectId object : (*objects)[i].owned) {
      owners[object] = peer;
      record.objects.push_back({object, scene.path_of(object), peer});
    }
    for (const auto& [object, motion] : (*objects)[i].motions) truths[object].motion = &motion;
  }
  std::ranges::sort(record.objects, {}, &report::ObjectInfo::object);

  const auto within = [&](double t_s) { return t_s >= 0.0 && t_s <= run.duration_s; };
  for (const PeerLog& log : logs) {
    for (const PeerLog::ObjectSample& b : log.object_samples) {
      if (b.owner == log.peer || !owners.contains(b.object)) continue;
      const Truth& truth = truths[b.object];
      if (truth.ticks.empty() || !alive(presences[owners[b.object]], b.true_at)) continue;
      const double t_s = to_seconds(truth.session_time(b.true_at) - *start);
      if (!within(t_s)) continue;
      record.ghost_samples.push_back({t_s, log.peer, b.object, truth.pose(b.true_at, *start), b.state.pose(), b.shown,
                                      truth.seen(b.true_at, *start)});
    }
    const auto since_start = [&](SimTime t) { return to_seconds(t - *start); };
    for (const PeerLog::Update& u : log.updates) {
      if (!within(since_start(u.at))) continue;
      record.updates.push_back({since_start(u.at), log.peer, u.object, u.bytes, u.threshold_m, u.reason});
    }
    for (const PeerLog::Datagram& d : log.datagrams) {
      if (within(since_start(d.at))) record.datagrams.push_back({since_start(d.at), log.peer, d.bytes});
    }
    for (const PeerLog::Contact& c : log.contacts) {
      if (!within(since_start(c.at))) continue;
      for (ObjectId id : {c.collider, c.collidee}) {
        if (!owners.contains(id)) record.scene_paths.try_emplace(id, scene.path_of(id));
      }
      record.contacts.push_back(
          {since_start(c.at), log.peer, c.kind, c.collider, c.collidee, c.normal, since_start(c.known_at)});
    }
    if (const auto& c = log.clock_error) {
      const auto ms = [](Duration d) { return to_seconds(d) * 1e3; };
      record.clocks.push_back(
          {log.peer, c->samples, ms(c->p99), ms(c->max), ms(c->bound_median), ms(c->bound_max), c->beyond_bound});
    }
    record.groups_joined += log.groups_joined;
    record.worlds_equal = record.worlds_equal && log.other_worlds == 0;
    for (const auto& [name, count] : log.counters) record.counters[name] += count;
  }
  std::ranges::stable_sort(record.ghost_samples, [](const auto& a, const auto& b) {
    return std::tie(a.observer, a.object, a.t_s) < std::tie(b.observer, b.object, b.t_s);
  });
  std::ranges::stable_sort(record.updates, {}, &report::UpdateSent::t_s);
  std::ranges::stable_sort(record.datagrams, {}, &report::DatagramSent::t_s);
  std::ranges::stable_sort(record.contacts, {}, &report::ContactRow::t_s);
  return record;
}

}  // namespace peerd
