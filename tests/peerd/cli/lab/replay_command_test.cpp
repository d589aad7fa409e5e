// A peer that runs again on its capture does all that it did.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>
#include <sstream>

#include "peerd/cli/lab/replay_command.hpp"
#include "peerd/peer/record/pcapng.hpp"
#include "peerd/peer/record/udp_packet.hpp"
#include "tests/peerd/scratch_folder.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::replay_command_test {

using peerd::testing_support::ScratchFolder;
using peerd::testing_support::text_of;
using testing::HasSubstr;

// Captures what a command prints during its lifetime.
class Printed {
 public:
  Printed() : out_(std::cout.rdbuf(text_.rdbuf())), error_(std::cerr.rdbuf(errors_.rdbuf())) {}
  Printed(const Printed&) = delete;
  Printed& operator=(const Printed&) = delete;
  ~Printed() {
    std::cout.rdbuf(out_);
    std::cerr.rdbuf(error_);
  }
  [[nodiscard]] std::string text() const { return text_.str(); }
  [[nodiscard]] std::string errors() const { return errors_.str(); }

 private:
  std::ostringstream text_, errors_;
  std::streambuf *out_, *error_;
};

struct Replayed {
  int code;
  nlohmann::json json;
  std::string error;
};
Replayed replay(const std::filesystem::path& file, const std::filesystem::path& record = {},
                const std::filesystem::path& world = {}) {
  const Printed printed;
  return {.code = run_replay({.file = file, .world = world, .record = record, .json = true}),
          .json = nlohmann::json::parse(printed.text(), nullptr, false),
          .error = printed.errors()};
}

struct Case {
  const char *name, *scenario;
  std::vector<std::string> sets;
};

// The first run of a scenario: its logs, and with a folder its captures.
std::vector<PeerLog> run(const std::filesystem::path& file, const std::vector<std::string>& sets,
                         const std::filesystem::path& folder = {}) {
  const config::Scenario scenario = testing_support::scenario_of(file, sets);
  const auto shared = must(share_world(scenario.world, scenario.reading));
  const Captures captures{folder, scenario, file};
  return must(simulate(scenario.runs.front(), *shared, {}, {}, nullptr, folder.empty() ? nullptr : &captures));
}

class Replay : public testing::TestWithParam<Case> {};
TEST_P(Replay, DoesWhatThePeerDid) {
  const auto& [name, scenario, sets] = GetParam();
  const ScratchFolder folder;
  const std::string file = PEERD_SOURCE_DIR "/configs/scenarios/" + std::string(scenario);
  const auto logs = run(file, sets, folder.path()), plain = run(file, sets);
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const PeerLog& log = logs[i];
    SCOPED_TRACE("peer " + log.name);
    const Replayed again = replay(folder / (log.name + ".pcapng"), folder / "again");
    EXPECT_EQ(again.code, 0) << again.error << again.json.dump();
    EXPECT_EQ(again.json["same"], true);
    EXPECT_EQ(again.json["datagrams_out"], log.counters.at("datagrams_out"));
    EXPECT_EQ(again.json["datagrams_in"], log.counters.at("datagrams_in"));
    ASSERT_TRUE(save(log, folder / "once"));
    EXPECT_TRUE(text_of(folder / "once") == text_of(folder / "again"))
        << "what it believed and decided, contacts and counters included";
    ASSERT_TRUE(save(plain[i], folder / "plain"));
    EXPECT_TRUE(text_of(folder / "once") == text_of(folder / "plain")) << "to be recorded changes nothing";
  }
}
INSTANTIATE_TEST_SUITE_P(
    Scenario, Replay,
    testing::Values(
        Case{"RoughNetwork",
             "eq47.toml",
             {"network.latency_ms=40", "network.jitter_ms=30", "network.loss=0.1", "network.reordering=0.1",
              "network.duplication=0.05", "duration_s=6", "replication.approach=dr+rcp+acpt", "replication.order=2",
              "peer.a.clock_offset_s=-2", "peer.b.clock_offset_s=1.5"}},
        Case{"Regions", "flock-regions.toml", {"duration_s=4"}}, Case{"Physics", "snooker.toml", {"duration_s=3"}},
        Case{"Decisions", "head-on.toml", {"decisions.policy=id", "decisions.compare=false", "duration_s=4"}},
        Case{"Keys", "keys.toml", {}},
        Case{"GroupsShared", "flock-regions.toml", {"duration_s=2", "transport.group_pool=3"}},
        Case{"Ipv6", "keys.toml", {"transport.group=ff15::1:0:0"}}),
    [](const auto& c) { return std::string(c.param.name); });

class ReplayOfOne : public testing::Test {
 protected:
  ReplayOfOne() {
    folder.write("w.wrl", R"(#VRML V2.0 utf8
DEF CAR Transform { children Shape { geometry Box { } } }
)");
    folder.write("s.toml", R"toml(world = "w.wrl"
duration_s = 1
[replication]
error_threshold_m = 0.05
[network]
latency_ms = 20
[peer.a]
id = 1
owns = ["CAR"]
[peer.a.motion.CAR]
x = "2*sin(3*t)"
[peer.b]
id = 2
)toml");
    (void)run(folder / "s.toml", {}, folder.path());
  }

  // The packets of a's capture, passed through `change` (false: left out), as a file.
  template <class Change>
  std::filesystem::path changed(Change change) {
    const std::string file = text_of(folder / "a.pcapng");
    std::ofstream out(folder / "changed.pcapng", std::ios::binary);
    record::PcapngWriter writer(out, "test", "");
    writer.interface(record::LinkType::kRawIp, "network", "");
    writer.interface(record::LinkType::kUser0, "inputs", "");
    record::PcapngReader reader(std::as_bytes(std::span(file)));
    for (int number = 1;; ++number) {
      const auto packet = reader.next();
      if (!packet || !*packet) break;
      std::vector<std::byte> bytes((*packet)->bytes.begin(), (*packet)->bytes.end());
      if (!change(number, **packet, bytes)) continue;
      writer.packet((*packet)->link == record::LinkType::kRawIp ? 0 : 1, (*packet)->at, (*packet)->direction, bytes);
    }
    return folder / "changed.pcapng";
  }

  ScratchFolder folder;
};

TEST_F(ReplayOfOne, ACopyThatChangesNothingIsTheSame) {
  const Replayed again = replay(changed([](auto&&...) { return true; }));
  EXPECT_EQ(again.code, 0) << again.error << again.json.dump();
}

// The last byte of the tenth datagram sent.
TEST_F(ReplayOfOne, OneByteThatDiffersIsFound) {
  int sent = 0, number_of_it = 0;
  std::size_t last = 0;
  const auto file = changed([&](int number, const record::PcapngPacket& p, std::vector<std::byte>& bytes) {
    if (p.direction != record::Direction::kOut || ++sent != 10) return true;
    const auto udp = record::decode_udp_packet(p.bytes);
    std::vector<std::byte> payload(udp->payload.begin(), udp->payload.end());
    payload.back() ^= std::byte{1};
    last = payload.size() - 1;
    bytes = record::encode({udp->from, udp->to, payload});
    number_of_it = number;
    return true;
  });
  const Replayed again = replay(file);
  EXPECT_EQ(again.code, 1);
  EXPECT_EQ(again.json["same"], false);
  EXPECT_EQ(again.json["difference"]["packet"], number_of_it);
  EXPECT_THAT(again.json["difference"]["what"].get<std::string>(),
              HasSubstr("the first byte that differs is number " + std::to_string(last)));
}

TEST_F(ReplayOfOne, ADatagramThatWasNotSentIsFound) {
  int sent = 0;
  const Replayed again = replay(changed([&](int, const record::PcapngPacket& p, auto&) {
    return p.direction != record::Direction::kOut || ++sent != 10;
  }));
  EXPECT_EQ(again.code, 1);
  EXPECT_THAT(again.json["difference"]["what"].get<std::string>(), HasSubstr("that it did not send"));
}

TEST_F(ReplayOfOne, InputThatIsMissingMakesAnotherPeer) {
  int heard = 0;
  const Replayed again = replay(changed([&](int, const record::PcapngPacket& p, auto&) {
    return p.link != record::LinkType::kRawIp || p.direction != record::Direction::kIn || ++heard != 2;
  }));
  EXPECT_EQ(again.code, 1);
}

// Captures of earlier versions have the names that keys had then.
TEST_F(ReplayOfOne, OldNamesOfKeysInItsHeadAreUnderstood) {
  bool renamed = false;
  const auto file = changed([&](int number, const record::PcapngPacket&, std::vector<std::byte>& bytes) {
    if (number != 1) return true;
    std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string now = "owns = ", old = "enslaves = ";
    const auto at = text.find(now);
    renamed = at != std::string::npos;
    if (renamed) text.replace(at, now.size(), old);
    const auto changed_bytes = std::as_bytes(std::span(text));
    bytes.assign(changed_bytes.begin(), changed_bytes.end());
    return true;
  });
  ASSERT_TRUE(renamed);
  const Replayed again = replay(file);
  EXPECT_EQ(again.code, 0) << again.error << again.json.dump();
  EXPECT_GT(again.json["datagrams_out"], 0);
}

TEST_F(ReplayOfOne, WhereTheRecordIsCutOffWhatIsThereIsTheSame) {
  const std::string file = text_of(folder / "a.pcapng");
  folder.write("cut.pcapng", file.substr(0, file.size() / 2 + 1));
  const Replayed again = replay(folder / "cut.pcapng");
  EXPECT_EQ(again.code, 0) << again.json.dump();
  EXPECT_EQ(again.json["cut_off"], true);
}

TEST_F(ReplayOfOne, TheWorldMustBeTheOneThatWasRecorded) {
  std::filesystem::rename(folder / "w.wrl", folder / "elsewhere.wrl");
  EXPECT_EQ(replay(folder / "a.pcapng").code, 2) << "there is none";
  EXPECT_EQ(replay(folder / "a.pcapng", {}, folder / "elsewhere.wrl").code, 0);
  folder.write("w.wrl", "#VRML V2.0 utf8\nDEF CAR Transform { children Shape { geometry Sphere { } } }\n");
  const Replayed other = replay(folder / "a.pcapng");
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.error, HasSubstr("--world"));
}

TEST_F(ReplayOfOne, NoCaptureIsAFindingAboutTheFile) {
  const Replayed text = replay(folder / "s.toml");
  EXPECT_EQ(text.code, 1);
  EXPECT_THAT(text.error, HasSubstr("no pcapng file"));
}

}  // namespace peerd::sim::replay_command_test
