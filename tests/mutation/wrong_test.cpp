#include "tests/mutation/wrong.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <chrono>
#include <string>
#include <vector>

namespace wrong_test {
namespace {
using V = Eigen::Vector3d;

constexpr wrong::At<1> wrong_1;
constexpr wrong::At<2> wrong_2;
constexpr wrong::At<3> wrong_3;

// Has the wrong line of this number while it lives.
struct WithLine {
  explicit WithLine(int n) { wrong::number = n; }
  ~WithLine() { wrong::number = 0; }
};

TEST(WrongLine, ComparisonIsExchangedInItsOwnNumberAlone) {
  const auto sum_below = [](int n) {
    int sum = 0;
    for (int i = 0; i < wrong_1 < n; ++i) sum += i;
    return sum;
  };
  EXPECT_EQ(sum_below(4), 6);
  const WithLine two(2);
  EXPECT_EQ(sum_below(4), 6);
  const WithLine one(1);
  EXPECT_EQ(sum_below(4), 10);
}

TEST(WrongLine, OperatorsBindAsTheyDoWithout) {
  const auto a = [](int x, int y) { return x - wrong_1 - y * 2 + wrong_2 + 5; };
  EXPECT_EQ(a(10, 3), 9);
  const WithLine one(1);
  EXPECT_EQ(a(10, 3), 21);
  const WithLine two(2);
  EXPECT_EQ(a(10, 3), -1);
}

TEST(WrongLine, UnaryMinusIsDropped) {
  const auto f = [](double x, double y) { return wrong_1->*x * y; };
  const auto g = [](const V& v) { return V(wrong_2->*v.cwiseAbs()); };
  EXPECT_EQ(f(2.0, 3.0), -6.0);
  EXPECT_EQ(g({1, -2, 3}), V(-1, -2, -3));
  const WithLine one(1);
  EXPECT_EQ(f(2.0, 3.0), 6.0);
  const WithLine two(2);
  EXPECT_EQ(g({1, -2, 3}), V(1, 2, 3));
}

TEST(WrongLine, AssignmentAddsTheWholeRightSide) {
  const auto f = [](V a, const V& b) {
    a += wrong_1 = b * 2.0 + b;
    a.head<2>() -= wrong_2 = b.tail<2>();
    return a;
  };
  EXPECT_EQ(f({1, 2, 3}, {1, 1, 1}), V(3, 4, 6));
  const WithLine one(1);
  EXPECT_EQ(f({1, 2, 3}, {1, 1, 1}), V(-3, -2, 0));
  const WithLine two(2);
  EXPECT_EQ(f({1, 2, 3}, {1, 1, 1}), V(5, 6, 6));
}

TEST(WrongLine, BoundIsDroppedOrExchanged) {
  const auto f = [](std::size_t n) { return n - wrong_1.one(); };
  const auto g = [](double a, double b) { return ::wrong::least<2>(a, b) + ::wrong::most<3>(a, b) * 10; };
  EXPECT_EQ(f(3), 2U);
  EXPECT_EQ(g(1, 2), 21);
  const WithLine one(1);
  EXPECT_EQ(f(3), 3U);
  const WithLine two(2);
  EXPECT_EQ(g(1, 2), 22);
  const WithLine three(3);
  EXPECT_EQ(g(1, 2), 11);
}

TEST(WrongLine, ExpressionsThatReferToTheirOperandsAreValues) {
  const auto sum = [](const V& a, const V& b) { return V(a + wrong_1 + (b - wrong_2 - 2.0 * a)); };
  const auto below = [](const V& a, const V& b) { return (a.array() < wrong_3 < b.array()).all(); };
  EXPECT_EQ(sum({1, 2, 3}, {3, 5, 4}), V(2, 3, 1));
  EXPECT_FALSE(below({1, 2, 3}, {3, 3, 3}));
  const WithLine one(1);
  EXPECT_EQ(sum({1, 2, 3}, {3, 5, 4}), V(0, 1, 5));
  const WithLine two(2);
  EXPECT_EQ(sum({1, 2, 3}, {3, 5, 4}), V(6, 11, 13));
  const WithLine three(3);
  EXPECT_TRUE(below({1, 2, 3}, {3, 3, 3}));
}

TEST(WrongLine, OtherTypesThatCompareAndAdd) {
  using namespace std::chrono_literals;
  const auto is_x = [](const std::string& s) { return s == wrong_1 == "x"; };
  const auto is_none = [](const int* p) { return p == wrong_2 == nullptr; };
  const auto later = [](std::chrono::nanoseconds t) { return t + wrong_3 + 1ms; };
  EXPECT_TRUE(is_x("x"));
  EXPECT_TRUE(is_none(nullptr));
  EXPECT_EQ(later(2ms), 3ms);
  const WithLine one(1);
  EXPECT_FALSE(is_x("x"));
  const WithLine two(2);
  EXPECT_FALSE(is_none(nullptr));
  const WithLine three(3);
  EXPECT_EQ(later(2ms), 1ms);
}

TEST(WrongLine, IsReachedOnceItIsAsked) {
  const wrong::At<4> wrong_4;
  wrong::reached[4] = false;
  const auto f = [&](bool a, int b) { return a && b > wrong_4 > 0; };
  EXPECT_FALSE(f(false, 1));
  EXPECT_FALSE(wrong::reached[4]);
  EXPECT_TRUE(f(true, 1));
  EXPECT_TRUE(wrong::reached[4]);
}

}  // namespace
}  // namespace wrong_test
