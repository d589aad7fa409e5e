#include "peerd/lab/live/run_assembler.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "peerd/lab/live/scene_outlines.hpp"

namespace peerd {
namespace {

// A peer that was to be there from the start and never met the others. One that has left before it met them, or came
// back to a network that loses too much, was not there.
std::optional<InputError> never_met(const config::RunSettings& run, const std::vector<PeerLog>& logs) {
  std::set<PeerId> known;
  for (const PeerLog& log : logs) {
    const bool first_life = known.insert(log.peer).second;
    if (log.start || !first_life || log.ended_at || !config::starts_with(run.events, log.name)) continue;
    return InputError{"error: peer " + log.name + " never met all the others", kSystemFailed};
  }
  return std::nullopt;
}

}  // namespace

Result<std::unique_ptr<RunAssembler>> RunAssembler::make(const config::RunSettings& run, const SharedWorld& shared,
                                                         Measuring measuring) {
  auto objects = config::resolve(run, shared.world.scene);
  if (!objects) return std::unexpected(objects.error());
  return std::unique_ptr<RunAssembler>(new RunAssembler(run, shared, *std::move(objects), std::move(measuring)));
}

RunAssembler::RunAssembler(const config::RunSettings& run, const SharedWorld& shared,
                           std::vector<config::PeerObjects> objects, Measuring measuring)
    : run_(run),
      shared_(shared),
      resolved_(std::move(objects)),
      meter_(run.duration_s, run.sample_hz, measuring.limits, std::move(measuring.parts)),
      contact_meter_(run, shared, resolved_) {
  std::map<ObjectId, Object> by_id;
  for (std::size_t i = 0; i < run.peers.size(); ++i) {
    for (const ObjectId id : resolved_[i].owned) by_id[id].owner = PeerId{run.peers[i].id};
    // The lone peer of a run founds its session.
    for (const ObjectId id : resolved_[i].owned_by_founder) by_id[id].owner = PeerId{run.peers[i].id};
    for (const auto& [id, motion] : resolved_[i].motions) by_id[id].motion = &motion;
  }
  for (auto& [id, object] : by_id) {
    index_of_[id] = objects_.size();
    objects_.emplace_back(id, std::move(object));
  }
}

void RunAssembler::enter(const PeerLog& log) {
  (void)start_of(log);
  std::vector<Life>& lives = lives_[log.peer];
  const auto settings = std::ranges::find(run_.peers, log.peer.value, &config::PeerSettings::id);
  const bool first = lives.empty() && settings != run_.peers.end();
  lives.emplace_back().from_the_start = first && config::starts_with(run_.events, settings->name);
}

void RunAssembler::end(PeerId peer, HostTime ended_at) {
  lives_[peer].back().ended_at = ended_at;
  instants_.erase(peer);
}

// Whether the peer is in the session at a true time up to now. A peer that was there from the start was there before
// its first row, and a peer that nothing has ended stays after its last row.
bool RunAssembler::alive(PeerId peer, HostTime t) const {
  const auto lives = lives_.find(peer);
  return lives != lives_.end() && std::ranges::any_of(lives->second, [&](const Life& life) {
           return life.first_row && (life.from_the_start || life.first_row_at <= t) &&
                  t <= life.ended_at.value_or(HostTime::max());
         });
}

// All peers of a session have one start. A peer that has not learnt it yet goes by the start that others know.
std::optional<SimTime> RunAssembler::start_of(const PeerLog& log) {
  if (log.start && (!start_ || log.peer <= start_from_)) {
    start_ = log.start;
    start_from_ = log.peer;
  }
  return log.start ? log.start : start_;
}

void RunAssembler::add(const PeerLog& log, const PeerLog::ObjectSample& sample) {
  const std::optional<SimTime> start = start_of(log);
  std::vector<Life>& lives = lives_[log.peer];
  if (lives.empty()) enter(log);
  Life& life = lives.back();
  if (!life.first_row) life.first_row = sample.at, life.first_row_at = sample.true_at;
  life.last_row = sample.at;
  const auto found = index_of_.find(sample.object);
  if (!start || found == index_of_.end()) return;
  Object& object = objects_[found->second].second;
  if (sample.owner != log.peer) {
    note_ghost(sample, log.peer, sample.at - *start);
    if (object.owner == kNobody) return;
    const auto owners = lives_.find(object.owner);
    const bool gone = owners == lives_.end() || owners->second.empty() ||
                      (owners->second.back().ended_at && *owners->second.back().ended_at < sample.true_at);
    if (!gone)
      object.waiting.push_back({sample.true_at, sample.at - *start, log.peer, sample.state.pose(), sample.shown});
    return;
  }
  note_tick(log.peer, sample.at - *start);
  // What was asked for before this tick can be told now.
  add_tick(object, {sample.true_at, sample.at - *start, sample.state, sample.shown});
  std::erase_if(object.waiting, [&](const WaitingGhost& ghost) {
    if (ghost.true_at >= sample.true_at) return false;
    if (is_bounded() && ghost.since_start > sample.at - *start) return false;
    measure(objects_[found->second].first, object, ghost);
    return true;
  });
}

// A ghost's sample is at most one sample time older than the event that brings it.
void RunAssembler::add_tick(Object& object, const Tick& tick) {
  const HostTime oldest = tick.true_at - from_seconds(2.0 / run_.sample_hz);
  std::vector<Tick>& ticks = object.ticks;
  const auto needed = std::ranges::find_if(ticks, [&](const Tick& t) { return t.true_at > oldest; });
  const bool waits = std::ranges::any_of(object.waiting, [&](const WaitingGhost& g) { return g.true_at < oldest; });
  if (!waits && needed - ticks.begin() > 1) {
    ticks.erase(ticks.begin(), needed - 1);
    object.forgot_ticks = true;
  }
  ticks.push_back(tick);
}

// Whether a peer's tick at `now`, after one at `before`, is its first one in its part of a second, 1 / hz long: only
// that one is looked at.
bool RunAssembler::counts(std::optional<Duration> before, Duration now, int hz) const {
  const Duration part = std::chrono::nanoseconds(1'000'000'000 / hz);
  return within(to_seconds(now)) && (!before || *before / part < now / part || *before < Duration{0});
}

void RunAssembler::note_tick(PeerId peer, Duration since_start) {
  Instants& of = instants_[peer];
  if (of.tick == since_start) return;
  of.before = std::exchange(of.tick, since_start);
  see_truths(false);
  see_views(peer, of, of.before);
  const bool is_due = std::ranges::find(truths_due_, since_start) != truths_due_.end();
  if (counts(of.before, since_start, measure::kContactSamples_hz) && !is_due) truths_due_.push_back(since_start);
}

void RunAssembler::note_ghost(const PeerLog::ObjectSample& sample, PeerId observer, Duration since_start) {
  Instants& of = instants_[observer];
  if (of.view != since_start) {
    see_views(observer, of, of.tick);
    const std::optional<Duration> before = std::exchange(of.view, since_start);
    of.counts = counts(before, since_start, measure::kContactViews_hz);
    if (of.counts) of.views.emplace_back(since_start).ghosts.reserve(objects_.size());
  }
  if (of.counts) of.views.back().ghosts.push_back({sample.object, sample.state});
}

// An instant has come to its end where each peer that owns something has a later tick. One that has no more ticks is
// not waited for.
void RunAssembler::see_truths(bool all) {
  constexpr std::size_t kMostDue = 8;
  while (!truths_due_.empty()) {
    const Duration t = truths_due_.front();
    const bool is_over =
        std::ranges::all_of(instants_, [&](const auto& of) { return !of.second.tick || *of.second.tick > t; });
    if (!is_over && !all && truths_due_.size() <= kMostDue) return;
    truths_due_.pop_front();
    seen_.clear();
    for (const auto& [id, object] : objects_) {
      const auto tick = std::ranges::find(object.ticks, t, &Tick::since_start);
      if (tick != object.ticks.end()) seen_.push_back({id, tick->state});
    }
    contact_meter_.see_truth(to_seconds(t), seen_);
  }
}

// An object of the observer's own is taken at that instant where its ticks before and after it are of one law.
void RunAssembler::see_views(PeerId peer, Instants& of, std::optional<Duration> known_until) {
  while (!of.views.empty() && (!of.tick || (known_until && *known_until >= of.views.front().since_start))) {
    SampledView view = std::move(of.views.front());
    of.views.pop_front();
    const Duration t = view.since_start;
    for (const auto& [id, object] : objects_) {
      if (object.owner != peer) continue;
      const auto next = std::ranges::find_if(object.ticks, [&](const Tick& tick) { return tick.since_start >= t; });
      if (next == object.ticks.end()) continue;
      if (next->since_start == t) {
        view.ghosts.push_back({id, next->state, true});
      } else if (next != object.ticks.begin()) {
        const Tick& before = *(next - 1);
        constexpr double kSameLaw_m = 1e-9;
        const KinematicState then = advance(before.state, to_seconds(next->since_start - before.since_start));
        if ((then.position - next->state.position).norm() > kSameLaw_m) continue;
        view.ghosts.push_back({id, advance(before.state, to_seconds(t - before.since_start)), true});
      }
    }
    contact_meter_.see_view(to_seconds(t), peer, view.ghosts);
  }
}

const Pose* RunAssembler::seen_at(const Object& object, Duration since_start) {
  const auto found = std::ranges::find(object.ticks, since_start, &Tick::since_start);
  return found == object.ticks.end() ? nullptr : &found->shown;
}

void RunAssembler::measure(ObjectId id, const Object& object, const WaitingGhost& ghost) {
  const HostTime t = ghost.true_at;
  if (object.ticks.empty() || !alive(object.owner, t)) return;
  const auto next = std::ranges::upper_bound(object.ticks, t, {}, &Tick::true_at);
  const Tick* const before = next == object.ticks.begin() ? nullptr : &*(next - 1);
  if (before == nullptr && object.forgot_ticks) {
    ++too_late_;
    return;
  }
  const Tick& known = before != nullptr ? *before : object.ticks.front();
  const double t_s = to_seconds(known.since_start + (t - known.true_at));  // of the owner's session
  if (!within(t_s)) return;

  const auto between = [&](auto pose_of) -> Pose {
    if (before == nullptr) return pose_of(*next);
    if (next == object.ticks.end() || before->true_at == t) return pose_of(*before);
    const double s = to_seconds(t - before->true_at) / to_seconds(next->true_at - before->true_at);
    const Pose a = pose_of(*before), b = pose_of(*next);
    return {a.position + s * (b.position - a.position), a.orientation.slerp(s, b.orientation)};  // exact at rest
  };
  const auto truth = [&]() -> Pose {
    if (object.motion != nullptr) return object.motion->pose(t_s);
    if (before != nullptr && next == object.ticks.end()) {
      return advance(before->state, to_seconds(t - before->true_at)).pose();
    }
    return between([](const Tick& tick) { return tick.state.pose(); });
  };
  const Pose pose = truth();
  const bool as_it_is = before == nullptr || before->shown.position == before->state.position;
  const Pose* const at_one_time = is_bounded() ? seen_at(object, ghost.since_start) : nullptr;
  const Pose seen = at_one_time != nullptr ? *at_one_time
                    : as_it_is             ? pose
                                           : between([](const Tick& tick) { return tick.shown; });
  meter_.add(measure::GhostSample{t_s, ghost.observer, id, pose, ghost.ghost, ghost.shown, seen});
}

void RunAssembler::add(const PeerLog& log, PeerLog::Update update) {
  const std::optional<SimTime> start = start_of(log);
  if (!start) return;  // the motions have not begun
  const double t_s = to_seconds(update.at - *start);
  if (!within(t_s)) return;
  meter_.add(
      measure::UpdateSent{t_s, log.peer, update.object, update.bytes, update.threshold_m, std::move(update.reason)});
}

void RunAssembler::add(const PeerLog& log, const PeerLog::Datagram& datagram) {
  const std::optional<SimTime> start = start_of(log);
  if (!start) return;
  const double t_s = to_seconds(datagram.at - *start);
  if (within(t_s)) meter_.add(measure::DatagramSent{t_s, log.peer, datagram.bytes});
}

measure::PeerInfo RunAssembler::peer_info(const config::PeerSettings& peer, const std::vector<PeerLog>& logs,
                                          SimTime start) const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  measure::PeerInfo info{PeerId{peer.id}, peer.name};
  const auto lives = lives_.find(info.peer);
  std::size_t life_number = 0;
  for (const PeerLog& log : logs) {
    if (log.peer != info.peer || lives == lives_.end() || life_number == lives->second.size()) continue;
    const Life& life = lives->second[life_number++];
    if (!log.start || (!life.first_row && !life.from_the_start)) continue;
    const double from_s = life.from_the_start ? -kNever : to_seconds(*life.first_row - start);
    const double until_s = life.ended_at && life.last_row ? to_seconds(*life.last_row - start) : kNever;
    info.there_s.emplace_back(from_s, until_s);
  }
  if (info.there_s.empty()) info.there_s.emplace_back(1.0, 0.0);  // an interval that no time is in
  return info;
}

void RunAssembler::add_logs(measure::RunRecord& record, const std::vector<PeerLog>& logs, SimTime start) const {
  const Scene& scene = shared_.world.scene;
  const auto owned = [&](ObjectId id) {
    const auto found = index_of_.find(id);
    return found != index_of_.end() && objects_[found->second].second.owner != kNobody;
  };
  for (const PeerLog& log : logs) {
    for (const PeerLog::Contact& c : log.contacts) {
      const double t_s = to_seconds(c.at - start);
      if (!within(t_s)) continue;
      const auto name = [&](ObjectId id) {
        if (owned(id)) return;
        const auto added = log.paths.find(id);
        record.scene_paths.try_emplace(id, added != log.paths.end() ? added->second : scene.path_of(id));
      };
      name(c.collider);
      name(c.collidee);
      for (const auto& [of_collider, of_collidee] : c.polygons.pairs) {
        name(of_collider.shape);
        name(of_collidee.shape);
      }
      record.contacts.push_back({t_s, log.peer, c.kind, c.collider, c.collidee, c.normal,
                                 to_seconds(c.known_at - start), c.type, c.polygons});
    }
    if (const auto& c = log.clock_error) {
      const auto ms = [](Duration d) { return to_seconds(d) * 1e3; };
      record.clocks.push_back(
          {log.peer, c->samples, ms(c->p99), ms(c->max), ms(c->bound_median), ms(c->bound_max), c->beyond_bound});
    }
    if (const auto& b = log.bound) {
      const auto in_ms = [](Duration d) { return to_seconds(d) * 1e3; };
      measure::ShownDelay& shown =
          record.shown_delay ? *record.shown_delay : record.shown_delay.emplace(in_ms(b->least), in_ms(b->most), 0.0);
      shown.least_ms = std::min(shown.least_ms, in_ms(b->least));
      shown.most_ms = std::max(shown.most_ms, in_ms(b->most));
      shown.latest_by_ms = std::max(shown.latest_by_ms, in_ms(b->latest_by));
    }
    record.groups_joined += log.groups_joined;
    record.worlds_equal = record.worlds_equal && log.other_worlds == 0;
    for (const auto& [name, count] : log.counters) {
      std::uint64_t& all = record.counters[name];  // of `_max` the greatest of all peers, else the sum
      all = name.ends_with("_max") ? std::max(all, count) : all + count;
    }
  }
  std::ranges::stable_sort(record.contacts, {}, &measure::ContactRow::t_s);
}

Result<measure::RunRecord> RunAssembler::finish(const std::vector<PeerLog>& logs, std::optional<double> stopped_at_s) {
  if (const auto error = never_met(run_, logs); error && !stopped_at_s) return std::unexpected(*error);
  std::optional<SimTime> start;  // session time of the lowest peer, which the others follow
  for (const PeerLog& log : logs) {
    if (!start) start = log.start;
  }
  if (!start) return std::unexpected(InputError{"error: nobody's log says when the motions began", kSystemFailed});
  for (auto& [id, object] : objects_) {
    for (const WaitingGhost& ghost : object.waiting) measure(id, object, ghost);
    object.waiting = {};
  }
  see_truths(true);
  for (auto& [peer, of] : instants_) see_views(peer, of, of.tick);
  measure::RunRecord record;
  record.params = run_.params;
  record.network_settings = config::network_settings(run_);
  record.seed = run_.seed;
  record.duration_s = stopped_at_s.value_or(run_.duration_s);
  record.stopped = stopped_at_s.has_value();
  for (const config::ScenarioEvent& e : run_.events) {
    if (!stopped_at_s || e.at_s <= *stopped_at_s) record.events.push_back({e.at_s, e.name});
  }
  for (const config::PeerSettings& peer : run_.peers) record.peers.push_back(peer_info(peer, logs, *start));
  for (const auto& [id, object] : objects_) {
    if (object.owner != kNobody) record.objects.push_back({id, shared_.world.scene.path_of(id), object.owner});
  }
  add_logs(record, logs, *start);
  record.contacts_measured = contact_meter_.result(record.contacts, record.duration_s);
  if (too_late_ > 0) record.counters["report.samples_too_late"] = too_late_;
  meter_.finish(record, record.duration_s);
  SceneOutlines scene = outlines_of(shared_.world.scene, record);
  record.outlines = std::move(scene.outlines);
  record.outlines_left_out = scene.left_out;
  return record;
}

}  // namespace peerd
