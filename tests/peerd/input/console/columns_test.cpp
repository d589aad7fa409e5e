#include "peerd/input/console/columns.hpp"

#include <gtest/gtest.h>

namespace peerd::columns_test {

TEST(Columns, AreAlignedUnderTheirNamesAndGroups) {
  std::string out;
  append_rows(out, {{"", "run", true, {"1", "10"}},
                    {"", "path", false, {"CÄR", "B"}},
                    {"at b", "error", true, {"0.5", "12.25"}},
                    {"at b", "n", true, {"1", "2"}}});
  EXPECT_EQ(out,
            "             at b\n"
            "run  path    error  n\n"
            "  1  CÄR       0.5  1\n"
            " 10  B       12.25  2\n")
      << "letters count, not bytes, and no line ends with a blank";
}

TEST(Columns, WithoutGroupsThereIsNoLineOfThem) {
  std::string out;
  append_rows(out, {{"", "a", true, {"1"}}});
  EXPECT_EQ(out, "a\n1\n");
}

TEST(Fixed, HasSoManyDecimalsOfAnyNumber) {
  EXPECT_EQ(fixed(1.0, 2), "1.00");
  EXPECT_EQ(fixed(-0.125, 1), "-0.1");
  EXPECT_EQ(fixed(1e308, 0).size(), 309u);
}

}  // namespace peerd::columns_test
