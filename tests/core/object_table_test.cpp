#include "core/object_table.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <random>

namespace peerd {
namespace {

// A table and a map are told the same, of objects of the file that are far apart and of others.
template <class Value>
void compare_with_a_map(Value none, Value last) {
  std::mt19937_64 rng(5);
  ObjectTable<Value> table(none);
  std::map<ObjectId, Value> map;
  const auto draw_id = [&] {
    const bool is_of_file = rng() % 4 != 0;
    const auto number = static_cast<std::uint32_t>(rng() % 2 == 0 ? rng() % 10 : rng() % 100'000);
    return is_of_file ? ObjectId{number} : ObjectId{number % 50, 7};
  };
  for (int i = 0; i < 3000; ++i) {
    const ObjectId id = draw_id();
    const Value value = rng() % 3 == 0 ? none : last;
    table.set(id, value);
    if (value == none) {
      map.erase(id);
    } else {
      map[id] = value;
    }
    const ObjectId asked = draw_id();
    const auto known = map.find(asked);
    ASSERT_EQ(table.of(asked), known == map.end() ? none : known->second) << asked.packed();
    const auto next = map.lower_bound(asked);
    const auto from = table.from(asked);
    ASSERT_EQ(from.has_value(), next != map.end());
    if (from) {
      ASSERT_EQ(from->first, next->first);
      ASSERT_EQ(from->second, next->second);
    }
  }
  table.clear();
  EXPECT_FALSE(table.from(ObjectId{}));
  for (const auto& [id, value] : map) EXPECT_EQ(table.of(id), none);
}

TEST(ObjectTable, SaysWhatAMapSays) { compare_with_a_map<std::uint32_t>(~0u, 3); }

TEST(ObjectTable, KeepsTruthsOfEitherDefault) {
  compare_with_a_map<bool>(false, true);
  compare_with_a_map<bool>(true, false);
}

}  // namespace
}  // namespace peerd
