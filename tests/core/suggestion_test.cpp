#include "core/suggestion.hpp"

#include <gtest/gtest.h>

#include <string>

namespace peerd::suggestion_test {

TEST(Suggestion, OffersTheNearestOrNothing) {
  const auto suggest = [](std::string_view word) {
    Suggestion s(word);
    for (const char* candidate : {"Group", "Transform", "Shape", "Box", "Sphere"}) s.consider(candidate);
    return std::string(s.best().value_or("(none)"));
  };
  EXPECT_EQ(suggest("transform"), "Transform");
  EXPECT_EQ(suggest("Tarnsfrom"), "Transform");
  EXPECT_EQ(suggest("BOX"), "Box");
  EXPECT_EQ(suggest("Shpere"), "Sphere");
  EXPECT_EQ(suggest("Elephant"), "(none)");
  EXPECT_EQ(suggest("x"), "(none)");
  EXPECT_EQ(suggest(std::string(100000, 'x')), "(none)");
}

TEST(Suggestion, KnowsUnitsBehindAWord) {
  const auto suggest = [](std::string_view word) {
    Suggestion s(word);
    for (const char* candidate : {"jitter_ms", "latency_ms", "loss", "loss_burst", "position_m"}) s.consider(candidate);
    return std::string(s.best().value_or("(none)"));
  };
  EXPECT_EQ(suggest("latency"), "latency_ms");
  EXPECT_EQ(suggest("Position"), "position_m");
  EXPECT_EQ(suggest("loss"), "loss") << "the word itself is nearer";
  EXPECT_EQ(suggest("_ms"), "(none)");
}

}  // namespace peerd::suggestion_test
