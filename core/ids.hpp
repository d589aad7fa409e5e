#pragma once
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "core/strong.hpp"

namespace peerd {

// The number of a peer in its session; chosen by its configuration, 0 is never a peer. The lower number decides
// collisions.
using PeerId = Strong<struct PeerIdTag, std::uint32_t>;
// The owner of scene objects, which no peer runs.
inline constexpr PeerId kNobody{0};

// A LastingId names a part of a world for as long as the world lives, on all peers: the world's own file numbers its
// parts, and whoever adds a text later numbers those of that.
template <class Tag>
struct LastingId {
  std::uint32_t number = 0;
  std::uint32_t origin = 0;  // 0: the world's file; otherwise the author, below 2^31

  constexpr LastingId() = default;
  constexpr explicit LastingId(std::uint32_t of_number, std::uint32_t of_origin = 0)
      : number(of_number), origin(of_origin) {}

  [[nodiscard]] constexpr std::uint64_t packed() const { return std::uint64_t{origin} << 32 | number; }
  [[nodiscard]] static constexpr LastingId unpacked(std::uint64_t id) {
    return LastingId{static_cast<std::uint32_t>(id), static_cast<std::uint32_t>(id >> 32)};
  }
  friend constexpr bool operator==(LastingId a, LastingId b) = default;
  friend constexpr auto operator<=>(LastingId a, LastingId b) { return a.packed() <=> b.packed(); }
};

// A node instance of the scene, numbered in depth-first order; a USE counts as a new instance.
using ObjectId = LastingId<struct InstanceTag>;
// A node as it is written, of which there may be several instances or none (vrml::Document), numbered as the reader
// meets them.
using NodeId = LastingId<struct NodeTag>;

// A region of the scene; each has a multicast group of its own.
using RegionId = Strong<struct RegionIdTag, std::uint32_t>;

}  // namespace peerd

template <class Tag>
struct std::hash<peerd::LastingId<Tag>> {
  std::size_t operator()(peerd::LastingId<Tag> id) const noexcept { return std::hash<std::uint64_t>{}(id.packed()); }
};
