#pragma once
#include <unistd.h>

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <unordered_map>
#include <vector>

#include "peerd/daemon/embed/event_signal.hpp"
#include "peerd/daemon/embed/include/peerd/peerd.h"
#include "peerd/daemon/open/opened_peer.hpp"
#include "peerd/daemon/open/peer_options.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/peer/feed/pose_message.hpp"
#include "replication/settings/output/output.hpp"

namespace peerd::embed {

[[nodiscard]] peerd_pose pose_of(const Pose& pose);

// An event with its texts, to which its pointers point when it is taken.
struct StoredEvent {
  peerd_event event{};
  std::optional<std::string> name{}, text{}, path{};
};

// An EmbeddedPeer is a peer in a program of somebody else's, which drives it in its own loop or lets it have a thread.
// Everything but start(), and the class Hold, is called by whoever holds the peer.
class EmbeddedPeer {
 public:
  static constexpr std::size_t kEventsMax = 65'536;

  [[nodiscard]] static Result<std::unique_ptr<EmbeddedPeer>> open(const PeerOptions& options);
  ~EmbeddedPeer();
  EmbeddedPeer(const EmbeddedPeer&) = delete;
  EmbeddedPeer& operator=(const EmbeddedPeer&) = delete;

  // False in a process that was forked off after open(): the peer's thread is not in it, its locks may be held for
  // ever, and its sockets, its store and its part in the session are the first process's. Nothing else may be called
  // there, nor may the peer be destroyed.
  [[nodiscard]] bool is_of_this_process() const { return getpid() == opened_in_; }

  // Keeps the peer's thread, where it has one, between two of its steps, and other threads from holding it. Holds of
  // one thread nest.
  void hold();
  void release();

  // False: it has left.
  bool poll(Duration at_most);
  // False: it has a thread already.
  bool start();
  [[nodiscard]] bool has_thread() const { return thread_.joinable(); }
  void leave();
  [[nodiscard]] bool has_left() const { return peer_->daemon().has_left(); }

  [[nodiscard]] const PeerNode& node() const { return peer_->node(); }
  [[nodiscard]] OpenedPeer& opened() { return *peer_; }
  [[nodiscard]] std::optional<SimTime> session_now();
  // Brings what poses() reads to the present. None: there is no session yet.
  [[nodiscard]] std::optional<SimTime> look();
  [[nodiscard]] Pose shown(ObjectId object, SimTime t) { return peer_->node().shown(object, t); }
  // The reply of the control protocol, without a line end.
  [[nodiscard]] std::string ask(std::string_view request) { return peer_->daemon().on_control(request).line; }
  // Returns how many were taken.
  [[nodiscard]] std::size_t move(std::span<const peerd_motion> motions);
  [[nodiscard]] std::optional<StoredEvent> next_event();
  // It is raised while events wait, and from when the peer has left.
  [[nodiscard]] const EventSignal& signal() const { return signal_; }

  // For the C interface, whose texts are valid until the next call.
  std::string error{}, text{};
  StoredEvent event{};

 private:
  EmbeddedPeer(std::unique_ptr<OpenedPeer> peer, EventSignal signal);
  void note(const replication::Output& output);
  [[nodiscard]] const std::string& path_of(ObjectId object);

  pid_t opened_in_ = getpid();
  std::unique_ptr<OpenedPeer> peer_;
  std::optional<SimTime> looked_at_;
  std::deque<StoredEvent> events_;
  std::uint64_t lost_ = 0;
  EventSignal signal_;
  std::vector<feed::FedPose> fed_;
  std::unordered_map<ObjectId, std::string> paths_;  // of this scene
  std::uint64_t paths_of_ = 0;                       // .. PeerCounters::scene_changes then

  // Between the peer's thread and those that hold it.
  std::recursive_mutex door_;  // whoever holds the peer has it
  std::size_t depth_ = 0;      // of its holds
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_wanted_ = false, waits_ = false, has_ended_ = false;
  std::thread thread_;
};

// Holds a peer for as long as it lives.
class Hold {
 public:
  explicit Hold(EmbeddedPeer& peer) : peer_(peer) { peer_.hold(); }
  ~Hold() { peer_.release(); }
  Hold(const Hold&) = delete;
  Hold& operator=(const Hold&) = delete;

 private:
  EmbeddedPeer& peer_;
};

}  // namespace peerd::embed
