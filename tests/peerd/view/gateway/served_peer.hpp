#pragma once
#include <gtest/gtest.h>

#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "peerd/daemon/loop/daemon.hpp"
#include "peerd/daemon/loop/viewed_peer.hpp"
#include "peerd/net/transport/multicast_socket.hpp"
#include "peerd/view/gateway/gateway.hpp"
#include "tests/must.hpp"
#include "tests/net/listener.hpp"
#include "tests/peerd/comes_true.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::testing_support {

// A real peer alone on lo, in a thread of its own, whose gateway listens at a port of the system's choice.
class ServedPeer {
 public:
  static constexpr const char* kToken = "0123456789abcdefghijkl";
  static constexpr const char* kOtherOrigin = "http://localhost:5173";  // whose pages are let in

  ServedPeer(const std::string& vrml, const std::vector<std::string>& owns) {
    shared_ = std::move(*share_world(folder_.write("w.wrl", vrml)));
    const config::PeerSettings settings{.name = "a", .id = 1};
    config::PeerObjects objects;
    for (const std::string& path : owns) objects.owned.push_back(shared_->world.scene.find(path).value());
    PeerNode::Options options;
    options.keep_log = false;
    node_ = PeerNode::make(settings, {}, *shared_, std::move(objects), options);
    transport_ = must(net::MulticastSocket::open(
        io_, clock_,
        {.interface = "lo",
         .groups = {boost::asio::ip::make_address("239.192.80.0"), net::testing_support::own_port(13)}}));
    const auto log = [this](const LogLine& line) {
      const std::lock_guard lock(said_mutex_);
      said_ += line.text + '\n';
    };
    daemon_ = std::make_unique<Daemon>(io_, *node_, *transport_, clock_, log, std::nullopt);
    viewed_ = std::make_unique<ViewedPeer>(io_, *daemon_, *node_, "w", view::ImageLoader());
    gateway_ = must(gateway::Gateway::open(io_, *viewed_,
                                           {.at = {boost::asio::ip::address_v4::loopback(), 0},
                                            .assets = {},
                                            .token = kToken,
                                            .origins = {kOtherOrigin},
                                            .log = log}));
    port_ = gateway_->endpoint().port();
    daemon_->publish_to(*gateway_);
    daemon_->add_to_status([this] { return control::More{gateway_->counters().named()}; });
    thread_ = std::thread([this] { exit_code_ = daemon_->run(); });
  }
  ServedPeer(const ServedPeer&) = delete;
  ServedPeer& operator=(const ServedPeer&) = delete;
  ~ServedPeer() { stop(); }

  // The peer leaves, unless it has.
  void stop() {
    if (!thread_.joinable()) return;
    boost::asio::post(io_, [this] { (void)daemon_->on_control(R"({"do":"leave"})"); });
    thread_.join();
  }
  // Waits until the peer has left by itself.
  int wait() {
    thread_.join();
    return exit_code_;
  }

  // Evaluates in the peer's thread.
  template <class Function>
  auto in_its_thread(Function function) {
    std::packaged_task<decltype(function())()> task(std::move(function));
    auto result = task.get_future();
    boost::asio::post(io_, [&task] { task(); });
    return result.get();
  }
  std::uint64_t counter(const std::string& name) {
    return in_its_thread([&] {
      const auto own = node_->log().counters;
      if (own.contains(name)) return own.at(name);
      const auto more = daemon_->more_status().counters;
      return more.contains(name) ? more.at(name) : std::uint64_t{0};
    });
  }
  std::size_t connections() {
    return in_its_thread([&] { return gateway_->connections(); });
  }
  // Whether this comes true within 10 s.
  static bool soon(const std::function<bool()>& condition) { return comes_true(condition, 10); }

  // The session time; in the peer's thread only.
  [[nodiscard]] SimTime session_now() const { return node_->peer().clock().to_session(clock_.now()); }

  // Waits until the motions have begun.
  void await_start() {
    const auto begun = [this] { return node_->start() && session_now() > *node_->start(); };
    EXPECT_TRUE(soon([&] { return in_its_thread(begun); }));
  }

  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] std::string host() const { return "127.0.0.1:" + std::to_string(port_); }
  [[nodiscard]] std::string said() {
    const std::lock_guard lock(said_mutex_);
    return said_;
  }
  [[nodiscard]] gateway::GatewaySource& source() { return *viewed_; }
  [[nodiscard]] PeerNode& node() { return *node_; }  // in its thread only, or after it

 private:
  ScratchFolder folder_;
  boost::asio::io_context io_{1};
  net::HostClock clock_;
  std::unique_ptr<const SharedWorld> shared_;
  std::unique_ptr<PeerNode> node_;
  std::unique_ptr<net::Transport> transport_;
  std::mutex said_mutex_;
  std::string said_;
  std::unique_ptr<Daemon> daemon_;
  std::unique_ptr<ViewedPeer> viewed_;
  std::unique_ptr<gateway::Gateway> gateway_;
  std::uint16_t port_ = 0;
  int exit_code_ = -1;
  std::thread thread_;
};

}  // namespace peerd::testing_support
