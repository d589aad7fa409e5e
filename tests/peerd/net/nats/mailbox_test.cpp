#include "peerd/net/nats/mailbox.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace peerd::nats::mailbox_test {

Message message(std::size_t bytes) {
  natsMsg* made = nullptr;
  const std::string text(bytes, 'x');
  EXPECT_EQ(natsMsg_Create(&made, "subject", nullptr, text.data(), static_cast<int>(bytes)), NATS_OK);
  return Message(made);
}

struct MailboxTest : testing::Test {
  // The library frees messages by threads of its own, which it has to be asked for.
  MailboxTest() { EXPECT_EQ(nats_Open(-1), NATS_OK); }

  boost::asio::io_context io;
  net::HostClock clock;
  std::vector<Letter> letters;
};

TEST_F(MailboxTest, WakesTheReaderOnceForWhatWaits) {
  Mailbox mailbox(io, clock, 1 << 20);
  int woken = 0;
  mailbox.put(RegionId{3}, message(10));
  mailbox.open([&] { ++woken; });
  mailbox.put(RegionId{4}, message(20));
  io.poll();
  EXPECT_EQ(woken, 1);
  mailbox.take(letters);
  ASSERT_EQ(letters.size(), 2u);
  EXPECT_EQ(letters[0].region, RegionId{3});
  EXPECT_EQ(natsMsg_GetDataLength(letters[1].message.get()), 20);
  EXPECT_LE(letters[0].at, letters[1].at);
  EXPECT_LE(letters[1].at, clock.now());
  letters.clear();
  mailbox.put(RegionId{3}, message(10));
  io.restart();
  io.poll();
  EXPECT_EQ(woken, 2);
}

TEST_F(MailboxTest, LosesAndCountsWhatHasNoRoom) {
  Mailbox mailbox(io, clock, 3000);
  for (int i = 0; i < 5; ++i) mailbox.put(RegionId{0}, message(1000));
  mailbox.take(letters);
  EXPECT_EQ(letters.size(), 2u) << "with 256 bytes of overhead each";
  EXPECT_EQ(mailbox.lost(), 3u);
  letters.clear();
  mailbox.put(RegionId{0}, message(1000));
  mailbox.take(letters);
  EXPECT_EQ(letters.size(), 1u);
  EXPECT_EQ(mailbox.lost(), 3u);
}

TEST_F(MailboxTest, ClosedCallsNobody) {
  auto mailbox = std::make_shared<Mailbox>(io, clock, 1 << 20);
  mailbox->open([] { FAIL() << "called after close()"; });
  mailbox->put(RegionId{0}, message(1));
  mailbox->close();
  mailbox->put(RegionId{0}, message(1));
  mailbox.reset();
  io.poll();
}

// Thread sanitizer reads this.
TEST_F(MailboxTest, TakesFromAnotherThreadInOrder) {
  Mailbox mailbox(io, clock, 1 << 24);
  constexpr int kCount = 5000;
  int next = 0;
  mailbox.open([&] {
    mailbox.take(letters);
    for (const Letter& letter : letters) EXPECT_EQ(natsMsg_GetDataLength(letter.message.get()), next++ % 100);
    letters.clear();
  });
  std::thread library([&] {
    for (int i = 0; i < kCount; ++i) mailbox.put(RegionId{0}, message(static_cast<std::size_t>(i % 100)));
  });
  const auto work = boost::asio::make_work_guard(io);
  while (next < kCount) io.run_one();
  library.join();
  EXPECT_EQ(mailbox.lost(), 0u);
}

}  // namespace peerd::nats::mailbox_test
