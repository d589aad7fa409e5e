#pragma once
#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "peerd/input/input_error.hpp"
#include "peerd/peer/config/scenario.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "peerd/peer/record/capture.hpp"
#include "peerd/peer/record/setup.hpp"

namespace peerd::recorded {

// One run of the recorded configuration in the recorded world. Another world would only give differences that nobody
// understands.
struct RecordedPeer {
  config::RunSettings run;
  const config::PeerSettings* peer;
  std::filesystem::path world;
  std::unique_ptr<const SharedWorld> shared;
  std::unique_ptr<const replication::LogSigner> signer;  // null: it signs nothing
  // The signer knows the members by that roster from then on. False: it is none.
  std::function<bool(std::string_view)> follow_roster;
  std::unique_ptr<PeerNode> node;  // as it was when the capture began
};
// `signatures`: those that it will repeat. `file`: the capture's, for errors. `world`: where the world is now; empty:
// where it was.
[[nodiscard]] Result<RecordedPeer> make_recorded_peer(const record::Setup& setup,
                                                      std::vector<record::Signed> signatures,
                                                      const std::filesystem::path& file,
                                                      const std::filesystem::path& world);

// Sees what a replayed peer does.
class ReplayWatch {
 public:
  virtual ~ReplayWatch() = default;
  // The next input comes at that time of the peer's own clock.
  virtual void before(HostTime /*at*/) {}
  virtual void on_output(HostTime at, const replication::Output& output) = 0;
  virtual void on_line(HostTime at, const LogLine& line) = 0;
};

// Drives a PeerNode with the clock and the network of a capture.
class Replay {
 public:
  // The first place at which the peer does not do what it did when it was recorded.
  struct Difference {
    std::size_t packet;  // number of the packet in the capture, from 1; 0: after the last one
    HostTime at;
    std::string what;
  };
  struct Outcome {
    std::size_t inputs = 0, datagrams_in = 0, datagrams_out = 0;
    HostTime end{};
    std::optional<Difference> difference;
  };

  // All outlive it; `watch` may be null.
  Replay(const RecordedPeer& peer, record::CaptureReader& capture, ReplayWatch* watch)
      : node_(*peer.node), follow_roster_(peer.follow_roster), capture_(capture), watch_(watch) {}

  // Runs to the end, or to the first difference. The error says why the capture can't be read on.
  Result<Outcome> run();

 private:
  void differ(std::size_t packet, HostTime at, std::string what);
  std::string compare_next(const record::DatagramOut& recorded);
  void apply_input(std::size_t packet, const record::Event& event);
  void drain(HostTime at);

  PeerNode& node_;
  const std::function<bool(std::string_view)>& follow_roster_;
  record::CaptureReader& capture_;
  ReplayWatch* watch_;
  std::deque<replication::Send> sent_;  // not yet compared
  Outcome outcome_;
};

}  // namespace peerd::recorded
