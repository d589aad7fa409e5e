#include "peerd/lab/cluster/chaos_bytes.hpp"

#include <gtest/gtest.h>

namespace peerd::cluster::chaos_bytes_test {

chaos::ChaosReport full_report() {
  return {.seed = 1,
          .violations = {"a", "b"},
          .trace_hash = 0xfedc'ba98'7654'3210U,
          .peers = 2,
          .lives = 3,
          .faults = 4,
          .edits = 5,
          .operations = 6,
          .held = 7,
          .datagrams = 8,
          .damaged = 9,
          .one_world_after_s = 0.1,
          .branches = {{"x", 1}, {"y", 2}}};
}

TEST(ChaosBytes, AllFieldsComeBack) {
  const std::string bytes = to_bytes(full_report());
  const auto again = chaos_report_from(bytes);
  ASSERT_TRUE(again) << again.error();
  EXPECT_EQ(to_bytes(*again), bytes);
  EXPECT_EQ(again->violations, full_report().violations);
  EXPECT_EQ(again->trace_hash, full_report().trace_hash);
  EXPECT_EQ(again->one_world_after_s, 0.1);
  EXPECT_EQ(again->branches, full_report().branches);
  EXPECT_EQ(again->damaged, 9U);
}

TEST(ChaosBytes, APartAndAnotherFormatAreRefused) {
  std::string bytes = to_bytes(full_report());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(chaos_report_from(std::string_view(bytes).substr(0, size))) << size;
  }
  EXPECT_FALSE(chaos_report_from(bytes + 'x'));
  bytes[0] = 2;
  EXPECT_EQ(chaos_report_from(bytes).error(), "it is of format 2, and this program reads 1");
}

}  // namespace peerd::cluster::chaos_bytes_test
