#include "bench/impact/moving_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace peerd::bench::impact {
namespace {

using collision::Numbers;
using collision::TriangleSoup;

double power_of_ten(Numbers& numbers, double low, double high) { return std::pow(10.0, numbers.between(low, high)); }
std::uint32_t count(Numbers& numbers, std::uint32_t low, std::uint32_t high) {
  return low + static_cast<std::uint32_t>(numbers.unit() * (high - low + 1));
}

void add_triangle(TriangleSoup& soup, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto first = static_cast<std::uint32_t>(soup.vertices.size());
  const auto polygon = static_cast<std::uint32_t>(soup.faces.size());
  soup.vertices.insert(soup.vertices.end(), {a, b, c});
  soup.faces.push_back({{first, first + 1, first + 2}, polygon});
}

TriangleSoup any_soup(Numbers& numbers) {
  return collision::random_soup(count(numbers, 2, 120), power_of_ten(numbers, -2, 0), count(numbers, 0, 1'000'000));
}
TriangleSoup closed_torus(Numbers& numbers) {
  return collision::torus(count(numbers, 3, 10), count(numbers, 3, 14), true);
}
TriangleSoup open_torus(Numbers& numbers) {
  TriangleSoup soup = collision::torus(count(numbers, 3, 10), count(numbers, 4, 14), false);
  soup.faces.resize(soup.faces.size() / 2);
  return soup;
}
TriangleSoup block(Numbers& numbers) {
  TriangleSoup soup;
  const Vec3 half(power_of_ten(numbers, -1, 0), power_of_ten(numbers, -1, 0), 1.0);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const auto corner = [&](double u, double v) {
        Vec3 p;
        p[axis] = side * half[axis];
        p[(axis + 1) % 3] = u * half[(axis + 1) % 3];
        p[(axis + 2) % 3] = v * half[(axis + 2) % 3];
        return p;
      };
      add_triangle(soup, corner(-1, -1), corner(1, -1), corner(1, 1));
      add_triangle(soup, corner(-1, -1), corner(1, 1), corner(-1, 1));
    }
  }
  return soup;
}
// Prisms, a hundredth to a ten-thousandth as thick as long.
TriangleSoup thin_rods(Numbers& numbers) {
  TriangleSoup soup;
  for (std::uint32_t rods = count(numbers, 1, 6); rods > 0; --rods) {
    const Vec3 from = numbers.point(1.0), to = numbers.point(1.0);
    const Vec3 u = (to - from).unitOrthogonal(), v = (to - from).normalized().cross(u);
    const double r = power_of_ten(numbers, -4, -2);
    const auto side = [&](int i) {
      const double angle = 2.0 * std::numbers::pi * i / 3.0;
      return Vec3(r * (std::cos(angle) * u + std::sin(angle) * v));
    };
    for (int i = 0; i < 3; ++i) {
      add_triangle(soup, from + side(i), to + side(i), to + side(i + 1));
      add_triangle(soup, from + side(i), to + side(i + 1), from + side(i + 1));
    }
  }
  return soup;
}
// Segments, points, triangles whose corners are in a row, and needles.
TriangleSoup without_area(Numbers& numbers) {
  TriangleSoup soup;
  for (std::uint32_t i = count(numbers, 1, 40); i > 0; --i) {
    const Vec3 p = numbers.point(1.0), q = numbers.point(1.0);
    const std::array<Vec3, 4> thirds = {p, q, Vec3(0.5 * (p + q)), Vec3(0.25 * (3.0 * p + q) + numbers.point(1e-9))};
    add_triangle(soup, p, thirds[count(numbers, 0, 3)], thirds[count(numbers, 0, 3)]);
  }
  return soup;
}
// A lattice of z over x and y, 2 wide.
template <class Height>
TriangleSoup ground(std::uint32_t cells, Height height) {
  TriangleSoup soup;
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    return Vec3(2.0 * i / cells - 1.0, 2.0 * j / cells - 1.0, height(i, j));
  };
  for (std::uint32_t i = 0; i < cells; ++i) {
    for (std::uint32_t j = 0; j < cells; ++j) {
      add_triangle(soup, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add_triangle(soup, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return soup;
}
TriangleSoup flat(Numbers& numbers) {
  return ground(count(numbers, 1, 8), [](std::uint32_t, std::uint32_t) { return 0.0; });
}
TriangleSoup hills(Numbers& numbers) {
  const double steep = numbers.between(0.05, 0.5);
  return ground(count(numbers, 4, 9),
                [=](std::uint32_t i, std::uint32_t j) { return steep * std::sin(1.7 * i) * std::cos(2.3 * j); });
}

struct Kind {
  const char* name;
  TriangleSoup (*make)(Numbers&);
};
constexpr Kind kKinds[] = {{"soup", any_soup},    {"torus", closed_torus}, {"open torus", open_torus},
                           {"block", block},      {"rods", thin_rods},     {"without area", without_area},
                           {"flat ground", flat}, {"hills", hills}};
constexpr std::size_t kGround = 6;  // it and what follows

// Coordinates as files have them.
void finish(TriangleSoup& soup, double size_m, const Vec3& offset_m) {
  for (Vec3& v : soup.vertices) v = (size_m * v + offset_m).cast<float>().cast<double>();
  soup.box = {};
  for (const TriangleSoup::Face& face : soup.faces) {
    for (const std::uint32_t corner : face.corners) soup.box.merge(soup.vertices[corner]);
  }
}

Vec3 center(const TriangleSoup& soup) { return 0.5 * (soup.box.lo + soup.box.hi); }
double half_diagonal_m(const TriangleSoup& soup) { return 0.5 * (soup.box.hi - soup.box.lo).norm(); }

Vec3 any_direction(Numbers& numbers) {
  while (true) {
    const Vec3 p = numbers.point(1.0);
    if (p.norm() > 0.1 && p.norm() < 1.0) return p.normalized();
  }
}

Vec3 any_spin(Numbers& numbers) {  // [rad], in the step
  const double which = numbers.unit();
  if (which < 0.25) return Vec3::Zero();
  return (which < 0.75 ? power_of_ten(numbers, -3, 0) : numbers.between(1.0, 30.0)) * any_direction(numbers);
}

}  // namespace

double radius_m(const TriangleSoup& soup) { return soup.box.lo.cwiseAbs().cwiseMax(soup.box.hi.cwiseAbs()).norm(); }

MovingPair random_pair(Numbers& numbers) {
  MovingPair pair;
  const bool on_ground = numbers.unit() < 0.2;
  const std::size_t kinds = std::size(kKinds);
  const std::size_t a = on_ground ? kGround + count(numbers, 0, 1) : count(numbers, 0, kinds - 1);
  const std::size_t b = count(numbers, 0, on_ground ? kGround - 1 : kinds - 1);
  pair.kind_a = kKinds[a].name;
  pair.kind_b = kKinds[b].name;
  pair.a.soup = kKinds[a].make(numbers);
  pair.b.soup = kKinds[b].make(numbers);
  const double size = power_of_ten(numbers, on_ground ? -1 : -3, 3);
  const double other = on_ground ? 0.01 * size : std::clamp(size * power_of_ten(numbers, -1.5, 1.5), 1e-3, 1e3);
  const auto offset = [&](double of) {
    return numbers.unit() < 0.3 ? Vec3(numbers.point(of * power_of_ten(numbers, -1, 1))) : Vec3(Vec3::Zero());
  };
  finish(pair.a.soup, size, offset(size));
  finish(pair.b.soup, other, offset(other));
  pair.step_s = numbers.unit() < 0.5 ? 1.0 : power_of_ten(numbers, -3, 1);
  pair.tolerance_m = numbers.unit() < 0.7 ? 1e-6 : std::max(1e-6, other * power_of_ten(numbers, -6, -3));

  // Middle beside middle, in units of both half diagonals.
  KinematicState &of_a = pair.a.motion, &of_b = pair.b.motion;
  const double both = half_diagonal_m(pair.a.soup) + half_diagonal_m(pair.b.soup), small = 2.0 * std::min(size, other);
  const double away = numbers.unit() < 0.3 ? 0.0 : power_of_ten(numbers, 0, 6);
  of_a.orientation = random_pose(numbers, 0.0).orientation;
  of_b.orientation = random_pose(numbers, 0.0).orientation;
  const Vec3 middle_a = away * numbers.point(1.0);
  Vec3 between =
      any_direction(numbers) * both * (numbers.unit() < 0.5 ? numbers.between(0.4, 1.1) : numbers.between(1.0, 4.0));
  if (on_ground) {  // over any place of it, some sizes high
    const Vec3 over(0.7 * size * numbers.between(-1, 1), 0.7 * size * numbers.between(-1, 1),
                    other * numbers.between(1.5, 12.0) + (a > kGround ? 0.3 * size : 0.0));
    between = of_a.orientation * over;
  }
  of_a.position = middle_a - of_a.orientation * center(pair.a.soup);
  of_b.position = middle_a + between - of_b.orientation * center(pair.b.soup);

  // The velocity between the middles: to a place in A, sooner or later; anyhow; or none.
  const double step = pair.step_s, which = numbers.unit();
  Vec3 way = -between + numbers.point(0.5 * both);
  if (on_ground)
    way = -between + of_a.orientation * Vec3(size * numbers.between(-1, 1), size * numbers.between(-1, 1), 0);
  Vec3 velocity = way / (step * (numbers.unit() < 0.7 ? numbers.between(0.1, 1.5) : power_of_ten(numbers, -2, 0)));
  if (which > 0.7) velocity = any_direction(numbers) * small * power_of_ten(numbers, -3, 2) / step;
  if (which > 0.9) velocity.setZero();
  const double fastest = 100.0 * std::max(size, other) / step;
  if (velocity.norm() > fastest) velocity *= fastest / velocity.norm();
  of_a.angular_velocity_body = any_spin(numbers) / step;
  of_b.angular_velocity_body = any_spin(numbers) / step;
  // The velocity that turning about an origin elsewhere adds to the middle's is not compensated.
  const Vec3 shared = numbers.unit() < 0.5 ? Vec3(Vec3::Zero()) : Vec3(numbers.point(10.0 * both / step));
  of_a.velocity = shared;
  of_b.velocity = shared + velocity;
  if (numbers.unit() < 0.4)
    of_b.acceleration = any_direction(numbers) * both * power_of_ten(numbers, -2, 1) / (step * step);
  if (numbers.unit() < 0.2) of_a.acceleration = of_b.acceleration;  // gravity
  return pair;
}

}  // namespace peerd::bench::impact
