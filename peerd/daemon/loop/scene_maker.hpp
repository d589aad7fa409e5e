#pragma once
#include <expected>
#include <functional>
#include <string>
#include <thread>

#include <boost/asio/io_context.hpp>

#include "peerd/view/frames/picture_input.hpp"

namespace peerd {

// Makes scenes as glTF in a thread of its own, one at a time, because a large one takes longer than a tick has. The
// thread reads its own copy of the scene and nothing else of the peer.
class SceneMaker {
 public:
  using Made = std::expected<std::string, std::string>;  // the error says why it can't be written

  explicit SceneMaker(boost::asio::io_context& io) : io_(io) {}

  [[nodiscard]] bool is_busy() const { return busy_; }
  // Calls `done` in the thread of the io_context. It must not be busy.
  void make(view::PictureInput input, std::function<void(Made)> done);

 private:
  boost::asio::io_context& io_;
  bool busy_ = false;
  std::jthread thread_;  // the destructor waits for it
};

}  // namespace peerd
