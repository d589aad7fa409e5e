#pragma once
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace peerd::testing_support {

// How a command ended, and what it has printed.
struct Outcome {
  int exit_code = 0;
  std::string out, err;
  [[nodiscard]] nlohmann::ordered_json json() const { return nlohmann::ordered_json::parse(out); }
};

// Calls a command with the two streams that it prints to.
template <class Command>
Outcome outcome_of(Command command) {
  std::ostringstream out, err;
  const int exit_code = command(out, err);
  return {exit_code, out.str(), err.str()};
}

inline std::vector<std::string> keys_of(const nlohmann::ordered_json& json) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  return keys;
}

}  // namespace peerd::testing_support
