#pragma once
#include <nats/nats.h>

#include <cstddef>
#include <cstdint>
#include <expected>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "core/ids.hpp"
#include "peerd/net/nats/connection_state.hpp"
#include "peerd/net/nats/mailbox.hpp"
#include "peerd/net/nats/nats_options.hpp"
#include "peerd/net/nats/subjects.hpp"
#include "peerd/net/os/net_error.hpp"

namespace peerd::nats {

// A connection of the C library to one of the servers, which it changes by itself where the one that it has is gone.
// The library may hold its lock while it connects, for seconds, so every call here may wait that long: the
// io_context's thread makes none.
class Connection {
 public:
  struct Failure {
    bool
        is_final;  // a wrong setting, a refused user, a server that takes no whole datagram: trying again does not help
    net::NetError error;
  };
  // Connects to one of the servers. What comes goes to `mailbox`, what happens to `state`.
  [[nodiscard]] static std::expected<std::unique_ptr<Connection>, Failure> open(const NatsOptions& options,
                                                                                std::shared_ptr<Mailbox> mailbox,
                                                                                std::shared_ptr<ConnectionState> state);
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection();

  // NATS_OK, or why not.
  natsStatus subscribe(RegionId region);
  natsStatus unsubscribe(RegionId region);
  natsStatus publish(RegionId region, std::span<const std::byte> datagram);
  // Messages of the subscriptions that the library has thrown away, because they waited too long in it.
  [[nodiscard]] std::uint64_t thrown_away();
  // Its URL without user and password.
  [[nodiscard]] std::string server() const;

 private:
  struct FreeConnection {
    void operator()(natsConnection* connection) const { natsConnection_Destroy(connection); }
  };
  struct FreeSubscription {
    void operator()(natsSubscription* subscription) const { natsSubscription_Destroy(subscription); }
  };
  using Subscription = std::unique_ptr<natsSubscription, FreeSubscription>;

  Connection(const NatsOptions& options, std::shared_ptr<Mailbox> mailbox);

  Subjects subjects_;
  std::shared_ptr<Mailbox> mailbox_;
  std::unique_ptr<natsConnection, FreeConnection> connection_;
  std::map<RegionId, Subscription> subscriptions_;
  std::uint64_t thrown_away_ = 0;  // of subscriptions that are no more
};

}  // namespace peerd::nats
