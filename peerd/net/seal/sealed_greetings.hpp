#pragma once
#include <functional>
#include <optional>
#include <string>

#include "peerd/net/greeting/greeting_seal.hpp"
#include "peerd/net/keys/symmetric_key.hpp"

namespace peerd::seal {

// Seals greetings by the session's key (docs/protocol.md, Greeting). A greeting that was recorded is opened once more:
// the numbers in it, which their receivers renew, say that it is old (net::KnownPeers).
class SealedGreetings final : public net::GreetingSeal {
 public:
  static constexpr std::size_t kAdded_bytes = 1 + 24 + 16;
  using Warn = std::function<void(const std::string&)>;

  // The key of a session's greetings, from which nobody finds the session's: a relay has it (peerd/net/relay).
  [[nodiscard]] static keys::SymmetricKey key_of(const keys::SymmetricKey& session);

  // `key`: of the greetings. `warn` gets a line about who is not opened, once a minute.
  SealedGreetings(const keys::SymmetricKey& key, Warn warn);
  // The session has other keys from now on.
  void rekey(const keys::SymmetricKey& key) { key_ = key; }

  [[nodiscard]] std::vector<std::byte> seal(std::span<const std::byte> greeting) override;
  [[nodiscard]] std::optional<std::vector<std::byte>> open(std::span<const std::byte> sealed, HostTime at,
                                                           const boost::asio::ip::udp::endpoint& from) override;

 private:
  [[nodiscard]] std::optional<std::vector<std::byte>> opened(std::span<const std::byte> sealed) const;

  keys::SymmetricKey key_;
  Warn warn_;
  std::optional<HostTime> warned_;
};

}  // namespace peerd::seal
