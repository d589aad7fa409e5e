#include "peerd/net/seal/nonce_seal.hpp"

#include <sodium.h>

#include <algorithm>
#include <cassert>

#include "peerd/net/keys/little_endian.hpp"

namespace peerd::seal {
namespace {

constexpr std::size_t kRandomNonce_bytes = crypto_aead_xchacha20poly1305_ietf_NPUBBYTES;
static_assert(kNonceSealAdded_bytes == kRandomNonce_bytes + crypto_aead_xchacha20poly1305_ietf_ABYTES);

}  // namespace

std::vector<std::byte> seal_by_nonce(std::span<const std::uint8_t> text, std::size_t clear_bytes,
                                     const keys::SymmetricKey& key) {
  assert(clear_bytes <= text.size());
  std::vector<std::byte> sealed(text.size() + kNonceSealAdded_bytes);
  const auto out = keys::as_octets(std::span(sealed));
  const auto nonce = out.subspan(clear_bytes, kRandomNonce_bytes);
  const auto contents = text.subspan(clear_bytes);
  std::ranges::copy(text.first(clear_bytes), out.begin());
  randombytes_buf(nonce.data(), nonce.size());
  crypto_aead_xchacha20poly1305_ietf_encrypt(nonce.data() + nonce.size(), nullptr, contents.data(), contents.size(),
                                             out.data(), clear_bytes, nullptr, nonce.data(), key.data());
  return sealed;
}

std::optional<std::vector<std::uint8_t>> open_by_nonce(std::span<const std::byte> sealed, std::size_t clear_bytes,
                                                       const keys::SymmetricKey& key) {
  if (sealed.size() < clear_bytes + kNonceSealAdded_bytes) return std::nullopt;
  const auto in = keys::as_octets(sealed);
  const auto nonce = in.subspan(clear_bytes, kRandomNonce_bytes);
  const auto contents = in.subspan(clear_bytes + kRandomNonce_bytes);
  std::vector<std::uint8_t> text(in.size() - kNonceSealAdded_bytes);
  std::ranges::copy(in.first(clear_bytes), text.begin());
  const int failed =
      crypto_aead_xchacha20poly1305_ietf_decrypt(text.data() + clear_bytes, nullptr, nullptr, contents.data(),
                                                 contents.size(), in.data(), clear_bytes, nonce.data(), key.data());
  return failed == 0 ? std::optional(std::move(text)) : std::nullopt;
}

}  // namespace peerd::seal
