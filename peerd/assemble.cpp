#include "peerd/assemble.hpp"

#include <algorithm>

namespace peerd {
namespace {

// The truth of one object as its owner logged it, in true time.
struct Truth {
  const config::MotionSource* motion = nullptr;  // what drives it
  std::vector<const PeerLog::Belief*> ticks;     // by true_at

  [[nodiscard]] const PeerLog::Belief* last_not_after(HostTime t) const {
    const auto next = std::ranges::upper_bound(ticks, t, {}, [](const auto* b) { return b->true_at; });
    return next == ticks.begin() ? nullptr : *(next - 1);
  }
  // The owner's session time at that instant.
  [[nodiscard]] SimTime session_time(HostTime t) const {
    const PeerLog::Belief* b = last_not_after(t);
    if (b == nullptr) b = ticks.front();
    return b->at + (t - b->true_at);
  }
  [[nodiscard]] Pose pose(HostTime t, SimTime start) const {
    if (motion != nullptr) return motion->pose(to_seconds(session_time(t) - start));
    const PeerLog::Belief* before = last_not_after(t);
    const bool last = before == ticks.back();
    if (before != nullptr && last) return advance(before->state, to_seconds(t - before->true_at)).pose();
    return between(t, [](const PeerLog::Belief& b) { return b.state.pose(); });
  }
  // What the owner's user sees then.
  [[nodiscard]] Pose seen(HostTime t, SimTime start) const {
    const PeerLog::Belief* b = last_not_after(t);
    if (b == nullptr || b->shown.position == b->state.position) return pose(t, start);
    return between(t, [](const PeerLog::Belief& tick) { return tick.shown; });
  }

 private:
  template <class PoseOf>
  [[nodiscard]] Pose between(HostTime t, PoseOf pose_of) const {
    const auto next = std::ranges::upper_bound(ticks, t, {}, [](const auto* b) { return b->true_at; });
    if (next == ticks.begin()) return pose_of(**next);
    const PeerLog::Belief& before = **(next - 1);
    if (next == ticks.end() || before.true_at == t) return pose_of(before);
    const double s = to_seconds(t - before.true_at) / to_seconds((*next)->true_at - before.true_at);
    const Pose a = pose_of(before), b = pose_of(**next);
    return {(1.0 - s) * a.position + s * b.position, a.orientation.slerp(s, b.orientation)};
  }
};

}  // namespace

config::Result<report::RunRecord> assemble(const config::RunSettings& run, const SharedWorld& shared,
                                           const std::vector<PeerLog>& logs) {
  const Scene& scene = shared.world.scene;
  report::RunRecord record;
  record.params = run.params;
  record.duration_s = run.duration_s;

  std::map<ObjectId, Truth> truths;
  std::map<ObjectId, PeerId> owners;
  const auto objects = config::resolve(run, scene);
  if (!objects) return std::unexpected(objects.error());
  std::optional<SimTime> start;
  for (const PeerLog& log : logs) {
    if (!log.start)
      return std::unexpected(config::InputError{"error: peer " + log.name + " never met all the others", 3});
    if (!start) start = log.start;  // the lowest peer's, which the others follow
    record.peers.push_back({log.peer, log.name});
    for (const PeerLog::Belief& b : log.beliefs) {
      if (b.owner == log.peer) truths[b.object].ticks.push_back(&b);
    }
    const auto settings = std::ranges::find(run.peers, log.name, &config::PeerSettings::name);
    const config::PeerObjects& own = (*objects)[static_cast<std::size_t>(settings - run.peers.begin())];
    for (const ObjectId object : own.enslaved) {
      owners[object] = log.peer;
      record.objects.push_back({object, scene.path_of(object), log.peer});
    }
    for (const auto& [object, motion] : own.motions) truths[object].motion = &motion;
  }
  std::ranges::sort(record.objects, {}, &report::ObjectInfo::object);

  const auto within = [&](double t_s) { return t_s >= 0.0 && t_s <= run.duration_s; };
  for (const PeerLog& log : logs) {
    for (const PeerLog::Belief& b : log.beliefs) {
      if (b.owner == log.peer || !owners.contains(b.object)) continue;
      const Truth& truth = truths[b.object];
      if (truth.ticks.empty()) continue;
      const double t_s = to_seconds(truth.session_time(b.true_at) - *start);
      if (!within(t_s)) continue;
      record.beliefs.push_back({t_s, log.peer, b.object, truth.pose(b.true_at, *start), b.state.pose(), b.shown,
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
    record.groups_joined += log.groups_joined;
    record.worlds_equal = record.worlds_equal && log.other_worlds == 0;
    for (const auto& [name, count] : log.counters) record.counters[name] += count;
  }
  std::ranges::stable_sort(record.beliefs, [](const auto& a, const auto& b) {
    return std::tie(a.observer, a.object, a.t_s) < std::tie(b.observer, b.object, b.t_s);
  });
  std::ranges::stable_sort(record.updates, {}, &report::UpdateSent::t_s);
  std::ranges::stable_sort(record.datagrams, {}, &report::DatagramSent::t_s);
  std::ranges::stable_sort(record.contacts, {}, &report::ContactRow::t_s);
  return record;
}

}  // namespace peerd
