#include "peerd/net/keys/symmetric_key.hpp"

#include <sodium.h>

#include <algorithm>
#include <cassert>
#include <stdexcept>

#include "peerd/net/keys/base64.hpp"

namespace peerd::keys {
namespace {

constexpr std::string_view kTextBegin = "peerd-key-1:";

static_assert(SymmetricKey::kBytes == crypto_aead_chacha20poly1305_ietf_KEYBYTES);
static_assert(SymmetricKey::kBytes == crypto_aead_xchacha20poly1305_ietf_KEYBYTES);
static_assert(SymmetricKey::kBytes == crypto_generichash_KEYBYTES);

}  // namespace

void need_sodium() {
  if (sodium_init() < 0) throw std::runtime_error("libsodium finds no entropy on this system");
}

SymmetricKey SymmetricKey::random() {
  SymmetricKey key;
  randombytes_buf(key.bits_.data(), kBytes);
  return key;
}

std::optional<SymmetricKey> SymmetricKey::of_text(std::string_view text) {
  if (!text.starts_with(kTextBegin)) return std::nullopt;
  text.remove_prefix(kTextBegin.size());
  SymmetricKey key;
  if (read_base64(text, key.bits_) != kBytes) return std::nullopt;
  return key;
}

SymmetricKey SymmetricKey::of_bytes(std::span<const std::uint8_t, kBytes> bytes) {
  SymmetricKey key;
  std::ranges::copy(bytes, key.bits_.begin());
  return key;
}

SymmetricKey::SymmetricKey() { need_sodium(); }

SymmetricKey::~SymmetricKey() { sodium_memzero(bits_.data(), kBytes); }

std::string SymmetricKey::text() const { return std::string(kTextBegin) + base64_of(bits_); }

SymmetricKey SymmetricKey::derived(std::string_view use, std::span<const std::uint8_t> of) const {
  SymmetricKey key;
  crypto_generichash_state state;
  crypto_generichash_init(&state, bits_.data(), kBytes, kBytes);
  const auto use_bytes = static_cast<std::uint8_t>(use.size());  // so that no use and what follows make another one
  assert(use.size() == use_bytes);
  crypto_generichash_update(&state, &use_bytes, 1);
  crypto_generichash_update(&state, reinterpret_cast<const std::uint8_t*>(use.data()), use.size());
  crypto_generichash_update(&state, of.data(), of.size());
  crypto_generichash_final(&state, key.bits_.data(), kBytes);
  sodium_memzero(&state, sizeof(state));
  return key;
}

bool operator==(const SymmetricKey& a, const SymmetricKey& b) {
  return sodium_memcmp(a.data(), b.data(), SymmetricKey::kBytes) == 0;
}

}  // namespace peerd::keys
