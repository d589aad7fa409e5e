// Wireshark, with peerd/packaging/peerd.lua, says of every datagram what our own decoder says; and of no other bytes
// that they are sound. Two programs that share no code: tshark is asked for all fields of whole captures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "peerd/net/greeting/unicast_frame.hpp"
#include "peerd/net/seal/sealed_greetings.hpp"
#include "peerd/net/seal/sealer.hpp"
#include "peerd/peer/record/capture.hpp"
#include "peerd/peer/record/udp_packet.hpp"
#include "replication/wire/codec.hpp"
#include "tests/peerd/scratch_folder.hpp"
#include "tests/sim/dissector/tshark.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::dissector_test {

using namespace replication;
using peerd::testing_support::ScratchFolder;
using peerd::testing_support::text_of;

// All datagrams of a capture; `seen` counts the values of each field.
void compare_all(const ScratchFolder& folder, const std::filesystem::path& file,
                 std::map<std::string, std::size_t>& seen, const std::vector<std::string>& preferences = {}) {
  const auto packets = dissected(folder, file, preferences);
  const std::string bytes = text_of(file);
  auto capture = record::CaptureReader::open(std::as_bytes(std::span(bytes)));
  ASSERT_TRUE(capture) << capture.error();
  Readers readers;
  std::size_t compared = 0;
  std::vector<std::string> differences;
  for (std::size_t number = 2;; ++number) {
    const auto event = capture->next();
    ASSERT_TRUE(event) << event.error();
    if (!*event) break;
    const auto* in = std::get_if<record::DatagramIn>(&(*event)->what);
    const auto* out = std::get_if<record::DatagramOut>(&(*event)->what);
    if (!in && !out) continue;
    const SimTime near{(*event)->at.time_since_epoch()};
    const Fields ours =
        in ? readers.datagram(in->datagram, in->region, near) : readers.datagram(out->datagram, out->region, near);
    const auto theirs = packets.find(number);
    ASSERT_NE(theirs, packets.end()) << "packet " << number << " is not peerd's to tshark";
    if (const std::string what = difference(ours, theirs->second); !what.empty()) {
      differences.push_back("packet " + std::to_string(number) + ": " + what + ": " +
                            hex(in ? in->datagram : out->datagram));
    }
    for (const auto& [name, values] : ours) seen[name] += values.size();
    if (theirs->second.contains(kUnknown)) ++seen[kUnknown];
    ++compared;
  }
  EXPECT_EQ(compared, packets.size());
  EXPECT_THAT(differences, testing::IsEmpty()) << file;
}

// The scenarios above never have a decision on objects that spin, nor a peer that leaves; these do.
Message farewell() {
  Message m;
  m.sender = PeerId{4'000'000'000};
  m.incarnation = 77;
  m.number = 1;
  m.leaving = true;
  DecisionRecord& d = m.decisions.emplace_back();
  d.collider = ObjectId{7};
  d.collidee = ObjectId{4'000'000'000};
  d.contact = SimTime{Duration{-5}};
  d.known = SimTime{Duration{1'700'000'000'123'456'789}};
  d.normal = Vec3(0.6, -0.8, 0.0);
  d.rule = DecisionRule::kServer;
  KinematicState s;
  s.position = Vec3(1.0 / 3.0, -1e12, 5e-324);
  s.velocity = Vec3(0, 1e-7, 0);
  s.acceleration = Vec3(0, 0, -9.81);
  s.orientation = Quat(0.5, -0.5, 0.5, -0.5);
  s.angular_velocity_body = Vec3(0, 1e4, 0);
  d.collider_before = d.collidee_after = s;
  m.decisions.push_back(d);
  m.decisions.back().contact += std::chrono::seconds(1);
  m.decisions.back().rests = true;
  m.decisions.back().collider_free = Vec3(2, 0, -9.81);
  m.decisions.back().collidee_free = Vec3(-1.0 / 3.0, 5, 1e-7);
  m.scene.since = SimTime{Duration{-3}};
  UpdateRecord& rests = m.scene.states.emplace_back();
  rests.object = ObjectId{9, 5};
  rests.carrier = ObjectId{8, 2'000'000'000};
  rests.sequence = 3;
  rests.at = SimTime{std::chrono::hours(1)};
  rests.model.state.position = Vec3(1.0 / 7.0, 0, 2);
  m.scene.states.push_back(rests);
  m.scene.states.back().object = ObjectId{10, 5};
  m.scene.states.back().carrier.reset();
  m.scene.states.back().at += std::chrono::hours(20);
  return m;
}

// A hello of a host whose operating system knows how good its clock is: no simulated one's does.
Message of_a_good_clock() {
  Message m;
  m.sender = PeerId{1};
  m.incarnation = 1;
  m.number = 1;
  Hello& hello = m.hello.emplace();
  hello.session_tx = SimTime{std::chrono::seconds(10'000'003)};
  hello.scene_digest = 0x8123'4567'89AB'CDEF;
  Introduction& introduction = hello.introduction.emplace();
  introduction.name = "a";
  introduction.owned = {ObjectId{4'000'000'000}, ObjectId{2, 5}, ObjectId{3, 2'000'000'000}};
  introduction.owned_as_founder = 5;
  introduction.line = 0x8123'4567'89AB'CDEF;
  introduction.has_edits = true;
  hello.notes.push_back({ObjectId{3, 4}, ObjectId{4'000'000'000, 5}, SimTime{std::chrono::seconds(10'000'002)}, true});
  hello.notes.push_back({ObjectId{3, 4}, ObjectId{4'000'000'000}, SimTime{std::chrono::seconds(10'000'002)}, false});
  hello.os_clock = OsClockNote{std::chrono::nanoseconds(-1'234'567'891), std::chrono::microseconds(15'999'999)};
  return m;
}

// No scenario has operations; these datagrams do, and lists of all lengths of their numbers.
Message of_operations() {
  Message m;
  m.sender = PeerId{3};
  m.incarnation = 1;
  m.number = 1;
  m.hello.emplace().logs = {
      {AuthorId{1}, 1}, {AuthorId{300}, 1'000'000}, {AuthorId{kAuthorMax}, std::uint64_t{1} << 40}};
  m.operations.push_back({AuthorId{300}, 0, Bytes(200, std::byte{0xFF})});
  m.operations.push_back({AuthorId{kAuthorMax}, (std::uint64_t{1} << 40) - 3, Bytes(3, std::byte{0x80})});
  m.operation_requests = {{AuthorId{1}, 0, 1}, {AuthorId{kAuthorMax}, 5'000'000'000, 5'000'300'000}};
  return m;
}

// No two peers of a scenario show an object at different places.
Message of_ghosts() {
  Message m;
  m.sender = PeerId{3};
  m.number = 1;
  const SimTime at{std::chrono::seconds(9'999'990)};
  m.ghosts = {.at = at, .groups = {0, 1, 0x8001, 0xFFFF}};
  GhostQuestion& question = m.ghost_question.emplace();
  question = {.owner = PeerId{4'000'000'000}, .region = RegionId{300}, .at = at + std::chrono::milliseconds(250)};
  question.group = 3;
  for (std::size_t i = 0; i < kGhostBuckets; ++i) question.buckets[i] = static_cast<std::uint16_t>(2000 * i);
  for (std::uint32_t i = 1; i <= kGhostAnswerMax; ++i) {
    UpdateRecord& state = m.ghost_answer.states.emplace_back();
    state.object = ObjectId{i, 5};
    state.sequence = i;
    state.at = at + std::chrono::nanoseconds(1);
    if (i % 2 == 0) state.decision = at - std::chrono::seconds(1);
    state.model.state.position = Vec3(1.0 / 3.0, i, 0);
    if (i % 3 == 0) state.drive = Drive{Vec3(0, -9.81, 1.0 / i), state.at - std::chrono::seconds(i)};
  }
  m.ghost_reports = {{ObjectId{2, 2'000'000'000}, 0.1f}, {ObjectId{1}, 0.0f}, {ObjectId{7}, 1e6f}};
  return m;
}

Message of_identity() {
  Message m;
  m.sender = PeerId{3};
  m.identity = IdentityCheck{0x8123'4567'89AB'CDEF, 5, true};
  return m;
}

// Two datagrams of a sealed session, and a greeting.
std::vector<Bytes> sealed() {
  seal::Sealer sealer(keys::SymmetricKey::random(),
                      {.peer = PeerId{4'000'000'000}, .identity = keys::Identity::random()});
  const auto datagram = sealer.seal(HostTime{}, RegionId{4}, encode(of_identity()), true);
  const auto announcement = sealer.announcement_due(HostTime{}).value();
  seal::SealedGreetings greetings(keys::SymmetricKey::random(), [](const std::string&) {});
  return {announcement, {datagram.begin(), datagram.end()}, greetings.seal(Bytes(20))};
}

class Dissector : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kTshark)) {
      GTEST_SKIP() << kNoTshark;
    }
  }
  // The capture of one run's first peer, which has received all others.
  std::filesystem::path capture(const std::string& file, const std::vector<std::string>& sets,
                                const std::vector<std::filesystem::path>& configs = {}) {
    const std::filesystem::path path = PEERD_SOURCE_DIR "/configs/scenarios/" + file;
    const config::Scenario scenario = testing_support::scenario_of(path, sets, configs);
    const auto shared = must(share_world(scenario.world, scenario.reading));
    const Captures captures{folder / std::to_string(++captured), scenario, path};
    std::filesystem::create_directory(captures.folder);
    (void)must(simulate(scenario.runs.front(), *shared, {}, {}, nullptr, &captures));
    return captures.folder / (scenario.runs.front().peers.front().name + ".pcapng");
  }

  // Datagrams that go out one after the other.
  std::filesystem::path capture_of(const std::vector<Bytes>& datagrams) {
    record::Setup setup;
    setup.groups = {boost::asio::ip::make_address("239.192.80.0"), 47474, 0};
    const auto path = folder / std::to_string(++captured);
    const auto writer = must(record::CaptureWriter::open(path, setup, kNow, boost::asio::ip::make_address("10.0.0.1")));
    std::uint32_t region = 0;
    for (const Bytes& datagram : datagrams) writer->on_send(RegionId{region++ % 7}, datagram);
    return path;
  }

  static constexpr HostTime kNow{std::chrono::seconds(10'000'003)};
  ScratchFolder folder;
  int captured = 0;
};

TEST_F(Dissector, SaysOfAllDatagramsWhatTheDecoderSays) {
  std::map<std::string, std::size_t> seen;
  const std::filesystem::path best = PEERD_SOURCE_DIR "/configs/best.toml";
  for (const auto& file :
       {capture("head-on.toml", {"duration_s=4", "decisions.policy=field-of-view", "decisions.compare=false"}),
        capture("flock-regions.toml", {"duration_s=3"}), capture("snooker.toml", {"duration_s=3"}),
        capture("eq47.toml", {"duration_s=6", "network.latency_ms=50", "network.loss=0.2"}, {best}),
        capture("orbit.toml", {"duration_s=4"}, {best}),
        capture("flock-regions.toml", {"duration_s=1", "transport.group_pool=3"})}) {
    compare_all(folder, file, seen);
  }
  compare_all(folder, capture_of(sealed()), seen);
  compare_all(folder,
              capture_of({encode(farewell()), encode(of_a_good_clock()), encode(of_operations()), encode(of_identity()),
                          encode(of_ghosts())}),
              seen);
  for (const std::string& name : fields_of_datagrams()) {
    if (!name.starts_with("peerd.operation.") &&
        name != "peerd.operation") {  // dissector/operations_test.cpp has these
      EXPECT_GT(seen[name], 0u) << name << " was never there";
    }
  }
  EXPECT_EQ(seen[kUnknown], 0u) << "fields that the dissector does not know";
}

// Greetings and datagrams between relays and their neighbours.
TEST_F(Dissector, ReadsNotesOfLinksAndRelayedDatagrams) {
  net::Greeting greeting{
      .instance = 0x10, .number = 2, .echo = 3, .leaving = true, .regions = {RegionId{0}, RegionId{9}}};
  greeting.link = net::LinkNote{.sent_at_ns = 1'795'751'607'924'201'000,
                                .echoed_ns = 5,
                                .held_us = 6,
                                .datagrams_out = 7,
                                .datagrams_in = 8,
                                .group_offset = 4096,
                                .path = {0x11, 0x12},
                                .detached = true};
  const auto header = net::relay_header({RegionId{77}, 3});
  Bytes relayed(header.begin(), header.end());
  const Bytes said = encode(of_identity());
  relayed.insert(relayed.end(), said.begin(), said.end());
  const auto packets = dissected(folder, capture_of({net::encode(greeting, true), relayed}));
  ASSERT_EQ(packets.size(), 2u);
  Fields note = packets.begin()->second, datagram = packets.rbegin()->second;
  using Values = Fields::mapped_type;
  EXPECT_EQ(note["peerd.greeting.sent_at"], (Values{"1795751607924201000"}));
  EXPECT_EQ(note["peerd.greeting.echoed"], (Values{"5"}));
  EXPECT_EQ(note["peerd.greeting.held"], (Values{"6"}));
  EXPECT_EQ(note["peerd.greeting.sent"], (Values{"7"}));
  EXPECT_EQ(note["peerd.greeting.received"], (Values{"8"}));
  EXPECT_EQ(note["peerd.greeting.group_offset"], (Values{"4096"}));
  EXPECT_EQ(note["peerd.greeting.region"], (Values{"0", "9"}));
  EXPECT_EQ(note["peerd.greeting.path"].size(), 2u);
  EXPECT_EQ(datagram["peerd.region"], (Values{"77"}));
  EXPECT_EQ(datagram["peerd.hops"], (Values{"3"}));
  EXPECT_TRUE(datagram.contains("peerd.sender"));
}

// A group's number modulo 1,024 is its region's by default. Where there are more regions, tshark needs the number of
// the first one's group.
TEST_F(Dissector, FindsRegionsBeyondItsDefaultOnceTold) {
  const auto file =
      capture("flock-regions.toml", {"duration_s=1", "regions.cell_m=9.375", "regions.counts=[64, 1, 64]"});
  const std::string bytes = text_of(file);
  const auto reader = record::CaptureReader::open(std::as_bytes(std::span(bytes)));
  ASSERT_TRUE(reader) << reader.error();
  const auto first = net::group_endpoint(reader->setup().groups, RegionId{1});
  ASSERT_TRUE(first) << first.error().sentence;
  std::map<std::string, std::size_t> seen;
  compare_all(folder, file, seen, {"peerd.regions:" + first->address().to_string()});
  EXPECT_GT(seen["peerd.record.object"], 0u);
  const auto beyond = [](const record::Event& event) {
    const auto* out = std::get_if<record::DatagramOut>(&event.what);
    return out != nullptr && out->region.value > 1023;
  };
  std::size_t found = 0;
  for (auto capture = *reader;;) {
    const auto event = capture.next();
    ASSERT_TRUE(event) << event.error();
    if (!*event) break;
    found += beyond(**event);
  }
  EXPECT_GT(found, 0u);
}

// Datagrams with some bits changed, cut short, or made of chance: tshark marks those that our decoder refuses, and says
// the same as it of the others.
TEST_F(Dissector, MarksWhatTheDecoderRefuses) {
  std::vector<Bytes> real;
  for (const auto& file : {capture("head-on.toml", {"duration_s=2", "decisions.compare=false"}),
                           capture("flock-regions.toml", {"duration_s=2"}),
                           capture("orbit.toml", {"duration_s=2"}, {PEERD_SOURCE_DIR "/configs/best.toml"})}) {
    const std::string bytes = text_of(file);
    auto reader = must([&]() -> Result<record::CaptureReader> {
      auto opened = record::CaptureReader::open(std::as_bytes(std::span(bytes)));
      if (!opened) return std::unexpected(InputError{opened.error()});
      return *opened;
    }());
    for (;;) {
      const auto event = reader.next();
      ASSERT_TRUE(event);
      if (!*event) break;
      if (const auto* in = std::get_if<record::DatagramIn>(&(*event)->what)) {
        real.emplace_back(in->datagram.begin(), in->datagram.end());
      }
    }
  }
  for (int i = 0; i < 300; ++i) real.push_back(encode(i % 3 == 0 ? of_ghosts() : of_operations()));
  std::mt19937_64 random(20261120);
  constexpr int kCount = 4000;
  std::vector<Bytes> hostile;
  for (int i = 0; i < kCount; ++i) {
    Bytes& datagram = hostile.emplace_back(real[random() % real.size()]);
    switch (i % 4) {
      case 0:
        datagram.resize(random() % datagram.size());
        break;
      case 1:
        for (std::byte& byte : datagram) byte = static_cast<std::byte>(random());
        break;
      default:
        for (int changes = i % 4 == 2 ? 1 : 4; changes > 0; --changes) {
          datagram[random() % datagram.size()] ^= static_cast<std::byte>(1 << random() % 8);
        }
    }
    // A packet that begins with a mark of the network, which stands before any datagram, would be something else.
    if (!datagram.empty() && (datagram[0] == std::byte{0x52} || datagram[0] == std::byte{0x47})) datagram.clear();
    if (datagram.empty()) datagram.push_back(std::byte{8});
  }
  std::map<std::string, std::size_t> seen;
  compare_all(folder, capture_of(hostile), seen);
  EXPECT_GT(seen[kMalformed], kCount / 2u);
  EXPECT_GT(seen["peerd.sender"], kCount / 20u) << "some are sound in spite of it";
}

}  // namespace peerd::sim::dissector_test
