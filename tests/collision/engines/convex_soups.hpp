#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>

#include "tests/collision/soups.hpp"

namespace peerd::collision::engines {

// A closed convex polyhedron: two rings of `around` corners each and two poles, within a metre of the origin.
inline TriangleSoup spindle(std::uint32_t around) {
  TriangleSoup soup;
  soup.vertices = {{0, 0, -1}, {0, 0, 1}};
  for (std::uint32_t i = 0; i < 2 * around; ++i) {
    const double turn = 2.0 * std::numbers::pi * (i / 2 + (i % 2 == 0 ? 0.0 : 0.5)) / around;
    const Vec3 at(0.8 * std::cos(turn), 0.8 * std::sin(turn), i % 2 == 0 ? -0.5 : 0.5);
    soup.vertices.push_back(at.cast<float>().cast<double>());
  }
  for (const Vec3& v : soup.vertices) soup.box.merge(v);
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    soup.faces.push_back({{a, b, c}, static_cast<std::uint32_t>(soup.faces.size())});
  };
  for (std::uint32_t i = 0; i < around; ++i) {
    const std::uint32_t low = 2 + 2 * i, high = low + 1, next = 2 + 2 * ((i + 1) % around);
    add(0, next, low);
    add(low, next, high);
    add(high, next, next + 1);
    add(1, high, next + 1);
  }
  return soup;
}

}  // namespace peerd::collision::engines
