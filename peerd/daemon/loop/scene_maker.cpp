#include "peerd/daemon/loop/scene_maker.hpp"

#include <cassert>
#include <utility>

#include <boost/asio/post.hpp>

#include "peerd/view/picture/gltf_writer.hpp"
#include "peerd/view/picture/scene_picture.hpp"

namespace peerd {

void SceneMaker::make(view::PictureInput input, std::function<void(Made)> done) {
  assert(!busy_);
  busy_ = true;
  if (thread_.joinable()) thread_.join();  // it has posted its result, and has nothing else to do
  thread_ = std::jthread([this, asked = std::move(input), done = std::move(done)]() mutable {
    Made made = view::write_glb(view::picture_of(asked));
    boost::asio::post(io_, [this, done = std::move(done), made = std::move(made)]() mutable {
      busy_ = false;
      done(std::move(made));
    });
  });
}

}  // namespace peerd
