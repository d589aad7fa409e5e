#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <vector>

#include "core/ids.hpp"
#include "peerd/net/keys/identity.hpp"
#include "peerd/net/keys/symmetric_key.hpp"
#include "peerd/net/seal/checkpoint.hpp"

namespace peerd::seal {

// A boot is one start of a peer: random bits, from which and from the session's key that of its datagrams is derived.
using BootId = std::array<std::uint8_t, 16>;

// A peer names the boots that it hears.
struct Named {
  static constexpr std::size_t kBytes = 8;
  enum Flag : std::uint8_t {
    kProven = 1,   // it opens its datagrams
    kForged = 2,   // others speak in its name
    kTaken = 4,    // it does not hear it: its peer's number is somebody else's
    kUnknown = 8,  // it does not hear it: its key is no member's
  };
  std::array<std::uint8_t, kBytes> boot{};  // the first ones of its id
  std::uint8_t flags = 0;

  friend bool operator==(const Named&, const Named&) = default;
};
[[nodiscard]] Named name_of(const BootId& boot, std::uint8_t flags = 0);

// An Announcement says that a boot is here, whose it is, which others it hears, and what it has sent of late. It is
// sealed by a key that all members have, and signed by its sender's.
struct Announcement {
  PeerId sender{};
  BootId boot{};
  std::uint64_t number = 0;  // of this boot's announcements, ascending from 1
  std::uint64_t sent = 0;    // datagrams of this boot so far
  keys::PublicKey key{};
  bool signs_all = false;  // from now on it signs each datagram
  Checkpoint checkpoint{};
  std::vector<Named> names{};
};

inline constexpr std::uint8_t kEpochBits = 0x1F;  // of the first byte of all that is sealed: the session's epoch
inline constexpr std::size_t kAnnouncementMax_bytes = 1200;
inline constexpr std::size_t kNamesMax = 109;

// The key of all announcements of a session's epoch.
[[nodiscard]] keys::SymmetricKey announcing_key(const keys::SymmetricKey& session);
// `kind`: the first byte. Names beyond kNamesMax are none of its.
[[nodiscard]] std::vector<std::byte> seal_announcement(const Announcement& announcement, std::uint8_t kind,
                                                       const keys::SymmetricKey& announcing, const keys::Identity& by);

// An announcement that a member has made, whose signature is still to be checked, which takes far longer than all else.
class OpenedAnnouncement {
 public:
  // None: it is none, or not of this session.
  [[nodiscard]] static std::optional<OpenedAnnouncement> open(std::span<const std::byte> sealed,
                                                              const keys::SymmetricKey& announcing);

  [[nodiscard]] const Announcement& says() const { return says_; }
  [[nodiscard]] bool is_signed() const;

 private:
  Announcement says_;
  std::vector<std::uint8_t> signed_;  // its header and contents, and the session
  keys::PublicKey::Signature signature_{};
};

}  // namespace peerd::seal
