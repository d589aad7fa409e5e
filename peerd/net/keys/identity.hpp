#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "peerd/net/keys/symmetric_key.hpp"

namespace peerd::keys {

// A public key of Ed25519 (RFC 8032) says who somebody is: whoever has the other half.
class PublicKey {
 public:
  static constexpr std::size_t kBytes = 32, kSignature_bytes = 64;
  using Signature = std::array<std::uint8_t, kSignature_bytes>;

  PublicKey() = default;
  explicit PublicKey(std::span<const std::uint8_t, kBytes> bytes);
  // The key that text() has written; none where the text is anything else.
  [[nodiscard]] static std::optional<PublicKey> of_text(std::string_view text);

  // One line of printable ASCII: "peerd-member-1:" and the key in base64 for URLs.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] std::span<const std::uint8_t, kBytes> bytes() const { return bits_; }
  // Whether the signature is this key's, for that use and of these bytes.
  [[nodiscard]] bool has_signed(std::string_view use, std::span<const std::uint8_t> bytes,
                                std::span<const std::uint8_t, kSignature_bytes> signature) const;

  friend auto operator<=>(const PublicKey&, const PublicKey&) = default;

 private:
  std::array<std::uint8_t, kBytes> bits_{};
};

// Both halves of a key. The secret one is wiped where it ends, and no log has it.
class Identity {
 public:
  static constexpr std::size_t kSeed_bytes = 32;

  // A new one, of the system's entropy.
  [[nodiscard]] static Identity random();
  // The identity that text() has written; none where the text is anything else.
  [[nodiscard]] static std::optional<Identity> of_text(std::string_view text);

  Identity(const Identity&) = default;
  Identity& operator=(const Identity&) = default;
  ~Identity();

  // One line of printable ASCII, which is secret: "peerd-identity-1:" and its seed in base64 for URLs.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] const PublicKey& public_key() const { return public_; }
  // A signature of bytes for one use, which no other use takes.
  [[nodiscard]] PublicKey::Signature sign(std::string_view use, std::span<const std::uint8_t> bytes) const;
  // The key in a box that is for this identity (crypto_box_seal of libsodium); none: it is for another, or damaged.
  [[nodiscard]] std::optional<SymmetricKey> open_box(std::span<const std::uint8_t> box) const;

 private:
  explicit Identity(std::span<const std::uint8_t, kSeed_bytes> seed);

  std::array<std::uint8_t, 64> secret_{};  // the seed, and the public key once more
  PublicKey public_;
};

}  // namespace peerd::keys
