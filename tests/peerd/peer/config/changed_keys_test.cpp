#include "peerd/peer/config/changed_keys.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace peerd::config::changed_keys_test {
namespace {

using Keys = std::vector<std::string>;

struct Case {
  const char *name, *before, *after;
  Keys changed;
};
class Changed : public testing::TestWithParam<Case> {};
TEST_P(Changed, AreTheKeysThatDiffer) {
  const auto& [name, before, after, changed] = GetParam();
  EXPECT_EQ(changed_keys(before, after), changed);
  EXPECT_EQ(changed_keys(after, before), changed);
  EXPECT_EQ(changed_keys(before, before), Keys{});
}
INSTANTIATE_TEST_SUITE_P(
    Table, Changed,
    testing::Values(Case{"Nothing", "a = 1", "a = 1", {}}, Case{"Empty", "", "", {}},
                    Case{"Value", "a = 1\nb = 2", "a = 1\nb = 3", {"b"}}, Case{"Kind", "a = 1", "a = \"1\"", {"a"}},
                    Case{"OneHasIt", "a = 1", "", {"a"}},
                    Case{"InTables", "[t.u]\na = 1\nb = 1", "[t.u]\na = 2\nc = 1", {"t.u.a", "t.u.b", "t.u.c"}},
                    Case{"WholeTable", "[t]\na = 1", "", {"t.a"}},
                    Case{"ListIsOneValue", "a = [1, 2]", "a = [1, 3]", {"a"}},
                    Case{"TablesInAList", "[[k]]\nat = 1", "[[k]]\nat = 2", {"k"}},
                    Case{"TableForValue", "t = 1", "[t]\na = 1", {"t", "t.a"}},
                    Case{"OrderDoesNotCount", "a = 1\nb = 2", "b = 2\na = 1", {}}),
    [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace peerd::config::changed_keys_test
