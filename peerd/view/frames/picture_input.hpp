#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/ids.hpp"
#include "core/math.hpp"
#include "core/scene/scene.hpp"
#include "core/vrml/file_loader.hpp"

namespace peerd::view {

// An ImageLoader reads the file behind the URL of an ImageTexture, or says in a few words why it cannot.
using ImageLoader = std::function<std::expected<std::string, std::string>(std::string_view url)>;

// The longest image that a picture takes [bytes].
inline constexpr std::size_t kImage_bytes = std::size_t{16} << 20;
// Reads images as `files` reads them for a world whose file has that name, and those that stand in data: URLs. Without
// `files` there are only the latter.
[[nodiscard]] ImageLoader images_of(FileLoader files, std::string world_file);

// All that a picture is made of, at one instant. It refers to nothing that changes later, so that the picture may be
// made on another thread.
struct PictureInput {
  struct Mover {
    ObjectId id;
    Pose pose;  // the rigid frame of the node in the world
    PeerId owner = kNobody;
  };

  std::string world;           // name, for people
  std::uint32_t revision = 1;  // of the picture
  Scene scene;                 // as it is at that instant, but for the movers
  std::vector<Mover> movers;   // movers_of() it
  ImageLoader load_image{};    // none: no image is found
  bool all_levels = true;      // of an LOD, among which the viewer chooses; false: the first, which collides
};

// The scene as its own motion has it at world time t: driven Transforms and Coordinates are where they are then. t < 0:
// as its file has it.
[[nodiscard]] Scene scene_at(const Scene& scene, double t_s);
// The input for a world that no peer runs, as its own motion has it at world time t.
[[nodiscard]] PictureInput input_at(const Scene& scene, double t_s, std::string world, ImageLoader load_image = {});

}  // namespace peerd::view
