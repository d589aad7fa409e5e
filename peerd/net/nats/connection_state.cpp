#include "peerd/net/nats/connection_state.hpp"

#include <utility>

namespace peerd::nats {

void ConnectionState::say(bool is_back, const std::string& sentence) {
  if (changes_.size() < kSentencesMax) changes_.push_back({is_back, sentence});
}

void ConnectionState::on_up(const std::string& sentence) {
  const std::scoped_lock lock(mutex_);
  up_ = true;
  if (said_down_) say(true, sentence);  // the first connection is said by describe()
  said_down_.reset();
}

void ConnectionState::on_down(const std::string& sentence) {
  const std::scoped_lock lock(mutex_);
  up_ = false;
  if (said_down_ != sentence) say(false, sentence);
  said_down_ = sentence;
}

void ConnectionState::on_closed(const std::string& sentence) {
  const std::scoped_lock lock(mutex_);
  up_ = false;
  closed_ = true;
  if (!sentence.empty()) say(false, sentence);
  said_down_ = sentence;
}

void ConnectionState::warn(const std::string& sentence) {
  const std::scoped_lock lock(mutex_);
  say(false, sentence);
}

void ConnectionState::begin() {
  const std::scoped_lock lock(mutex_);
  up_ = closed_ = false;
}

bool ConnectionState::is_up() const {
  const std::scoped_lock lock(mutex_);
  return up_;
}

bool ConnectionState::is_closed() const {
  const std::scoped_lock lock(mutex_);
  return closed_;
}

std::optional<net::InterfaceChange> ConnectionState::take_change() {
  const std::scoped_lock lock(mutex_);
  if (changes_.empty()) return std::nullopt;
  net::InterfaceChange change = std::move(changes_.front());
  changes_.pop_front();
  return change;
}

}  // namespace peerd::nats
