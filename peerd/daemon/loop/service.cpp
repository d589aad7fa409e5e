#include "peerd/daemon/loop/service.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace peerd {
namespace {

constexpr std::chrono::seconds kPeriod{1};
// A peer says so often within the watchdog's period that it is alive.
constexpr int kSignsOfLife = 4;

}  // namespace

Service::Service(boost::asio::io_context& io, net::ServiceManager manager, Peer peer,
                 std::function<void(const LogLine&)> log)
    : timer_(io), manager_(std::move(manager)), peer_(std::move(peer)), log_(std::move(log)), period_(kPeriod) {
  if (const auto watched = manager_.watches_for()) {
    period_ = std::min<boost::asio::steady_timer::duration>(period_, *watched / kSignsOfLife);
  }
}

void Service::begin() {
  check(manager_.ready());
  wake();
}

void Service::leave() { check(manager_.stopping()); }

void Service::reload(const std::function<void()>& work) {
  check(manager_.reloading());
  work();
  check(manager_.ready());
}

// A loop that turns without ticks is not alive: the manager ends it then, and starts it anew.
void Service::wake() {
  const std::uint64_t ticks = peer_.ticks();
  if (manager_.watches_for() && ticks != ticks_) check(manager_.alive());
  ticks_ = ticks;
  if (manager_.is_there()) {
    if (std::string status = peer_.status(); status != status_) {
      status_ = std::move(status);
      check(manager_.status(status_));
    }
  }
  if (peer_.every_second) peer_.every_second();
  timer_.expires_after(period_);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) wake();
  });
}

void Service::check(const Result<void>& done) {
  if (done || has_failed_) return;
  has_failed_ = true;
  log_({LogLevel::kError, done.error().text});
}

}  // namespace peerd
