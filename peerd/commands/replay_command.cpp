#include "peerd/commands/replay_command.hpp"

#include <deque>
#include <iostream>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/commands/print.hpp"
#include "peerd/commands/problems.hpp"
#include "peerd/control/answer.hpp"
#include "peerd/feed/pose_message.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/node/describe.hpp"
#include "peerd/record/capture.hpp"

namespace peerd {
namespace {

// The first place at which the peer does not do what it did when it was recorded.
struct Difference {
  std::size_t packet;  // number of the packet in the capture, from 1
  HostTime at;
  std::string what;
};

struct Outcome {
  std::size_t inputs = 0, datagrams_in = 0, datagrams_out = 0;
  HostTime end{};
  std::optional<Difference> difference;
};

std::string size_of(std::size_t bytes) { return counted(bytes, "byte"); }

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

// Drives a PeerNode with the clock and the network of a capture.
class Replay {
 public:
  Replay(PeerNode& node, record::CaptureReader& capture, bool verbose)
      : node_(node), capture_(capture), verbose_(verbose) {}

  // The error says why the capture can't be read on.
  Result<Outcome> run() {
    outcome_.end = capture_.begin();
    drain(capture_.begin());
    for (std::size_t packet = 2;; ++packet) {  // the first packet describes the peer
      const auto event = capture_.next();
      if (!event) return std::unexpected(InputError{event.error(), 1});
      if (!*event) break;
      outcome_.end = (*event)->at;
      if (const auto* recorded = std::get_if<record::DatagramOut>(&(*event)->what)) {
        ++outcome_.datagrams_out;
        differ(packet, (*event)->at, compare_next(*recorded));
      } else if (!sent_.empty()) {
        differ(
            packet, (*event)->at,
            "before that it sends a datagram of " + size_of(sent_.front().datagram.size()) + " that it did not send");
      } else {
        apply_input(**event);
        drain((*event)->at);
      }
      if (outcome_.difference) return outcome_;
    }
    // A writer that was stopped has not written everything; the missing datagrams are no difference.
    if (!sent_.empty() && !capture_.cut_off()) {
      differ(0, outcome_.end,
             fmt::format("at the end it sends {} that it did not send", counted(sent_.size(), "datagram")));
    }
    return outcome_;
  }

 private:
  void differ(std::size_t packet, HostTime at, std::string what) {
    if (!what.empty()) outcome_.difference.emplace(packet, at, std::move(what));
  }

  std::string compare_next(const record::DatagramOut& recorded) {
    if (sent_.empty()) return "it does not send a datagram of " + size_of(recorded.datagram.size());
    const replication::Send sent = std::move(sent_.front());
    sent_.pop_front();
    return compare(sent, recorded);
  }

  void apply_input(const record::Event& event) {
    ++outcome_.inputs;
    if (const auto* in = std::get_if<record::DatagramIn>(&event.what)) {
      ++outcome_.datagrams_in;
      node_.on_packet(event.at, in->region, in->datagram);
    } else if (std::holds_alternative<record::Tick>(event.what)) {
      node_.on_tick(event.at);
    } else if (const auto* os = std::get_if<record::OsClockRead>(&event.what)) {
      node_.on_os_clock(event.at, os->clock);
    } else if (const auto* control = std::get_if<record::Control>(&event.what)) {
      (void)api::answer(node_, event.at, control->line, control->host_minus_wall);
    } else if (const auto* poses = std::get_if<record::Poses>(&event.what)) {
      if (const auto message = feed::parse_pose_message(poses->datagram)) {
        (void)node_.on_poses(event.at, poses->host_minus_wall, message->poses);
      } else {
        node_.refuse_poses(message.error());
      }
    } else if (std::holds_alternative<record::Left>(event.what)) {
      node_.leave(event.at);
    }
  }

  void drain(HostTime at) {
    while (auto out = node_.poll_output()) {
      if (verbose_) print(at, describe(*out, node_.scene()));
      if (auto* send = std::get_if<replication::Send>(&*out)) sent_.push_back(std::move(*send));
    }
    while (const auto key = node_.poll_key_report()) {
      for (const LogLine& line : describe(*key, node_.scene())) {
        if (verbose_) print(at, line);
      }
    }
    while (const auto edit = node_.poll_edit_report()) {
      if (verbose_) print(at, describe(*edit));
    }
    while (const auto notice = node_.poll_feed_notice()) {
      if (verbose_) print(at, describe(*notice));
    }
  }

  void print(HostTime at, const std::optional<LogLine>& line) const {
    if (line) std::cerr << fmt::format("{:10.4f} s  {}\n", to_seconds(at - capture_.begin()), line->text);
  }

  PeerNode& node_;
  record::CaptureReader& capture_;
  bool verbose_;
  std::deque<replication::Send> sent_;  // not yet compared
  Outcome outcome_;
};

// One run of the recorded configuration in the recorded world. Another world would only give differences that nobody
// understands.
struct Recorded {
  config::RunSettings run;
  const config::PeerSettings* peer;
  std::unique_ptr<const SharedWorld> shared;
};

Result<Recorded> read_recorded(const record::Setup& setup, const ReplayOptions& options) {
  config::ScenarioRequest request;
  request.file = setup.file;
  request.text = setup.configuration;
  request.sweep = false;
  auto scenario = config::read_scenario(request);
  if (!scenario) return std::unexpected(scenario.error());
  // The scenario's warnings are about the text in the capture, which nobody can change any more.
  Recorded recorded;
  recorded.run = std::move(scenario->runs.front());
  const auto peer = std::ranges::find(recorded.run.peers, setup.peer, &config::PeerSettings::name);
  if (peer == recorded.run.peers.end()) {
    return std::unexpected(
        InputError{options.file.string() + ": error: its configuration has no peer \"" + setup.peer + "\"", 1});
  }
  recorded.peer = &*peer;
  const std::filesystem::path& world = options.world.empty() ? setup.world : options.world;
  auto shared = share_world(world, setup.reading, {&recorded.run, 1});
  if (!shared) return std::unexpected(shared.error());
  if ((*shared)->world.hash != setup.world_hash) {
    return std::unexpected(
        InputError{"error: " + world.string() + " is not the world that was recorded; say where that is with --world"});
  }
  recorded.shared = *std::move(shared);
  return recorded;
}

nlohmann::ordered_json to_json(const PeerNode& node, const record::CaptureReader& capture, const Outcome& outcome) {
  nlohmann::ordered_json difference = nullptr;
  if (const auto& d = outcome.difference) {
    difference = {{"packet", d->packet}, {"at_s", to_seconds(d->at - capture.begin())}, {"what", d->what}};
  }
  return {{"peer", {{"id", node.peer().id().value}, {"name", node.name()}}},
          {"inputs", outcome.inputs},
          {"datagrams_in", outcome.datagrams_in},
          {"datagrams_out", outcome.datagrams_out},
          {"begin_s", to_seconds(capture.begin().time_since_epoch())},
          {"duration_s", to_seconds(outcome.end - capture.begin())},
          {"cut_off", capture.cut_off()},
          {"same", !outcome.difference},
          {"difference", difference}};
}

void print_outcome(const PeerNode& node, const record::CaptureReader& capture, const Outcome& outcome) {
  const std::string who = fmt::format("peer {} (id {})", node.name(), node.peer().id().value);
  if (const auto& d = outcome.difference) {
    const std::string where = d->packet == 0 ? "after the last packet" : fmt::format("packet {}", d->packet);
    std::cout << fmt::format("{} does something else at {}, {:.6f} s after its begin: {}\n", who, where,
                             to_seconds(d->at - capture.begin()), d->what);
  } else {
    std::cout << fmt::format("{} does what it did for {:.3f} s: {}, {} of them received, and the same {} sent\n", who,
                             to_seconds(outcome.end - capture.begin()), counted(outcome.inputs, "input"),
                             counted(outcome.datagrams_in, "datagram"), counted(outcome.datagrams_out, "datagram"));
  }
  if (capture.cut_off()) std::cout << "the record ends in the middle of a packet: its writer was stopped there\n";
}

}  // namespace

int run_replay(const ReplayOptions& options) {
  const auto file = read_text_file(options.file, {options.size_max_mib * kMiB, "--size-max allows more"});
  if (!file) return failed(file.error());
  auto capture = record::CaptureReader::open(std::as_bytes(std::span(*file)));
  const auto unreadable = [&](const std::string& why) {
    return failed({options.file.string() + ": error: " + why, 1});
  };
  if (!capture) return unreadable(capture.error());
  const auto recorded = read_recorded(capture->setup(), options);
  if (!recorded) return failed(recorded.error());
  auto objects = config::resolve(recorded->run, recorded->shared->world.scene);
  if (!objects) return failed(objects.error());

  auto& own = (*objects)[static_cast<std::size_t>(recorded->peer - recorded->run.peers.data())];
  const auto node = PeerNode::make(*recorded->peer, recorded->run.replication, *recorded->shared, std::move(own),
                                   capture->setup().options);
  if (!options.record.empty() && !capture->setup().options.keep_log) {
    return failed(
        {"error: the peer that was recorded kept no log, and one that does would tick at other times; record "
         "it with --record"});
  }
  const auto outcome = Replay(*node, *capture, options.verbose).run();
  if (!outcome) return unreadable(outcome.error().text);
  if (!options.record.empty()) {
    if (const auto saved = save(node->log(), options.record); !saved) return failed(saved.error());
  }
  if (options.json) {
    std::cout
        << to_json(*node, *capture, *outcome).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
        << '\n';
  } else {
    print_outcome(*node, *capture, *outcome);
  }
  return outcome->difference ? 1 : 0;
}

}  // namespace peerd
