#include "collision_motion.hpp"

#include "collision/query/wide_query.hpp"
#include "generated_text.hpp"

namespace peerd::bench {
namespace {

constexpr double kStep_s = 1.0 / 60;
constexpr double kPull = 3.0;  // towards the centre [1/s^2]

Vec3 vector(Random& random, double size) {
  const double x = random.real(-size, size), y = random.real(-size, size), z = random.real(-size, size);
  return {x, y, z};
}

struct Copy {
  Pose at;
  Vec3 velocity, spin;
};

// Equal masses: the parts of the velocities along the line of centres change owners where they approach.
void bounce(Copy& a, Copy& b) {
  const Vec3 n = (b.at.position - a.at.position).normalized();
  const double closing = (a.velocity - b.velocity).dot(n);
  if (closing <= 0) return;
  a.velocity -= closing * n;
  b.velocity += closing * n;
  std::swap(a.spin, b.spin);
}

bool spheres_overlap(const Pose& a, const Pose& b) { return (a.position - b.position).squaredNorm() <= 4.0; }

}  // namespace

std::vector<Frame> move_copies(const collision::TriangleSoup& soup, std::uint32_t frames, std::uint64_t seed) {
  Random random(seed);
  std::array<Copy, kCopies> copies;
  for (std::uint32_t i = 0; i < kCopies; ++i) {
    const Vec3 place(2.2 * (i % 3) - 2.2, 2.2 * (i / 3 % 3) - 2.2, i < 9 ? 0.0 : 2.2);
    const double w = random.real(0.1, 1);
    const Vec3 axis = vector(random, 1);
    copies[i] = {{place, Quat(w, axis[0], axis[1], axis[2]).normalized()}, vector(random, 1.5), vector(random, 2)};
  }
  collision::WideTree tree(soup);
  collision::WideQuery query;
  constexpr std::uint32_t kGathering = 120;
  std::vector<Frame> out;
  for (std::uint32_t frame = 0; frame < kGathering + frames; ++frame) {
    for (Copy& c : copies) {
      c.velocity -= kPull * kStep_s * c.at.position;
      c.at.position += kStep_s * c.velocity;
      c.at.orientation = (quat_exp(Vec3(kStep_s * c.spin)) * c.at.orientation).normalized();
    }
    for (std::uint32_t a = 0; a < kCopies; ++a) {
      for (std::uint32_t b = a + 1; b < kCopies; ++b) {
        collision::PolygonPair pair{};
        if (spheres_overlap(copies[a].at, copies[b].at) &&
            query.find_pair(tree, tree, {copies[a].at, copies[b].at}, pair)) {
          bounce(copies[a], copies[b]);
        }
      }
    }
    if (frame < kGathering) continue;
    for (std::uint32_t i = 0; Copy & c : copies) {
      if (i == 0) out.emplace_back();
      out.back()[i++] = c.at;
    }
  }
  return out;
}

std::vector<CloseQuery> close_queries(const std::vector<Frame>& frames) {
  std::vector<CloseQuery> out;
  for (std::uint32_t f = 0; f < frames.size(); ++f) {
    for (std::uint32_t a = 0; a < kCopies; ++a) {
      for (std::uint32_t b = a + 1; b < kCopies; ++b) {
        if (spheres_overlap(frames[f][a], frames[f][b])) out.push_back({f, a, b, {frames[f][a], frames[f][b]}});
      }
    }
  }
  return out;
}

}  // namespace peerd::bench
