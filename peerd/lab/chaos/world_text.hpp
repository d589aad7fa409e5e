#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace peerd {
struct SharedWorld;
}

namespace peerd::chaos {

// This key moves what answers to keys [KeyEvent::value].
inline constexpr std::int32_t kMovingKey = 32;
// So begin the names of what nothing meets, and that key moves.
inline constexpr char kFreeBegin = 'F';

// A generated world: a walled ground on which movers, which peers own, meet each other, what nobody owns, what nothing
// meets, and what stands.
struct ChaosWorld {
  std::string text;                             // VRML97
  std::vector<std::vector<std::string>> owned;  // the paths that each peer owns
};
[[nodiscard]] ChaosWorld draw_world(std::uint64_t seed, std::size_t peers);

// The world as peers have it.
[[nodiscard]] std::unique_ptr<const SharedWorld> share(const ChaosWorld& world);

}  // namespace peerd::chaos
