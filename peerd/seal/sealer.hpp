#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/seal/replay_window.hpp"
#include "peerd/seal/symmetric_key.hpp"

namespace peerd::seal {

// Why a datagram was not opened.
enum class Refusal : std::uint8_t {
  kOpen,      // it is not sealed: its sender was started with --open, or is an older program
  kOwn,       // it has this peer's number, and no other process of this peer has sent it
  kUnproven,  // nothing shows that its sender runs at present: no announcement of its boot has named this process's
  kForged,    // no key opens it: another session's, or damaged, or forged
  kReplayed,  // it has come before, or is older than kWidth counters of its region
  kTooMany,   // of a boot in whose place so many others of its peer came that it was given up
};
inline constexpr std::size_t kRefusals = 6;

// Seals datagrams and opens those of the others (docs/protocol.md, The seal). All peers of a session have one secret
// key. Each process has a boot: 128 random bits, which it announces. A datagram's key is derived from the secret, its
// sender and its boot, and its nonce is a counter of that boot, so that no pair of the two comes twice, whatever
// becomes of clocks and stores. A boot is proven once an announcement has come from it that names this process's boot:
// nobody can have recorded that before. It has no socket and no clock.
class Sealer {
 public:
  using BootId = std::array<std::uint8_t, 16>;
  static constexpr std::size_t kHeader_bytes = 8;
  static constexpr std::size_t kAdded_bytes = kHeader_bytes + 16;  // to each datagram
  static constexpr std::size_t kAnnouncementMax_bytes = 1200;
  static constexpr std::size_t kBootsOfPeerMax = 8;    // of one peer, of those that are proven and of the others each
  static constexpr std::size_t kGivenUpMax = 1 << 16;  // proven boots in whose place others came

  // A boot is random, and a process has one.
  Sealer(const SymmetricKey& session, PeerId self, const BootId& boot);
  [[nodiscard]] static BootId random_boot();

  // The sealed datagram; valid until the next call.
  [[nodiscard]] std::span<const std::byte> seal(RegionId region, std::span<const std::byte> datagram);
  // The datagram that was sealed; valid until the next call. Nothing of what comes is read before its tag is right.
  [[nodiscard]] std::expected<std::span<const std::byte>, Refusal> open(RegionId region,
                                                                        std::span<const std::byte> sealed);

  [[nodiscard]] static bool is_announcement(std::span<const std::byte> datagram);
  // Takes an announcement of region 0; none: it is good.
  [[nodiscard]] std::optional<Refusal> hear(std::span<const std::byte> announcement, HostTime now);
  // The announcement of this process's boot, if it is time for one.
  [[nodiscard]] std::optional<std::vector<std::byte>> announcement_due(HostTime now);
  [[nodiscard]] HostTime next_announcement() const { return announce_at_; }

  [[nodiscard]] std::size_t proven_count() const;
  [[nodiscard]] std::size_t heard_count() const;  // of boots, proven or not

 private:
  struct Boot {
    BootId id;
    SymmetricKey key;
    HostTime heard;
    bool is_proven = false;
    std::optional<HostTime> named_us{};    // when it last named this process's boot
    bool has_proven_us = false;            // as it said then
    std::uint64_t newest = 0, begins = 0;  // counters: the newest known, and the one at the proof, which is the first
    std::map<RegionId, ReplayWindow> windows;  // by region: their datagrams overtake each other by far
  };

  [[nodiscard]] SymmetricKey key_of(PeerId sender, const BootId& boot) const;
  Boot* boot_of(PeerId sender, const BootId& id, HostTime now);
  bool prove(PeerId sender);
  void forget_silent(HostTime now);
  bool may_answer(HostTime now);

  SymmetricKey session_, announcing_;
  PeerId self_;
  BootId boot_;
  SymmetricKey key_;
  std::uint64_t sent_ = 0;
  std::map<PeerId, std::vector<Boot>> boots_;     // the one that was heard of last is the last
  std::set<std::pair<PeerId, BootId>> given_up_;  // they would begin anew, and records of them be heard
  std::size_t named_ = 0;                         // how many boots have been named, where not all fit
  std::optional<HostTime> announced_;
  double answers_left_;  // before their time
  std::optional<HostTime> answers_counted_;
  HostTime announce_at_{};
  std::vector<std::byte> sealed_, opened_;
};

}  // namespace peerd::seal
