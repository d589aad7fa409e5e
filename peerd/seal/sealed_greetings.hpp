#pragma once
#include <functional>
#include <optional>
#include <string>

#include "peerd/keys/symmetric_key.hpp"
#include "peerd/transport/greeting_seal.hpp"

namespace peerd::seal {

// Seals greetings by the session's key (docs/protocol.md, Greeting). A greeting that was recorded is opened once more:
// the numbers in it, which their receivers renew, say that it is old (net::KnownPeers).
class SealedGreetings final : public net::GreetingSeal {
 public:
  static constexpr std::byte kMark{0x67};  // the first byte
  static constexpr std::size_t kAdded_bytes = 1 + 24 + 16;
  using Warn = std::function<void(const std::string&)>;

  // `warn` gets a line about who is not opened, once a minute.
  SealedGreetings(const SymmetricKey& session, Warn warn);
  // The session has another key from now on.
  void rekey(const SymmetricKey& session);

  [[nodiscard]] std::vector<std::byte> seal(std::span<const std::byte> greeting) override;
  [[nodiscard]] std::optional<std::vector<std::byte>> open(std::span<const std::byte> sealed, HostTime at,
                                                           const boost::asio::ip::udp::endpoint& from) override;

 private:
  [[nodiscard]] std::optional<std::vector<std::byte>> opened(std::span<const std::byte> sealed) const;

  SymmetricKey key_;
  Warn warn_;
  std::optional<HostTime> warned_;
};

}  // namespace peerd::seal
