// Wireshark shows all operations that parts of logs bring, wherever they are cut and whichever comes first, as our own
// reader decodes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <variant>

#include "tests/sim/dissector/wire.hpp"

namespace peerd::sim::dissector_test::operations {

using namespace replication;
using peerd::testing_support::ScratchFolder;

constexpr AuthorId kAuthor{300};
constexpr std::uint64_t kOfAuthor = std::uint64_t{300} << 32;

// Each kind of operation, with all of its fields and with as few as there may be.
std::vector<OperationBody> one_of_each() {
  const ObjectId car{7, 300}, ball{4'000'000'000, kAuthorMax};
  const NodeId node = NodeId::unpacked(kOfAuthor + 9), other = NodeId::unpacked(12);
  const Placement placement{{1.5F, -0.1F, 3e10F}, {0.6F, 0.8F, 0.0F, -1.25F}};
  const SimTime earlier{Duration{-1'700'000'000'123'456'789}};
  const std::string any("\0\xff,;\1\2\n\\ \"", 10);
  return {AddNodes{car,
                   ball,
                   "DEF A Group { }\nDEF B Transform { translation 1, 2, 3 }",
                   5,
                   6,
                   {{"A/B", car}, {"C", ObjectId{1}}}},
          AddNodes{{}, {}, "Group { }"},
          RemoveObject{ball},
          RemoveNode{node},
          MoveObject{car, ball, ObjectId{0}},
          MoveObject{car, {}, {}},
          SetField{node, "translation", "1 2 3", 77},
          SetField{other, "children", "[ ]"},
          ChangeRoute{node, other, "translation_changed", "set_translation", true},
          ChangeRoute{other, node, "a", "b"},
          GiveObject{car, PeerId{4'000'000'000}, PeerId{2}, placement},
          GiveObject{ball, kNobody, kNobody},
          RequestObject{car, PeerId{1}, PeerId{2}},
          RefuseRequest{{AuthorId{kAuthorMax}, 4'000'000'000}, "its owner, who holds it: no"},
          SetData{node, "key", any},
          SetData{node, std::string(200, 'k'), ""},
          SetData{other, any, {}},
          SendMessage{PeerId{3}, "chat", "hello, all; and you"},
          SendMessage{PeerId{3}, "", any},
          UndoOperation{3, earlier, true},
          UndoOperation{4'000'000'000},
          PlaceObject{car, PeerId{5}, earlier, placement},
          LockObject{car},
          LockObject{ball, true}};
}

using Log = std::vector<Bytes>;  // operation by operation

Log log_of(const std::vector<OperationBody>& bodies, AuthorId author = kAuthor) {
  Log log;
  for (const OperationBody& body : bodies) {
    const auto number = static_cast<std::uint32_t>(log.size() + 1);
    Operation operation{{author, number}, SimTime{Duration{1'000'000'007 * std::int64_t{number} - 5}}, body};
    if (number % 3 == 0) operation.knows = {{AuthorId{1}, number}, {AuthorId{299}, 1}, {AuthorId{kAuthorMax}, 7}};
    const Bytes key(number == 1 ? 40 : 0, std::byte{7});
    log.push_back(number % 4 == 0 ? encode(operation)
                                  : encode_unsigned(operation, key));  // older logs have no signatures
  }
  return log;
}

Bytes joined(const Log& log) {
  Bytes all;
  for (const Bytes& operation : log) all.insert(all.end(), operation.begin(), operation.end());
  return all;
}

OperationPart part_of(const Bytes& log, std::size_t from, std::size_t size, AuthorId author = kAuthor) {
  const auto begin = log.begin() + static_cast<std::ptrdiff_t>(from);
  return {author, from, Bytes(begin, begin + static_cast<std::ptrdiff_t>(std::min(size, log.size() - from)))};
}

Bytes datagram_of(std::vector<OperationPart> parts) {
  Message m;
  m.sender = PeerId{3};
  m.incarnation = 1;
  m.number = 1;
  m.operations = std::move(parts);
  return encode(m);
}

class DissectorOfOperations : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kTshark)) GTEST_SKIP() << kNoTshark;
  }
  void send(std::vector<OperationPart> parts) { wire.datagram(datagram_of(std::move(parts))); }
  void compare(const std::vector<OperationPart>& known = {}) {
    wire.flush();
    compare_wire(folder, file, seen, known);
  }
  // All values of a field that tshark reports, in their order.
  std::vector<std::string> values_of(const std::string& field) {
    std::vector<std::string> values;
    for (const auto& [number, fields] : dissected(folder, file)) {
      if (fields.contains(field)) values.insert(values.end(), fields.at(field).begin(), fields.at(field).end());
    }
    return values;
  }

  ScratchFolder folder;
  const std::filesystem::path file = folder / "wire.pcapng";
  WireWriter wire{file};
  std::map<std::string, std::size_t> seen;
};

TEST_F(DissectorOfOperations, ShowsEachKindWithAllItsFields) {
  const auto bodies = one_of_each();
  std::set<std::size_t> kinds;
  for (const OperationBody& body : bodies) kinds.insert(body.index());
  ASSERT_EQ(kinds.size(), std::variant_size_v<OperationBody>) << "a kind is missing above";
  std::uint64_t from = 0;
  for (const Bytes& operation : log_of(bodies)) {
    send({{kAuthor, from, operation}});
    from += operation.size();
  }
  compare();
  EXPECT_THAT(values_of("peerd.operation.kind"), testing::IsSupersetOf(kinds_of_operations()));
  for (const std::string& name : fields_of_datagrams()) {
    if (!name.starts_with("peerd.operation.") || name == "peerd.operation.repeated") continue;
    EXPECT_GT(seen[name], 0u) << name;
  }
  EXPECT_EQ(seen[kUnknown], 0u);
}

TEST_F(DissectorOfOperations, PutsPartsTogetherInAnyOrder) {
  const Log operations = log_of(one_of_each());
  const Bytes log = joined(operations);
  std::set<std::size_t> begins{0};
  for (const Bytes& operation : operations) begins.insert(*begins.rbegin() + operation.size());
  constexpr std::size_t kSize = 23;
  std::mt19937_64 random(20261125);
  std::vector<OperationPart> parts;
  for (std::size_t from = 0; from < log.size(); from += kSize) {
    // A part that begins as an operation does would be read as one before what precedes it has come.
    const std::size_t begin = from > 0 && begins.contains(from) ? from - 1 : from;
    parts.push_back(part_of(log, begin, kSize + from % 5));
  }
  const std::size_t count_of_parts = parts.size();
  for (std::size_t i = 0; i < count_of_parts; i += 2) parts.push_back(parts[i]);
  std::ranges::shuffle(parts, random);
  for (std::size_t i = 0; i < parts.size(); i += 3) {
    send({parts.begin() + static_cast<std::ptrdiff_t>(i),
          parts.begin() + static_cast<std::ptrdiff_t>(std::min(i + 3, parts.size()))});
  }
  send({part_of(log, 0, *std::next(begins.begin(), 2))});  // two that have been shown
  compare();
  EXPECT_GT(seen["peerd.operation.repeated"], 0u);
  EXPECT_EQ(seen["peerd.operation"] - seen["peerd.operation.repeated"], one_of_each().size());
}

TEST_F(DissectorOfOperations, ShowsWhatIsLongerThanADatagram) {
  std::string text = "Group { }";
  while (text.size() < 60'000) text += " # " + std::to_string(text.size());
  const Bytes log = joined(log_of({RemoveObject{ObjectId{1}}, AddNodes{{}, {}, text}, RemoveObject{ObjectId{2}}}));
  for (std::size_t from = 0; from < log.size(); from += 1000) send({part_of(log, from, 1000)});
  compare();
  EXPECT_EQ(seen["peerd.operation"], 3u);
}

TEST_F(DissectorOfOperations, FindsTheNextOperationWhereALogsBeginningIsMissing) {
  constexpr std::size_t kMissing = 5;
  const Log log = log_of(one_of_each());
  const Bytes all = joined(log);
  std::uint64_t from = 0;
  for (std::size_t i = 0; i < log.size(); ++i) {
    if (i >= kMissing) send({{kAuthor, from, log[i]}});
    from += log[i].size();
  }
  compare({part_of(all, 0, all.size() - log.back().size())});
  EXPECT_EQ(seen["peerd.operation"], log.size() - kMissing);
}

TEST_F(DissectorOfOperations, ReadsOnBehindTheEndOfAnOperationWhoseBeginningIsMissing) {
  const Log log = log_of({RemoveObject{ObjectId{1}}, RemoveObject{ObjectId{2}}, RemoveObject{ObjectId{3}}});
  const Bytes all = joined(log);
  const std::size_t second = log[0].size(), third = second + log[1].size();
  send({part_of(all, second - 3, 3), part_of(all, second, 8)});
  send({part_of(all, second + 8, third - second)});
  wire.flush();
  EXPECT_THAT(values_of("peerd.operation.number"), testing::IsEmpty()) << "their first part might be any bytes";
  send({part_of(all, third, all.size() - third)});
  wire.flush();
  EXPECT_THAT(values_of("peerd.operation.number"), testing::ElementsAre("3"));
  send({part_of(all, 0, second)});  // all that was missing
  wire.flush();
  EXPECT_THAT(values_of("peerd.operation.number"), testing::ElementsAre("3", "1", "2"));
}

TEST_F(DissectorOfOperations, MarksForksAndWhatNobodyReadsOn) {
  const Bytes log = joined(log_of({RemoveObject{ObjectId{1}}, RemoveObject{ObjectId{2}}}));
  Bytes other = log;
  other.back() ^= std::byte{1};
  send({part_of(log, 0, log.size())});
  send({part_of(other, 0, other.size())});
  send({part_of(log, 0, log.size())});
  // A number is left out; a stamp does not follow; there is no such kind.
  const Log next = log_of(one_of_each(), AuthorId{1});
  Bytes gap = next[0], back = next[0];
  gap.insert(gap.end(), next[2].begin(), next[2].end());
  const Bytes early = encode(Operation{{AuthorId{2}, 2}, SimTime{Duration{1}}, RemoveObject{ObjectId{1}}});
  back.insert(back.end(), early.begin(), early.end());
  send({part_of(gap, 0, gap.size(), AuthorId{1})});
  send({part_of(back, 0, back.size(), AuthorId{2})});
  send({part_of(gap, 0, gap.size(), AuthorId{1}), {AuthorId{3}, 0, {std::byte{2}, std::byte{8}, std::byte{1}}}});
  compare();
  EXPECT_EQ(seen[kForked], 1u);
  EXPECT_EQ(seen[kUnreadable], 3u);
}

// Logs with some bits changed: tshark marks those that our reader refuses, and says the same as it of the others.
TEST_F(DissectorOfOperations, MarksWhatOurReaderRefuses) {
  const Log log = log_of(one_of_each(), AuthorId{1});
  std::mt19937_64 random(20261126);
  for (std::uint32_t i = 0; i < 1500; ++i) {
    const AuthorId author{1000 + i};
    Bytes bytes = encode(Operation{{author, 1}, SimTime{Duration{1}}, one_of_each()[i % log.size()]});
    for (std::uint64_t changes = i % 8 == 0 ? 0 : 1 + i % 3; changes > 0; --changes) {
      bytes[random() % bytes.size()] ^= static_cast<std::byte>(1 << random() % 8);
    }
    if (i % 7 == 0) std::ranges::generate(bytes, [&] { return static_cast<std::byte>(random()); });
    send({part_of(bytes, 0, bytes.size(), author)});
  }
  compare();
  EXPECT_GT(seen[kUnreadable], 200u);
  EXPECT_GT(seen["peerd.operation"], 300u);
}

}  // namespace peerd::sim::dissector_test::operations
