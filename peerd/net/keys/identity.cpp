#include "peerd/net/keys/identity.hpp"

#include <sodium.h>

#include <algorithm>
#include <cassert>

#include "peerd/net/keys/base64.hpp"
#include "peerd/net/keys/symmetric_key.hpp"

namespace peerd::keys {
namespace {

constexpr std::string_view kMemberBegin = "peerd-member-1:", kIdentityBegin = "peerd-identity-1:";

static_assert(PublicKey::kBytes == crypto_sign_PUBLICKEYBYTES && PublicKey::kSignature_bytes == crypto_sign_BYTES);
static_assert(Identity::kSeed_bytes == crypto_sign_SEEDBYTES);

// A signature is of a digest of the use and the bytes, so that a signature for one use is none for another.
std::array<std::uint8_t, 32> digest_of(std::string_view use, std::span<const std::uint8_t> bytes) {
  std::array<std::uint8_t, 32> digest{};
  crypto_generichash_state state;
  crypto_generichash_init(&state, nullptr, 0, digest.size());
  const auto use_bytes = static_cast<std::uint8_t>(use.size());
  assert(use.size() == use_bytes);
  crypto_generichash_update(&state, &use_bytes, 1);
  crypto_generichash_update(&state, reinterpret_cast<const std::uint8_t*>(use.data()), use.size());
  crypto_generichash_update(&state, bytes.data(), bytes.size());
  crypto_generichash_final(&state, digest.data(), digest.size());
  return digest;
}

}  // namespace

PublicKey::PublicKey(std::span<const std::uint8_t, kBytes> bytes) { std::ranges::copy(bytes, bits_.begin()); }

std::optional<PublicKey> PublicKey::of_text(std::string_view text) {
  if (!text.starts_with(kMemberBegin)) return std::nullopt;
  PublicKey key;
  if (read_base64(text.substr(kMemberBegin.size()), key.bits_) != kBytes) return std::nullopt;
  return key;
}

std::string PublicKey::text() const { return std::string(kMemberBegin) + base64_of(bits_); }

bool PublicKey::has_signed(std::string_view use, std::span<const std::uint8_t> bytes,
                           std::span<const std::uint8_t, kSignature_bytes> signature) const {
  const auto digest = digest_of(use, bytes);
  return crypto_sign_verify_detached(signature.data(), digest.data(), digest.size(), bits_.data()) == 0;
}

Identity::Identity(std::span<const std::uint8_t, kSeed_bytes> seed) {
  need_sodium();
  std::array<std::uint8_t, PublicKey::kBytes> bits{};
  crypto_sign_seed_keypair(bits.data(), secret_.data(), seed.data());
  public_ = PublicKey(bits);
}

Identity Identity::random() {
  need_sodium();
  std::array<std::uint8_t, kSeed_bytes> seed{};
  randombytes_buf(seed.data(), seed.size());
  Identity identity(seed);
  sodium_memzero(seed.data(), seed.size());
  return identity;
}

std::optional<Identity> Identity::of_text(std::string_view text) {
  if (!text.starts_with(kIdentityBegin)) return std::nullopt;
  std::array<std::uint8_t, kSeed_bytes> seed{};
  std::optional<Identity> identity;
  if (read_base64(text.substr(kIdentityBegin.size()), seed) == kSeed_bytes) identity = Identity(seed);
  sodium_memzero(seed.data(), seed.size());
  return identity;
}

Identity::~Identity() { sodium_memzero(secret_.data(), secret_.size()); }

std::string Identity::text() const {
  return std::string(kIdentityBegin) + base64_of(std::span(secret_).first<kSeed_bytes>());
}

PublicKey::Signature Identity::sign(std::string_view use, std::span<const std::uint8_t> bytes) const {
  const auto digest = digest_of(use, bytes);
  PublicKey::Signature signature{};
  crypto_sign_detached(signature.data(), nullptr, digest.data(), digest.size(), secret_.data());
  return signature;
}

std::optional<SymmetricKey> Identity::open_box(std::span<const std::uint8_t> box) const {
  std::array<std::uint8_t, crypto_box_PUBLICKEYBYTES> curve_public{};
  std::array<std::uint8_t, crypto_box_SECRETKEYBYTES> curve_secret{};
  std::array<std::uint8_t, SymmetricKey::kBytes> bits{};
  std::optional<SymmetricKey> key;
  if (box.size() == crypto_box_SEALBYTES + SymmetricKey::kBytes &&
      crypto_sign_ed25519_pk_to_curve25519(curve_public.data(), public_.bytes().data()) == 0 &&
      crypto_sign_ed25519_sk_to_curve25519(curve_secret.data(), secret_.data()) == 0 &&
      crypto_box_seal_open(bits.data(), box.data(), box.size(), curve_public.data(), curve_secret.data()) == 0) {
    key = SymmetricKey::of_bytes(bits);
  }
  sodium_memzero(curve_secret.data(), curve_secret.size());
  sodium_memzero(bits.data(), bits.size());
  return key;
}

}  // namespace peerd::keys
