#include "core/formats/draft/words.hpp"

#include <gmock/gmock.h>

#include <string>

namespace peerd::formats::words_test {
namespace {

struct Case {
  std::string word;
  std::optional<double> number;
};
class NumberOf : public testing::TestWithParam<Case> {};
TEST_P(NumberOf, IsFiniteOrZeroOrNone) { EXPECT_EQ(number_of(GetParam().word), GetParam().number) << GetParam().word; }

const std::string kZeros(400, '0');
INSTANTIATE_TEST_SUITE_P(Table, NumberOf,
                         testing::Values(Case{"+1.5", 1.5}, Case{"1e-400", 0.0}, Case{"1E-400", 0.0},
                                         Case{"1e400", std::nullopt}, Case{"-1e400", std::nullopt},
                                         Case{"1" + kZeros, std::nullopt}, Case{"1" + kZeros + "e-5", std::nullopt},
                                         Case{"1" + kZeros + ".5e-5", std::nullopt}, Case{"1" + kZeros + "e-800", 0.0},
                                         Case{"0." + kZeros + "1", 0.0}, Case{"-." + kZeros + "1e+5", 0.0},
                                         Case{"0." + kZeros + "1e800", std::nullopt}, Case{"000.001e-400", 0.0},
                                         Case{"1e-99999999999999999999", 0.0},
                                         Case{"1e99999999999999999999", std::nullopt},
                                         Case{"0e99999999999999999999", 0.0}, Case{"nan", std::nullopt},
                                         Case{"inf", std::nullopt}, Case{"", std::nullopt}));

}  // namespace
}  // namespace peerd::formats::words_test
