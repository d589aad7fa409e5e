#pragma once
#include <cstdint>

#include "peerd/input/toml_input.hpp"

namespace peerd::config {

enum class BaselineSystem : std::uint8_t { kNone, kLockstep, kServer };

// The table [baseline]: another system in the place of this project's peers, in simulated runs alone
// (peerd/lab/baselines).
struct BaselineSettings {
  BaselineSystem system = BaselineSystem::kNone;
  std::uint32_t snapshots_hz = 20;  // of the server
  double interpolation_ms = 100.0;  // how long before the newest snapshot clients show what others own
  bool prediction = true;           // clients show their own objects at once
  bool lag_compensation = true;     // the server decides hits by what the player saw
};
[[nodiscard]] BaselineSettings read_baseline(TomlReader reader);

}  // namespace peerd::config
