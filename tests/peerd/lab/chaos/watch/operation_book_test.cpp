#include "peerd/lab/chaos/watch/operation_book.hpp"

#include <gtest/gtest.h>

namespace peerd::chaos::operation_book_test {

using namespace replication;

constexpr AuthorId kAuthor{7};

Operation message(std::uint32_t number, const std::string& text) {
  return {{kAuthor, number}, SimTime{std::chrono::seconds(number)}, SendMessage{PeerId{1}, "topic", text}};
}

OperationLogs logs_of(std::initializer_list<Operation> operations) {
  OperationLogs logs(kAuthor);
  for (const Operation& operation : operations) EXPECT_TRUE(logs.append(operation));
  return logs;
}

TEST(OperationBook, ReadsOnWhereALogGrows) {
  OperationBook book;
  book.follow(logs_of({message(1, "a")}), kAuthor);
  book.follow(logs_of({message(1, "a"), message(2, "b")}), kAuthor);
  book.follow(logs_of({message(1, "a")}), kAuthor);  // of a peer that is behind
  ASSERT_NE(book.find({kAuthor, 2}), nullptr);
  EXPECT_EQ(book.find({kAuthor, 2})->body, message(2, "b").body);
  EXPECT_EQ(book.operations().size(), 2u);
}

// Chaos seed 20053: an author lost its first operation before anybody had it, and wrote others of its number.
TEST(OperationBook, ForgetsWhatAnAuthorHasWrittenAnew) {
  OperationBook book;
  book.follow(logs_of({message(1, "a"), message(2, "lost with its author"), message(3, "too")}), kAuthor);
  book.follow(logs_of({message(1, "a"), message(2, "anew")}), kAuthor);
  EXPECT_EQ(book.operations().size(), 2u);
  ASSERT_NE(book.find({kAuthor, 2}), nullptr);
  EXPECT_EQ(book.find({kAuthor, 2})->body, message(2, "anew").body);
}

TEST(OperationBook, CutsToWhatAnAuthorStillHas) {
  OperationBook book;
  book.follow(logs_of({message(1, "a"), message(2, "b")}), kAuthor);
  book.cut(logs_of({message(1, "a")}), kAuthor);
  EXPECT_EQ(book.operations().size(), 1u);
  book.cut(OperationLogs{}, kAuthor);
  EXPECT_EQ(book.find({kAuthor, 1}), nullptr);
}

}  // namespace peerd::chaos::operation_book_test
