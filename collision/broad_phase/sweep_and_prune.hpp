#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "collision/broad_phase/overlap_finder.hpp"

namespace peerd::collision {

// Both ends of the members' fat boxes, sorted along each axis; an end whose number is new walks to its place (insertion
// sort), and where a lower end passes another box's upper end downwards, the two may have begun to overlap (Baraff,
// 1992; Cohen et al., I-COLLIDE, 1995). When many members are new at once, everything is sorted anew.
class SweepAndPrune final : public OverlapFinder {
 public:
  explicit SweepAndPrune(const std::vector<FatBox>& boxes) : boxes_(boxes) {}  // by object; outlives it

  void insert(BroadIndex object) override;
  void erase(BroadIndex object) override;
  void update(std::span<const BroadIndex> changed, std::vector<Found>& found) override;

 private:
  static constexpr std::uint32_t kNone = ~0u;
  struct End {
    float at_m;
    std::uint32_t who;  // 2 * object + (1: upper end)

    // Closed boxes: of ends at the same place the lower ones come first.
    [[nodiscard]] bool before(const End& b) const { return at_m < b.at_m || (at_m == b.at_m && !upper() && b.upper()); }
    [[nodiscard]] bool upper() const { return (who & 1) != 0; }
    [[nodiscard]] BroadIndex object() const { return who >> 1; }
  };
  struct Axis {
    std::vector<End> ends;             // sorted
    std::vector<std::uint32_t> place;  // by End::who: where in `ends`; kNone: isn't there
  };

  void walk(Axis& axis, std::uint32_t who, float to_m, std::vector<Found>& found);
  void take_out(BroadIndex object);
  void sort_anew(std::span<const BroadIndex> changed, std::vector<Found>& found);

  const std::vector<FatBox>& boxes_;
  std::array<Axis, 3> axes_;
  std::vector<BroadIndex> open_;  // of sort_anew()
};

}  // namespace peerd::collision
