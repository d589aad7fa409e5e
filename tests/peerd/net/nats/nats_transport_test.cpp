// The transport against the real nats-server.
#include "peerd/net/nats/nats_transport.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/asio/executor_work_guard.hpp>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/must.hpp"
#include "tests/net/listener.hpp"
#include "tests/peerd/net/nats/nats_server.hpp"

namespace peerd::nats::nats_transport_test {

using net::testing_support::bytes_of;
using net::testing_support::clock;
using net::testing_support::text_of;
using peerd::testing_support::NatsServer;
using peerd::testing_support::ScratchFolder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

using Heard = std::vector<std::pair<std::uint32_t, std::string>>;

// A transport that records what it hears.
struct Listener {
  Listener(boost::asio::io_context& io, NatsOptions options) {
    transport = must(NatsTransport::open(io, clock(), options));
    transport->on_receive([this](const net::Arrival& arrival) {
      heard.emplace_back(arrival.region.value, text_of(arrival.datagram));
      at.push_back(arrival.at);
      if (then) then(heard.back().second);
    });
  }
  void join(std::uint32_t region) { ASSERT_TRUE(transport->join(RegionId{region})); }
  void leave(std::uint32_t region) { ASSERT_TRUE(transport->leave(RegionId{region})); }
  void send(std::uint32_t region, const std::string& text) {
    transport->send(RegionId{region}, bytes_of(text));
    transport->flush();
  }
  [[nodiscard]] bool has_heard(const std::string& text) const {
    return std::ranges::any_of(heard, [&](const auto& each) { return each.second == text; });
  }

  Heard heard;
  std::vector<HostTime> at;
  std::function<void(const std::string&)> then;
  std::unique_ptr<NatsTransport> transport;
};

class NatsTransportTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!peerd::testing_support::has_nats_server()) GTEST_SKIP() << "nats-server is not installed";
  }
  [[nodiscard]] static NatsOptions by(std::vector<std::string> servers) {
    NatsOptions options;
    options.settings.servers = std::move(servers);
    options.world = "town";
    options.session = 7;
    return options;
  }
  // Each turn takes 10 ms, or until something has come: whoever sends in `holds` must not fill the outbox, which would
  // refuse what the test sends next.
  bool run_until(const std::function<bool()>& holds, double within_s = 20.0) {
    const auto work = boost::asio::make_work_guard(io);  // without it an idle run_one_for() returns at once
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::duration<double>(within_s);
    while (!holds()) {
      if (std::chrono::steady_clock::now() > give_up) return false;
      io.restart();
      io.run_one_for(std::chrono::milliseconds(10));
    }
    return true;
  }
  // Sends until it is heard in that region: the subscription has gone to the server by then, with all that was done
  // before it.
  [[nodiscard]] bool meet(Listener& from, Listener& to, std::uint32_t region, const std::string& word) {
    return run_until([&] {
      from.send(region, word);
      return std::ranges::find(to.heard, std::pair(region, word)) != to.heard.end();
    });
  }
  // Sends a marker after all else, and waits until it is heard.
  [[nodiscard]] testing::AssertionResult mark(Listener& from, Listener& to, std::uint32_t region) {
    const std::string word = "marker " + std::to_string(++marks_);
    from.send(region, word);
    if (run_until([&] { return to.has_heard(word); })) return testing::AssertionSuccess();
    auto failure = testing::AssertionFailure() << word << " was not heard;";
    for (const auto& [who, listener] : {std::pair{"sender's ", &from}, {"receiver's ", &to}}) {
      for (const auto& [name, n] : listener->transport->counters().named()) {
        if (n > 0) failure << " " << who << name << " " << n;
      }
      while (const auto said = listener->transport->follow_interface()) failure << " " << who << said->sentence;
    }
    const bool was_there = to.transport->receive_pending();
    return failure << (was_there ? " It waited, and nobody was woken." : "");
  }
  static void forget(Listener& listener) { listener.heard.clear(); }
  [[nodiscard]] static Heard without_markers(Heard heard) {
    std::erase_if(heard, [](const auto& each) { return each.second.starts_with("marker") || each.second == "hello"; });
    return heard;
  }

  ScratchFolder folder;
  boost::asio::io_context io{1};
  int marks_ = 0;
};

TEST_F(NatsTransportTest, CarriesDatagramsOfJoinedRegionsInOrder) {
  NatsServer server(folder, "server");
  Listener a(io, by({server.url()})), b(io, by({server.url()}));
  b.join(0);
  b.join(5);
  ASSERT_TRUE(meet(a, b, 0, "hello"));
  ASSERT_TRUE(meet(a, b, 5, "hello"));
  const HostTime before = clock().now();
  for (int i = 0; i < 100; ++i) {
    a.transport->send(RegionId{5}, bytes_of(std::to_string(i)));
    if (i % 10 == 0) a.transport->flush();
  }
  a.send(6, "of no joined region");
  ASSERT_TRUE(mark(a, b, 5));
  Heard expected;
  for (int i = 0; i < 100; ++i) expected.emplace_back(5, std::to_string(i));
  EXPECT_EQ(without_markers(b.heard), expected);
  EXPECT_GE(b.at.back(), before);
  EXPECT_LE(b.at.back(), clock().now());
  EXPECT_EQ(b.transport->joined_count(), 2u);
  EXPECT_EQ(b.transport->counters().packets_in, b.heard.size());
  EXPECT_GT(b.transport->counters().bytes_in, 100u);
  EXPECT_TRUE(run_until([&] { return a.transport->counters().packets_out >= 102; }));
  EXPECT_THAT(a.transport->describe(), AllOf(HasSubstr("peerd.town.any.0"), HasSubstr("peerd.town.0000000000000007.*"),
                                             HasSubstr(server.url())));
}

TEST_F(NatsTransportTest, DoesNotHearItself) {
  NatsServer server(folder, "server");
  Listener a(io, by({server.url()})), b(io, by({server.url()}));
  a.join(1);
  b.join(1);
  ASSERT_TRUE(meet(a, b, 1, "hello"));
  ASSERT_TRUE(meet(b, a, 1, "hello"));
  forget(a);
  a.send(1, "mine");
  ASSERT_TRUE(mark(a, b, 1));
  ASSERT_TRUE(mark(b, a, 1));
  EXPECT_THAT(without_markers(a.heard), ElementsAre());
}

// A region is left while a datagram of it is under way, or waits in this process already: it is not handed on. What
// comes later does not even come.
TEST_F(NatsTransportTest, HearsNothingOfARegionThatItHasLeft) {
  NatsServer server(folder, "server");
  Listener a(io, by({server.url()})), b(io, by({server.url()}));
  b.join(1);
  b.join(2);
  ASSERT_TRUE(meet(a, b, 1, "hello"));
  ASSERT_TRUE(meet(a, b, 2, "hello"));
  b.then = [&](const std::string& text) {
    if (text == "leave") b.leave(1);
  };
  a.transport->send(RegionId{2}, bytes_of("leave"));
  a.transport->send(RegionId{1}, bytes_of("behind it"));
  ASSERT_TRUE(mark(a, b, 2));
  EXPECT_TRUE(b.has_heard("leave"));
  EXPECT_FALSE(b.has_heard("behind it"));
  const std::uint64_t dropped = b.transport->counters().in_other_region;
  EXPECT_LE(dropped, 1u);
  b.join(3);  // the worker makes changes in their order: once 3 is heard, 1 is left
  ASSERT_TRUE(meet(a, b, 3, "hello of 3"));
  a.send(1, "later");
  ASSERT_TRUE(mark(a, b, 3));
  EXPECT_FALSE(b.has_heard("later"));
  EXPECT_EQ(b.transport->counters().in_other_region, dropped) << "the subscription is no more";
  b.join(1);
  ASSERT_TRUE(meet(a, b, 1, "joined again"));
}

TEST_F(NatsTransportTest, OtherWorldsAndSessionsAreApart) {
  NatsServer server(folder, "server");
  NatsOptions other = by({server.url()}), version = by({server.url()}), prefix = by({server.url()});
  other.world = "village";
  version.session = 8;
  prefix.settings.subject = "test.peerd";
  Listener a(io, by({server.url()})), b(io, by({server.url()})), c(io, other), d(io, version), e(io, prefix);
  for (Listener* each : {&b, &c, &d, &e}) {
    each->join(0);
    each->join(1);
  }
  ASSERT_TRUE(meet(a, b, 0, "hello"));
  ASSERT_TRUE(meet(a, d, 0, "hello")) << "another version of the world is noticed in region 0";
  Listener c2(io, other), e2(io, prefix), d2(io, version);
  ASSERT_TRUE(meet(c2, c, 1, "marker"));
  ASSERT_TRUE(meet(e2, e, 1, "marker"));
  ASSERT_TRUE(meet(d2, d, 1, "marker"));
  for (Listener* each : {&b, &c, &d, &e}) forget(*each);
  a.send(1, "of region 1");
  a.send(0, "of region 0");
  ASSERT_TRUE(mark(a, b, 0));
  ASSERT_TRUE(mark(c2, c, 0));
  ASSERT_TRUE(mark(e2, e, 0));
  ASSERT_TRUE(run_until([&] { return d.has_heard("of region 0"); }));
  EXPECT_THAT(without_markers(b.heard),
              ElementsAre(Heard::value_type{1, "of region 1"}, Heard::value_type{0, "of region 0"}));
  EXPECT_THAT(without_markers(c.heard), ElementsAre());
  EXPECT_THAT(without_markers(d.heard), ElementsAre(Heard::value_type{0, "of region 0"}));
  EXPECT_THAT(without_markers(e.heard), ElementsAre());
}

TEST_F(NatsTransportTest, CountsWhatIsTooLarge) {
  NatsServer server(folder, "server");
  Listener a(io, by({server.url()})), b(io, by({server.url()}));
  b.join(0);
  a.send(0, std::string(net::kMaxDatagramBytes + 1, 'x'));
  EXPECT_EQ(a.transport->counters().out_too_large, 1u);
  ASSERT_TRUE(meet(a, b, 0, std::string(net::kMaxDatagramBytes, 'x')));
}

// A process that does not read loses what has no room, which is counted and said.
TEST_F(NatsTransportTest, ASlowReaderLosesAndSaysSo) {
  NatsServer server(folder, "server");
  NatsOptions small = by({server.url()});
  small.receive_bytes = 10'000;
  Listener a(io, by({server.url()})), b(io, small);
  b.join(0);
  ASSERT_TRUE(meet(a, b, 0, "hello"));
  for (int i = 0; i < 50; ++i) a.send(0, std::string(1000, 'x'));
  EXPECT_TRUE(testing_support::comes_true([&] { return b.transport->counters().in_queue_overflow >= 40; }, 20));
  const auto said = must(b.transport->follow_interface());
  EXPECT_FALSE(said.is_back);
  EXPECT_THAT(said.sentence, HasSubstr("were lost: this peer reads them too slowly"));
  EXPECT_FALSE(b.transport->follow_interface()) << "said once";
  ASSERT_TRUE(run_until([&] { return b.has_heard(std::string(1000, 'x')); }));
  ASSERT_TRUE(mark(a, b, 0)) << "and goes on";
}

// A datagram that could not leave is counted and not sent later; both hear each other again, in all their regions.
TEST_F(NatsTransportTest, GoesOnWhenTheServerIsBack) {
  NatsServer server(folder, "server");
  Listener a(io, by({server.url()})), b(io, by({server.url()}));
  a.join(3);
  b.join(0);
  b.join(3);
  ASSERT_TRUE(meet(a, b, 3, "hello"));
  server.kill();
  std::optional<net::InterfaceChange> said;
  ASSERT_TRUE(run_until([&] { return (said = a.transport->follow_interface()).has_value(); }));
  EXPECT_FALSE(said->is_back);
  EXPECT_THAT(said->sentence, HasSubstr("the NATS server is gone"));
  for (int i = 0; i < 20; ++i) a.send(3, "into the void");
  ASSERT_TRUE(run_until([&] { return a.transport->counters().out_unreachable >= 20; }));
  b.join(4);
  b.leave(0);
  server.start();
  ASSERT_TRUE(run_until([&] { return (said = a.transport->follow_interface()).has_value(); }));
  EXPECT_TRUE(said->is_back);
  EXPECT_THAT(said->sentence, HasSubstr("goes on by NATS server " + server.url()));
  ASSERT_TRUE(meet(a, b, 3, "again"));
  ASSERT_TRUE(meet(a, b, 4, "anew"));
  ASSERT_TRUE(meet(b, a, 3, "back"));
  EXPECT_FALSE(b.has_heard("into the void"));
}

// What is wrong is said when it is another thing than before: silence, then a refusal, then too small messages.
TEST_F(NatsTransportTest, SaysWhyEachServerThatComesLaterIsNoUse) {
  NatsServer refuses(folder, "refuses", "authorization { user: peer, password: secret }\n");
  refuses.kill();
  Listener a(io, by({refuses.url()}));
  const auto says = [&](const std::string& words) {
    return run_until([&] {
      const auto said = a.transport->follow_interface();
      return said && said->sentence.find(words) != std::string::npos;
    });
  };
  ASSERT_TRUE(says("no NATS server answers at " + refuses.url()));
  refuses.start();
  ASSERT_TRUE(says("the NATS server refuses this user (" + refuses.url()));
  refuses.kill();
  refuses.configure("max_payload: 1000\n");
  refuses.start();
  ASSERT_TRUE(says("takes messages of 1000 bytes at most"));
  refuses.kill();
  refuses.configure("");
  refuses.start();
  ASSERT_TRUE(says("goes on by NATS server " + refuses.url()));
}

// A server that hangs is left after two pings that it does not answer.
TEST_F(NatsTransportTest, LeavesAServerThatHangsForAnother) {
  NatsServer server(folder, "one"), other(folder, "two");
  Listener a(io, by({server.url(), other.url()}));
  const bool at_first = a.transport->describe().find(server.url()) != std::string::npos;
  NatsServer& hanging = at_first ? server : other;
  NatsServer& healthy = at_first ? other : server;
  hanging.signal(SIGSTOP);
  std::optional<net::InterfaceChange> said;
  const auto back = [&] {
    said = a.transport->follow_interface();
    return said && said->is_back;
  };
  EXPECT_TRUE(run_until(back));
  EXPECT_THAT(said ? said->sentence : "", HasSubstr(healthy.url()));
  hanging.signal(SIGCONT);
}

// The worker waits for a server that takes nothing; send() and flush() don't, or the queue would never be full.
TEST_F(NatsTransportTest, NeverWaitsForAServerThatHangs) {
  NatsServer server(folder, "server");
  Listener a(io, by({server.url()}));
  server.signal(SIGSTOP);
  const std::string big(1400, 'x');
  std::uint64_t sent = 0;
  while (a.transport->counters().out_queue_full < 100 && sent < 1'000'000) {
    a.send(0, big);
    if (++sent % 50 == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  EXPECT_GE(a.transport->counters().out_queue_full, 100u) << "of " << sent;
  server.signal(SIGCONT);
}

// ---- who may connect ----

std::string refusal(boost::asio::io_context& io, const NatsOptions& options) {
  const auto opened = NatsTransport::open(io, clock(), options);
  return opened ? "no refusal" : opened.error().sentence;
}

TEST_F(NatsTransportTest, AWrongPasswordIsASentence) {
  NatsServer server(folder, "server", "authorization { user: peer, password: secret }\n");
  const std::string wrong = refusal(io, by({server.url("peer:wrong")}));
  EXPECT_THAT(wrong, AllOf(HasSubstr("the NATS server refuses this user (" + server.url()),
                           HasSubstr("transport.nats_credentials"), Not(HasSubstr("wrong"))));
  EXPECT_THAT(refusal(io, by({server.url()})), HasSubstr("refuses this user"));
  Listener a(io, by({server.url("peer:secret")})), b(io, by({server.url("peer:secret")}));
  EXPECT_THAT(a.transport->describe(), Not(HasSubstr("secret")));
  b.join(0);
  EXPECT_TRUE(meet(a, b, 0, "hello"));
}

// A user who is taken out while it is connected is tried again for ever, and comes back when it may.
TEST_F(NatsTransportTest, AUserWhoIsRefusedLaterComesBackWhenItMay) {
  const std::string good = "authorization { user: peer, password: secret }\n",
                    bad = "authorization { user: x, password: y }\n";
  std::ofstream(folder / "users.conf") << good;
  NatsServer server(folder, "server", "include \"users.conf\"\n");
  Listener a(io, by({server.url("peer:secret")})), b(io, by({server.url("peer:secret")}));
  b.join(2);
  ASSERT_TRUE(meet(a, b, 2, "hello"));
  server.kill();
  std::ofstream(folder / "users.conf") << bad;
  server.start();
  std::string all;
  EXPECT_TRUE(run_until([&] {
    if (const auto said = a.transport->follow_interface()) all += said->sentence + "\n";
    return all.find("refuse this peer") != std::string::npos;
  })) << all;
  server.kill();
  std::ofstream(folder / "users.conf") << good;
  server.start();
  EXPECT_TRUE(meet(a, b, 2, "again"));
}

TEST_F(NatsTransportTest, ARegionThatMayNotBeHeardIsSaid) {
  NatsServer server(folder, "server",
                    "authorization { users: [{ user: peer, password: s, permissions: { publish: \"peerd.town.>\", "
                    "subscribe: \"peerd.town.any.>\" } }] }\n");
  Listener a(io, by({server.url("peer:s")}));
  a.join(0);
  a.join(1);
  std::string all;
  EXPECT_TRUE(run_until([&] {
    if (const auto said = a.transport->follow_interface()) all += said->sentence + "\n";
    return all.find("Permissions Violation") != std::string::npos;
  })) << all;
  EXPECT_THAT(all, HasSubstr("peerd.town.0000000000000007.1"));
}

class NatsTls : public NatsTransportTest {
 protected:
  // An authority of the test's own, and a server's certificate by it for 127.0.0.1.
  void SetUp() override {
    NatsTransportTest::SetUp();
    if (IsSkipped()) return;
    const auto run = [&](const std::string& command) {
      if (std::system(("cd " + folder.path().string() + " && " + command + " >openssl.log 2>&1").c_str()) != 0) {
        throw std::runtime_error(command + ": " + peerd::testing_support::text_of(folder / "openssl.log"));
      }
    };
    const std::string key = "-newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes ";
    for (const char* ca : {"ca", "other"}) {
      run("openssl req -x509 " + key + "-days 2 -subj /CN=" + ca + " -keyout " + ca + ".key -out " + ca + ".pem");
    }
    const auto certify = [&](const std::string& name, const std::string& alternative) {
      run("openssl req " + key + "-subj /CN=" + name + " -keyout " + name + ".key -out " + name + ".csr");
      std::ofstream(folder / (name + ".ext")) << "subjectAltName=" << alternative << "\n";
      run("openssl x509 -req -days 2 -in " + name + ".csr -CA ca.pem -CAkey ca.key -CAcreateserial -extfile " + name +
          ".ext -out " + name + ".pem");
    };
    certify("server", "IP:127.0.0.1,DNS:localhost");
    certify("elsewhere", "DNS:elsewhere.example");
    certify("peer", "DNS:peer");
  }
  [[nodiscard]] std::string tls(const std::string& certificate, bool verify = false) const {
    const auto file = [&](const std::string& name) { return "\"" + (folder / name).string() + "\""; };
    return "tls { cert_file: " + file(certificate + ".pem") + ", key_file: " + file(certificate + ".key") +
           (verify ? ", verify: true, ca_file: " + file("ca.pem") : "") + " }\n";
  }
  [[nodiscard]] NatsOptions trusting(const NatsServer& server, const std::string& ca,
                                     const std::string& host = "127.0.0.1") const {
    NatsOptions options = by({"tls://" + host + ":" + std::to_string(server.port())});
    options.settings.tls_ca = (folder / (ca + ".pem")).string();
    return options;
  }
};

TEST_F(NatsTls, ConnectsToAServerThatTheAuthorityKnows) {
  NatsServer server(folder, "server", tls("server"));
  Listener a(io, trusting(server, "ca")), b(io, trusting(server, "ca", "localhost"));
  b.join(0);
  EXPECT_TRUE(meet(a, b, 0, "hello"));
}

TEST_F(NatsTls, RefusesAServerOfAnotherAuthorityOrName) {
  NatsServer server(folder, "server", tls("server")), elsewhere(folder, "elsewhere", tls("elsewhere"));
  EXPECT_THAT(refusal(io, trusting(server, "other")), HasSubstr("no TLS with the NATS server (tls://127.0.0.1:"));
  EXPECT_THAT(refusal(io, trusting(elsewhere, "ca", "localhost")), HasSubstr("no TLS with the NATS server"));
  NatsOptions system = by({"tls://127.0.0.1:" + std::to_string(server.port())});
  EXPECT_THAT(refusal(io, system), HasSubstr("no TLS with the NATS server")) << "the system knows no such authority";
}

TEST_F(NatsTls, RefusesAServerWithoutTls) {
  NatsServer server(folder, "server");
  EXPECT_THAT(refusal(io, trusting(server, "ca")), HasSubstr("no TLS with the NATS server"));
}

TEST_F(NatsTls, ShowsItsOwnCertificateToWhoAsksForIt) {
  NatsServer server(folder, "server", tls("server", /*verify=*/true));
  NatsOptions options = trusting(server, "ca");
  {
    Listener without(io, options);  // it goes on trying
    EXPECT_THAT(without.transport->describe(), HasSubstr("no server so far"));
    const auto said = must(without.transport->follow_interface());
    EXPECT_THAT(said.sentence, HasSubstr("it may want transport.nats_tls_cert"));
  }
  options.settings.tls_cert = (folder / "peer.pem").string();
  options.settings.tls_key = (folder / "peer.key").string();
  Listener a(io, options), b(io, options);
  b.join(0);
  EXPECT_TRUE(meet(a, b, 0, "hello"));
}

TEST_F(NatsTls, AFileThatIsNoneIsAWrongSetting) {
  NatsServer server(folder, "server", tls("server"));
  NatsOptions options = trusting(server, "missing");
  EXPECT_THAT(error_of(NatsTransport::open(io, clock(), options)),
              IsError(net::NetError::Kind::kBadSetting,
                      AllOf(HasSubstr("transport.nats_tls_ca: can't read"), HasSubstr("missing.pem: No such file"))));
}

}  // namespace peerd::nats::nats_transport_test
