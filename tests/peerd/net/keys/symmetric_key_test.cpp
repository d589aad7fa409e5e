#include "peerd/net/keys/symmetric_key.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <new>
#include <set>
#include <vector>

#include "tests/must.hpp"

namespace peerd::keys {
namespace {

TEST(SymmetricKeys, TheTextOfAKeyIsThatKey) {
  const SymmetricKey key = SymmetricKey::random();
  EXPECT_EQ(must(SymmetricKey::of_text(key.text())), key);
  EXPECT_FALSE(SymmetricKey::random() == key);
}

TEST(SymmetricKeys, NothingElseIsAKey) {
  const std::string text = SymmetricKey::random().text();
  for (std::size_t i = 0; i < text.size(); ++i) EXPECT_FALSE(SymmetricKey::of_text(text.substr(0, i))) << i;
  for (const char* const more : {"A", "=", " ", "\n"}) EXPECT_FALSE(SymmetricKey::of_text(text + more)) << more;
  EXPECT_FALSE(SymmetricKey::of_text("peerd-key-2:" + text.substr(12)));
  EXPECT_FALSE(SymmetricKey::of_text("peerd-key-1:" + std::string(43, '*')));
}

TEST(SymmetricKeys, AreWipedWhereTheyEnd) {
  alignas(SymmetricKey) std::array<std::uint8_t, sizeof(SymmetricKey)> place{};
  auto* const key = new (place.data()) SymmetricKey(SymmetricKey::random());
  const std::vector<std::uint8_t> bits(key->data(), key->data() + SymmetricKey::kBytes);
  EXPECT_FALSE(std::ranges::search(place, bits).empty());
  std::destroy_at(key);
  EXPECT_TRUE(std::ranges::all_of(place, [](std::uint8_t byte) { return byte == 0; }));
}

TEST(SymmetricKeys, EachUseHasAKeyOfItsOwn) {
  const SymmetricKey key = SymmetricKey::random();
  const std::array<std::uint8_t, 2> ab{'a', 'b'};
  const std::span<const std::uint8_t> all(ab);
  std::set<std::string> texts{key.text()};
  texts.insert(key.derived("one", all).text());
  texts.insert(key.derived("two", all).text());
  texts.insert(key.derived("one", all.first(1)).text());
  texts.insert(key.derived("onea", all.subspan(1)).text());
  texts.insert(SymmetricKey::random().derived("one", all).text());
  EXPECT_EQ(texts.size(), 6u);
  EXPECT_EQ(key.derived("one", all), key.derived("one", all));
}

}  // namespace
}  // namespace peerd::keys
