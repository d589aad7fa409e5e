#pragma once
#include <nats/nats.h>

#include <boost/asio/io_context.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/net/os/host_clock.hpp"

namespace peerd::nats {

struct FreeMessage {
  void operator()(natsMsg* message) const { natsMsg_Destroy(message); }
};
using Message = std::unique_ptr<natsMsg, FreeMessage>;

// A message that has come.
struct Letter {
  RegionId region;
  HostTime at;
  Message message;
};

// Hands messages from the C library's thread over to the io_context's. It is bounded: where the reader is too slow,
// further messages are lost and counted.
class Mailbox {
 public:
  // `io` and `clock` outlive close().
  Mailbox(boost::asio::io_context& io, const net::HostClock& clock, std::size_t most_bytes);

  // ---- of the library's thread ----
  void put(RegionId region, Message message);

  // ---- of the io_context's thread ----
  // `wake` is called in the io_context's thread once for each time at which letters begin to wait.
  void open(std::function<void()> wake);
  // From now on nothing is called any more, and messages are freed as they come.
  void close();
  // Exchanges the letters that wait for `letters`, which has to be empty. Letters stand in the order of their coming.
  void take(std::vector<Letter>& letters);
  [[nodiscard]] std::uint64_t lost() const;

 private:
  // The cost of a message beside its bytes: the library's own struct, its subject, its place here [bytes].
  static constexpr std::size_t kOverhead_bytes = 256;
  void wake_reader();  // with mutex_ held

  const std::size_t most_bytes_;
  mutable std::mutex mutex_;
  boost::asio::io_context* io_;  // null: closed
  const net::HostClock* clock_;
  std::function<void()> wake_;
  std::shared_ptr<const bool> alive_ = std::make_shared<const bool>(true);  // of the reader, in its own thread
  std::vector<Letter> letters_;
  std::size_t bytes_ = 0;
  std::uint64_t lost_ = 0;
};

}  // namespace peerd::nats
