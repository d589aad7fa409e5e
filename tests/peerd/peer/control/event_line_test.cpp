#include "peerd/peer/control/event_line.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/vrml/document.hpp"
#include "tests/has_members.hpp"
#include "tests/peerd/peer/node/lone_peer.hpp"

namespace peerd::control::event_line_test {

using namespace replication;
using nlohmann::json;

class EventLine : public testing_support::LonePeer, public testing::Test {
 protected:
  EventLine()
      : LonePeer("#VRML V2.0 utf8\nDEF A Transform { }\nDEF B Transform { }\nDEF DRIVEN Transform { }\n", {"DRIVEN"}) {
    make();
  }
  [[nodiscard]] json line(const Output& output) const {
    const std::string text = event_line(output, *node);
    EXPECT_EQ(text.find('\n'), std::string::npos);
    return json::parse(text);
  }
};

constexpr SimTime kAt{std::chrono::milliseconds(1500)};

TEST_F(EventLine, EachKindHasItsEvents) {
  EXPECT_EQ(kind_of(ObjectGiven{}), EventKind::kObjects);
  EXPECT_EQ(kind_of(ObjectOrphaned{}), EventKind::kObjects);
  EXPECT_EQ(kind_of(ContactSeen{}), EventKind::kContacts);
  EXPECT_EQ(kind_of(Overruled{}), EventKind::kContacts);
  EXPECT_EQ(kind_of(ContactsRetracted{}), EventKind::kContacts);
  EXPECT_EQ(kind_of(PeerJoined{}), EventKind::kPeers);
  EXPECT_EQ(kind_of(PeerLost{}), EventKind::kPeers);
  EXPECT_EQ(kind_of(DataChanged{}), EventKind::kData);
  EXPECT_EQ(kind_of(MessageReceived{}), EventKind::kMessages);
  EXPECT_EQ(kind_of(SceneEdited{}), EventKind::kEdits);
  EXPECT_EQ(kind_of(Send{}), std::nullopt);
  EXPECT_EQ(kind_of(LogGrown{}), std::nullopt);
}

TEST_F(EventLine, SaysWhatHasHappened) {
  const ObjectId a = *node->scene().find("A"), b = *node->scene().find("B");
  EXPECT_EQ(line(ObjectGiven{a, kNobody, PeerId{2}, kAt}), (json{{"v", 1},
                                                                 {"event", "owner"},
                                                                 {"at_s", 1.5},
                                                                 {"object", "A"},
                                                                 {"id", a.packed()},
                                                                 {"owner", 2},
                                                                 {"before", nullptr}}));
  EXPECT_EQ(line(ObjectOrphaned{b, PeerId{2}})["event"], "orphaned");
  ContactSeen seen{ContactKind::kDecided, {}, kAt, PeerId{2}};
  seen.contact.collider = a;
  seen.contact.collidee = b;
  seen.contact.normal = Vec3(0, 1, 0);
  seen.contact.collider_before.position = Vec3(1, 2, 3);
  const json contact = line(seen);
  EXPECT_THAT(contact, HasMembers(R"({"kind": "decided", "collider": "A", "decider": 2})"));
  EXPECT_EQ(contact["collider_position_m"], (json{1.0, 2.0, 3.0}));
  EXPECT_EQ(contact["normal"], (json{0.0, 1.0, 0.0}));
  seen.decider = kNobody;
  EXPECT_TRUE(line(seen)["decider"].is_null());
  EXPECT_EQ(line(Overruled{a, b, kAt})["collidee"], "B");
  EXPECT_EQ(line(ContactsRetracted{a, kAt, b, true})["partner"], "B");
  EXPECT_FALSE(line(ContactsRetracted{a, kAt}).contains("partner"));
  EXPECT_EQ(line(PeerJoined{PeerId{2}, "b", false})["name"], "b");
  EXPECT_EQ(line(PeerLost{PeerId{2}, "b", true})["left_gracefully"], true);
  const NodeId node_a = node->scene().document->ids.id_of(node->scene().at(a).node);
  EXPECT_EQ(line(DataChanged{node_a, "k", "v", kAt}),
            (json{{"v", 1}, {"event", "data"}, {"at_s", 1.5}, {"node", "A"}, {"key", "k"}, {"value", "v"}}));
  EXPECT_EQ(line(DataChanged{NodeId{77, 3}, "k", std::nullopt, kAt})["node"], "node 3:77");
  EXPECT_EQ(line(MessageReceived{{AuthorId{7}, 2}, PeerId{2}, "chat", "a\nb", kAt}),
            (json{{"v", 1},
                  {"event", "message"},
                  {"at_s", 1.5},
                  {"operation", {{"author", 7}, {"number", 2}}},
                  {"peer", 2},
                  {"topic", "chat"},
                  {"text", "a\nb"}}));
  EXPECT_FALSE(line(SceneEdited{{AuthorId{7}, 2}, kAt, ""}).contains("refused"));
  EXPECT_EQ(line(SceneEdited{{AuthorId{7}, 2}, kAt, "it is gone"})["refused"], "it is gone");
  EXPECT_EQ(json::parse(dropped_line(12)), (json{{"v", 1}, {"event", "dropped"}, {"count", 12}}));
}

}  // namespace peerd::control::event_line_test
