#include "peerd/net/os/token_bucket.hpp"

#include <gtest/gtest.h>

namespace peerd::net::token_bucket_test {

using std::chrono::milliseconds;

TEST(TokenBucket, LetsSoManyThroughAtOnceAndSoManyASecond) {
  constexpr TokenRate kRate{3.0, 10.0};
  const HostTime begin{std::chrono::seconds(100)};
  TokenBucket bucket(kRate, begin);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(bucket.take(kRate, begin));
  EXPECT_FALSE(bucket.take(kRate, begin));
  EXPECT_FALSE(bucket.take(kRate, begin + milliseconds(90)));
  EXPECT_TRUE(bucket.take(kRate, begin + milliseconds(110)));
  EXPECT_FALSE(bucket.take(kRate, begin + milliseconds(120)));
  int taken = 0;
  for (int i = 0; i < 100; ++i) taken += bucket.take(kRate, begin + std::chrono::hours(1)) ? 1 : 0;
  EXPECT_EQ(taken, 3) << "it does not fill beyond its most";
}

TEST(TokenBucket, GivesNothingForATimeThatGoesBack) {
  constexpr TokenRate kRate{1.0, 1.0};
  TokenBucket bucket(kRate, HostTime{std::chrono::seconds(10)});
  EXPECT_TRUE(bucket.take(kRate, HostTime{std::chrono::seconds(10)}));
  EXPECT_FALSE(bucket.take(kRate, HostTime{std::chrono::seconds(5)}));
  EXPECT_FALSE(TokenBucket().take(kRate, HostTime{}));
}

}  // namespace peerd::net::token_bucket_test
