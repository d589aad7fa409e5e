#include "replication/settings/output/peer_counters.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

namespace peerd::replication::peer_counters_test {

// Statistics and tools know drops by these names.
TEST(PeerCounters, NamesEachReasonOfADrop) {
  std::set<std::string> names;
  for (const auto& [drop, name] : {std::pair(Drop::kOwn, "own"),
                                   {Drop::kUndecodable, "undecodable"},
                                   {Drop::kIdInUse, "id_in_use"},
                                   {Drop::kStaleIncarnation, "stale_boot"},
                                   {Drop::kOtherWorld, "other_world"},
                                   {Drop::kOtherLine, "other_line"},
                                   {Drop::kTooMany, "too_many"},
                                   {Drop::kUnintroduced, "stranger"},
                                   {Drop::kNotYetInSession, "not_yet_in_session"},
                                   {Drop::kRegion, "region"}}) {
    EXPECT_STREQ(to_string(drop), name);
    EXPECT_TRUE(names.insert(to_string(drop)).second);
  }
}

TEST(PeerCounters, RecordSizesAscendAndTheLastClassHoldsTheRest) {
  EXPECT_TRUE(std::ranges::is_sorted(kRecordSizes));
  EXPECT_EQ(PeerCounters{}.update_sizes_out.size(), kRecordSizes.size() + 1);
}

}  // namespace peerd::replication::peer_counters_test
