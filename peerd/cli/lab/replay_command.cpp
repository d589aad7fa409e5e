#include "peerd/cli/lab/replay_command.hpp"

#include <iostream>
#include <span>
#include <string>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/cli/shell/print.hpp"
#include "peerd/cli/shell/problems.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/lab/recorded/replay.hpp"
#include "peerd/peer/node/describe.hpp"
#include "peerd/peer/record/capture.hpp"

namespace peerd {
namespace {

using recorded::Replay;

// Prints what the peer says about itself.
class Printer final : public recorded::ReplayWatch {
 public:
  Printer(const PeerNode& node, HostTime begin) : node_(node), begin_(begin) {}

  void on_output(HostTime at, const replication::Output& output) override {
    if (const auto line = describe(output, node_.scene())) on_line(at, *line);
  }
  void on_line(HostTime at, const LogLine& line) override {
    std::cerr << fmt::format("{:10.4f} s  {}\n", to_seconds(at - begin_), line.text);
  }

 private:
  const PeerNode& node_;
  HostTime begin_;
};

nlohmann::ordered_json to_json(const PeerNode& node, const record::CaptureReader& capture,
                               const Replay::Outcome& outcome) {
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

void print_outcome(const PeerNode& node, const record::CaptureReader& capture, const Replay::Outcome& outcome) {
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
    return failed({options.file.string() + ": error: " + why, kFinding});
  };
  if (!capture) return unreadable(capture.error());
  const auto recorded = recorded::make_recorded_peer(
      capture->setup(), record::signatures_in(std::as_bytes(std::span(*file))), options.file, options.world);
  if (!recorded) return failed(recorded.error());
  const auto& node = recorded->node;
  if (!options.record.empty() && !capture->setup().options.keep_log) {
    return failed(
        {"error: the peer that was recorded kept no log, and one that does would tick at other times; record "
         "it with --record"});
  }
  Printer printer(*node, capture->begin());
  const auto outcome = Replay(*recorded, *capture, options.verbose ? &printer : nullptr).run();
  if (!outcome) return unreadable(outcome.error().text);
  if (!options.record.empty()) {
    if (const auto saved = save(node->log(), options.record); !saved) return failed(saved.error());
  }
  if (options.json) {
    std::cout << json_line(to_json(*node, *capture, *outcome)) << '\n';
  } else {
    print_outcome(*node, *capture, *outcome);
  }
  return outcome->difference ? 1 : 0;
}

}  // namespace peerd
