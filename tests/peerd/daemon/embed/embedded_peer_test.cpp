// Two peers in one program, by the interface that strangers have, over multicast on lo.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <thread>

#include <peerd/peerd.hpp>
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::embed::embedded_peer_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF CAR Transform { children Shape { geometry Box { } } }
DEF CUBE Transform { translation 8 0 0 children Shape { geometry Box { } } }
DEF TOWER Transform { translation 0 0 30 children Shape { geometry Box { } } }
CollisionInterest { objectPath "CAR" interests "CUBE" collisionType 1 }
)";

// A port that no other test process uses, as in tests/net/listener.hpp, which needs the inside of the house.
std::string own_port() { return std::to_string(10'000 + getpid() % 1400 * 16); }

class Embedded : public testing::Test {
 protected:
  Embedded() {
    folder.write("w.wrl", kWorld);
    setenv("XDG_CONFIG_HOME", (folder / "settings").c_str(), 1);
  }
  [[nodiscard]] Options options(const std::string& name, const std::string& own) const {
    return Options()
        .set("world", (folder / "w.wrl").string())
        .set("name", name)
        .set("own", own)
        .set("interface", "lo")
        .set("port", own_port())
        .set("take-over", "yes");
  }
  // Does that again and again until the condition holds; not for ever.
  static bool wait_until(const std::function<bool()>& holds, const std::function<bool()>& meanwhile) {
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!holds()) {
      if (std::chrono::steady_clock::now() > give_up || !meanwhile()) return false;
    }
    return true;
  }
  // Drives both until the condition holds.
  static bool run_until(Peer& a, Peer& b, const std::function<bool()>& holds) {
    return wait_until(holds, [&] { return a.poll(0.002) && b.poll(0.002); });
  }
  static bool are_together(const Peer& a, const Peer& b) {
    return a.in_session() && b.in_session() && a.member_count() == 1 && b.member_count() == 1;
  }
  static bool meet(Peer& a, Peer& b) {
    return run_until(a, b, [&] { return are_together(a, b); });
  }

  testing_support::ScratchFolder folder;
};

TEST_F(Embedded, SeesWhatTheOtherMovesAndBothSeeTheContact) {
  Peer a(options("a", "CAR")), b(options("b", "CUBE"));
  ASSERT_TRUE(meet(a, b));
  const Object car = a.find("CAR").value(), cube = b.find("CUBE").value();
  EXPECT_EQ(b.find("CAR"), car) << "it is the same number at all peers";
  EXPECT_EQ(b.path(car), "CAR");
  EXPECT_EQ(a.find("HORSE"), std::nullopt);
  ASSERT_TRUE(run_until(a, b, [&] { return b.owner(car) == a.id() && a.owner(cube) == b.id(); }));
  EXPECT_THAT(a.owned_objects(), ElementsAre(car, cube));

  a.take(car);  // from then on this program moves what a configuration gave to this peer
  const double begin = a.session_time().value();
  const auto drive = [&] {
    const double x = 4.0 * (a.session_time().value() - begin);
    a.move(car, Pose{{x, 0.0, 0.0}}, Vector{4.0, 0.0, 0.0});
  };
  ASSERT_TRUE(run_until(a, b, [&] {
    drive();
    const auto seen = b.pose(car);
    return seen && seen->position[0] > 3.0;
  }));
  EXPECT_NEAR(b.pose(car)->position[1], 0.0, 1e-6);

  std::optional<Event> at_a, at_b;
  const auto note = [&](Peer& peer, std::optional<Event>& contact) {
    while (const auto event = peer.next_event()) {
      if (event->kind == PEERD_CONTACT) contact = event;
    }
  };
  ASSERT_TRUE(run_until(a, b, [&] {
    drive();
    note(a, at_a);
    note(b, at_b);
    return at_a && at_b;
  }));
  for (const auto& contact : {*at_a, *at_b}) {
    EXPECT_THAT((std::array{contact.object, contact.other}), testing::UnorderedElementsAre(car, cube));
    EXPECT_NEAR(std::abs(contact.normal[0]), 1.0, 1e-9);
    const bool is_car = contact.object == car;
    EXPECT_NEAR((is_car ? contact.velocity_before : contact.other_velocity_before)[0], 4.0, 1e-3);
    EXPECT_NEAR((is_car ? contact.velocity_after : contact.other_velocity_after)[0], 4.0, 1e-3) << "it is driven";
    EXPECT_EQ((is_car ? contact.other_velocity_before : contact.velocity_before), Vector{});
  }
  EXPECT_EQ(at_a->time, at_b->time) << "one outcome";
  EXPECT_EQ(at_a->peer, at_b->peer);
}

// Returns the exit code of a forked child that does this; -1 where it does not end.
int exit_code_of_child(const std::function<int()>& work) {
  const pid_t child = fork();
  if (child == 0) _exit(work());
  int status = 0;
  for (int i = 0; i < 2000; ++i) {
    if (waitpid(child, &status, WNOHANG) == child) return WIFEXITED(status) ? WEXITSTATUS(status) : -2;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
  return -1;
}

// The C interface in a child of fork(): each call is refused and says why, and nothing of the parent's peer changes.
int refuse_all_of(peerd_peer* peer) {
  int wrong = 0;
  const auto expect = [&](bool holds) { wrong += holds ? 0 : 1; };
  peerd_hold(peer);
  expect(peerd_poll(peer, 0.0) == 0);
  expect(peerd_start(peer) == 0);
  expect(peerd_id(peer) == 0);
  expect(peerd_has_left(peer) == 1);
  expect(peerd_in_session(peer) == 0);
  expect(std::isnan(peerd_session_time(peer)));
  expect(peerd_find(peer, "CAR") == PEERD_NO_OBJECT);
  expect(peerd_world(peer) == nullptr);
  expect(peerd_data(peer, "CAR", "a") == nullptr);
  peerd_operation operation{1, 1};
  expect(peerd_send(peer, "chat", "child", &operation) == 0 && operation.number == 0);
  expect(peerd_add(peer, PEERD_NO_OBJECT, "Group { }", nullptr) == 0);
  expect(peerd_set_data(peer, "CAR", "a", "child", nullptr) == 0);
  expect(peerd_ask(peer, "{}") == nullptr);
  peerd_event event{};
  expect(peerd_next_event(peer, &event, sizeof(event)) == 0);
  expect(peerd_event_descriptor(peer) == -1);
  expect(std::string(peerd_error(peer)).find("another process") != std::string::npos);
  peerd_unhold(peer);
  peerd_leave(peer);
  peerd_close(peer);
  return wrong;
}

TEST_F(Embedded, AChildOfForkHasNoPartInIt) {
  for (const bool has_thread : {false, true}) {
    Peer a(options("a", "CAR")), b(options("b", "CUBE"));
    ASSERT_TRUE(meet(a, b));
    const auto polled = [&](const std::function<bool()>& holds) {
      return wait_until(holds, [&] { return (has_thread || a.poll(0.002)) && b.poll(0.002); });
    };
    if (has_thread) a.start();
    peerd_peer* const handle = a.handle();
    EXPECT_EQ(exit_code_of_child([&] { return refuse_all_of(handle); }), 0);
    EXPECT_EQ(exit_code_of_child([&] {
                const Peer own = std::move(a);
                try {
                  (void)own.id();
                } catch (const Error&) {
                  return 0;
                }
                return 1;
              }),
              0);
    a.send("chat", "parent");
    std::optional<Event> heard;
    ASSERT_TRUE(polled([&] {
      while (const auto event = b.next_event()) {
        EXPECT_NE(event->kind, PEERD_PEER_LEFT);
        if (event->kind == PEERD_MESSAGE) heard = event;
      }
      return heard.has_value();
    }));
    EXPECT_EQ(heard->text, "parent");
    EXPECT_EQ(b.member_count(), 1u);
    EXPECT_FALSE(a.has_left());
  }
}

TEST_F(Embedded, AFunctionForTheLogMayThrow) {
  Options throwing = options("a", "CAR");
  int lines = 0;
  throwing.log_to([&](int, const std::string&) {
    ++lines;
    throw std::runtime_error("no log");
  });
  Peer a(throwing);
  a.start();
  EXPECT_TRUE(wait_until([&] { return a.in_session(); }, [] { return true; }));
  EXPECT_GT(lines, 0);
}

TEST_F(Embedded, DataMayHaveZeroBytesAndOtherTextsMayNot) {
  Peer a(options("a", "CAR"));
  const std::string value("a\0b", 3);
  ASSERT_TRUE(wait_until([&] { return a.in_session(); }, [&] { return a.poll(0.002); }));
  a.set_data("CAR", "text", value);
  EXPECT_TRUE(wait_until([&] { return a.data("CAR", "text") == value; }, [&] { return a.poll(0.002); }));
  EXPECT_STREQ(peerd_data(a.handle(), "CAR", "text"), "a");
  EXPECT_THROW(a.send("chat", value), Error);
  EXPECT_THROW((void)a.find(value), Error);
}

TEST_F(Embedded, EditsDataAndMessagesReachTheOther) {
  Peer a(options("a", "CAR")), b(options("b", "CUBE"));
  ASSERT_TRUE(meet(a, b));
  const Operation added = a.add("DEF BALL Transform { children Shape { geometry Sphere { } } }");
  EXPECT_GT(added.number, 0u);
  ASSERT_TRUE(run_until(a, b, [&] { return b.find("BALL") && a.find("BALL"); }));
  EXPECT_THAT(b.world(), HasSubstr("BALL"));
  b.set("BALL", "translation", "1 2 3");
  a.set_data("BALL", "colour", "red");
  a.send("chat", "hello");
  std::optional<Event> message, data, own_message;
  ASSERT_TRUE(run_until(a, b, [&] {
    while (const auto event = a.next_event()) {
      if (event->kind == PEERD_MESSAGE) own_message = event;
    }
    while (const auto event = b.next_event()) {
      if (event->kind == PEERD_MESSAGE) message = event;
      if (event->kind == PEERD_DATA) data = event;
    }
    return message && data && own_message;
  }));
  EXPECT_EQ(message->name, "chat");
  EXPECT_EQ(message->text, "hello");
  EXPECT_EQ(message->peer, a.id());
  EXPECT_EQ(data->path, "BALL");
  EXPECT_EQ(data->name, "colour");
  EXPECT_EQ(data->text, "red");
  EXPECT_EQ(b.data("BALL", "colour"), "red");
  EXPECT_EQ(b.data("BALL", "size"), std::nullopt);
  const Object ball = a.find("BALL").value();
  ASSERT_TRUE(run_until(a, b, [&] { return a.pose(ball)->position == Vector{1.0, 2.0, 3.0}; }));
  b.undo();
  ASSERT_TRUE(run_until(a, b, [&] { return a.pose(ball)->position == Vector{}; }));
  b.reparent(ball, b.find("CAR").value());
  ASSERT_TRUE(run_until(a, b, [&] { return a.path(ball) == "CAR/BALL"; }));
  a.remove(ball);
  ASSERT_TRUE(run_until(a, b, [&] { return !b.find("BALL"); }));
  EXPECT_EQ(b.pose(ball), std::nullopt);
}

TEST_F(Embedded, JoinsAWorldOfAnotherWithoutItsFile) {
  const std::string world = "embed-test-" + own_port();
  Peer a(options("a", "CAR").set("world-name", world).set("set", "transport.snapshot_port=" + own_port()));
  a.start();  // it answers while others ask
  while (!a.in_session()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  a.add("DEF BALL Transform { children Shape { geometry Sphere { } } }");
  const auto joining = [](const std::string& name) {
    return Options().set("name", name).set("interface", "lo").set("take-over", "yes");
  };
  const auto has_ball = [&](Peer& peer) {
    return wait_until([&] { return peer.find("BALL") && are_together(a, peer); }, [&] { return peer.poll(0.002); });
  };
  {
    Peer by_name(joining("b").set("join", world));
    ASSERT_TRUE(has_ball(by_name));
    EXPECT_EQ(by_name.find("CAR"), a.find("CAR"));
  }
  Peer by_address(joining("c").set("join", world).set("from", "127.0.0.1:" + own_port()));
  (void)wait_until([&] { return a.member_count() <= 1; }, [&] { return by_address.poll(0.002); });
  EXPECT_TRUE(has_ball(by_address));
  EXPECT_THROW(Peer(joining("d").set("join", world + "-elsewhere")), Error) << "there is no such world";
}

// The loop of a program waits for the descriptor and for whatever else it waits for.
TEST_F(Embedded, ItsDescriptorIsReadableWhileEventsWaitAndOnceItHasLeft) {
  const auto is_readable = [](const Peer& peer, int at_most_ms) {
    pollfd waits{peer.event_descriptor(), POLLIN, 0};
    return ::poll(&waits, 1, at_most_ms) == 1;
  };
  Peer a(options("a", "CAR")), b(options("b", "CUBE"));
  EXPECT_FALSE(is_readable(a, 0));
  ASSERT_TRUE(meet(a, b));
  a.start();
  b.start();
  ASSERT_TRUE(is_readable(a, 20'000)) << "the other has joined";
  EXPECT_TRUE(is_readable(a, 0)) << "until the event is taken";
  while (a.next_event()) {
  }
  b.send("chat", "hello");
  std::optional<Event> message;
  while (!message && is_readable(a, 20'000)) {
    message = a.next_event();
    if (message && message->kind != PEERD_MESSAGE) message.reset();
  }
  ASSERT_TRUE(message);
  EXPECT_EQ(message->text, "hello");
  EXPECT_FALSE(a.has_left());
  a.leave();
  EXPECT_TRUE(a.has_left());
  while (a.next_event()) {
  }
  EXPECT_TRUE(is_readable(a, 20'000)) << "who waits for it would wait for ever";
}

TEST_F(Embedded, WithThreadsTheProgramOnlyAsks) {
  Peer a(options("a", "CAR")), b(options("b", "CUBE"));
  a.start();
  b.start();
  EXPECT_THROW(a.start(), Error) << "it has a thread";
  EXPECT_FALSE(a.poll(0.0)) << "its thread does that";
  const auto waits = [](const std::function<bool()>& holds) {
    return wait_until(holds, [] {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      return true;
    });
  };
  ASSERT_TRUE(waits([&] { return are_together(a, b); }));
  // Several threads ask at once.
  std::vector<std::thread> askers;
  for (int i = 0; i < 4; ++i) {
    askers.emplace_back([&] {
      for (int n = 0; n < 200; ++n) {
        const Peer::Hold held(a);
        const auto one = a.session_time(), other = a.session_time();
        EXPECT_TRUE(one && other);
        (void)a.pose(a.find("CAR").value());
      }
    });
  }
  for (std::thread& asker : askers) asker.join();
  a.send("chat", "by a");
  ASSERT_TRUE(waits([&] {
    const auto event = b.next_event();
    return event && event->kind == PEERD_MESSAGE;
  }));
  b.leave();
  ASSERT_TRUE(waits([&] { return a.member_count() == 0; })) << "it has said goodbye";
  EXPECT_EQ(b.find("CAR"), a.find("CAR")) << "what has left may still be asked";
}

TEST_F(Embedded, SaysWhyNot) {
  const auto why = [](const std::function<void()>& work) -> std::string {
    try {
      work();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(why([] { Options().set("colour", "red"); }), HasSubstr("no option colour"));
  EXPECT_THAT(why([] { Options().set("id", "first"); }), HasSubstr("does not take \"first\""));
  EXPECT_THAT(why([] { Peer peer(Options().set("name", "a")); }),
              HasSubstr("give a configuration, a world, or one to join"));
  EXPECT_THAT(why([] { Peer peer(Options().set("world", "/nowhere.wrl")); }), HasSubstr("/nowhere.wrl"));
  std::vector<std::string> lines;
  Peer peer(options("a", "CAR").log_to([&](int, const std::string& text) { lines.push_back(text); }));
  EXPECT_THAT(lines, testing::Contains(HasSubstr("peer a")));
  EXPECT_THAT(why([&] { peer.remove(PEERD_NO_OBJECT); }), HasSubstr("no such object"));
  EXPECT_THAT(why([&] { peer.set("HORSE", "translation", "1 2 3"); }), HasSubstr("HORSE"));
  EXPECT_FALSE(peer.move(peer.find("TOWER").value(), Pose{})) << "it is not this peer's";
  EXPECT_THAT(peer.ask("{\"do\":\"dance\"}"), HasSubstr("\"ok\":false"));
}

}  // namespace
}  // namespace peerd::embed::embedded_peer_test
