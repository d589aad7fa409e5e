// Wireshark, with peerd/packaging/peerd.lua, says of every datagram what our own decoder says; and of no other bytes
// that they are sound. Two programs that share no code: tshark is asked for all fields of whole captures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <map>
#include <random>
#include <sstream>

#include "peerd/record/capture.hpp"
#include "peerd/record/udp_packet.hpp"
#include "peerd/transport/unicast_frame.hpp"
#include "replication/wire/codec.hpp"
#include "tests/net/process.hpp"
#include "tests/peerd/scratch_folder.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::dissector_test {

using namespace replication;
using peerd::testing_support::Process;
using peerd::testing_support::ScratchFolder;
using peerd::testing_support::text_of;
using testing_support::must;

constexpr const char* kTshark = "/usr/bin/tshark";
constexpr const char* kMalformed = "peerd.malformed";

// The values of each field by its name, in order of appearance.
using Fields = std::map<std::string, std::vector<std::string>>;

class Expected {
 public:
  void add(const std::string& name, const std::string& value) { fields_["peerd." + name].push_back(value); }
  void add(const std::string& name, double x) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, x).ptr;
    add(name, std::string(text, end));
  }
  template <std::integral T>
  void add(const std::string& name, T n) {
    add(name, std::to_string(n));
  }
  void add(const std::string& name, SimTime t) { add(name, t.time_since_epoch().count()); }
  void add(const std::string& name, const Vec3& v) {
    add(name + ".x", v.x());
    add(name + ".y", v.y());
    add(name + ".z", v.z());
  }
  void add(const std::string& name, const Quat& q) {
    add(name + ".w", q.w());
    add(name + ".x", q.x());
    add(name + ".y", q.y());
    add(name + ".z", q.z());
  }
  [[nodiscard]] const Fields& fields() const { return fields_; }

 private:
  Fields fields_;
};

bool is_identity(const Quat& q) { return q.coeffs() == Quat::Identity().coeffs(); }

void add(Expected& out, const Hello& h, std::uint64_t incarnation) {
  if (h.session_tx) out.add("hello.session_tx_ns", *h.session_tx);
  // Protobuf sends no zeros.
  if (h.sessions != 0) out.add("hello.sessions", h.sessions);
  if (h.latency != Duration{0}) out.add("hello.latency_ms", h.latency / std::chrono::milliseconds(1));
  if (h.clock_error) out.add("hello.clock_error_us", *h.clock_error / std::chrono::microseconds(1));
  if (h.os_clock) {
    if (h.os_clock->minus_session != Duration{0}) {
      out.add("hello.os_minus_session_ns", h.os_clock->minus_session.count());
    }
    out.add("hello.os_error_us", h.os_clock->error / std::chrono::microseconds(1));
  }
  for (const Echo& e : h.echoes) {
    out.add("echo.peer", e.peer.value);
    out.add("echo.hello", e.hello);
    out.add("echo.held_ns", e.hold_time.count());
    const Received& r = e.received;
    out.add("echo.newer", r.highest - e.hello);
    out.add("echo.run", r.run);
    if (r.run < std::min(r.highest, Received::kWindow)) out.add("echo.absent", ~r.last >> r.run);
    out.add("echo.loss_permille", std::lround(e.loss * 1000.0));
  }
  for (const ContactNote& n : h.notes) {
    out.add("note.collider", n.collider.packed());
    out.add("note.collidee", n.collidee.packed());
    out.add("note.contact_ns", n.contact);
    out.add("note.held", n.deferred);
  }
  if (h.scene_digest != 0) out.add("hello.scene_digest", h.scene_digest);
  for (const LogLength& log : h.logs) {
    out.add("log.author", log.author.value);
    out.add("log.bytes", log.bytes);
  }
  if (!h.introduction) return;
  const Introduction& i = *h.introduction;
  out.add("introduction.name", i.name);
  if (i.world_hash != 0) out.add("introduction.world_hash", i.world_hash);
  if (incarnation != 0) out.add("introduction.boot", incarnation);
  for (const ObjectId object : i.owned) out.add("introduction.enslaved", object.packed());
  if (i.owned_as_founder != 0) out.add("introduction.owned_as_founder", i.owned_as_founder);
  if (i.start) out.add("introduction.start_ns", *i.start);
  if (i.world_zero) out.add("introduction.world_zero_ns", *i.world_zero);
  if (!i.viewpoint) return;
  if (i.viewpoint->object) out.add("viewpoint.object", i.viewpoint->object->packed());
  out.add("viewpoint.position", i.viewpoint->pose.position);
  out.add("viewpoint.orientation", i.viewpoint->pose.orientation);
  out.add("viewpoint.field_of_view", i.viewpoint->field_of_view);
  out.add("viewpoint.aspect", i.viewpoint->aspect);
}

void add(Expected& out, const UpdateRecord& u) {
  const auto kind = static_cast<int>(u.model.kind);
  const KinematicState& s = u.model.state;
  out.add("record.object", u.object.packed());
  if (u.carrier) out.add("record.carrier", u.carrier->packed());
  out.add("record.sequence", u.sequence);
  out.add("record.kind", kind);
  out.add("record.time_ns", u.at);
  if (u.decision != SimTime{}) out.add("record.decision_ns", u.decision);
  if (u.position_step_log2) {
    out.add("record.step_log2", *u.position_step_log2);
  } else {
    out.add("record.exact", true);
  }
  out.add("record.position", s.position);
  out.add("record.velocity", s.velocity);
  if (u.model.kind != MotionKind::kFirst) out.add("record.acceleration", s.acceleration);
  const bool oscillating = u.model.kind == MotionKind::kOscillating;
  if (oscillating || u.model.kind == MotionKind::kThird) out.add("record.jerk", u.model.jerk);
  if (oscillating || u.model.kind == MotionKind::kTurning) out.add("record.rate", u.model.rate_rad_s);
  if (!is_identity(s.orientation)) out.add("record.orientation", s.orientation);
  out.add("record.spin", s.angular_velocity_body);
  if (!u.model.angular_acceleration_body.isZero(0.0)) {
    out.add("record.spin_acceleration", u.model.angular_acceleration_body);
  }
}

void add(Expected& out, const KinematicState& s) {
  out.add("decision.position", s.position);
  if (!s.velocity.isZero(0.0)) out.add("decision.velocity", s.velocity);
  if (!s.acceleration.isZero(0.0)) out.add("decision.acceleration", s.acceleration);
  if (!is_identity(s.orientation)) out.add("decision.orientation", s.orientation);
  if (!s.angular_velocity_body.isZero(0.0)) out.add("decision.spin", s.angular_velocity_body);
}

void add(Expected& out, const DecisionRecord& d) {
  if (d.collider.packed() != 0) out.add("decision.collider", d.collider.packed());
  if (d.collidee.packed() != 0) out.add("decision.collidee", d.collidee.packed());
  if (d.contact != SimTime{}) out.add("decision.contact_ns", d.contact);
  out.add("decision.normal", d.normal);
  for (const auto* s : {&d.collider_before, &d.collidee_before, &d.collider_after, &d.collidee_after}) add(out, *s);
  out.add("decision.rule", static_cast<int>(d.rule));
  if (d.known != SimTime{}) out.add("decision.known_ns", d.known);
}

// The fields that our decoder finds in a datagram, or for one that it refuses, that it is malformed.
Fields expected_of(std::span<const std::byte> datagram, RegionId region, SimTime near) {
  Expected out;
  const auto m = decode(datagram, near);
  if (!m) {
    out.add("malformed", "");
    return out.fields();
  }
  out.add("region", region.value);
  out.add("version", kProtocolVersion);
  out.add("sender", m->sender.value);
  if (m->number != 0) out.add("number", m->number);
  if (m->introduction() == nullptr && m->incarnation != 0) out.add("boot_low", m->incarnation);
  if (m->hello) add(out, *m->hello, m->incarnation);
  for (const UpdateRecord& u : m->updates) add(out, u);
  for (const DecisionRecord& d : m->decisions) add(out, d);
  if (!m->scene.states.empty()) {
    out.add("scene.since_ns", m->scene.since);
    for (const UpdateRecord& u : m->scene.states) add(out, u);
  }
  for (const Subscription& e : m->subscriptions) {
    out.add("entered.region", e.region.value);
    out.add("entered.since_ns", e.since);
  }
  for (const Handover& g : m->handovers) {
    out.add("gone.object", g.object.packed());
    out.add("gone.sequence", g.sequence);
    out.add("gone.region", g.to.value);
  }
  for (const OperationPart& part : m->operations) {
    out.add("operations.author", part.author.value);
    out.add("operations.from", part.from);
    out.add("operations.bytes", part.bytes.size());
  }
  for (const OperationRange& range : m->operation_requests) {
    out.add("operations.asked.author", range.author.value);
    out.add("operations.asked.from", range.from);
    out.add("operations.asked.bytes", range.to - range.from);
  }
  if (m->leaving) out.add("leaving", true);
  return out.fields();
}

// The names of all compared fields, so that the test notices a field that tshark does not report.
std::vector<std::string> all_fields() {
  std::vector<std::string> names;
  const auto with = [&](const std::string& prefix, std::initializer_list<const char*> ends) {
    for (const char* end : ends) names.push_back("peerd." + prefix + end);
  };
  with("", {"region", "version", "sender", "number", "boot_low", "leaving", "malformed"});
  with("hello.", {"session_tx_ns", "sessions", "latency_ms", "clock_error_us", "os_minus_session_ns", "os_error_us",
                  "scene_digest"});
  with("scene.", {"since_ns"});
  with("echo.", {"peer", "hello", "held_ns", "newer", "run", "absent", "loss_permille"});
  with("note.", {"collider", "collidee", "contact_ns", "held"});
  with("introduction.", {"name", "world_hash", "boot", "enslaved", "owned_as_founder", "start_ns", "world_zero_ns"});
  with("viewpoint.", {"object", "field_of_view", "aspect"});
  with("record.", {"object", "carrier", "sequence", "kind", "time_ns", "decision_ns", "step_log2", "exact"});
  with("decision.", {"collider", "collidee", "contact_ns", "rule", "known_ns"});
  with("entered.", {"region", "since_ns"});
  with("gone.", {"object", "sequence", "region"});
  with("log.", {"author", "bytes"});
  with("operations.", {"author", "from", "bytes", "asked.author", "asked.from", "asked.bytes"});
  for (const char* vector : {"viewpoint.position", "record.position", "record.velocity", "record.acceleration",
                             "record.jerk", "record.rate", "record.spin", "record.spin_acceleration", "decision.normal",
                             "decision.position", "decision.velocity", "decision.acceleration", "decision.spin"}) {
    with(vector, {".x", ".y", ".z"});
  }
  for (const char* q : {"viewpoint.orientation", "record.orientation", "decision.orientation"}) {
    with(q, {".w", ".x", ".y", ".z"});
  }
  return names;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts(1);
  for (const char c : text) c == at ? static_cast<void>(parts.emplace_back()) : parts.back().push_back(c);
  return parts;
}

// The packets that tshark takes for peerd's, by their numbers from 1. A preference is "NAME:VALUE".
std::map<std::size_t, Fields> dissected(const ScratchFolder& folder, const std::filesystem::path& file,
                                        const std::vector<std::string>& preferences) {
  const std::vector<std::string> names = all_fields();
  std::vector<std::string> words{"-r", file.string(), "-X", "lua_script:" PEERD_SOURCE_DIR "/peerd/packaging/peerd.lua",
                                 "-Y", "peerd",       "-T", "fields",
                                 "-E", "separator=;", "-e", "frame.number"};
  for (const std::string& name : names) words.insert(words.end(), {"-e", name});
  for (const std::string& preference : preferences) words.insert(words.end(), {"-o", preference});
  Process tshark(folder, "tshark", kTshark, words);
  EXPECT_EQ(tshark.exit_code(60), 0) << tshark.err();
  EXPECT_EQ(tshark.err().find("Lua"), std::string::npos) << tshark.err();
  std::map<std::size_t, Fields> packets;
  std::istringstream lines(tshark.out());
  for (std::string line; std::getline(lines, line);) {
    const auto columns = split(line, ';');
    EXPECT_EQ(columns.size(), names.size() + 1) << line;
    if (columns.size() != names.size() + 1) continue;
    Fields& fields = packets[std::stoul(columns[0])];
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!columns[i + 1].empty()) fields[names[i]] = split(columns[i + 1], ',');
    }
  }
  return packets;
}

// tshark prints 15 digits of a double.
bool same_value(const std::string& ours, const std::string& theirs) {
  if (ours == theirs) return true;
  if (ours.find_first_of(".e") == std::string::npos && theirs.starts_with("0x")) {
    return std::stoull(ours) == std::stoull(theirs, nullptr, 16);
  }
  char *our_end = nullptr, *their_end = nullptr;
  const double x = std::strtod(ours.c_str(), &our_end), y = std::strtod(theirs.c_str(), &their_end);
  if (*our_end != '\0' || *their_end != '\0' || ours.size() + theirs.size() == 0) return false;
  const bool whole = ours.find_first_of(".e") == std::string::npos && theirs.find_first_of(".e") == std::string::npos;
  return whole ? false : std::abs(x - y) <= 1e-14 * std::abs(x);
}

std::string difference(const Fields& ours, Fields theirs) {
  if (ours.contains(kMalformed)) return theirs.contains(kMalformed) ? "" : "it is not malformed to tshark";
  if (theirs.contains(kMalformed)) return "tshark takes it for malformed: " + theirs[kMalformed].front();
  for (const auto& [name, values] : ours) {
    const auto& found = theirs[name];
    if (found.size() != values.size()) {
      return name + ": " + std::to_string(found.size()) + " times, not " + std::to_string(values.size());
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!same_value(values[i], found[i])) return name + ": " + found[i] + ", not " + values[i];
    }
  }
  for (const auto& [name, values] : theirs) {  // a zero that is sent is one that is not
    const bool absent = values.empty() || values == std::vector<std::string>{"0"};
    if (!absent && !ours.contains(name)) return name + ": " + values.front() + ", which it does not have";
  }
  return "";
}

std::string hex(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    for (const auto digit : {byte >> 4, byte & std::byte{15}}) text += "0123456789abcdef"[std::to_integer<int>(digit)];
  }
  return text;
}

// All datagrams of a capture; `seen` counts the values of each field.
void compare_all(const ScratchFolder& folder, const std::filesystem::path& file,
                 std::map<std::string, std::size_t>& seen, const std::vector<std::string>& preferences = {}) {
  const auto packets = dissected(folder, file, preferences);
  const std::string bytes = text_of(file);
  auto capture = record::CaptureReader::open(std::as_bytes(std::span(bytes)));
  ASSERT_TRUE(capture) << capture.error();
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
        in ? expected_of(in->datagram, in->region, near) : expected_of(out->datagram, out->region, near);
    const auto theirs = packets.find(number);
    ASSERT_NE(theirs, packets.end()) << "packet " << number << " is not peerd's to tshark";
    if (const std::string what = difference(ours, theirs->second); !what.empty()) {
      differences.push_back("packet " + std::to_string(number) + ": " + what + ": " +
                            hex(in ? in->datagram : out->datagram));
    }
    for (const auto& [name, values] : ours) seen[name] += values.size();
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

class Dissector : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kTshark)) {
      GTEST_SKIP() << "no " << kTshark << ": scripts/test --full installs it (apt-get install tshark)";
    }
  }
  // The capture of one run's first peer, which has received all others.
  std::filesystem::path capture(const std::string& file, const std::vector<std::string>& sets,
                                const std::vector<std::filesystem::path>& configs = {}) {
    const std::filesystem::path path = PEERD_SOURCE_DIR "/configs/scenarios/" + file;
    const config::Scenario scenario =
        must(config::read_scenario({.file = path, .configs = configs, .sets = sets, .seed = {}}));
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
  compare_all(folder, capture_of({encode(farewell()), encode(of_a_good_clock()), encode(of_operations())}), seen);
  for (const std::string& name : all_fields()) {
    if (name != kMalformed) {
      EXPECT_GT(seen[name], 0u) << name << " was never there";
    }
  }
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
  for (int i = 0; i < 300; ++i) real.push_back(encode(of_operations()));
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
