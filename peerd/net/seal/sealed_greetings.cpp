#include "peerd/net/seal/sealed_greetings.hpp"

#include <cassert>

#include "peerd/net/greeting/unicast_frame.hpp"
#include "peerd/net/keys/little_endian.hpp"
#include "peerd/net/os/datagram_limits.hpp"
#include "peerd/net/seal/nonce_seal.hpp"

namespace peerd::seal {
namespace {

constexpr Duration kGreeterNamedApart = std::chrono::minutes(1);
static_assert(SealedGreetings::kAdded_bytes == 1 + kNonceSealAdded_bytes);
static_assert(net::kGreetingMaxBytes + SealedGreetings::kAdded_bytes <= net::kSentDatagramMax_bytes);

}  // namespace

keys::SymmetricKey SealedGreetings::key_of(const keys::SymmetricKey& session) {
  return session.derived("greetings", {});
}

SealedGreetings::SealedGreetings(const keys::SymmetricKey& key, Warn warn) : key_(key), warn_(std::move(warn)) {
  assert(warn_);
}

std::vector<std::byte> SealedGreetings::seal(std::span<const std::byte> greeting) {
  std::vector<std::uint8_t> text{std::to_integer<std::uint8_t>(kMark)};
  const auto octets = keys::as_octets(greeting);
  text.insert(text.end(), octets.begin(), octets.end());
  return seal_by_nonce(text, 1, key_);
}

std::optional<std::vector<std::byte>> SealedGreetings::opened(std::span<const std::byte> sealed) const {
  if (sealed.empty() || sealed.front() != kMark) return std::nullopt;
  const auto text = open_by_nonce(sealed, 1, key_);
  if (!text) return std::nullopt;
  const auto greeting = std::as_bytes(std::span(*text)).subspan(1);
  return std::vector<std::byte>(greeting.begin(), greeting.end());
}

std::optional<std::vector<std::byte>> SealedGreetings::open(std::span<const std::byte> sealed, HostTime at,
                                                            const boost::asio::ip::udp::endpoint& from) {
  auto greeting = opened(sealed);
  if (!greeting && (!warned_ || at - *warned_ >= kGreeterNamedApart)) {
    warned_ = at;
    const bool is_sealed = !sealed.empty() && sealed.front() == kMark;
    warn_(from.address().to_string() + " port " + std::to_string(from.port()) +
          (is_sealed ? " greets by another key, or forges" : " greets without a seal: it was started with --open"));
  }
  return greeting;
}

}  // namespace peerd::seal
