#pragma once
#include <stdexcept>
#include <string>
#include <utility>

#include "core/scene/reader.hpp"
#include "peerd/view/picture/gltf_writer.hpp"
#include "peerd/view/picture/scene_picture.hpp"
#include "tests/must.hpp"
#include "tests/peerd/view/picture/glb_reader.hpp"

namespace peerd::testing_support {

[[nodiscard]] inline Scene scene_of(const std::string& body) {
  static std::string text;  // it outlives the result
  text = "#VRML V2.0 utf8\n" + body;
  ReadResult read = read_world(text);
  if (!read.scene) throw std::runtime_error(read.diagnostics.empty() ? "no scene" : render(read, read.diagnostics[0]));
  return std::move(*read.scene);
}

[[nodiscard]] inline view::ScenePicture picture_of_text(const std::string& body, double at_s = 0.0,
                                                        view::ImageLoader images = {}) {
  return view::picture_of(view::input_at(scene_of(body), at_s, "test", std::move(images)));
}

[[nodiscard]] inline Glb glb_of_text(const std::string& body, double at_s = 0.0, view::ImageLoader images = {}) {
  return read_glb(must(view::write_glb(picture_of_text(body, at_s, std::move(images)))));
}

}  // namespace peerd::testing_support
