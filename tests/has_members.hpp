#pragma once
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace peerd {

// Whether a JSON value has all members of another one, at any depth. It may have more.
template <class Json>
bool has_members(const Json& value, const Json& expected) {
  if (!expected.is_object()) return value == expected;
  for (const auto& [key, member] : expected.items()) {
    if (!value.is_object() || !value.contains(key) || !has_members(value.at(key), member)) return false;
  }
  return true;
}

MATCHER_P(HasMembers, expected, "") {
  using Json = std::decay_t<decltype(arg)>;
  return has_members(arg, Json::parse(expected));
}

}  // namespace peerd
