#include "peerd/lab/recorded/replay.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "peerd/net/seal/operation_signer.hpp"
#include "peerd/peer/config/resolve.hpp"
#include "peerd/peer/control/answer.hpp"
#include "peerd/peer/feed/pose_message.hpp"
#include "peerd/peer/node/describe.hpp"

namespace peerd::recorded {
namespace {

// Such as "1 byte", "2 bytes".
std::string number_of(std::size_t count, const std::string& what) {
  return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s");
}

std::string size_of(std::size_t bytes) { return number_of(bytes, "byte"); }

// Compares a datagram with the recorded one. The result is empty where they are the same.
std::string compare(const replication::Send& sent, const record::DatagramOut& recorded) {
  if (sent.region != recorded.region) {
    return fmt::format("a datagram goes to region {} that went to region {}", sent.region.value, recorded.region.value);
  }
  const auto [here, there] = std::ranges::mismatch(sent.datagram, recorded.datagram);
  if (here == sent.datagram.end() && there == recorded.datagram.end()) return "";
  return fmt::format("a datagram of {} was one of {}; the first byte that differs is number {}",
                     size_of(sent.datagram.size()), size_of(recorded.datagram.size()), here - sent.datagram.begin());
}

// Whoever may not write has not written in what was recorded.
bool all_write(const keys::PublicKey& /*key*/) { return true; }

// Repeats the signatures of a peer whose secret nobody has recorded, and checks those of the others.
class SignatureRepeater final : public seal::OperationVerifier {
 public:
  SignatureRepeater(std::uint64_t world, std::vector<std::byte> own_key, std::vector<record::Signed> signatures)
      : OperationVerifier(world, all_write,
                          [this](const keys::PublicKey& key) {
                            return roster_ ? seal::writer_by(*roster_, key) : seal::writer_without_roster(key);
                          }),
        own_key_(std::move(own_key)),
        signatures_(std::move(signatures)) {}
  [[nodiscard]] bool follow(std::string_view roster) {
    roster_ = keys::Roster::of_text(roster);
    return roster_.has_value();
  }

  [[nodiscard]] std::vector<std::byte> own_key() const override { return own_key_; }
  // Zeros, where it signs more than it did: the datagram with it is a difference.
  [[nodiscard]] std::array<std::byte, replication::kSignature_bytes> sign(replication::AuthorId /*author*/,
                                                                          const Digest& /*digest*/) const override {
    return next_ < signatures_.size() ? signatures_[next_++].signature : record::Signed{}.signature;
  }
  [[nodiscard]] const char* why_not_write() const override { return nullptr; }

 private:
  std::vector<std::byte> own_key_;
  std::vector<record::Signed> signatures_;
  mutable std::size_t next_ = 0;
  std::optional<keys::Roster> roster_;
};

}  // namespace

Result<Replay::Outcome> Replay::run() {
  outcome_.end = capture_.begin();
  drain(capture_.begin());
  for (std::size_t packet = 2;; ++packet) {  // the first packet describes the peer
    const auto event = capture_.next();
    if (!event) return std::unexpected(InputError{event.error(), kFinding});
    if (!*event) break;
    outcome_.end = (*event)->at;
    if (std::holds_alternative<record::Signed>((*event)->what)) continue;  // make_recorded_peer() has them
    if (const auto* recorded = std::get_if<record::DatagramOut>(&(*event)->what)) {
      ++outcome_.datagrams_out;
      differ(packet, (*event)->at, compare_next(*recorded));
    } else if (!sent_.empty()) {
      differ(packet, (*event)->at,
             "before that it sends a datagram of " + size_of(sent_.front().datagram.size()) + " that it did not send");
    } else {
      if (watch_ != nullptr) watch_->before((*event)->at);
      apply_input(packet, **event);
      drain((*event)->at);
    }
    if (outcome_.difference) return outcome_;
  }
  // A writer that was stopped has not written everything; the missing datagrams are no difference.
  if (!sent_.empty() && !capture_.cut_off()) {
    differ(0, outcome_.end,
           fmt::format("at the end it sends {} that it did not send", number_of(sent_.size(), "datagram")));
  }
  return outcome_;
}

void Replay::differ(std::size_t packet, HostTime at, std::string what) {
  if (!what.empty()) outcome_.difference.emplace(packet, at, std::move(what));
}

std::string Replay::compare_next(const record::DatagramOut& recorded) {
  if (sent_.empty()) return "it does not send a datagram of " + size_of(recorded.datagram.size());
  const replication::Send sent = std::move(sent_.front());
  sent_.pop_front();
  return compare(sent, recorded);
}

void Replay::apply_input(std::size_t packet, const record::Event& event) {
  ++outcome_.inputs;
  if (const auto* in = std::get_if<record::DatagramIn>(&event.what)) {
    ++outcome_.datagrams_in;
    node_.on_packet(event.at, in->region, in->datagram);
  } else if (std::holds_alternative<record::Tick>(event.what)) {
    node_.on_tick(event.at);
  } else if (const auto* os = std::get_if<record::OsClockRead>(&event.what)) {
    node_.on_os_clock(event.at, os->clock);
  } else if (const auto* control = std::get_if<record::Control>(&event.what)) {
    (void)control::answer(node_, event.at, control->line, control->host_minus_wall);
  } else if (const auto* poses = std::get_if<record::Poses>(&event.what)) {
    if (const auto message = feed::parse_pose_message(poses->datagram)) {
      (void)node_.on_poses(event.at, poses->host_minus_wall, message->poses);
    } else {
      node_.refuse_poses(message.error());
    }
  } else if (const auto* roster = std::get_if<record::RosterRead>(&event.what)) {
    if (!follow_roster_ || !follow_roster_(roster->text)) {
      return differ(packet, event.at, "the roster that it gets is none by this program");
    }
    node_.follow_writers();
  } else if (std::holds_alternative<record::Left>(event.what)) {
    node_.leave(event.at);
  }
}

void Replay::drain(HostTime at) {
  while (auto out = node_.poll_output()) {
    if (watch_ != nullptr) watch_->on_output(at, *out);
    if (auto* send = std::get_if<replication::Send>(&*out)) sent_.push_back(std::move(*send));
  }
  while (const auto key = node_.poll_key_report()) {
    for (const LogLine& line : describe(*key, node_.scene())) {
      if (watch_ != nullptr) watch_->on_line(at, line);
    }
  }
  while (const auto edit = node_.poll_edit_report()) {
    if (watch_ != nullptr) watch_->on_line(at, describe(*edit));
  }
  while (const auto notice = node_.poll_feed_notice()) {
    if (watch_ != nullptr) watch_->on_line(at, describe(*notice));
  }
}

Result<RecordedPeer> make_recorded_peer(const record::Setup& setup, std::vector<record::Signed> signatures,
                                        const std::filesystem::path& file, const std::filesystem::path& world) {
  config::ScenarioRequest request;
  request.file = setup.file;
  request.text = setup.configuration;
  request.sweep = false;
  auto scenario = config::read_scenario(request);
  if (!scenario) return std::unexpected(scenario.error());
  // The scenario's warnings are about the text in the capture, which nobody can change any more.
  RecordedPeer recorded;
  recorded.run = std::move(scenario->runs.front());
  const auto peer = std::ranges::find(recorded.run.peers, setup.peer, &config::PeerSettings::name);
  if (peer == recorded.run.peers.end()) {
    return std::unexpected(
        InputError{file.string() + ": error: its configuration has no peer \"" + setup.peer + "\"", kFinding});
  }
  recorded.peer = &*peer;
  recorded.world = world.empty() ? setup.world : world;
  auto shared = share_world(recorded.world, setup.reading, {&recorded.run, 1});
  if (!shared) return std::unexpected(shared.error());
  if ((*shared)->world.hash != setup.world_hash) {
    return std::unexpected(InputError{"error: " + recorded.world.string() +
                                      " is not the world that was recorded; say where that is with --world"});
  }
  recorded.shared = *std::move(shared);
  auto objects = config::resolve(recorded.run, recorded.shared->world.scene);
  if (!objects) return std::unexpected(objects.error());
  auto& own = (*objects)[static_cast<std::size_t>(recorded.peer - recorded.run.peers.data())];
  PeerNode::Options node = setup.options;
  if (!setup.author_key.empty()) {
    auto signer =
        std::make_unique<SignatureRepeater>(recorded.shared->world.hash, setup.author_key, std::move(signatures));
    if (!setup.roster.empty() && !signer->follow(setup.roster)) {
      return std::unexpected(InputError{file.string() + ": error: its roster is damaged", kFinding});
    }
    recorded.follow_roster = [signer = signer.get()](std::string_view roster) { return signer->follow(roster); };
    recorded.signer = std::move(signer);
    node.signer = recorded.signer.get();
  }
  recorded.node = PeerNode::make(*recorded.peer, recorded.run.replication, *recorded.shared, std::move(own), node);
  return recorded;
}

}  // namespace peerd::recorded
