// The real program: peers as processes of their own, on real multicast over lo.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <regex>

#include "peerd/lab/live/assemble.hpp"
#include "peerd/lab/measure/summary.hpp"
#include "peerd/net/keys/key_file.hpp"
#include "tests/must.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/process.hpp"
#include "tests/net/wire.hpp"

namespace peerd::run_command_test {

using net::testing_support::own_port;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::Process;
using testing_support::ScratchFolder;

using Words = std::vector<std::string>;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF CAR Transform { children Shape { geometry Box { } } }
DEF CUBE Transform { translation 0 50 0 velocityVector 0 0 1 children Shape { geometry Box { } } }
DEF WALL Transform { translation 9 0 0 children Shape { geometry Box { } } }
CollisionInterest { objectPath "CAR" interests "WALL" collisionType 1 }
)";

// CAR turns round after a second; it does not reach the wall.
constexpr const char* kScenario = R"toml(world = "w.wrl"
duration_s = 3

[replication]
error_threshold_m = 0.05

[peer.a]
id = 1
owns = ["CAR"]
[peer.a.motion.CAR]
x = "2*abs(t - 1)"
z = "-3*t"

[peer.b]
id = 2

[peer.c]
id = 3
owns = ["CUBE"]
)toml";

// Each test uses a port of its own: slots 0 to 9 of this process.
class PeerProcess : public testing::Test {
 protected:
  PeerProcess() {
    folder.write("w.wrl", kWorld);
    folder.write("s.toml", kScenario);
  }
  Process start(const std::string& name, Words arguments) {
    return Process(folder, name, PEERD_PROGRAM, std::move(arguments));
  }
  Process start_peer(const std::string& name, unsigned slot, const Words& more = {}) {
    Words words{"run", "--config", (folder / "s.toml").string(),  "--peer", name, "--interface",
                "lo",  "--port",   std::to_string(own_port(slot))};
    words.insert(words.end(), more.begin(), more.end());
    return start(name, words);
  }
  // The record assembled from the peers' records.
  nlohmann::ordered_json summary_of(const Words& names, const Words& sets) {
    const auto scenario = must(config::read_scenario(
        {.file = folder / "s.toml", .configs = {}, .sets = sets, .seed = {}, .real = true, .sweep = true}));
    config::RunSettings run = scenario.runs.front();
    std::erase_if(run.peers, [&](const auto& p) { return std::ranges::find(names, p.name) == names.end(); });
    const auto shared = share_world(scenario.world);
    std::vector<PeerLog> logs;
    for (const std::string& name : names) {
      auto log = load_peer_log(record_of(name));
      EXPECT_TRUE(log) << log.error().text;
      if (log) logs.push_back(std::move(*log));
    }
    auto record = assemble(run, **shared, logs);
    if (!record) {
      ADD_FAILURE() << record.error().text;
      return {};
    }
    return measure::summarise({"s", "real", 1, {}}, {&*record, 1})["runs"][0];
  }
  [[nodiscard]] std::string record_of(const std::string& name) const { return (folder / (name + ".rows")).string(); }

  ScratchFolder folder;
};

std::string joined(const std::string& name, int id) {
  return "peer " + name + " (id " + std::to_string(id) + ") joined";
}

double mean_error_m(const nlohmann::ordered_json& summary, const std::string& observer, const std::string& path) {
  for (const auto& o : summary["objects"]) {
    if (o["observer"] == observer && o["path"] == path) {
      EXPECT_GT(o["samples"].get<int>(), 50);
      return o["ghost_error_m"]["mean"].get<double>();
    }
  }
  ADD_FAILURE() << observer << " has seen nothing of " << path;
  return -1;
}

TEST_F(PeerProcess, ThreeShareAWorldAndLeaveWhenItIsOver) {
  Process a = start_peer("a", 0, {"--once", "--record", record_of("a")});
  Process b = start_peer("b", 0, {"--once", "--record", record_of("b")});
  Process c = start_peer("c", 0, {"--once", "--record", record_of("c")});
  for (Process* p : {&a, &b, &c}) {
    EXPECT_EQ(p->exit_code(15), 0) << p->out() << p->err();
    EXPECT_EQ(p->err(), "");
    EXPECT_THAT(p->out(), HasSubstr("in session"));
    EXPECT_THAT(p->out(), HasSubstr("leaving: the scenario is over"));
    EXPECT_THAT(p->out(), Not(HasSubstr("undecodable"))) << "nothing strange on a port of our own";
  }
  EXPECT_THAT(a.out(), AllOf(HasSubstr(joined("b", 2)), HasSubstr(joined("c", 3))));
  EXPECT_THAT(b.out(), AllOf(HasSubstr(joined("a", 1)), HasSubstr(joined("c", 3))));
  EXPECT_THAT(c.out(), AllOf(HasSubstr(joined("a", 1)), HasSubstr(joined("b", 2))));
  const auto summary = summary_of({"a", "b", "c"}, {});
  for (const char* observer : {"b", "c"}) {
    EXPECT_LT(mean_error_m(summary, observer, "CAR"), 0.2) << "the threshold of 0.05 m and what one computer delays";
  }
  EXPECT_LT(mean_error_m(summary, "a", "CUBE"), 0.05);
  EXPECT_TRUE(summary["state_roots_equal"]);
}

TEST_F(PeerProcess, ClocksThatDifferByThreeSecondsAgree) {
  folder.write("s.toml", std::string(kScenario).substr(0, std::string(kScenario).find("[peer.b]")) +
                             "[peer.c]\nid = 3\nowns = [\"CUBE\"]\n");
  const Words sets{"peer.a.clock_offset_s=-1", "peer.c.clock_offset_s=2", "duration_s=2"};
  const auto more = [&](const std::string& name) {
    Words words{"--once", "--record", record_of(name)};
    for (const auto& s : sets) words.insert(words.end(), {"--set", s});
    return words;
  };
  Process a = start_peer("a", 1, more("a"));
  Process c = start_peer("c", 1, more("c"));
  EXPECT_EQ(a.exit_code(15), 0) << a.out() << a.err();
  EXPECT_EQ(c.exit_code(15), 0) << c.out() << c.err();
  const auto summary = summary_of({"a", "c"}, sets);
  EXPECT_LT(mean_error_m(summary, "c", "CAR"), 0.2) << "3 s would be 9 m";
  EXPECT_LT(mean_error_m(summary, "a", "CUBE"), 0.05);
}

TEST_F(PeerProcess, AKilledPeerIsLostAndATerminatedOneLeavesAtOnce) {
  Process a = start_peer("a", 2), b = start_peer("b", 2), c = start_peer("c", 2);
  ASSERT_TRUE(a.says(joined("c", 3), 5) && b.says(joined("c", 3), 5) && a.says("in session", 5) &&
              b.says("in session", 5) && c.says("in session", 5))
      << a.out() << b.out() << c.out();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // c's hellos say now what it runs

  const auto killed = std::chrono::steady_clock::now();
  c.signal(SIGKILL);
  for (Process* p : {&a, &b}) {
    EXPECT_TRUE(p->says("peer c (id 3) is lost", 4)) << p->out();
    EXPECT_TRUE(p->says("CUBE stands still: its owner, peer 3, is gone", 1)) << p->out();
  }
  const std::chrono::duration<double> noticed = std::chrono::steady_clock::now() - killed;
  EXPECT_LT(noticed.count(), 2.0 + 0.2) << "2 s, and what this test takes to read it";
  EXPECT_EQ(c.exit_code(1), -1);

  const auto asked = std::chrono::steady_clock::now();
  a.signal(SIGTERM);
  EXPECT_EQ(a.exit_code(2), 0);
  EXPECT_TRUE(b.says("peer a (id 1) left", 2)) << b.out();
  const std::chrono::duration<double> left = std::chrono::steady_clock::now() - asked;
  EXPECT_LT(left.count(), 0.5) << "a goodbye, not a silence";
  EXPECT_THAT(b.out(), HasSubstr("CAR stands still"));
  EXPECT_THAT(b.out(), Not(HasSubstr("peer a (id 1) is lost")));
  EXPECT_THAT(a.out(), HasSubstr("leaving: got SIGTERM"));
  EXPECT_TRUE(b.running());
  b.signal(SIGINT);
  EXPECT_EQ(b.exit_code(2), 0);
  EXPECT_THAT(b.out(), HasSubstr("leaving: got SIGINT"));
}

// Worlds from before VRML97 was UTF-8 throughout: what is not has a sign of its own in JSON.
TEST_F(PeerProcess, NamesThatAreNotUtf8DoNotEndAPeerThatLogsJson) {
  folder.write("w.wrl",
               "#VRML V2.0 utf8\nDEF CAF\xC9 Transform { velocityVector 0 0 1 children Shape { geometry Box { } } }\n");
  folder.write("s.toml", "world = \"w.wrl\"\nduration_s = 1\n[peer.a]\nid = 1\nowns = [\"CAF*\"]\n");
  Process a = start_peer("a", 6, {"--json", "--verbose", "--once"});
  EXPECT_EQ(a.exit_code(10), 0) << a.out() << a.err();
  EXPECT_THAT(a.out(), HasSubstr("update of CAF\xEF\xBF\xBD"));
  EXPECT_TRUE(nlohmann::json::accept(a.out().substr(0, a.out().find('\n')))) << a.out();
  Process sim = start("sim", {"sim", (folder / "s.toml").string(), "--json", "--out", (folder / "out").string()});
  EXPECT_EQ(sim.exit_code(10), 0) << sim.err();
  EXPECT_TRUE(nlohmann::json::accept(sim.out())) << sim.out();
}

// Random bytes, and real datagrams with bytes of them changed.
class Garbage : public PeerProcess {
 protected:
  // Sends two peers random bytes, and real datagrams with some bytes changed, and ends them. What they have logged.
  Words logs_of_two(unsigned slot, const Words& options) {
    boost::asio::io_context io;
    net::testing_support::Listener outsider(
        io, {.interface = "lo", .groups = {boost::asio::ip::make_address("239.192.80.0"), own_port(slot)}});
    outsider.join(0);
    Process a = start_peer("a", slot, options), c = start_peer("c", slot, options);
    EXPECT_TRUE(net::testing_support::run_until(io, [&] { return outsider.heard.size() >= 20; })) << a.out();
    const auto real = outsider.heard;
    std::mt19937_64 random(1);
    std::string bytes;
    for (int i = 0; i < kEach; ++i) {
      bytes.resize(random() % 1500);
      for (char& byte : bytes) byte = static_cast<char>(random());
      outsider.send(0, bytes);
      bytes = real[random() % real.size()].second;
      for (int changes = 0; changes < 3 && !bytes.empty(); ++changes) {
        bytes[random() % bytes.size()] = static_cast<char>(random());
      }
      outsider.send(0, bytes);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    Words logs;
    for (Process* p : {&a, &c}) {
      EXPECT_TRUE(p->running()) << p->out() << p->err();
      p->signal(SIGTERM);
      EXPECT_EQ(p->exit_code(2), 0) << p->out() << p->err();
      logs.push_back(p->out());
    }
    return logs;
  }
  // The number behind the words in a log; 0: they are not in it.
  static int count_of(const std::string& log, const std::string& before, const std::string& behind) {
    std::smatch found;
    return std::regex_search(log, found, std::regex(before + "([0-9]+)" + behind)) ? std::stoi(found[1]) : 0;
  }
  static constexpr int kEach = 200;
};

TEST_F(Garbage, IsCountedAndDroppedBeforeItIsRead) {
  for (const std::string& log : logs_of_two(3, {})) {
    int refused = 0;
    for (const char* const why : {"forged", "open", "other_epoch"}) {
      refused += count_of(log, std::string("net.in_") + why + ": ", "");
    }
    EXPECT_GE(refused, kEach * 3 / 2) << log;
    EXPECT_EQ(count_of(log, "dropped ", ": undecodable"), 0) << log;
    EXPECT_THAT(log, HasSubstr("sends datagrams that this peer's key does not open"));
    EXPECT_THAT(log, Not(HasSubstr("peerd-key-1:"))) << "the key is in no log";
  }
}

TEST_F(Garbage, IsCountedAndDroppedByOpenPeersToo) {
  for (const std::string& log : logs_of_two(4, {"--open"})) {
    EXPECT_GE(count_of(log, "dropped ", ": undecodable"), kEach * 9 / 10) << "random bytes hardly ever make a datagram";
    EXPECT_THAT(log, HasSubstr("open: whoever is on this network can listen, and speak as any peer"));
  }
}

// Two peers share a key; a third one has another, and a fourth none.
TEST_F(PeerProcess, WhoHasAnotherKeyIsNotHeard) {
  const std::string other = (folder / "other.key").string();
  ASSERT_TRUE(keys::read_or_make_key(other));
  Process a = start_peer("a", 5), b = start_peer("b", 5);
  const auto unheard_peer = [&](const std::string& name, Words words) {
    const Words usual{"run", "--config", (folder / "s.toml").string(), "--peer",    "c", "--interface",
                      "lo",  "--port",   std::to_string(own_port(5)),  "--control", ""};
    words.insert(words.begin(), usual.begin(), usual.end());
    return start(name, words);
  };
  Process c = unheard_peer("c", {"--key", other}), open = unheard_peer("open", {"--open"});
  ASSERT_TRUE(a.says("peer b (id 2) joined", 10)) << a.out();
  ASSERT_TRUE(a.says("sends datagrams that are not sealed", 10)) << a.out();
  ASSERT_TRUE(a.says("sends datagrams that this peer's key does not open", 10)) << a.out();
  for (Process* each : {&a, &b, &c, &open}) {
    EXPECT_THAT(each->out(), Not(HasSubstr("peer c (id 3) joined")));
    each->signal(SIGTERM);
    EXPECT_EQ(each->exit_code(5), 0) << each->out();
  }
  EXPECT_THAT(c.out(), Not(HasSubstr("joined")));
  EXPECT_THAT(open.out(), Not(HasSubstr("joined")));
}

TEST_F(PeerProcess, AScenarioOfRealProcessesWritesItsReport) {
  Process all = start("scenario", {"scenario", (folder / "s.toml").string(), "--set", "duration_s=1", "--set",
                                   "peer.c.owns=[\"CUBE\", \"WALL\"]", "--out", (folder / "out").string()});
  ASSERT_EQ(all.exit_code(20), 0) << all.out() << all.err();
  const auto summary = nlohmann::json::parse(testing_support::text_of(folder / "out/summary.json"));
  EXPECT_EQ(summary["mode"], "real");
  EXPECT_EQ(summary["runs"][0]["params"]["peer.c.owns"], nlohmann::json({"CUBE", "WALL"}));
  EXPECT_EQ(summary["runs"][0]["objects"].size(), 3u * 2);
  for (const char* file : {"errors.csv", "traffic.csv", "collisions.csv", "report.html"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / "out" / file)) << file;
  }
}

TEST_F(PeerProcess, AScenarioThatIsStoppedOrKilledTakesItsPeersWithIt) {
  const auto peer_says = [&](const char* words) {
    const auto log = folder / "out/run-001.a.log";
    return testing_support::comes_true([&] { return testing_support::text_of(log).find(words) != std::string::npos; },
                                       10);
  };
  for (const int signal : {SIGTERM, SIGKILL}) {
    SCOPED_TRACE(signal);
    std::filesystem::remove_all(folder / "out");
    Process all = start("scenario", {"scenario", (folder / "s.toml").string(), "--out", (folder / "out").string()});
    ASSERT_TRUE(peer_says("in session"));
    all.signal(signal);
    EXPECT_TRUE(peer_says("leaving: got SIGTERM"));
    if (signal == SIGKILL) continue;
    EXPECT_EQ(all.exit_code(5), 3);
    EXPECT_THAT(all.err(), HasSubstr("stopped by a signal"));
  }
}

TEST_F(PeerProcess, APeerThatRunsAlreadyIsNotStartedASecondTime) {
  Process a = start_peer("a", 0), b = start_peer("b", 0);
  ASSERT_TRUE(b.says(joined("a", 1), 10)) << b.out() << b.err();
  Process again = start("again", {"run", "--config", (folder / "s.toml").string(), "--peer", "a", "--interface", "lo",
                                  "--port", std::to_string(own_port(0))});
  EXPECT_EQ(again.exit_code(10), 3) << again.out() << again.err();
  EXPECT_THAT(again.out(), HasSubstr("peer a (id 1) is running already"));
  EXPECT_TRUE(a.running()) << a.out();
  Process successor = start("successor", {"run", "--config", (folder / "s.toml").string(), "--peer", "a", "--interface",
                                          "lo", "--port", std::to_string(own_port(0)), "--take-over"});
  EXPECT_EQ(a.exit_code(10), 3) << a.err();
  EXPECT_THAT(a.out(), HasSubstr("another program has taken over as peer 1"));
  EXPECT_TRUE(b.says("peer a (id 1) restarted", 10)) << b.out();
  successor.signal(SIGKILL);  // nobody answers for it
  Process third = start("third", {"run", "--config", (folder / "s.toml").string(), "--peer", "a", "--interface", "lo",
                                  "--port", std::to_string(own_port(0))});
  EXPECT_TRUE(third.says(joined("b", 2), 10)) << third.out() << third.err();
}

TEST_F(PeerProcess, APeerSaysForWhomItWaits) {
  Process a = start_peer("a", 0), b = start_peer("b", 0);
  EXPECT_TRUE(a.says("waits for peer c (id 3): nothing moves before", 10)) << a.out() << a.err();
  Process c = start_peer("c", 0);
  EXPECT_TRUE(a.says("all peers are here, and motions begin", 10)) << a.out() << a.err();
}

TEST_F(PeerProcess, ALogThatNobodyReadsIsAReasonToLeave) {
  const std::string socket = (folder / "a.sock").string();
  const std::string command = std::string(PEERD_PROGRAM) + " run --config " + (folder / "s.toml").string() +
                              " --peer a --interface lo --port " + std::to_string(own_port(0)) +
                              " --verbose --record " + record_of("a") + " --control " + socket + " | head -3";
  Process piped(folder, "piped", "/bin/sh", {"-c", command});
  EXPECT_EQ(piped.exit_code(20), 0) << piped.err();
  EXPECT_EQ(std::ranges::count(piped.out(), '\n'), 3) << piped.out();
  EXPECT_TRUE(load_peer_log(record_of("a"))) << "its record is whole";
  EXPECT_FALSE(std::filesystem::exists(socket));
}

// ---- bad input ----

struct Bad {
  const char* name;
  Words arguments;  // in the scratch folder: @ stands for it
  int exit_code;
  const char* word;
  bool one_line = true;
};
class BadInput : public PeerProcess, public testing::WithParamInterface<Bad> {};
TEST_P(BadInput, IsOneSentenceAndAnExitCode) {
  folder.write("malformed.toml", "world = \"w.wrl\"\n[peer.a\nid = 1\n");
  folder.write("unknown_key.toml", std::string("duratoin_s = 3\n") + kScenario);
  folder.write("bad.wrl", "#VRML V2.0 utf8\nDEF CAR Transform { translation 1 2 }\n");
  folder.write("bad_world.toml", "world = \"bad.wrl\"\n[peer.a]\nid = 1\n");
  folder.write("no_world.toml", "world = \"none.wrl\"\n[peer.a]\nid = 1\n");
  folder.write("empty.toml", "");
  folder.write("file", "");
  Words words = GetParam().arguments;
  for (std::string& word : words) {
    if (const auto at = word.find('@'); at != std::string::npos) word.replace(at, 1, folder.path().string());
    if (const auto at = word.find("PORT"); at != std::string::npos) word.replace(at, 4, std::to_string(own_port(9)));
  }
  boost::asio::io_context io;
  const boost::asio::ip::udp::socket greedy(io,
                                            {boost::asio::ip::udp::v4(), own_port(9)});  // shares its port with nobody
  Process p = start("p", words);
  EXPECT_EQ(p.exit_code(10), GetParam().exit_code) << p.out() << p.err();
  EXPECT_THAT(p.err(), HasSubstr(GetParam().word));
  EXPECT_THAT(p.err(), Not(HasSubstr("terminate")));
  if (GetParam().one_line) {
    EXPECT_EQ(std::ranges::count(p.err(), '\n'), 1) << p.err();
  }
}
INSTANTIATE_TEST_SUITE_P(
    Table, BadInput,
    testing::Values(
        Bad{"NothingToRun", {"run"}, 2, "--config FILE"}, Bad{"NoScenario", {"sim"}, 2, "scenario is required", false},
        Bad{"SetWithoutValue", {"sim", "@/s.toml", "--set", "duration_s"}, 2, "KEY=VALUE"},
        Bad{"NoSuchScenario", {"sim", "@/none.toml"}, 2, "none.toml: error: there is no such file"},
        Bad{"NoSuchConfiguration", {"run", "--config", "@/none.toml"}, 2, "none.toml: error: there is no such file"},
        Bad{"NoSuchOverlay", {"sim", "@/s.toml", "--config", "@/none.toml"}, 2, "none.toml"},
        Bad{"ScenarioIsAFolder", {"sim", "@"}, 3, "can't be read"},
        Bad{"EmptyScenario", {"sim", "@/empty.toml"}, 2, "world is missing"},
        Bad{"MalformedToml", {"run", "--config", "@/malformed.toml"}, 2, "malformed.toml:2:8: error: "},
        Bad{"UnknownKey", {"sim", "@/unknown_key.toml"}, 2, "unknown_key.toml:1:1: error: unknown key duratoin_s"},
        Bad{"NoSuchWorld", {"sim", "@/no_world.toml"}, 2, "none.wrl: error: there is no such file"},
        Bad{"MalformedWorld", {"sim", "@/bad_world.toml"}, 1, "bad.wrl:2:", false},
        Bad{"MalformedWorldOfAPeer", {"run", "--world", "@/bad.wrl"}, 1, "bad.wrl:2:", false},
        Bad{"UnknownObject", {"run", "--world", "@/w.wrl", "--own", "CARR"}, 2, "did you mean \"CAR\"?"},
        Bad{"UnknownObjectByTheOptionsOldName",
            {"run", "--world", "@/w.wrl", "--enslave", "CARR"},
            2,
            "warning: --enslave is now called --own\nerror: ",
            false},
        Bad{"BothNamesOfAnOption",
            {"run", "--world", "@/w.wrl", "--enslave", "CAR", "--own", "CAR"},
            2,
            "--enslave and --own are two names of one option"},
        Bad{"BothNamesOfAKey",
            {"sim", "@/s.toml", "--set", "peer.a={id = 1, enslaves = [], owns = []}"},
            2,
            "peer.a.enslaves and peer.a.owns are two names of one key"},
        Bad{"UnknownPeer",
            {"run", "--config", "@/s.toml", "--peer", "d"},
            2,
            "there is no peer \"d\"; there are a, b, c"},
        Bad{"WhichPeer", {"run", "--config", "@/s.toml"}, 2, "--peer NAME; there are a, b, c"},
        Bad{"UnknownInterface", {"run", "--world", "@/w.wrl", "--interface", "nosuch9"}, 3, "\"nosuch9\""},
        Bad{"UnknownInterfaceOfAScenario",
            {"scenario", "@/s.toml", "--interface", "nosuch9", "--out", "@/out"},
            3,
            "\"nosuch9\"",
            false},
        Bad{"NoMulticastGroup", {"run", "--world", "@/w.wrl", "--group", "10.0.0.1"}, 2, "10.0.0.1"},
        Bad{"NoMulticastThere", {"run", "--world", "@/w.wrl", "--group", "ff15::1:0:0", "--interface", "lo"}, 3, "lo"},
        Bad{"PortBusy",
            {"run", "--world", "@/w.wrl", "--interface", "lo", "--port", "PORT"},
            3,
            "is held by another program"},
        Bad{"WrongFormula",
            {"sim", "@/s.toml", "--set", "peer.a.motion.CAR.x=sin("},
            2,
            "peer.a.motion.CAR: formula \"sin(\""},
        Bad{"OutputIsAFile", {"sim", "@/s.toml", "--out", "@/file"}, 3, "file"},
        Bad{"OutputInNothing", {"sim", "@/s.toml", "--out", "/proc/none"}, 3, "/proc/none"}),
    [](const auto& c) { return std::string(c.param.name); });

TEST_F(PeerProcess, OptionsDoNotSwallowTheScenario) {
  folder.write("over.toml", "duration_s = 0.5\n");
  Process sim = start("sim", {"sim", "--config", (folder / "over.toml").string(), "--set", "seed=3", "--out",
                              (folder / "out").string(), (folder / "s.toml").string()});
  EXPECT_EQ(sim.exit_code(10), 0) << sim.err();
}

TEST_F(PeerProcess, TwoMeetOverIpv6) {
  net::testing_support::with_wire([&](const net::testing_support::Wire& wire) {
    const auto peer = [&](const std::string& name, const std::string& interface) {
      return start(name, {"run", "--config", (folder / "s.toml").string(), "--peer", name, "--interface", interface,
                          "--group", "ff15::50:0", "--port", std::to_string(own_port(5))});
    };
    wire.left.enter();
    Process a = peer("a", "va");
    wire.right.enter();
    Process c = peer("c", "vb");
    EXPECT_TRUE(a.says(joined("c", 3), 5)) << a.out() << a.err();
    EXPECT_TRUE(c.says(joined("a", 1), 5)) << c.out() << c.err();
    EXPECT_TRUE(c.says("in session: follows the clock of peer 1", 5)) << c.out();
    a.signal(SIGTERM);
    EXPECT_EQ(a.exit_code(2), 0);
    EXPECT_TRUE(c.says("peer a (id 1) left", 2)) << c.out();
    c.signal(SIGTERM);
    EXPECT_EQ(c.exit_code(2), 0);
  });
}

}  // namespace peerd::run_command_test
