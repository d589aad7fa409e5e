#pragma once
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "peerd/net/seal/operation_signer.hpp"
#include "peerd/net/seal/sealed_transport.hpp"
#include "replication/edits/log/signed_log.hpp"
#include "replication/wire/codec.hpp"
#include "tests/attack/target.hpp"

namespace peerd::attack {

// A member as all peers see one: it announces itself, says hello five times a second, and writes a signed log, of which
// it gives what somebody asks for. What it says is up to who uses it.
class HostileMember {
 public:
  explicit HostileMember(const Target& target);

  // Receives, and says hello when it is time.
  void serve(std::chrono::microseconds time);
  // Serves until some peer's hello has said the session's time; ends the program where none does.
  void enter();

  // The bytes of one more operation of its log, which holds from then on.
  std::vector<std::byte> write(replication::OperationBody body, SimTime stamp);
  // Sends bytes of its log, from that one on, by datagrams.
  void publish(std::uint64_t from);
  [[nodiscard]] std::uint64_t log_bytes() const { return log_.size(); }
  [[nodiscard]] replication::AuthorId author() const { return author_.id; }

  // A message of its own, which counts on.
  [[nodiscard]] replication::Message message();
  void send(const replication::Message& message, RegionId region = RegionId{0});
  // Its next hello, with an introduction.
  [[nodiscard]] replication::Message hello();
  // It says that hello in place of hello() from now on.
  std::function<void(replication::Message&)> change_hello = [](replication::Message&) {};

  [[nodiscard]] SimTime session_now() const;
  [[nodiscard]] const snapshot::Snapshot& world() const { return world_; }
  [[nodiscard]] PeerId id() const { return id_; }
  [[nodiscard]] std::uint64_t sent() const { return sent_; }

 private:
  void on_datagram(const net::Arrival& arrival);

  snapshot::Snapshot world_;
  boost::asio::io_context io_{1};
  net::HostClock clock_;
  PeerId id_;
  std::uint64_t incarnation_;
  std::unique_ptr<seal::SealedTransport> transport_;
  replication::Author author_;
  seal::OperationSigner signer_;
  replication::SignedLog signed_;
  std::vector<std::byte> log_;
  std::uint32_t operations_ = 0;
  SimTime last_stamp_{};
  std::map<RegionId, std::uint32_t> numbers_;
  HostTime hello_at_{};
  std::optional<Duration> session_minus_host_;
  std::uint64_t sent_ = 0;
};

}  // namespace peerd::attack
