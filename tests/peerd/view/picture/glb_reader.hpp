#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace peerd::testing_support {

// A glTF 2.0 binary as a program reads it that knows the standard alone: it shares no code with the writer.
struct Glb {
  struct Primitive {
    int mode = 4;
    std::vector<Eigen::Vector3f> positions, normals;
    std::vector<Eigen::Vector2f> texture_coordinates;
    std::vector<std::array<float, 3>> colors;
    std::vector<std::uint32_t> corners;  // where there are no indices: all, in order
    int material = -1;
  };
  struct Node {
    Eigen::Affine3d world;
    int parent = -1, mesh = -1;
    nlohmann::json json;
  };

  nlohmann::json json;
  std::string binary;
  std::vector<Node> nodes;
  std::vector<Primitive> meshes;      // of one primitive each
  std::vector<std::string> problems;  // what the standard forbids, and what would mislead a reader

  // The node of a path in its extras; -1: there is none.
  [[nodiscard]] int find(std::string_view path) const;
  // The triangles of all meshes at and below a node, in the world.
  using Triangle = std::array<Eigen::Vector3d, 3>;
  [[nodiscard]] std::vector<Triangle> triangles(int node) const;
  [[nodiscard]] const nlohmann::json& extras() const { return json.at("asset").at("extras"); }
};

[[nodiscard]] Glb read_glb(std::string_view bytes);

}  // namespace peerd::testing_support
