#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <boost/asio/ip/address.hpp>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/net/greeting/source_buckets.hpp"
#include "peerd/net/keys/identity.hpp"
#include "peerd/net/keys/symmetric_key.hpp"
#include "peerd/net/os/token_bucket.hpp"
#include "peerd/net/seal/announcement.hpp"
#include "peerd/net/seal/checkpoint.hpp"
#include "peerd/net/seal/first_heard.hpp"
#include "peerd/net/seal/known_identities.hpp"
#include "peerd/net/seal/refusal.hpp"
#include "peerd/net/seal/replay_window.hpp"

namespace peerd::seal {

// Seals datagrams and opens those of the others (docs/protocol.md, The seal). All peers of a session have one secret
// key. Each process has a boot, which it announces. A datagram's key is derived from the secret, its sender and its
// boot, and its nonce is a counter of that boot, so that no pair of the two comes twice, whatever becomes of clocks and
// stores. A boot is proven once an announcement has come from it that names this process's boot: nobody can have
// recorded that before. What members could forge is signed, or is shown to be forged by the next announcements, after
// which its sender signs everything for a while. It has no socket and no clock.
class Sealer {
 public:
  static constexpr std::size_t kHeader_bytes = 8;
  static constexpr std::size_t kAdded_bytes = kHeader_bytes + 16;  // to each datagram
  static constexpr std::size_t kBootsOfPeerMax = 8;    // of one peer, of those that are proven and of the others each
  static constexpr std::size_t kGivenUpMax = 1 << 16;  // proven boots in whose place others came

  // Whether that key is a member's.
  using IsMember = std::function<bool(const keys::PublicKey&)>;
  struct Self {
    PeerId peer;
    keys::Identity identity;
    BootId boot = random_boot();  // a process has one in each epoch
    std::uint8_t epoch = 0;       // of the session, below 32: each has a key of its own
  };

  Sealer(const keys::SymmetricKey& session, Self self, IsMember is_member = {});
  [[nodiscard]] static BootId random_boot();

  // The sealed datagram; valid until the next call. A signed one has keys::PublicKey::kSignature_bytes more. All are
  // signed while others speak in this peer's name.
  [[nodiscard]] std::span<const std::byte> seal(HostTime now, RegionId region, std::span<const std::byte> datagram,
                                                bool is_signed);
  struct Opened {
    PeerId sender;
    std::span<const std::byte> datagram;  // valid until the next call
    bool is_signed = false;               // by its sender's key; else by whoever has the session's
  };
  // Nothing of what comes is read before its tag is right. Without `may_check` a signed datagram that is right so
  // far is refused (kUnchecked), and can be opened later.
  [[nodiscard]] std::expected<Opened, Refusal> open(HostTime now, RegionId region, std::span<const std::byte> sealed,
                                                    bool may_check = true);
  // The sender that a sealed datagram names, which anybody may have made; none: it is too short.
  [[nodiscard]] static std::optional<PeerId> claimed_sender(std::span<const std::byte> sealed);
  // Whether a sealed datagram says that it is signed.
  [[nodiscard]] static bool is_signed(std::span<const std::byte> sealed);

  [[nodiscard]] static bool is_announcement(std::span<const std::byte> datagram);
  // Takes an announcement of region 0, which came from that address; none: it is good.
  [[nodiscard]] std::optional<Refusal> hear(std::span<const std::byte> announcement, HostTime now,
                                            const boost::asio::ip::address& from = {}, bool may_check = true);
  // The announcement of this process's boot, if it is time for one.
  [[nodiscard]] std::optional<std::vector<std::byte>> announcement_due(HostTime now);
  [[nodiscard]] HostTime next_announcement() const { return announce_at_; }

  // A finding is what somebody should know, once.
  struct Finding {
    enum class Kind : std::uint8_t {
      kImpersonated,  // a member has spoken in the peer's name
      kNumberTaken,   // the peer does not hear this one, whose number is another key's for it
      kNoMember,      // the peer does not hear this one, whose key is no member's for it
    };
    Kind kind;
    PeerId peer;
  };
  [[nodiscard]] std::vector<Finding> take_findings();

  [[nodiscard]] std::size_t proven_count() const;
  [[nodiscard]] std::size_t heard_count() const;                           // of boots, proven or not
  [[nodiscard]] std::size_t bound_count() const { return known_.size(); }  // peers whose key is known
  // The key that a peer belongs to, as far as it has been proven.
  [[nodiscard]] std::optional<keys::PublicKey> key_of(PeerId peer) const { return known_.key_of(peer); }
  // The peers whose announcements come and do not name this process though they have room for it: they hear nothing of
  // it. So they never prove to be no record either, and nothing else of them is opened.
  [[nodiscard]] std::vector<PeerId> deaf_peers(HostTime now) const;
  // Whether it says that it signs each datagram.
  [[nodiscard]] bool signs_all(HostTime now) const { return now < signs_all_until_; }

 private:
  struct Boot {
    BootId id;
    keys::PublicKey owner;
    keys::SymmetricKey key;
    HostTime heard;
    std::uint64_t announcements = 0;       // the number of the last one
    std::uint8_t flags = 0;                // those of Named
    std::optional<HostTime> named_us{};    // when it last named this process's boot
    std::optional<HostTime> unnamed{};     // since when it has not, since the first time that it could have
    bool has_proven_us = false;            // as it said then
    bool signs_all = false;                // as it says
    std::uint64_t newest = 0, begins = 0;  // counters: the newest known, and the one at the proof, which is the first
    std::map<RegionId, ReplayWindow> windows{};  // by region: their datagrams overtake each other by far
    HeardDatagrams unsigned_heard{};
    std::optional<HostTime> forged{};  // when somebody was last found to speak in its name

    [[nodiscard]] bool is_proven() const { return (flags & Named::kProven) != 0; }
  };

  struct Place;
  [[nodiscard]] keys::SymmetricKey datagram_key(PeerId sender, const keys::PublicKey& owner, const BootId& boot) const;
  [[nodiscard]] std::vector<std::uint8_t> signed_bytes(const BootId& boot, const Place& place,
                                                       std::span<const std::byte> datagram) const;
  [[nodiscard]] bool is_by_sender(Boot& boot, HostTime now, const Place& place, std::uint64_t counter, bool is_signed,
                                  Tag tag);
  bool decrypt(std::span<const std::byte> sealed, const Place& place, const keys::SymmetricKey& key);
  void on_own_number(HostTime now, RegionId region, std::span<const std::byte> sealed, std::uint64_t lowest);
  [[nodiscard]] std::optional<Refusal> refused(const OpenedAnnouncement& announcement, HostTime now,
                                               const boost::asio::ip::address& from, bool may_check);
  Refusal refuse(const Announcement& says, Named::Flag why, HostTime now);
  [[nodiscard]] const Boot* find(const Announcement& says) const;
  [[nodiscard]] bool has_room(const Announcement& says, HostTime now) const;
  Boot& boot_of(const Announcement& says, HostTime now);
  bool prove(PeerId sender, HostTime now);
  void on_named(Boot& boot, const Announcement& says, const Named& us, HostTime now);
  void check(Boot& boot, const Announcement& says, HostTime now);
  void on_impersonated(HostTime now);
  void announce_early(HostTime now);
  [[nodiscard]] bool may_come(const boost::asio::ip::address& from, HostTime now);
  void forget_silent(HostTime now);
  [[nodiscard]] std::vector<Named> names(HostTime now, bool& all_proven);

  keys::SymmetricKey session_, announcing_, signing_;
  Self self_;
  IsMember is_member_;  // none: whoever has the session's key is one
  keys::SymmetricKey key_;
  SentDatagrams sent_;
  std::uint64_t announcements_ = 0;
  std::map<PeerId, std::vector<Boot>> boots_;     // the one that was heard of last is the last
  std::set<std::pair<PeerId, BootId>> given_up_;  // they would begin anew, and records of them be heard
  KnownIdentities known_;
  struct RefusedBoot {
    Named name;
    HostTime heard;
  };
  std::vector<RefusedBoot> refused_boots_;  // that should know it
  std::size_t named_ = 0;                   // how many boots have been named, where not all fit
  std::optional<HostTime> announced_;
  net::SourceBuckets newcomers_;
  net::TokenBucket answers_, newcomers_from_nowhere_;
  FirstHeard first_heard_;
  HostTime announce_at_{}, signs_all_until_{};
  Duration signs_all_for_;  // the next time
  std::vector<Finding> findings_;
  std::vector<std::byte> sealed_, opened_;
};

}  // namespace peerd::seal
