// Wireshark shows how peers are found and how the world comes to a joining peer, as our own readers decode it, and it
// takes any bytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <variant>

#include "peerd/input/compression.hpp"
#include "peerd/net/discovery/beacon.hpp"
#include "peerd/net/snapshot/snapshot_message.hpp"
#include "tests/net/process.hpp"
#include "tests/sim/dissector/wire.hpp"

namespace peerd::sim::dissector_test::joins {

using namespace snapshot;
using peerd::testing_support::ScratchFolder;
using peerd::testing_support::text_of;
using replication::AuthorId;
using replication::kAuthorMax;

constexpr std::uint64_t kSession = 0x8123'4567'89AB'CDEF;

// Each kind of request, with the reply to it.
std::vector<std::pair<Request, Reply>> exchanges() {
  static_assert(std::variant_size_v<decltype(Request::what)> == 3 && std::variant_size_v<Reply> == 4);
  const std::vector<replication::LogLength> logs{
      {AuthorId{1}, 1}, {AuthorId{300}, 1'000'000}, {AuthorId{kAuthorMax}, 1ull << 40}};
  std::string noise(kPartMax_bytes, ' ');
  std::mt19937_64 random(20261127);
  for (char& c : noise) c = static_cast<char>(random());
  return {{{0, OfferRequest{}}, Offer{9, kSession, "a world", "[session]\nname = \"x, y\"\n", 1, 2, 3, logs}},
          {{kSession, OfferRequest{}}, Offer{}},
          {{kSession, PartRequest{{AuthorId{0}, 0, kPartMax_bytes}}}, Part{std::string(kPartMax_bytes, 'a')}},
          {{kSession, PartRequest{{AuthorId{300}, 1ull << 40, (1ull << 40) + kPartMax_bytes}}}, Part{noise}},
          {{kSession, PartRequest{{AuthorId{1}, 5, 6}}}, Part{"x"}},
          {{kSession, PartRequest{{AuthorId{1}, 5, 305}}}, Part{std::string(300, 'b')}},
          {{kSession, PartRequest{{AuthorId{1}, 7, 8}}}, Refusal{"this peer does not hold that"}},
          {{kSession, DigestRequest{logs}}, Digests{{1, 0, kSession}}},
          {{kSession, DigestRequest{{{AuthorId{1}, 1}}}}, Digests{{7}}}};
}

// A reply with these bytes in place of a frame of zstd.
std::string chunk_of(const std::string& frame) { return std::string("\x1a") + static_cast<char>(frame.size()) + frame; }

class DissectorOfJoins : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kTshark)) GTEST_SKIP() << kNoTshark;
  }
  void compare() {
    wire.flush();
    compare_wire(folder, file, seen);
  }

  ScratchFolder folder;
  const std::filesystem::path file = folder / "wire.pcapng";
  WireWriter wire{file};
  std::map<std::string, std::size_t> seen;
};

TEST_F(DissectorOfJoins, ShowsQuestionsAndBeacons) {
  using discovery::Beacon;
  wire.discovery(discovery::question());
  wire.discovery(discovery::encode(Beacon{9, kSession, PeerId{4'000'000'000}, 77, 65'535, "a world", "b"}));
  wire.discovery(discovery::encode(Beacon{1, 2, PeerId{3}, 4, 0, std::string(63, 'w'), std::string(63, 'n')}));
  const auto beacon = discovery::encode(Beacon{1, 2, PeerId{3}, 4, 5, "w", "n"});
  for (std::size_t size = 1; size < beacon.size(); ++size) wire.discovery(std::span(beacon).first(size));
  const auto question = discovery::question();
  for (const std::size_t size : {std::size_t{7}, question.size() - 1}) wire.discovery(std::span(question).first(size));
  auto changed = beacon;
  changed.push_back(std::byte{0});
  wire.discovery(changed);
  changed = beacon;
  std::fill_n(changed.begin() + 19, 4, std::byte{0});  // its peer
  wire.discovery(changed);
  compare();
  for (const std::string& name : fields_of_discovery()) EXPECT_GT(seen[name], 0u) << name;
  EXPECT_EQ(seen[kMalformed], beacon.size() + 3);
}

TEST_F(DissectorOfJoins, ShowsEachRequestAndReplyHoweverItIsCut) {
  std::uint16_t connection = 50'000;
  for (const std::size_t most : {std::size_t{1400}, std::size_t{65'000}, std::size_t{100}, std::size_t{13}}) {
    ++connection;
    for (const auto& [request, reply] : exchanges()) {
      wire.frame(connection, true, encode(request), std::max<std::size_t>(most, 20));
      wire.frame(connection, false, encode(reply), most);
    }
  }
  // Requests that do not wait for replies, many in a segment.
  std::string requests, replies;
  const auto append = [](std::string& to, const std::string& content) {
    for (int shift = 0; shift < 32; shift += 8) to += static_cast<char>(content.size() >> shift & 0xff);
    to += content;
  };
  for (const auto& [request, reply] : exchanges()) {
    append(requests, encode(request));
    append(replies, encode(reply));
  }
  wire.bytes(50'100, true, requests);
  wire.bytes(50'100, false, replies, 1001);
  compare();
  for (const std::string& name : fields_of_joins()) EXPECT_GT(seen[name], 0u) << name;
  EXPECT_EQ(seen[kUnknown] + seen[kMalformedJoin], 0u);
}

// Messages with some bits changed, after a sound request. In the content of a frame of zstd only what unpacks it finds
// damage, so that chunks are cut or lengthened.
TEST_F(DissectorOfJoins, MarksWhatOurReaderRefuses) {
  std::mt19937_64 random(20261128);
  const auto all = exchanges();
  for (std::uint16_t i = 0; i < 1000; ++i) {
    const auto connection = static_cast<std::uint16_t>(52'000 + i);
    const auto& [request, reply] = all[i % all.size()];
    const bool of_reply = i % 2 == 0;
    std::string message = of_reply ? encode(reply) : encode(request);
    if (of_reply && std::holds_alternative<Part>(reply)) {
      message = chunk_of(compress(std::get<Part>(reply).bytes).substr(0, random() % 60) + (i % 4 == 0 ? "x" : ""));
    } else {
      for (int changes = 1 + i % 3; changes > 0 && !message.empty(); --changes) {
        message[random() % message.size()] ^= static_cast<char>(1 << random() % 8);
      }
    }
    wire.frame(connection, true, encode(Request{kSession, OfferRequest{}}));
    wire.frame(connection, !of_reply, message);
  }
  for (const bool from_client : {true, false}) {
    wire.frame(51'999, true, encode(Request{kSession, OfferRequest{}}));
    wire.bytes(51'999, from_client, "\xff\xff\xff\xff and no more");
  }
  compare();
  EXPECT_GT(seen[kMalformedJoin], 250u);
  EXPECT_GT(seen["peerd_join.kind"], 1200u);
}

// What fuzzing has found for all parsers, as datagrams, as questions, as parts of logs and as joins: nothing of it is
// an error of the dissector itself, which dissected() finds.
TEST_F(DissectorOfJoins, TakesWhateverFuzzingHasFound) {
  std::uint16_t connection = 55'000;
  std::size_t files = 0, datagrams = 0;
  const auto send = [&](std::span<const std::byte> datagram) {
    if (datagram.empty()) return;
    wire.datagram(datagram);
    ++datagrams;
  };
  for (const char* name :
       {"datagram", "operations", "join", "greeting", "control_request", "pose_message", "capture"}) {
    const std::filesystem::path corpus = PEERD_SOURCE_DIR "/tests/fuzz/corpus";
    for (const auto& entry : std::filesystem::directory_iterator(corpus / name)) {
      const std::string text = text_of(entry.path());
      const auto bytes = std::as_bytes(std::span(text));
      ++files;
      wire.discovery(bytes);
      send(bytes);
      for (auto rest = bytes; rest.size() > 3;) {  // as operations_fuzz.cpp cuts them
        const auto length = std::to_integer<std::size_t>(rest[0]) | std::to_integer<std::size_t>(rest[1]) << 8;
        const auto datagram = rest.subspan(3).first(std::min(length, rest.size() - 3));
        rest = rest.subspan(3 + datagram.size());
        send(datagram);
      }
      if (!text.empty() && text.size() < 1100) {
        replication::Message m;
        m.sender = PeerId{3};
        m.operations = {{AuthorId{connection}, 0, {bytes.begin(), bytes.end()}}};
        send(encode(m));
      }
      for (const bool from_client : {true, false}) {
        for (const bool is_frame : {true, false}) {
          wire.frame(++connection, true, encode(Request{kSession, OfferRequest{}}));
          if (is_frame) wire.frame(connection, from_client, text);
          if (!is_frame) wire.bytes(connection, from_client, text);
        }
      }
    }
  }
  wire.flush();
  EXPECT_GE(dissected(folder, file).size(), files + datagrams);
  EXPECT_GT(files, 50u);
}

}  // namespace peerd::sim::dissector_test::joins
