#include "peerd/net/os/net_error.hpp"

#include <gtest/gtest.h>

namespace peerd::net::net_error_test {

TEST(NetError, OnlyAWrongSettingIsWrongUse) {
  using Kind = NetError::Kind;
  EXPECT_EQ(input_error({Kind::kBadSetting, "s"}).exit_code, 2);
  for (const Kind kind :
       {Kind::kNoSuchInterface, Kind::kNoMulticast, Kind::kPortBusy, Kind::kPermission, Kind::kLimit, Kind::kOther}) {
    EXPECT_EQ(input_error({kind, "s"}).exit_code, 3) << "the environment";
  }
  EXPECT_EQ(input_error({Kind::kOther, "no way"}).text, "error: no way");
}

}  // namespace peerd::net::net_error_test
