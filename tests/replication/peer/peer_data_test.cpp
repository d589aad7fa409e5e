// Data that applications keep at nodes, and messages to all: whole peers on a small network.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/replication/peer/editing_peers.hpp"

namespace peerd::replication::peer_data_test {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Data : public EditingPeers {
 protected:
  [[nodiscard]] std::string value(std::size_t i, const char* path, const std::string& key) const {
    const std::string* const value = lan->peer(i).data().find(node(path), key);
    return value == nullptr ? "none" : *value;
  }
  // The texts that a peer has been given, in order.
  [[nodiscard]] std::vector<std::string> texts(std::size_t i) const {
    std::vector<std::string> texts;
    for (const MessageReceived& each : lan->seen<MessageReceived>(i)) texts.push_back(each.text);
    return texts;
  }
  [[nodiscard]] SendMessage message(std::size_t i, const std::string& text) const {
    return {lan->peer(i).id(), "chat", text};
  }
};

TEST_F(Data, AreTheSameForAllFromOneInstantOn) {
  begin();
  (void)edit(1, SetData{node("CAR"), "colour", "red"});
  EXPECT_EQ(value(1, "CAR", "colour"), "none") << "not before its stamp";
  run_on(1s);
  std::vector<SimTime> since;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(value(i, "CAR", "colour"), "red");
    EXPECT_EQ(value(i, "BALL", "colour"), "none");
    const auto changed = lan->seen<DataChanged>(i);
    ASSERT_EQ(changed.size(), 1u);
    EXPECT_EQ(changed[0].value, "red");
    since.push_back(changed[0].at);
  }
  EXPECT_THAT(since, testing::Each(since[0]));
  (void)edit(2, SetData{node("CAR"), "colour", std::nullopt});
  (void)edit(2, SetData{node("CAR"), "empty", ""});
  run_on(1s);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(value(i, "CAR", "colour"), "none");
    EXPECT_EQ(value(i, "CAR", "empty"), "") << "is a value";
    EXPECT_EQ(lan->seen<DataChanged>(i).size(), 3u);
    EXPECT_EQ(lan->peer(i).counters().scene_changes, 0u) << "the scene is as before";
  }
}

TEST_F(Data, GoWithTheNode) {
  begin();
  const NodeId car = node("CAR");
  (void)edit(0, SetData{car, "colour", "red"});
  run_on(1s);
  (void)edit(1, RemoveObject{world["CAR"]});
  run_on(1s);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(lan->peer(i).data().empty());
    EXPECT_EQ(lan->seen<DataChanged>(i).back().value, std::nullopt);
  }
  EXPECT_EQ(refusal(0, SetData{car, "colour", "blue"}), "it is not in the scene any more");
}

TEST_F(Data, LimitsAreSaid) {
  begin();
  EXPECT_EQ(refusal(0, SetData{node("CAR"), "", "1"}), "a key has 1 to 256 bytes, and this one 0");
  EXPECT_EQ(refusal(0, SetData{node("CAR"), std::string(257, 'k'), "1"}), "a key has 1 to 256 bytes, and this one 257");
  EXPECT_EQ(refusal(0, SetData{node("CAR"), "k", std::string(16'385, 'v')}),
            "the value has 16385 bytes, and may have 16384");
  EXPECT_EQ(refusal(0, SetData{node("CAR"), std::string(256, 'k'), std::string(16'384, 'v')}), "");
  EXPECT_THAT(refusal(0, SendMessage{PeerId{1}, "", "text"}), HasSubstr("a topic has 1 to 256 bytes"));
  EXPECT_THAT(refusal(0, SendMessage{PeerId{1}, "chat", std::string(16'385, 't')}), HasSubstr("may have 16384"));
  EXPECT_EQ(lan->peer(0).counters().operations, 1u);
}

// Whatever the network loses, doubles and overtakes.
TEST_F(Data, MessagesComeOnceAndInTheOrderOfTheirAuthor) {
  begin({.latency = 20ms, .jitter = 60ms, .loss = 0.2, .duplicates = 0.2}, 7);
  std::vector<std::string> of_author[2];
  for (int k = 0; k < 20; ++k) {
    for (const std::size_t i : {0, 1}) {
      of_author[i].push_back(std::to_string(i) + ":" + std::to_string(k));
      (void)edit(i, message(i, of_author[i].back()));
    }
    run_on(30ms);
  }
  run_on(8s);
  for (std::size_t i = 0; i < 3; ++i) {
    std::vector<std::string> seen[2];
    for (const std::string& text : texts(i)) seen[text[0] - '0'].push_back(text);
    EXPECT_EQ(seen[0], of_author[0]) << "peer " << i + 1;
    EXPECT_EQ(seen[1], of_author[1]) << "peer " << i + 1;
  }
  EXPECT_EQ(lan->seen<MessageReceived>(2)[0].topic, "chat");
  EXPECT_EQ(lan->peer(2).counters().scene_changes, 0u);
}

TEST_F(Data, MessagesAreForThoseWhoWereThere) {
  begin();
  lan->part({2});
  run_on(3s);
  (void)edit(0, message(0, "while apart"));
  run_on(2s);
  EXPECT_THAT(texts(2), IsEmpty());
  lan->part({});
  run_on(6s);
  EXPECT_THAT(texts(2), ElementsAre("while apart"));
  lan->add(config(4));
  run_on(4s);
  EXPECT_EQ(lan->peer(3).logs().lengths(), lan->peer(0).logs().lengths()) << "it has the log";
  EXPECT_THAT(texts(3), IsEmpty());
  (void)edit(0, message(0, "welcome"));
  run_on(1s);
  EXPECT_THAT(texts(3), ElementsAre("welcome"));
  EXPECT_THAT(texts(1), ElementsAre("while apart", "welcome"));
}

}  // namespace peerd::replication::peer_data_test
