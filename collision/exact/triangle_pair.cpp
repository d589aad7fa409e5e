#include "collision/exact/triangle_pair.hpp"

#include "collision/exact/triangle_touch.hpp"

namespace peerd::collision {
namespace {

struct ExactSigns {
  OrientationCounters& counters;

  [[nodiscard]] std::array<int, 3> sides(const Triangle& plane, const Triangle& of) {
    const PlaneFilter filter(plane[0], plane[1], plane[2]);
    std::array<int, 3> out{};
    for (std::size_t i = 0; i < 3; ++i) {
      out[i] = filter.sign(of[i]);
      if (out[i] == 0) out[i] = volume_sign_exact(plane[0], plane[1], plane[2], of[i], counters);
    }
    return out;
  }
  [[nodiscard]] int volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return volume_sign(a, b, c, d, counters);
  }
  [[nodiscard]] int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int i, int j) {
    return collision::orient2d(a, b, c, i, j, counters);
  }
};

}  // namespace

bool touch(const Triangle& a, const Triangle& b, OrientationCounters& counters) {
  ExactSigns signs{counters};
  return detail::touch(a, b, signs);
}

}  // namespace peerd::collision
