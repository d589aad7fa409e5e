#pragma once
#include <deque>
#include <functional>
#include <memory>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

namespace peerd::gateway {

// Does one piece of work in each turn of the loop, so that a peer's tick waits for one piece at most, however many
// clients ask at once.
class Turns : public std::enable_shared_from_this<Turns> {
 public:
  explicit Turns(boost::asio::io_context& io) : io_(io) {}

  void add(std::function<void()> work) {
    waiting_.push_back(std::move(work));
    if (waiting_.size() == 1) post();
  }
  // Drops what waits.
  void clear() { waiting_.clear(); }

 private:
  void post() {
    boost::asio::post(io_, [self = shared_from_this()] {
      if (self->waiting_.empty()) return;
      const std::function<void()> work = std::move(self->waiting_.front());
      self->waiting_.pop_front();
      if (!self->waiting_.empty()) self->post();
      work();
    });
  }

  boost::asio::io_context& io_;
  std::deque<std::function<void()>> waiting_;
};

}  // namespace peerd::gateway
