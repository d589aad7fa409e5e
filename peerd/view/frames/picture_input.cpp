#include "peerd/view/frames/picture_input.hpp"

#include <utility>

#include "core/formats/draft/base64.hpp"
#include "core/motion/scene_motion.hpp"
#include "peerd/view/frames/movers.hpp"

namespace peerd::view {

ImageLoader images_of(FileLoader files, std::string world_file) {
  return [files = std::move(files),
          world_file = std::move(world_file)](std::string_view url) -> std::expected<std::string, std::string> {
    if (url.starts_with("data:")) {
      auto bytes = formats::bytes_of_data_url(url);
      if (!bytes) return std::unexpected("its data: URL is no base64");
      return std::move(*bytes);
    }
    if (!files) return std::unexpected("no files have come with this world");
    auto file = files(url, world_file);
    if (!file) return std::unexpected(file.error());
    return std::move(file->bytes);
  };
}

Scene scene_at(const Scene& scene, double t_s) {
  Scene out = scene;
  if (t_s < 0.0) return out;
  SceneMotion motion(scene);
  out.transforms = motion.transforms_at(t_s);
  for (SceneMotion::MovedGeometry& moved : motion.moved_geometries(t_s)) {
    out.geometries[moved.index] = std::move(moved.form);
  }
  return out;
}

PictureInput input_at(const Scene& scene, double t_s, std::string world, ImageLoader load_image) {
  PictureInput input{std::move(world), 1, scene_at(scene, t_s), {}, std::move(load_image)};
  for (const ObjectId id : movers_of(scene).ids) input.movers.push_back({id, input.scene.rigid_pose(id)});
  return input;
}

}  // namespace peerd::view
