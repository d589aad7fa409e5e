#pragma once
#include <map>
#include <tuple>
#include <vector>

#include "core/formats/gltf/accessors.hpp"
#include "core/formats/gltf/materials.hpp"

namespace tinygltf {
struct Primitive;
}

namespace peerd::formats::gltf {

// The Shapes of a glTF's meshes. What several primitives have in common, such as an accessor, is one node.
class Primitives {
 public:
  Primitives(const tinygltf::Model& model, Accessors& accessors, Materials& materials, Reading& reading)
      : model_(model), accessors_(accessors), materials_(materials), reading_(reading) {}

  // Adds references to the Shapes of a mesh, which are made once for all nodes that have it, to `shapes`; false where
  // the file is wrong.
  bool add_mesh(int mesh, std::vector<vrml::NodeRef>& shapes);

 private:
  bool add_primitive(const tinygltf::Primitive& primitive, const std::string& path, std::vector<vrml::NodeRef>& shapes);
  bool fail(const std::string& why) { return reading_.fail(0, why); }
  // Returns the node that holds an accessor's values; none where there is no such attribute.
  [[nodiscard]] std::expected<vrml::NodeRef, std::string> attribute(const tinygltf::Primitive& primitive,
                                                                    const char* name, std::uint64_t points);
  [[nodiscard]] std::expected<std::vector<std::uint32_t>, std::string> corners_of(const tinygltf::Primitive& primitive,
                                                                                  std::uint64_t points);
  bool add_geometry(const tinygltf::Primitive& primitive, const std::string& path, std::uint64_t points,
                    vrml::NodeRef& geometry);
  bool add_indexed_points(const tinygltf::Primitive& primitive, const std::string& path, std::uint64_t points,
                          vrml::NodeRef& geometry);
  void name_what_is_not_kept(const tinygltf::Primitive& primitive, const std::string& path);

  const tinygltf::Model& model_;
  Accessors& accessors_;
  Materials& materials_;
  Reading& reading_;
  std::map<int, std::vector<vrml::NodeRef>> meshes_;
  std::map<std::pair<int, std::string>, vrml::NodeRef> attributes_;                       // by accessor and use
  std::map<std::tuple<int, int, std::uint64_t>, std::span<const std::int32_t>> indices_;  // by accessor, mode and count
  std::map<std::vector<int>, vrml::NodeRef> geometries_;                                  // by all that makes one
};

}  // namespace peerd::formats::gltf
