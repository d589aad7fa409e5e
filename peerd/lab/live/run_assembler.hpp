#pragma once
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "peerd/lab/live/contact_meter.hpp"
#include "peerd/lab/measure/meter.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd {

// What of a run is kept and measured beside the whole.
struct Measuring {
  measure::RowLimits limits{};
  std::vector<measure::TimeSpan> parts{};
};

// Lays the rows of one run's peers side by side while they come: every ghost against the truth at the same true
// instant. The truth of a driven object is its motion; that of any other object is interpolated between the ticks of
// its owner, so that a ghost waits for its owner's next tick. Of the ticks, the last two sample times are kept. With a
// bounded latency, what an observer and the owner see is compared at one session time: that is what the bound is of.
class RunAssembler final : public LogRows {
 public:
  [[nodiscard]] static Result<std::unique_ptr<RunAssembler>> make(const config::RunSettings& run,
                                                                  const SharedWorld& shared, Measuring measuring);

  void enter(const PeerLog& log) override;
  void end(PeerId peer, HostTime ended_at) override;
  void add(const PeerLog& log, const PeerLog::ObjectSample& sample) override;
  void add(const PeerLog& log, PeerLog::Update update) override;
  void add(const PeerLog& log, const PeerLog::Datagram& datagram) override;

  // The record of the run, with what only logs have: contacts, clocks, counters. Logs are in order of their peers, the
  // lives of a peer in order of time. `stopped_at_s`: where the run was ended before its time.
  [[nodiscard]] Result<measure::RunRecord> finish(const std::vector<PeerLog>& logs,
                                                  std::optional<double> stopped_at_s = std::nullopt);

 private:
  struct Life {
    bool from_the_start = false;
    std::optional<SimTime> first_row, last_row;
    HostTime first_row_at{};
    std::optional<HostTime> ended_at;
  };
  struct Tick {
    HostTime true_at;
    Duration since_start;
    KinematicState state;
    Pose shown;
  };
  struct WaitingGhost {
    HostTime true_at;
    Duration since_start;  // by the observer's session time
    PeerId observer;
    Pose ghost, shown;
  };
  // The states that a peer samples at one instant, for the contact meter.
  struct SampledView {
    Duration since_start;
    std::vector<ContactMeter::Seen> ghosts;
  };
  struct Instants {
    std::optional<Duration> tick, before, view;  // the latest tick, the one before it, and the latest sample of ghosts
    std::deque<SampledView> views;               // that wait for the next own tick
    bool counts = false;                         // the latest view is one of them
  };
  struct Object {
    PeerId owner = kNobody;                        // the peer that runs it by the settings; nobody: it has no views
    const motion::MotionSource* motion = nullptr;  // of a driven object
    std::vector<Tick> ticks;                       // the latest, by true_at
    bool forgot_ticks = false;                     // there were earlier ones
    std::vector<WaitingGhost> waiting;
  };

  RunAssembler(const config::RunSettings& run, const SharedWorld& shared, std::vector<config::PeerObjects> objects,
               Measuring measuring);
  [[nodiscard]] std::optional<SimTime> start_of(const PeerLog& log);
  [[nodiscard]] bool within(double t_s) const { return t_s >= 0.0 && t_s <= run_.duration_s; }
  [[nodiscard]] bool alive(PeerId peer, HostTime t) const;
  void add_tick(Object& object, const Tick& tick);
  [[nodiscard]] bool counts(std::optional<Duration> before, Duration now, int hz) const;
  void note_tick(PeerId peer, Duration since_start);
  void note_ghost(const PeerLog::ObjectSample& sample, PeerId observer, Duration since_start);
  void see_truths(bool all);
  void see_views(PeerId peer, Instants& of, std::optional<Duration> known_until);
  void measure(ObjectId id, const Object& object, const WaitingGhost& ghost);
  // The pose that the owner sees at the observer's session time, where it has a sample of just then.
  [[nodiscard]] static const Pose* seen_at(const Object& object, Duration since_start);
  [[nodiscard]] measure::PeerInfo peer_info(const config::PeerSettings& peer, const std::vector<PeerLog>& logs,
                                            SimTime start) const;
  [[nodiscard]] bool is_bounded() const { return run_.replication.bounded_latency.is_on(); }
  void add_logs(measure::RunRecord& record, const std::vector<PeerLog>& logs, SimTime start) const;

  const config::RunSettings& run_;
  const SharedWorld& shared_;
  std::vector<config::PeerObjects> resolved_;           // motions are in here
  std::unordered_map<ObjectId, std::size_t> index_of_;  // for look-ups alone, in objects_
  std::vector<std::pair<ObjectId, Object>> objects_;    // by id
  std::map<PeerId, std::vector<Life>> lives_;
  std::optional<SimTime> start_;  // of the lowest peer that has said one
  PeerId start_from_ = kNobody;
  std::uint64_t too_late_ = 0;  // samples of instants whose ticks were forgotten; they are left out
  measure::RunMeter meter_;
  ContactMeter contact_meter_;
  std::map<PeerId, Instants> instants_;   // of the peers that are there
  std::vector<ContactMeter::Seen> seen_;  // keeps its memory
  std::deque<Duration> truths_due_;       // instants that count, until all peers have gone on
};

}  // namespace peerd
