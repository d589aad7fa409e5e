#pragma once
#include <cstdlib>

namespace peerd::fuzz {

// Unlike assert(), this check is on in every build.
inline void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace peerd::fuzz
