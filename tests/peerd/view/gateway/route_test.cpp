#include "peerd/view/gateway/route.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace peerd::gateway::route_test {

using nlohmann::json;

template <class Kind>
bool leads_to(const char* method, const char* target) {
  const auto route = find_route(method, target);
  return route && std::holds_alternative<Kind>(*route);
}

json asked(const std::string& target) {
  const auto route = find_route("GET", target);
  if (!route || !std::holds_alternative<AskRoute>(*route)) return nullptr;
  return json::parse(std::get<AskRoute>(*route).request);
}

TEST(Route, EachPlaceHasOne) {
  EXPECT_TRUE(leads_to<AssetRoute>("GET", "/"));
  EXPECT_TRUE(leads_to<AssetRoute>("GET", "/?x=1"));
  EXPECT_TRUE(leads_to<MetricsRoute>("GET", "/metrics"));
  EXPECT_TRUE(leads_to<LiveRoute>("GET", "/api/v1/live"));
  EXPECT_TRUE(leads_to<SceneRoute>("GET", "/api/v1/scene.glb"));
  EXPECT_TRUE(leads_to<RecordingRoute>("GET", "/api/v1/recording"));
  EXPECT_TRUE(leads_to<RecordingRoute>("GET", "/api/v1/recording/0/scene-1"));
  EXPECT_TRUE(leads_to<RequestRoute>("POST", "/api/v1/request"));
  EXPECT_EQ(asked("/api/v1/status"), (json{{"do", "status"}}));
  EXPECT_EQ(asked("/api/v1/peers?from=7"), (json{{"do", "peers"}, {"from", 7}}));
  EXPECT_EQ(asked("/api/v1/objects?from=9&count=3"), (json{{"do", "objects"}, {"from", 9}, {"count", 3}}));
  EXPECT_EQ(asked("/api/v1/conflicts"), (json{{"do", "conflicts"}}));
  EXPECT_EQ(asked("/api/v1/world"), (json{{"do", "world"}}));
  EXPECT_EQ(asked("/api/v1/data?path=A%2FB&key=a%20%22b"), (json{{"do", "data"}, {"path", "A/B"}, {"key", "a \"b"}}));
}

// Names are looked up in a table of the program: none of them becomes a path of the system.
TEST(Route, AnAssetIsItsNameAsItStands) {
  const auto route = find_route("GET", "/assets/../../etc/passwd");
  ASSERT_TRUE(route && std::holds_alternative<AssetRoute>(*route));
  EXPECT_EQ(std::get<AssetRoute>(*route).name, "assets/../../etc/passwd");
}

TEST(Route, OtherPlacesAreNotFound) {
  for (const char* target : {"", "*", "x", "//", "/index.html", "/..", "/api", "/api/v1", "/api/v1/", "/api/v1/leave",
                             "/api/v1/key", "/api/v2/status", "/metrics/", "http://127.0.0.1/metrics", "/etc/passwd"}) {
    EXPECT_EQ(find_route("GET", target), std::unexpected(RefusalKind::kNotFound)) << target;
  }
}

TEST(Route, AMethodBelongsToItsPlace) {
  for (const auto& [method, target] : {std::pair("POST", "/"), std::pair("HEAD", "/"), std::pair("PUT", "/metrics"),
                                       std::pair("GET", "/api/v1/request"), std::pair("OPTIONS", "/api/v1/request"),
                                       std::pair("POST", "/api/v1/status"), std::pair("get", "/")}) {
    EXPECT_EQ(find_route(method, target), std::unexpected(RefusalKind::kMethod)) << method << target;
  }
}

TEST(Route, WrongParametersAreRefused) {
  for (const char* query : {"from", "from=", "from=x", "from=-1", "from=1.5", "from=99999999999999999999", "form=1",
                            "from=1&from=2", "from=1&&count=2", "=1", "from=%31%zz", "from=%3", "count=%00"}) {
    EXPECT_EQ(find_route("GET", std::string("/api/v1/objects?") + query), std::unexpected(RefusalKind::kMalformed))
        << query;
  }
  EXPECT_FALSE(find_route("GET", "/api/v1/status?from=1"));
  EXPECT_FALSE(find_route("GET", "/api/v1/data?path=%0a")) << "a line of the protocol stays one line";
}

}  // namespace peerd::gateway::route_test
