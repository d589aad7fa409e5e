#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace peerd::keys {

// 256 secret bits. They are wiped where it ends, and no log has them.
class SymmetricKey {
 public:
  static constexpr std::size_t kBytes = 32;

  // A key of the system's entropy.
  [[nodiscard]] static SymmetricKey random();
  // The key that text() has written; none where the text is anything else.
  [[nodiscard]] static std::optional<SymmetricKey> of_text(std::string_view text);

  [[nodiscard]] static SymmetricKey of_bytes(std::span<const std::uint8_t, kBytes> bytes);

  SymmetricKey(const SymmetricKey& other) = default;
  SymmetricKey& operator=(const SymmetricKey& other) = default;
  ~SymmetricKey();

  // One line of printable ASCII, which is as secret as the key: "peerd-key-1:" and the bits in base64 for URLs.
  [[nodiscard]] std::string text() const;
  // Another key, for one use alone, from which nobody finds this one: BLAKE2b (RFC 7693) keyed with this one, of the
  // use and of what tells keys of that use apart.
  [[nodiscard]] SymmetricKey derived(std::string_view use, std::span<const std::uint8_t> of) const;
  [[nodiscard]] const std::uint8_t* data() const { return bits_.data(); }
  // In a time that says nothing of the bits.
  friend bool operator==(const SymmetricKey& a, const SymmetricKey& b);

 private:
  SymmetricKey();
  std::array<std::uint8_t, kBytes> bits_{};
};

// Prepares libsodium, once for the process. A system without entropy is no place for a peer: throws std::runtime_error.
void need_sodium();

}  // namespace peerd::keys
