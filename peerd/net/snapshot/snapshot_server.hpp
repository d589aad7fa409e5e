#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/address.hpp>

#include "peerd/net/keys/symmetric_key.hpp"
#include "peerd/net/os/net_error.hpp"
#include "peerd/net/snapshot/reply_work.hpp"

namespace peerd::snapshot {

// Answers joining peers by TCP, in the io_context's one thread. All of them together get a step of ReplyWork in
// kStepsApart, so that the peer itself goes on, whoever asks for whatever. Addresses take turns, and the connections of
// each. It changes nothing.
class SnapshotServer {
 public:
  // The connections that have proven the session's key, and beside these the ones that have not.
  static constexpr std::size_t kProvenMax = 256, kUnprovenMax = 64;
  static constexpr std::chrono::milliseconds kStepsApart{1};

  // Listens at a port that the system chooses where `port` is 0. `serves_at`: whether a connection to that address of
  // this computer is taken, once it has come; none: each is. So a server at the unspecified address goes on where the
  // addresses of this computer change.
  using ServesAt = std::function<bool(const boost::asio::ip::address&)>;
  [[nodiscard]] static std::expected<std::unique_ptr<SnapshotServer>, net::NetError> open(
      boost::asio::io_context& io, const boost::asio::ip::address& address, std::uint16_t port, SnapshotContent content,
      ServesAt serves_at = {});
  SnapshotServer(const SnapshotServer&) = delete;
  SnapshotServer& operator=(const SnapshotServer&) = delete;
  ~SnapshotServer();

  [[nodiscard]] std::uint16_t port() const;

 private:
  class Impl;
  explicit SnapshotServer(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace peerd::snapshot
