#include "vrml_worlds.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "generated_text.hpp"

namespace peerd::bench {
namespace {

constexpr const char* kHeader = "#VRML V2.0 utf8\n";

// A hilly square of side x side points, each cell cut into two triangles. `number` prints a coordinate.
TextWorld mesh(std::string name, std::uint32_t side, const char* number, std::uint64_t seed) {
  Random random(seed);
  TextWorld world{std::move(name), kHeader};
  std::string& out = world.text;
  const std::string point = std::string(number) + ' ' + number + ' ' + number + ",\n";
  out += "Shape {\n  geometry IndexedFaceSet {\n    coord Coordinate {\n      point [\n";
  for (std::uint32_t z = 0; z < side; ++z) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const double height = 3 * std::sin(0.05 * x) * std::cos(0.07 * z) + random.real(-0.1, 0.1);
      char line[128];
      const int size = std::snprintf(line, sizeof line, point.c_str(), 0.1 * x + random.real(-0.02, 0.02) - 20, height,
                                     0.1 * z + random.real(-0.02, 0.02) - 20);
      out.append(line, static_cast<std::size_t>(size));
    }
  }
  out += "      ]\n    }\n    coordIndex [\n";
  for (std::uint32_t z = 0; z + 1 < side; ++z) {
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t a = z * side + x, b = a + 1, c = a + side, d = c + 1;
      append(out, "%u, %u, %u, -1,\n%u, %u, %u, -1,\n", a, c, b, b, c, d);
    }
  }
  out += "    ]\n  }\n}\n";
  world.polygons = world.triangles = 2 * std::uint64_t{side - 1} * (side - 1);
  return world;
}

// A prism: quadrilaterals around, a fan of triangles above, one polygon below.
struct Faces {
  std::uint64_t polygons = 0, triangles = 0;
};
Faces part(std::string& out, Random& random, std::uint32_t sides) {
  const double radius = random.real(0.2, 2), height = random.real(0.1, 1);
  out += "geometry IndexedFaceSet { creaseAngle 0.50 coordIndex [";
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t j = (i + 1) % sides;
    append(out, "%u,%u,%u,%u,-1,%u,%u,%u,-1,", i, j, sides + j, sides + i, sides + i, sides + j, 2 * sides);
  }
  for (std::uint32_t i = sides; i-- > 0;) append(out, "%u,", i);
  out += "-1]\ncoord Coordinate { point [";
  for (const double y : {0.0, height}) {
    for (std::uint32_t i = 0; i < sides; ++i) {
      const double angle = 2 * std::numbers::pi * i / sides;
      append(out, "%.3f %.3f %.3f,", radius * std::cos(angle), y, -radius * std::sin(angle));
    }
  }
  append(out, "0.0 %.3f 0.0] } }\n", height + 0.1);
  return {2 * sides + 1, 2 * sides + sides + sides - 2};
}

// A circuit board as its editors export it: parts of 20 to 60 faces, a few materials, most parts USEd again.
TextWorld board(std::string name, std::uint32_t parts, std::uint64_t seed) {
  Random random(seed);
  TextWorld world{std::move(name), kHeader};
  std::string& out = world.text;
  constexpr std::uint32_t kMaterials = 12;
  for (std::uint32_t m = 0; m < kMaterials; ++m) {
    append(out,
           "Shape { appearance Appearance { material DEF PIN-%02u Material {\n  ambientIntensity %.3f\n  diffuseColor "
           "%.3f %.3f %.3f\n  specularColor %.3f %.3f %.3f\n  emissiveColor 0.0 0.0 0.0\n  transparency 0.0\n  "
           "shininess %.3f\n} } }\n",
           m, random.real(0, 1), random.real(0, 1), random.real(0, 1), random.real(0, 1), random.real(0, 1),
           random.real(0, 1), random.real(0, 1), random.real(0, 1));
  }
  std::vector<Faces> faces;
  const auto place = [&] {
    append(out, "Transform { translation %.4f 0 %.4f rotation 0 1 0 %.5f scale 0.3937 0.3937 0.3937\n",
           random.real(-100, 100), random.real(-100, 100), random.real(-3.14, 3.14));
  };
  const auto count = [&](Faces f) {
    world.polygons += f.polygons;
    world.triangles += f.triangles;
  };
  for (std::uint32_t i = 0; i < parts; ++i) {
    place();
    append(out, "children [ DEF PART_%u Shape { appearance Appearance { material USE PIN-%02u }\n", i,
           random.below(kMaterials));
    faces.push_back(part(out, random, 10 + random.below(20)));
    out += "} ] }\n";
    count(faces.back());
    if (random.below(2) == 0) continue;
    const std::uint32_t again = random.below(i + 1);
    place();
    append(out, "children [ USE PART_%u ] }\n", again);
    count(faces[again]);
  }
  return world;
}

// Many small named things.
TextWorld boxes(std::string name, std::uint32_t count, std::uint64_t seed) {
  Random random(seed);
  TextWorld world{std::move(name), kHeader};
  std::string& out = world.text;
  for (std::uint32_t i = 0; i < count; ++i) {
    append(out,
           "DEF Box_%u Transform {\n  translation %.6g %.6g %.6g\n  rotation 0 1 0 %.6g\n  children [\n    Shape {\n"
           "      appearance Appearance { material Material { diffuseColor %.3g %.3g %.3g } }\n"
           "      geometry Box { size %.4g %.4g %.4g }\n    }\n  ]\n}\n",
           i, random.real(-500, 500), random.real(0, 50), random.real(-500, 500), random.real(0, 6), random.real(0, 1),
           random.real(0, 1), random.real(0, 1), random.real(0.1, 3), random.real(0.1, 3), random.real(0.1, 3));
  }
  world.polygons = 6 * std::uint64_t{count};
  world.triangles = 12 * std::uint64_t{count};
  return world;
}

// A few Shapes, placed again and again, in groups that are themselves USEd.
TextWorld uses(std::string name, std::uint32_t count, std::uint64_t seed) {
  Random random(seed);
  TextWorld world{std::move(name), kHeader};
  std::string& out = world.text;
  constexpr std::uint32_t kShapes = 200, kRow = 50;
  std::vector<Faces> faces;
  for (std::uint32_t i = 0; i < kShapes; ++i) {
    append(out, "DEF Stone%u Shape { ", i);
    faces.push_back(part(out, random, 4 + random.below(8)));
    out += "}\n";
    world.polygons += faces.back().polygons;
    world.triangles += faces.back().triangles;
  }
  for (std::uint32_t row = 0; row < count / kRow; ++row) {
    Faces sum;
    append(out, "DEF Row%u Group { children [\n", row);
    for (std::uint32_t i = 0; i < kRow; ++i) {
      const std::uint32_t stone = random.below(kShapes);
      append(out, "  Transform { translation %.4f 0 %.4f children USE Stone%u }\n", random.real(-50, 50),
             random.real(-50, 50), stone);
      sum.polygons += faces[stone].polygons;
      sum.triangles += faces[stone].triangles;
    }
    append(out, "] }\nTransform { translation 0 %u 0 children [ USE Row%u ] }\n", row, row);
    world.polygons += 2 * sum.polygons;
    world.triangles += 2 * sum.triangles;
  }
  return world;
}

}  // namespace

std::vector<TextWorld> make_worlds(bool quick) {
  const std::uint32_t side = quick ? 12 : 400;  // 160,000 points, 318,402 triangles
  std::vector<TextWorld> worlds;
  worlds.push_back(mesh("mesh_6_decimals", side, "%.6f", 1));
  worlds.push_back(mesh("mesh_3_digits", side, "%.3g", 2));
  worlds.push_back(mesh("mesh_9_digits", side, "%.9g", 3));
  worlds.push_back(board("board", quick ? 20 : 3'000, 4));
  worlds.push_back(boxes("boxes", quick ? 50 : 60'000, 5));
  worlds.push_back(uses("uses", quick ? 200 : 100'000, 6));
  return worlds;
}

}  // namespace peerd::bench
