#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "collision/exact/relative_motion.hpp"
#include "collision/exact/triangle_soup.hpp"

namespace peerd::bench {

// The thesis's scene (3.3.2): ten copies of an object in close proximity, bouncing off each other.
inline constexpr std::uint32_t kCopies = 10;
using Frame = std::array<Pose, kCopies>;

// The copies are of a soup of bounding radius 1; the frames are 60 a second and begin after two seconds of gathering.
[[nodiscard]] std::vector<Frame> move_copies(const collision::TriangleSoup& soup, std::uint32_t frames,
                                             std::uint64_t seed);

// Two copies whose bounding spheres overlap.
struct CloseQuery {
  std::uint32_t frame, a, b;
  collision::RelativeMotion a_from_b;
};
[[nodiscard]] std::vector<CloseQuery> close_queries(const std::vector<Frame>& frames);

}  // namespace peerd::bench
