#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "collision/broad_phase/overlap_finder.hpp"

namespace peerd::collision {

// Keeps both ends of the members' fat boxes sorted along each axis. An end whose coordinate is new walks to its place
// (insertion sort), and where a lower end passes another box's upper end downwards, the two may have begun to overlap
// (Baraff, 1992; Cohen et al., I-COLLIDE, 1995). When many members are new at once, everything is sorted anew.
class SweepAndPrune final : public OverlapFinder {
 public:
  explicit SweepAndPrune(const std::vector<FatBox>& boxes) : boxes_(boxes) {}  // by object; outlives it

  void insert(BroadIndex object) override;
  void erase(BroadIndex object) override;
  void update(std::span<const BroadIndex> changed, std::vector<Found>& found) override;

 private:
  static constexpr std::uint32_t kNone = ~0u;
  struct Endpoint {
    float at_m;
    std::uint32_t endpoint_id;  // 2 * object + (1: upper end)

    // Closed boxes: of ends at the same place the lower ones come first.
    [[nodiscard]] bool before(const Endpoint& b) const {
      return at_m < b.at_m || (at_m == b.at_m && !upper() && b.upper());
    }
    [[nodiscard]] bool upper() const { return (endpoint_id & 1) != 0; }
    [[nodiscard]] BroadIndex object() const { return endpoint_id >> 1; }
  };
  struct Axis {
    std::vector<Endpoint> endpoints;         // sorted
    std::vector<std::uint32_t> position_of;  // by Endpoint::endpoint_id: its place in `endpoints`, or kNone
  };

  void move_endpoint(Axis& axis, std::uint32_t endpoint_id, float to_m, std::vector<Found>& found);
  void remove_endpoints(BroadIndex object);
  void sort_all(std::span<const BroadIndex> changed, std::vector<Found>& found);

  const std::vector<FatBox>& boxes_;
  std::array<Axis, 3> axes_;
  std::vector<BroadIndex> open_;  // scratch of sort_all()
};

}  // namespace peerd::collision
