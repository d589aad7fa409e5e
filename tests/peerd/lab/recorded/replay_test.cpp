#include "peerd/lab/recorded/replay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <span>
#include <string>

#include "tests/must.hpp"
#include "tests/peerd/lab/recorded/recorded_run.hpp"

namespace peerd::recorded::replay_test {

using testing::HasSubstr;
using testing_support::SimulatedFolder;
using testing_support::text_of;

const std::string kSnooker = PEERD_SOURCE_DIR "/configs/scenarios/snooker.toml";

struct Looker final : ReplayWatch {
  void before(HostTime at) override {
    EXPECT_GE(at, last);
    last = at;
    ++inputs;
  }
  void on_output(HostTime /*at*/, const replication::Output& /*output*/) override { ++outputs; }
  void on_line(HostTime /*at*/, const LogLine& /*line*/) override {}
  HostTime last = HostTime::min();
  std::size_t inputs = 0, outputs = 0;
};

TEST(Replay, TellsWhoLooksOnOfEachInput) {
  const SimulatedFolder folder(kSnooker, "", SimulatedFolder::Captures::kAll);
  const std::string bytes = text_of(folder.captures() / "a.pcapng");
  auto capture = must(record::CaptureReader::open(std::as_bytes(std::span(bytes))));
  const RecordedPeer peer = must(make_recorded_peer(capture.setup(), {}, "a.pcapng", {}));
  EXPECT_EQ(peer.node->name(), "a");
  Looker looker;
  const Replay::Outcome outcome = must(Replay(peer, capture, &looker).run());
  EXPECT_FALSE(outcome.difference);
  EXPECT_EQ(looker.inputs, outcome.inputs);
  EXPECT_GT(looker.outputs, outcome.datagrams_out);
  EXPECT_EQ(looker.last, outcome.end);
}

TEST(Replay, NeedsTheWorldThatWasRecorded) {
  const SimulatedFolder folder(kSnooker, "", SimulatedFolder::Captures::kAll);
  const std::string bytes = text_of(folder.captures() / "a.pcapng");
  const auto capture = must(record::CaptureReader::open(std::as_bytes(std::span(bytes))));
  EXPECT_THAT(
      error_of(make_recorded_peer(capture.setup(), {}, "a.pcapng", PEERD_SOURCE_DIR "/configs/worlds/eq47.wrl")).text,
      HasSubstr("is not the world that was recorded"));
}

}  // namespace peerd::recorded::replay_test
