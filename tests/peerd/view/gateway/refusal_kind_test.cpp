#include "peerd/view/gateway/refusal_kind.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "peerd/view/gateway/http_reply.hpp"

namespace peerd::gateway::refusal_kind_test {

TEST(RefusalKind, SaysWhyInTheControlProtocolsWords) {
  std::set<unsigned> statuses;
  for (std::size_t i = 0; i < kRefusalKinds; ++i) {
    const auto kind = static_cast<RefusalKind>(i);
    const HttpReply reply = refusal_reply(kind);
    EXPECT_TRUE(reply.status >= 400U && reply.status < 600U);
    EXPECT_TRUE(statuses.insert(reply.status).second) << "a client tells them apart by the status";
    const auto said = nlohmann::json::parse(reply.body);
    EXPECT_EQ(said["ok"], false);
    EXPECT_EQ(said["error"], text_of(kind).sentence);
  }
  EXPECT_EQ(text_of(RefusalKind::kToken).status, 401U);
  EXPECT_EQ(text_of(RefusalKind::kOrigin).status, 403U);
  EXPECT_EQ(text_of(RefusalKind::kHost).status, 421U);
}

}  // namespace peerd::gateway::refusal_kind_test
