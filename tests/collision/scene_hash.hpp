#pragma once
#include <cstdint>

namespace peerd::collision {

// One number of everything that queries say of a generated scene: answers about all of the oracle's generators' pairs,
// witnesses, all pairs and work of wide trees and of k-DOP trees over some hundred poses. The same wherever it is
// computed. Nothing in it asks libm.
[[nodiscard]] std::uint64_t scene_hash();

// Changes with every change to the scene, to what trees look like, and to what is counted; then write the new one here.
inline constexpr std::uint64_t kSceneHash = 9223887378327659611u;

// The same of rays and frusta: what is hit first, by how much work, and what may be in view.
[[nodiscard]] std::uint64_t view_hash();
inline constexpr std::uint64_t kViewHash = 6720466255638140494u;

}  // namespace peerd::collision
