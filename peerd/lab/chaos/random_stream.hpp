#pragma once
#include <cstdint>

#include "core/mixed_bits.hpp"
#include "peerd/peer/motion/random.hpp"

namespace peerd::chaos {

using motion::Random;

// A purpose for which a seed's numbers are drawn. Each has streams of its own, and each item of a plan has one, so that
// leaving an item out changes no draw of another.
//
// C++ leaves open in which order the arguments of a call and the operands of an operator are evaluated, so no such
// expression has two draws: they would be other ones with another compiler. Each draw becomes a named variable first.
enum class Stream : std::uint64_t {
  kWorld = 1,
  kGeneral,
  kPeer,
  kFault,
  kEdit,
  kRareFault,
  kRareEdit,
  kLink,
  kDamage,
  kOsClock,
  kDisk,
  kAuthor,
  kRareBranches,
};

[[nodiscard]] inline Random stream_of(std::uint64_t seed, Stream stream, std::uint64_t item = 0) {
  return Random(mixed_bits(seed) ^ static_cast<std::uint64_t>(stream), item);
}

}  // namespace peerd::chaos
