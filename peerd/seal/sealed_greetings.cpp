#include "peerd/seal/sealed_greetings.hpp"

#include <sodium.h>

#include <algorithm>
#include <cassert>

namespace peerd::seal {
namespace {

constexpr Duration kGreeterNamedApart = std::chrono::minutes(1);
constexpr std::size_t kGreetingNonce_bytes = crypto_aead_xchacha20poly1305_ietf_NPUBBYTES;
constexpr std::size_t kGreetingTag_bytes = crypto_aead_xchacha20poly1305_ietf_ABYTES;
constexpr std::size_t kGreetingHeader_bytes = 1 + kGreetingNonce_bytes;
static_assert(SealedGreetings::kAdded_bytes == kGreetingHeader_bytes + kGreetingTag_bytes);

std::uint8_t* octets_of(std::byte* bytes) { return reinterpret_cast<std::uint8_t*>(bytes); }
const std::uint8_t* octets_of(const std::byte* bytes) { return reinterpret_cast<const std::uint8_t*>(bytes); }

}  // namespace

SealedGreetings::SealedGreetings(const SymmetricKey& session, Warn warn)
    : key_(session.derived("greetings", {})), warn_(std::move(warn)) {
  assert(warn_);
}

void SealedGreetings::rekey(const SymmetricKey& session) { key_ = session.derived("greetings", {}); }

std::vector<std::byte> SealedGreetings::seal(std::span<const std::byte> greeting) {
  std::vector<std::byte> sealed(greeting.size() + kAdded_bytes);
  std::uint8_t* const out = octets_of(sealed.data());
  sealed[0] = kMark;
  randombytes_buf(out + 1, kGreetingNonce_bytes);
  crypto_aead_xchacha20poly1305_ietf_encrypt(out + kGreetingHeader_bytes, nullptr, octets_of(greeting.data()),
                                             greeting.size(), out, 1, nullptr, out + 1, key_.data());
  return sealed;
}

std::optional<std::vector<std::byte>> SealedGreetings::opened(std::span<const std::byte> sealed) const {
  if (sealed.size() < kAdded_bytes || sealed.front() != kMark) return std::nullopt;
  std::vector<std::byte> greeting(sealed.size() - kAdded_bytes);
  const std::uint8_t* const in = octets_of(sealed.data());
  const int failed = crypto_aead_xchacha20poly1305_ietf_decrypt(
      octets_of(greeting.data()), nullptr, nullptr, in + kGreetingHeader_bytes, sealed.size() - kGreetingHeader_bytes,
      in, 1, in + 1, key_.data());
  if (failed != 0) return std::nullopt;
  return greeting;
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
