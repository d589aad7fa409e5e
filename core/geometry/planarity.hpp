#pragma once
#include <Eigen/Core>
#include <span>

namespace peerd {

// These functions return whether points lie on one line, or in one plane. The decision is exact; coordinates must be
// finite.
[[nodiscard]] bool collinear(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c);
[[nodiscard]] bool coplanar(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
                            const Eigen::Vector3f& d);
[[nodiscard]] bool coplanar(std::span<const Eigen::Vector3f> points);  // linear

}  // namespace peerd
