#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace peerd::collision {

// The rules by which a node of a hierarchy is split in two: across which axis, and where. All but the last split at the
// mean of the corners (the thesis's equation 3.1, a corner counted as often as triangles use it): a triangle goes where
// its centroid lies.
enum class SplitRule : std::uint8_t {
  kLongestSide,          // the longest side of the node
  kSplatter,             // the largest variance of the centroids
  kMinSum,               // the least sum of the children's volumes
  kMinMax,               // the least larger one of the children's volumes
  kCombinedLongestSide,  // kMinSum on the first levels, then kLongestSide
  kCombinedSplatter,     // kMinSum on the first levels, then kSplatter
  kLeastOverlap,         // the least volume that the children share (Zachmann's best criterion)
  kBinnedSah,            // the surface-area heuristic over 16 bins of each axis; splits between bins
};
inline constexpr std::size_t kSplitRules = 8;

// Levels of kMinSum in the combined rules; at the top, where hierarchies part early.
inline constexpr std::uint32_t kCombinedLevels = 4;

struct SplitRuleName {
  SplitRule rule;
  std::string_view name;
};
inline constexpr std::array<SplitRuleName, kSplitRules> kSplitRuleNames = {{
    {SplitRule::kLongestSide, "longest-side"},
    {SplitRule::kSplatter, "splatter"},
    {SplitRule::kMinSum, "min-sum"},
    {SplitRule::kMinMax, "min-max"},
    {SplitRule::kCombinedLongestSide, "combined-longest-side"},
    {SplitRule::kCombinedSplatter, "combined-splatter"},
    {SplitRule::kLeastOverlap, "least-overlap"},
    {SplitRule::kBinnedSah, "binned-sah"},
}};

}  // namespace peerd::collision
