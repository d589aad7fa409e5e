#pragma once
#include <array>

namespace peerd::store {

// The files beside the operations in the folder of a store (stored_world.hpp).
inline constexpr std::array kWorldFiles{"world.archive", "world.json", "peer"};

}  // namespace peerd::store
