#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "replication/wire/operation.hpp"

namespace peerd::store {

// A checksum of what a row has, of the bytes of the log (FNV-1a): SQLite's own checks see no byte that has changed
// within a part.
inline std::int64_t part_checksum(replication::AuthorId author, std::uint64_t from, std::span<const std::byte> bytes) {
  std::uint64_t hash = 0xCBF29CE484222325U;
  const auto add = [&](std::uint64_t byte) { hash = (hash ^ byte) * 0x100000001B3U; };
  for (int shift = 0; shift < 32; shift += 8) add(author.value >> shift & 0xFFU);
  for (int shift = 0; shift < 64; shift += 8) add(from >> shift & 0xFFU);
  for (const std::byte byte : bytes) add(std::to_integer<std::uint64_t>(byte));
  return static_cast<std::int64_t>(hash);
}

}  // namespace peerd::store
