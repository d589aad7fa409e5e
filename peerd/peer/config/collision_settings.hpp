#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "peerd/input/toml_input.hpp"
#include "replication/physics/world/tick_detection.hpp"

namespace peerd::config {

// The table [collision]: how peers find contacts. All peers of a session have the same.
struct CollisionSettings {
  std::string engine = "ours";  // collision::engines::make_engine()

  [[nodiscard]] bool is_ours() const { return engine == "ours"; }
  // The hash of a session with this engine, which is asked `tick_hz` times a second; with ours it is `hash`.
  [[nodiscard]] std::uint64_t session_hash(std::uint64_t hash, std::uint32_t tick_hz) const;
  // A new engine, asked at ticks; null: ours, which finds contact times.
  [[nodiscard]] std::unique_ptr<replication::TickDetection> make_detection(std::uint32_t tick_hz) const;
};
// The error names an engine or an option that there is not.
[[nodiscard]] CollisionSettings read_collision(TomlReader reader);

}  // namespace peerd::config
