#include "peerd/peer/config/collision_settings.hpp"

#include <cassert>

#include "collision/engines/engine.hpp"

namespace peerd::config {

// FNV-1a 64, as for world files and regions.
std::uint64_t CollisionSettings::session_hash(std::uint64_t hash, std::uint32_t tick_hz) const {
  if (is_ours()) return hash;
  for (const char c : engine + "@" + std::to_string(tick_hz)) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3;
  }
  return hash;
}

std::unique_ptr<replication::TickDetection> CollisionSettings::make_detection(std::uint32_t tick_hz) const {
  if (is_ours()) return nullptr;
  auto made = collision::engines::make_engine(engine);
  assert(made && made->narrow_phase != nullptr);  // as read_collision() has it
  return std::make_unique<replication::TickDetection>(std::move(made->narrow_phase), tick_hz);
}

CollisionSettings read_collision(TomlReader reader) {
  CollisionSettings s;
  reader.read("engine", s.engine);
  if (const auto made = collision::engines::make_engine(s.engine); !made) {
    reader.fail(reader.raw().get("engine"), reader.dotted("engine") + ": " + made.error());
  } else if (made->narrow_phase == nullptr) {
    s.engine = CollisionSettings{}.engine;  // ours, however it is written
  }
  reader.finish();
  return s;
}

}  // namespace peerd::config
