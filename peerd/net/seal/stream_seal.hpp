#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "peerd/net/keys/symmetric_key.hpp"

namespace peerd::seal {

// One end of a connection whose frames are sealed (docs/protocol.md, Joining). Both ends send a fresh public key of
// X25519 (RFC 7748) first. The keys of the two directions come from what the two make of these and from the session's
// key: only who has that can send a frame which is opened, and who gets it later cannot read what was recorded. Frames
// are numbered, so that none comes twice or is left out. A client proves by its first frame already that it has the
// session's key, so that the server keeps a place for it before it does any other work.
class StreamSeal {
 public:
  static constexpr std::size_t kHello_bytes = 32;
  static constexpr std::size_t kAdded_bytes = 16;  // to each frame
  static constexpr std::size_t kProof_bytes = 16;  // behind a client's hello
  using Hello = std::array<std::uint8_t, kHello_bytes>;
  enum class End : std::uint8_t { kClient, kServer };

  StreamSeal(const keys::SymmetricKey& session, End end);

  // To be sent before all else.
  [[nodiscard]] const Hello& hello() const { return hello_; }
  // The same with the proof behind it.
  [[nodiscard]] std::string proven_hello() const;
  // Whether the first frame of a client has a proof, be it right or wrong, and whether it is right.
  [[nodiscard]] static bool has_proof(std::string_view frame) { return frame.size() == kHello_bytes + kProof_bytes; }
  [[nodiscard]] static bool is_proven(const keys::SymmetricKey& session, std::string_view frame);
  // Takes that of the other end, once. False: it is none.
  [[nodiscard]] bool take_hello(std::string_view hello);

  // After take_hello():
  [[nodiscard]] std::string seal(std::string_view frame);
  // None: the frame is forged, or not the next one.
  [[nodiscard]] std::optional<std::string> open(std::string_view sealed);

 private:
  keys::SymmetricKey session_, secret_;
  End end_;
  Hello hello_{};
  std::optional<keys::SymmetricKey> out_, in_;
  std::uint64_t sent_ = 0, taken_ = 0;
};

}  // namespace peerd::seal
