#include "peerd/net/nats/mailbox.hpp"

#include <boost/asio/post.hpp>
#include <cassert>
#include <utility>

namespace peerd::nats {

Mailbox::Mailbox(boost::asio::io_context& io, const net::HostClock& clock, std::size_t most_bytes)
    : most_bytes_(most_bytes), io_(&io), clock_(&clock) {}

void Mailbox::put(RegionId region, Message message) {
  const std::size_t bytes = static_cast<std::size_t>(natsMsg_GetDataLength(message.get())) + kOverhead_bytes;
  const std::scoped_lock lock(mutex_);
  if (io_ == nullptr) return;
  if (bytes_ + bytes > most_bytes_) {
    ++lost_;
    return;
  }
  bytes_ += bytes;
  letters_.push_back({region, clock_->now(), std::move(message)});
  if (letters_.size() == 1) wake_reader();
}

void Mailbox::wake_reader() {
  if (!wake_) return;
  boost::asio::post(*io_, [this, alive = std::weak_ptr(alive_)] {
    if (!alive.expired()) wake_();
  });
}

void Mailbox::open(std::function<void()> wake) {
  assert(wake && !wake_);
  const std::scoped_lock lock(mutex_);
  wake_ = std::move(wake);
  if (!letters_.empty()) wake_reader();
}

void Mailbox::close() {
  const std::scoped_lock lock(mutex_);
  io_ = nullptr;
  alive_.reset();
  letters_.clear();
}

void Mailbox::take(std::vector<Letter>& letters) {
  assert(letters.empty());
  const std::scoped_lock lock(mutex_);
  letters.swap(letters_);
  bytes_ = 0;
}

std::uint64_t Mailbox::lost() const {
  const std::scoped_lock lock(mutex_);
  return lost_;
}

}  // namespace peerd::nats
