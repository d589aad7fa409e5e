#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "peerd/lab/chaos/simulated_disk.hpp"
#include "peerd/lab/chaos/watch/data_watch.hpp"
#include "peerd/lab/chaos/watch/findings.hpp"
#include "peerd/lab/chaos/watch/message_watch.hpp"
#include "peerd/lab/chaos/watch/operation_book.hpp"
#include "peerd/lab/chaos/watch/ownership_watch.hpp"
#include "peerd/peer/node/edit_operation.hpp"
#include "peerd/peer/node/key_report.hpp"
#include "peerd/peer/node/peer_log.hpp"
#include "replication/settings/output/output.hpp"
#include "replication/wire/operation.hpp"

namespace peerd {
class PeerNode;
struct Scene;
}  // namespace peerd

namespace peerd::chaos {

// Sees all peers of a run, which none of them can, and says what must not be.
class Oracle final : public LogRows {
 public:
  // `trusts_datagrams`: nothing damaged reaches a peer, so that all must come to one scene.
  Oracle(std::size_t hosts, bool trusts_datagrams);
  // The scene that all peers begin with, which outlives this: what their operations make of it is checked, too.
  void set_file(const Scene& file) { file_ = &file; }

  void begin_life(std::size_t host, const PeerNode& node);
  void end_life(std::size_t host);  // before the peer is gone
  // The peer has put that out.
  void on_output(double now_s, std::size_t host, const replication::Output& output);
  // An edit was asked of the peer.
  void on_edit(std::size_t host, const EditReport& report);
  // The peer's store has its operations up to this one.
  void on_stored(std::size_t host, replication::OperationId last);
  // A key was pressed at a peer.
  void on_key(const KeyReport& report);
  // The peer has taken something in.
  void on_input(std::size_t host);
  // Checks what must hold at every time.
  void check(double now_s);
  // From now on all peers are together, and every contact has one outcome.
  void begin_calm();
  // Whether all peers know each other, have the same logs and the same scene.
  [[nodiscard]] bool is_one_world() const;
  // Checks what must hold at the end, when everything has come to rest.
  void finish(double now_s);

  [[nodiscard]] const std::vector<std::string>& violations() const { return findings_.violations(); }
  void violate(double now_s, const std::string& what) { findings_.violate(now_s, what); }
  // How often each rare branch was taken, by its name.
  [[nodiscard]] const std::map<std::string, std::uint64_t>& branches() const { return findings_.branches(); }
  void count(const std::string& branch, std::uint64_t times = 1) { findings_.count(branch, times); }
  void count(const SimulatedDisk::Counters& disk);
  [[nodiscard]] std::size_t operations() const { return operations_; }
  [[nodiscard]] std::size_t held() const { return held_.size(); }

  // ---- what peers write to their logs

  void enter(const PeerLog&) override {}
  void end(PeerId, HostTime) override {}
  void add(const PeerLog& log, const PeerLog::ObjectSample& sample) override;
  void add(const PeerLog&, PeerLog::Update) override {}
  void add(const PeerLog&, const PeerLog::Datagram&) override {}

 private:
  using Contact = std::pair<SimTime, std::pair<ObjectId, ObjectId>>;  // of the lower id and the higher one
  struct Outcome {
    ObjectId collider;
    Vec3 normal;
  };
  struct Life {
    std::size_t host = 0;
    const PeerNode* node = nullptr;                       // null: it is over
    std::map<replication::AuthorId, std::uint32_t> last;  // the number of the last operation that it has held
    std::map<Contact, Outcome> outcomes;                  // of contacts of two peers' objects
    std::map<replication::OperationId, bool> refused;
    std::uint64_t taken = 0;  // operations
  };

  [[nodiscard]] Life& life_of(std::size_t host);
  [[nodiscard]] std::vector<const Life*> alive() const;
  [[nodiscard]] std::string name_of(const Life& life) const;
  [[nodiscard]] WatchedPeer watched(const Life& life) const;
  [[nodiscard]] std::vector<WatchedPeer> all_watched() const;
  void watch_stored(const WatchedPeer& peer);
  void watch_edit(const WatchedPeer& peer, const EditReport& report);
  void watch_output(double now_s, const WatchedPeer& peer, const replication::Output& output);
  void on_edited(Life& life, const replication::SceneEdited& edited);
  void note_written(replication::AuthorId author, std::uint64_t bytes);
  void on_growth(std::size_t host, const replication::OperationRange& grown);
  void on_contact(Life& life, const replication::ContactSeen& seen);
  void on_difference(double now_s, const Life& life, const replication::GhostDiffers& differs);
  void check_held(double now_s);
  void check_stored(double now_s);
  void check_logs(double now_s);
  void check_scenes(double now_s);
  void check_owners(double now_s);
  void check_outcomes(double now_s);
  void measure_ghosts();
  void count_all(const PeerNode& node);

  bool trusts_datagrams_;
  std::vector<std::optional<std::size_t>> life_of_host_;  // none: nobody runs there
  std::vector<Life> lives_;
  std::map<replication::AuthorId, std::uint64_t> written_;  // bytes of each log
  std::map<replication::AuthorId, std::size_t> author_host_;
  std::map<replication::AuthorId, std::uint32_t> stored_;  // the number of the last one that its author's store has
  std::map<replication::OperationId, double> held_;        // since when
  std::size_t operations_ = 0;
  std::optional<SimTime> calm_since_;
  Findings findings_;
  const Scene* file_ = nullptr;
  OperationBook book_;
  OwnershipWatch ownership_{book_, findings_};
  DataWatch data_{book_, findings_};
  MessageWatch messages_{book_, findings_};
};

}  // namespace peerd::chaos
