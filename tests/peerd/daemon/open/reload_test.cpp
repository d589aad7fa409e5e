#include "peerd/daemon/open/reload.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "peerd/peer/config/scenario.hpp"
#include "peerd/peer/control/request.hpp"
#include "tests/must.hpp"

namespace peerd::reload_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

config::RunSettings settings(const std::string& more) {
  return must(config::read_scenario({.real = true, .sweep = false, .text = "world = \"w.wrl\"\n" + more})).runs.front();
}

Reload reload(const std::string& before, const std::string& after) {
  const Reload found = reload_of(settings(before), settings(after), "a");
  for (const std::string& line : found.requests) EXPECT_TRUE(control::parse_request(line)) << line;
  return found;
}

TEST(Reload, OfTheSameAsksNothing) {
  const Reload same = reload("[peer.a]\nid = 1\n", "[peer.a]\nid = 1\n");
  EXPECT_THAT(same.requests, IsEmpty());
  EXPECT_THAT(same.now, IsEmpty());
  EXPECT_THAT(same.later, IsEmpty());
}

TEST(Reload, NamesWhatCountsLater) {
  const Reload later = reload("[peer.a]\nid = 1\n[transport]\nport = 5000\n",
                              "[peer.a]\nid = 2\n[transport]\nport = 5001\n[replication]\norder = 1\n");
  EXPECT_THAT(later.later, ElementsAre("peer.a.id", "replication.order", "transport.port"));
  EXPECT_THAT(later.now, IsEmpty());
  EXPECT_THAT(later.requests, IsEmpty());
}

TEST(Reload, OfTheLogCountsNow) {
  const Reload log = reload("[peer.a]\nid = 1\n", "[peer.a]\nid = 1\n[log]\nverbose = true\nburst = 5\n");
  EXPECT_THAT(log.now, ElementsAre("log.burst", "log.verbose"));
  EXPECT_THAT(log.later, IsEmpty());
}

TEST(Reload, OwnsAndReleasesPaths) {
  const Reload owns = reload("[peer.a]\nid = 1\nowns = [\"CAR\", \"CUBE\"]\n[peer.b]\nid = 2\nowns = [\"X\"]\n",
                             "[peer.a]\nid = 1\nowns = [\"CUBE\", \"BALL\"]\n[peer.b]\nid = 2\nowns = [\"Y\"]\n");
  EXPECT_THAT(owns.now, ElementsAre("peer.a.owns"));
  EXPECT_THAT(owns.later, ElementsAre("peer.b.owns")) << "that peer must be asked itself";
  EXPECT_THAT(owns.requests, ElementsAre(R"({"do":"release","path":"CAR"})", R"({"do":"own","path":"BALL"})"));
}

TEST(Reload, OfPatternsCountsLater) {
  const Reload owns = reload("[peer.a]\nid = 1\nowns = [\"CAR\"]\n", "[peer.a]\nid = 1\nowns = [\"BALL_*\"]\n");
  EXPECT_THAT(owns.later, ElementsAre("peer.a.owns"));
  EXPECT_THAT(owns.requests, IsEmpty()) << "all of it or nothing";
}

TEST(Reload, LooksFromElsewhere) {
  const std::string peer = "[peer.a]\nid = 1\n[peer.a.viewpoint]\n";
  const Reload view =
      reload(peer + "position = [1, 2, 3]\nfar_m = 5\n",
             peer + "position = [4, 5, 6]\naxis = [0, 1, 0]\nangle_deg = 180\nfar_m = 9\nobject = \"CAR\"\n");
  EXPECT_THAT(view.later, ElementsAre("peer.a.viewpoint.far_m"));
  EXPECT_THAT(view.now, ElementsAre("peer.a.viewpoint.angle_deg", "peer.a.viewpoint.axis", "peer.a.viewpoint.object",
                                    "peer.a.viewpoint.position"));
  ASSERT_EQ(view.requests.size(), 1u);
  const auto request = nlohmann::json::parse(view.requests.front());
  EXPECT_EQ(request["position_m"], nlohmann::json({4.0, 5.0, 6.0}));
  EXPECT_EQ(request["object"], "CAR");
  EXPECT_NEAR(request["orientation_xyzw"][1], 1.0, 1e-12);
  EXPECT_NEAR(request["orientation_xyzw"][3], 0.0, 1e-12);
}

TEST(Reload, WithoutItsPeerNothingCountsNow) {
  const Reload gone = reload("[peer.a]\nid = 1\nowns = [\"CAR\"]\n", "[peer.b]\nid = 1\nowns = [\"CAR\"]\n");
  EXPECT_THAT(gone.now, IsEmpty());
  EXPECT_THAT(gone.requests, IsEmpty());
}

}  // namespace
}  // namespace peerd::reload_test
