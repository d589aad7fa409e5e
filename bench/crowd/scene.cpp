#include "bench/crowd/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <random>

#include "bench/wire_objects.hpp"

namespace peerd::bench {
namespace {

constexpr double kSpacing_m = 3.0, kSpeed_m_s = 2.0;
constexpr double kFloor_m = 200.0;

std::string text_of(const Vec3& v) {
  char text[80];
  std::snprintf(text, sizeof text, "%.9g %.9g %.9g", v.x(), v.y(), v.z());
  return text;
}

}  // namespace

CrowdScene gas_of(std::size_t bodies) {
  std::mt19937_64 rng(1);
  const double exact_side = std::cbrt(static_cast<double>(bodies));
  const auto in_a_row = static_cast<std::size_t>(std::ceil(exact_side - 1e-9));
  CrowdScene scene{CrowdKind::kGas, kSpacing_m * exact_side, {}};
  const double cell = scene.side_m / static_cast<double>(in_a_row), free = 0.5 * (cell - 1.2);
  std::vector<std::size_t> cells(in_a_row * in_a_row * in_a_row);
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = i;
  for (std::size_t i = cells.size(); i-- > 1;) std::swap(cells[i], cells[rng() % (i + 1)]);
  for (std::size_t i = 0; i < bodies; ++i) {
    const std::array at{cells[i] % in_a_row, cells[i] / in_a_row % in_a_row, cells[i] / in_a_row / in_a_row};
    CrowdBody body{Vec3::Zero(), Vec3::Zero()};
    for (int k = 0; k < 3; ++k) {
      const double centre = (static_cast<double>(at[static_cast<std::size_t>(k)]) + 0.5) * cell - 0.5 * scene.side_m;
      body.place[k] = static_cast<float>(centre + draw(rng, -free, free));
      body.velocity[k] = static_cast<float>(draw(rng, -kSpeed_m_s, kSpeed_m_s));
    }
    scene.bodies.push_back(body);
  }
  return scene;
}

CrowdScene pile_of(std::size_t bodies) {
  std::mt19937_64 rng(1);
  CrowdScene scene{CrowdKind::kPile, 0.0, {}};
  const std::size_t in_a_row = bodies < 100 ? 5 : bodies < 500 ? 6 : 10;
  const double middle = 0.5 * static_cast<double>(in_a_row - 1);
  for (std::size_t i = 0; i < bodies; ++i) {
    const double x = static_cast<double>(i % in_a_row) - middle,
                 z = static_cast<double>(i / in_a_row % in_a_row) - middle;
    const auto layer = static_cast<double>(i / in_a_row / in_a_row);
    const Vec3 place(1.5 * x + draw(rng, -0.2, 0.2), 1.5 + 2.0 * layer, 1.5 * z + draw(rng, -0.2, 0.2));
    scene.bodies.push_back({place.cast<float>().cast<double>(), Vec3::Zero()});
  }
  return scene;
}

CrowdScene standing_of(std::size_t bodies) {
  CrowdScene scene = gas_of(bodies);
  scene.kind = CrowdKind::kStanding;
  for (std::size_t i = kMovers; i < bodies; ++i) {
    scene.bodies[i].velocity.setZero();
    scene.bodies[i].moves = false;
  }
  return scene;
}

std::vector<CrowdWall> walls_of(const CrowdScene& scene) {
  if (scene.kind == CrowdKind::kPile) return {{{0, -0.5, 0}, {0.5 * kFloor_m, 0.5, 0.5 * kFloor_m}}};
  std::vector<CrowdWall> walls;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      CrowdWall wall{Vec3::Zero(), Vec3::Constant(0.5 * scene.side_m + 1.0)};
      wall.centre[axis] = side * (0.5 * scene.side_m + 0.5);
      wall.half[axis] = 0.5;
      walls.push_back(wall);
    }
  }
  return walls;
}

std::string world_text(const CrowdScene& scene) {
  const bool falls = scene.kind == CrowdKind::kPile;
  const std::string response =
      falls ? "collisionResponse CollisionResponse { responseType 2 restitution 0 friction 4.905 }"
            : "collisionResponse CollisionResponse { responseType 2 }";
  std::string text =
      "#VRML V2.0 utf8\nSwitch { choice DEF CUBE Shape { geometry Box { size 1 1 1 } } }\n"
      "DEF WALLS Group { children [\n";
  for (const CrowdWall& wall : walls_of(scene)) {
    text += "Transform { translation " + text_of(wall.centre) + " children Shape { geometry Box { size " +
            text_of(2.0 * wall.half) + " } } }\n";
  }
  text += "] }\n";
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const CrowdBody& body = scene.bodies[i];
    text += (body.moves ? "DEF B" : "DEF S") + std::to_string(i) + " Transform { translation " + text_of(body.place) +
            (body.moves ? " velocityVector " + text_of(body.velocity) + ' ' + response : "") + " children USE CUBE }\n";
  }
  text += scene.kind == CrowdKind::kStanding
              ? "CollisionInterest { objectPath \"B*\" interests [ \"B*\" \"S*\" \"WALLS\" ]"
              : "CollisionInterest { objectPath \"B*\" interests [ \"B*\" \"WALLS\" ]";
  return text + " collisionType 1 }\n";
}

CrowdState state_of(const CrowdScene& scene, const std::vector<CrowdPose>& bodies) {
  using Cell = std::array<std::int64_t, 3>;
  CrowdState state;
  std::map<Cell, std::vector<std::size_t>> cells;
  const auto cell_of = [](const Vec3& at) {
    return Cell{std::llround(at.x()), std::llround(at.y()), std::llround(at.z())};
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec3& at = bodies[i].place;
    state.energy_j += 0.5 * bodies[i].velocity.squaredNorm();
    cells[cell_of(at)].push_back(i);
    if (scene.kind == CrowdKind::kPile) {
      state.deepest_wall_m = std::max(state.deepest_wall_m, 0.5 - at.y());
      state.outside += at.y() < 0.0;
    } else {
      state.deepest_wall_m = std::max(state.deepest_wall_m, at.cwiseAbs().maxCoeff() + 0.5 - 0.5 * scene.side_m);
      state.outside += at.cwiseAbs().maxCoeff() > 0.5 * scene.side_m;
    }
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Cell at = cell_of(bodies[i].place);
    for (std::int64_t k = 0; k < 27; ++k) {
      const auto near = cells.find({at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1});
      if (near == cells.end()) continue;
      for (const std::size_t j : near->second) {
        if (j <= i) continue;
        const double overlap = 1.0 - (bodies[j].place - bodies[i].place).cwiseAbs().maxCoeff();
        state.deepest_m = std::max(state.deepest_m, overlap);
      }
    }
  }
  return state;
}

}  // namespace peerd::bench
