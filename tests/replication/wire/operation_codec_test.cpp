#include <gtest/gtest.h>

#include <limits>

#include "replication/wire/operation.hpp"
#include "replication/wire/wire_limits.hpp"
#include "tests/replication/peer/operations.hpp"

namespace peerd::replication::operation_codec_test {

using test::OperationMaker;

constexpr AuthorId kAuthor{7};

TEST(OperationCodec, RoundTrips) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    SCOPED_TRACE(seed);
    OperationMaker make(seed);
    const Operation o = make.operation({kAuthor, 1 + static_cast<std::uint32_t>(make.random() % 0xFFFF'FFFE)});
    const auto bytes = encode(o);
    const auto back = decode_operation(kAuthor, bytes);
    ASSERT_TRUE(back.has_value()) << back.error();
    ASSERT_TRUE(back->has_value());
    EXPECT_TRUE(test::same((*back)->operation, o));
    EXPECT_EQ((*back)->size_bytes, bytes.size());
    EXPECT_EQ(encode((*back)->operation), bytes);
  }
}

TEST(OperationCodec, WaitsForTheWholeOfIt) {
  const auto bytes = encode(OperationMaker(3).large({kAuthor, 1}, 20'000));
  for (std::size_t size = 0; size < bytes.size(); size += size < 5 ? 1 : 997) {
    const auto back = decode_operation(kAuthor, std::span(bytes).first(size));
    ASSERT_TRUE(back.has_value()) << size;
    EXPECT_FALSE(back->has_value()) << size;
  }
}

const char* error_of(std::span<const std::byte> log) {
  const auto back = decode_operation(kAuthor, log);
  return back ? "none" : back.error();
}
std::string error_of(const Operation& o) { return error_of(encode(o)); }
std::string error_of(std::initializer_list<int> numbers) {
  std::vector<std::byte> bytes;
  for (const int n : numbers) bytes.push_back(static_cast<std::byte>(n));
  return error_of(bytes);
}

constexpr std::uint32_t kOriginTooHigh = std::uint32_t{1} << 31;
Operation with(OperationBody body) { return {{kAuthor, 1}, SimTime{}, std::move(body)}; }

TEST(OperationCodec, NamesWhatIsWrong) {
  const ObjectId good{1, kAuthorMax}, bad{1, kOriginTooHigh};
  const NodeId node{1, 1}, bad_node{1, kOriginTooHigh};
  EXPECT_EQ(error_of(with(RemoveObject{good})), "none");
  EXPECT_EQ(error_of(with(RemoveObject{bad})), "operation_id");
  EXPECT_EQ(error_of(with(RemoveNode{bad_node})), "operation_id");
  EXPECT_EQ(error_of(with(MoveObject{bad, {}, {}})), "operation_id");
  EXPECT_EQ(error_of(with(MoveObject{good, bad, {}})), "operation_id");
  EXPECT_EQ(error_of(with(MoveObject{good, {}, bad})), "operation_id");
  EXPECT_EQ(error_of(with(SetField{bad_node, "a", "1", 0})), "operation_id");
  EXPECT_EQ(error_of(with(SetField{node, "", "1", 0})), "operation_text");
  EXPECT_EQ(error_of(with(SetField{node, "a", "", 0})), "operation_text");
  EXPECT_EQ(error_of(with(SetField{node, "a", std::string("1\0", 2), 0})), "operation_text");
  EXPECT_EQ(error_of(with(ChangeRoute{bad_node, node, "a", "b", false})), "operation_id");
  EXPECT_EQ(error_of(with(ChangeRoute{node, bad_node, "a", "b", false})), "operation_id");
  EXPECT_EQ(error_of(with(ChangeRoute{node, node, "", "b", false})), "operation_text");
  EXPECT_EQ(error_of(with(ChangeRoute{node, node, "a", "", true})), "operation_text");
  EXPECT_EQ(error_of(with(AddNodes{{}, {}, "Group { }", 0, 0, {{"A", good}}})), "none");
  EXPECT_EQ(error_of(with(AddNodes{{}, {}, "", 0, 0, {}})), "operation_text");
  EXPECT_EQ(error_of(with(AddNodes{bad, {}, "Group { }", 0, 0, {}})), "operation_id");
  EXPECT_EQ(error_of(with(AddNodes{{}, bad, "Group { }", 0, 0, {}})), "operation_id");
  EXPECT_EQ(error_of(with(AddNodes{{}, {}, "Group { }", 0, 0, {{"A", bad}}})), "operation_id");
  EXPECT_EQ(error_of(with(AddNodes{{}, {}, "Group { }", 0, 0, {{"", good}}})), "operation_text");
  const PeerId ada{1}, bob{2};
  EXPECT_EQ(error_of(with(GiveObject{good, kNobody, kNobody})), "none");
  EXPECT_EQ(error_of(with(GiveObject{bad, ada, bob})), "operation_id");
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  EXPECT_EQ(error_of(with(GiveObject{good, ada, bob, Placement{{0, kInfinite, 0}, {}}})), "operation_placement");
  EXPECT_EQ(error_of(with(GiveObject{good, ada, bob, Placement{{}, {0, 0, 1, -kInfinite}}})), "operation_placement");
  EXPECT_EQ(error_of(with(PlaceObject{good, ada, {}, {}})), "none");
  EXPECT_EQ(error_of(with(PlaceObject{bad, ada, {}, {}})), "operation_id");
  EXPECT_EQ(error_of(with(PlaceObject{good, kNobody, {}, {}})), "operation_id");
  EXPECT_EQ(error_of(with(PlaceObject{good, ada, SimTime::max(), {}})), "operation_stamp");
  EXPECT_EQ(error_of(with(PlaceObject{good, ada, {}, {{kInfinite, 0, 0}, {}}})), "operation_placement");
  EXPECT_EQ(error_of(with(RequestObject{bad, ada, bob})), "operation_id");
  EXPECT_EQ(error_of(with(RequestObject{good, kNobody, bob})), "operation_id");
  EXPECT_EQ(error_of(with(RequestObject{good, ada, kNobody})), "operation_id");
  EXPECT_EQ(error_of(with(RefuseRequest{{kNoAuthor, 1}, "no"})), "operation_id");
  EXPECT_EQ(error_of(with(RefuseRequest{{AuthorId{kOriginTooHigh}, 1}, "no"})), "operation_id");
  EXPECT_EQ(error_of(with(RefuseRequest{{kAuthor, 0}, "no"})), "operation_id");
  EXPECT_EQ(error_of(with(RefuseRequest{{kAuthor, 1}, ""})), "operation_text");
  EXPECT_EQ(error_of(with(SetData{node, "a", "1"})), "none");
  EXPECT_EQ(error_of(with(SetData{node, "", std::string("\0", 1)})), "none");
  EXPECT_EQ(error_of(with(SetData{bad_node, "a", std::nullopt})), "operation_id");
  EXPECT_EQ(error_of(with(SendMessage{ada, "", ""})), "none");
  EXPECT_EQ(error_of(with(SendMessage{kNobody, "topic", "text"})), "operation_id");
  EXPECT_EQ(error_of(with(UndoOperation{1, SimTime{}, false})), "none");
  EXPECT_EQ(error_of(with(UndoOperation{0, SimTime{}, true})), "operation_id");
  EXPECT_EQ(error_of(with(LockObject{good})), "none");
  EXPECT_EQ(error_of(with(LockObject{bad})), "operation_id");
  EXPECT_EQ(error_of(with(LockObject{bad, true})), "operation_id");
  Operation knows = with(RemoveObject{good});
  knows.knows = {{AuthorId{1}, 1}, {AuthorId{kAuthorMax}, 1}};
  EXPECT_EQ(error_of(knows), "none");
  knows.knows.push_back({AuthorId{kOriginTooHigh}, 1});
  EXPECT_EQ(error_of(knows), "operation_id");
  knows.knows.clear();
  for (std::uint32_t a = 1; a <= kKnowsMax + 1; ++a) knows.knows.push_back({AuthorId{a}, a});
  EXPECT_EQ(error_of(knows), "operation_id");
  knows.knows.pop_back();
  EXPECT_EQ(error_of(knows), "none");
  EXPECT_EQ(error_of({0}), "operation_number");         // an empty message
  EXPECT_EQ(error_of({2, 0x08, 1}), "operation_kind");  // a number and no body
  EXPECT_EQ(error_of({2, 0x08, 0}), "operation_number");
  EXPECT_EQ(error_of({3, 0x08, 1, 0xFF}), "not_an_operation");
  EXPECT_EQ(error_of({11, 0x08, 1, 0x11, 1, 0, 0, 0, 0, 0, 0, 0x40}), "operation_stamp");  // 2^62 + 1 ns
  EXPECT_EQ(error_of({0x82, 0x00, 0x08, 1}), "operation_size");
  EXPECT_EQ(error_of({0xFF, 0xFF, 0xFF}), "operation_too_large");
  EXPECT_EQ(error_of({0x81, 0x80, 0x40}), "operation_too_large");  // 2^20 + 1
  EXPECT_EQ(error_of({0x80, 0x80, 0x40}), "none");                 // 2^20 bytes, of which none is there
}

TEST(OperationCodec, TheLargestIsReadAndALargerOneIsRefused) {
  OperationMaker make(1);
  const std::size_t others = encode(make.large({kAuthor, 1}, 100'000)).size() - 100'000;
  for (const int more : {-8, -1, 0, 1, 8}) {
    const auto bytes =
        encode(make.large({kAuthor, 1}, kOperationMax_bytes + 3 - others + static_cast<std::size_t>(more)));
    const bool fits = bytes.size() <= kOperationMax_bytes + 3;
    EXPECT_EQ(std::string(error_of(bytes)), fits ? "none" : "operation_too_large") << more;
  }
}

// Whatever the bytes, the decoder answers, and what it accepts can be said again.
TEST(OperationCodec, DamagedBytesAreNoHarm) {
  std::size_t accepted = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    OperationMaker make(seed);
    auto bytes = encode(make.operation({kAuthor, 1}));
    for (auto i = 1 + make.random() % 3; i > 0; --i)
      bytes[make.random() % bytes.size()] ^= std::byte{1} << make.random() % 8;
    const auto back = decode_operation(kAuthor, bytes);
    if (!back || !*back) continue;
    ++accepted;
    const auto again = decode_operation(kAuthor, encode((*back)->operation));
    ASSERT_TRUE(again && *again) << seed;
    EXPECT_TRUE(test::same((*again)->operation, (*back)->operation));
  }
  EXPECT_GT(accepted, 100u);
}

}  // namespace peerd::replication::operation_codec_test
