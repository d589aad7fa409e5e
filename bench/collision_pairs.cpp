#include "collision_pairs.hpp"

#include "collision_descent.hpp"
#include "collision_motion.hpp"
#include "core/geometry/mesh.hpp"
#include "generated_text.hpp"
#include "tests/oracle/triangle_cases.hpp"

namespace peerd::bench {
namespace {

using collision::KdopTree;
using collision::Triangle;
using collision::TriangleSoup;

// All pairs of leaves that meet, up to a limit a query, so that every frame has its share.
void record(const TriangleSoup& a, const TriangleSoup& b, const collision::RelativeMotion& a_from_b, std::size_t most,
            std::vector<TrianglePair>& out) {
  KdopTree<18> tree_a(a, {}), tree_b(b, {});
  const std::size_t end = out.size() + most;
  (void)descend_pairs(tree_a, tree_b, a_from_b, [&](const Triangle& p, const Triangle& q) {
    out.push_back({p, q});
    return out.size() >= end;
  });
}

// The surface of a box of half sides 1 that stands on y = 0, in squares of two triangles; and a floor there.
TriangleSoup grid_box(int squares, double half, double height) {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::int32_t> corners;
  for (int axis = 0; axis < 3; ++axis) {
    for (int end = 0; end < 2; ++end) {
      const auto first = static_cast<std::int32_t>(vertices.size());
      for (int i = 0; i <= squares; ++i) {
        for (int j = 0; j <= squares; ++j) {
          Vec3 p;
          p[axis] = end;
          p[(axis + 1) % 3] = static_cast<double>(i) / squares;
          p[(axis + 2) % 3] = static_cast<double>(j) / squares;
          vertices.push_back(Vec3((2 * p[0] - 1) * half, p[1] * height, (2 * p[2] - 1) * half).cast<float>());
        }
      }
      for (int i = 0; i < squares; ++i) {
        for (int j = 0; j < squares; ++j) {
          const std::int32_t a = first + i * (squares + 1) + j, b = a + squares + 1;
          corners.insert(corners.end(), {a, b, b + 1, -1, a, b + 1, a + 1, -1});
        }
      }
    }
  }
  return *collision::make_soup(make_mesh(std::move(vertices), std::move(corners)));
}

// Triangles some of whose corners are on y = 0 and none below.
TriangleSoup standing_soup(std::uint32_t triangles) {
  Random random(7);
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::int32_t> corners;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const double x = random.real(-0.8, 0.8), z = random.real(-0.8, 0.8);
    const std::uint32_t standing = random.below(4);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const double y = k < standing ? 0 : random.real(0.01, 0.2);
      vertices.emplace_back(Vec3(x + random.real(-0.1, 0.1), y, z + random.real(-0.1, 0.1)).cast<float>());
      corners.push_back(static_cast<std::int32_t>(vertices.size()) - 1);
    }
    corners.push_back(-1);
  }
  return *collision::make_soup(make_mesh(std::move(vertices), std::move(corners)));
}

TriangleSoup baked(TriangleSoup soup, const Pose& pose) {
  const Mat3 rotation = pose.orientation.toRotationMatrix();
  soup.box = {};
  for (Vec3& v : soup.vertices) {
    v = rotation * v + pose.position;
    soup.box.merge(v);
  }
  return soup;
}

}  // namespace

PairInput moving_pairs(const NamedSoup& object, bool quick) {
  PairInput out{"moving." + object.name, {}};
  const auto queries = close_queries(move_copies(object.soup, quick ? 5 : 60, 1));
  for (const CloseQuery& query : queries) record(object.soup, object.soup, query.a_from_b, 4'000, out.pairs);
  return out;
}

// The floor is a slab whose top is y = 0, in squares of other sizes than the box's.
std::vector<PairInput> resting_pairs(bool quick) {
  const int squares = quick ? 4 : 20;
  TriangleSoup floor = grid_box(squares * 3 / 4, 1.5, 1);
  for (Vec3& v : floor.vertices) v[1] -= 1;
  const TriangleSoup box = grid_box(squares, 0.7, 0.7), soup = standing_soup(quick ? 50 : 2'000);
  std::vector<PairInput> out = {{"resting", {}}, {"resting_turned", {}}, {"resting_tilted", {}}, {"resting_baked", {}}};
  Random random(11);
  for (int i = 0; i < (quick ? 2 : 8); ++i) {
    const Vec3 off(random.real(-0.3, 0.3), 0, random.real(-0.3, 0.3));
    const Quat turned = quat_exp(Vec3(0, random.real(0, 6), 0));
    const Quat tilted = quat_exp(Vec3(random.real(-1, 1), random.real(-1, 1), random.real(-1, 1)));
    for (const TriangleSoup* object : {&box, &soup}) {
      record(floor, *object, {{}, {off, Quat::Identity()}}, 30'000, out[0].pairs);
      record(floor, *object, {{}, {off, turned}}, 30'000, out[1].pairs);
      record(floor, *object, {{Vec3(3, 4, 5), tilted}, {Vec3(3, 4, 5) + tilted * off, (tilted * turned).normalized()}},
             30'000, out[2].pairs);
      // Turned and rounded before: nothing is aligned with an axis, and what was one plane is so but for rounding.
      const TriangleSoup tilted_floor = baked(floor, {Vec3::Zero(), tilted});
      record(tilted_floor, baked(*object, {tilted * off, (tilted * turned).normalized()}), {{}, {}}, 30'000,
             out[3].pairs);
    }
  }
  return out;
}

std::vector<PairInput> adversarial_pairs(bool quick) {
  std::vector<PairInput> out;
  const auto triangle = [](const oracle::Triangle& t) {
    Triangle to;
    for (std::size_t i = 0; i < 3; ++i) to[i] = Vec3(t[i][0], t[i][1], t[i][2]);
    return to;
  };
  for (const oracle::Generator& generator : oracle::adversarial()) {
    out.push_back({std::string(generator.name), {}});
    oracle::Rng rng(5);
    for (int i = 0; i < (quick ? 10 : 2'000); ++i) {
      const oracle::Pair pair = generator.make(rng);
      out.back().pairs.push_back({triangle(pair.a), triangle(pair.b)});
    }
  }
  return out;
}

}  // namespace peerd::bench
