#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "peerd/net/keys/roster.hpp"
#include "peerd/net/seal/refusal.hpp"

namespace peerd::seal {

// The roster that a peer lives by, and its way to members that have an older one, be it that they were away: who hears
// one of them announce itself in an epoch that is over sends the roster, in parts that the key of that epoch seals. All
// hear that at once: each waits for a turn that its key gives it, and leaves out what another has sent meanwhile. It
// has no socket and no clock.
class RosterExchange {
 public:
  static constexpr std::size_t kPart_bytes = 1000;
  static constexpr Duration kTurn = std::chrono::milliseconds(200);
  static constexpr std::uint8_t kTurns = 8;
  static constexpr Duration kApart = std::chrono::seconds(2);         // of two times that it is sent to an epoch
  static constexpr Duration kApartFormer = std::chrono::seconds(60);  // where only former members have asked

  // `earlier`: rosters of the same world, whose members may come back with them.
  RosterExchange(keys::Roster current, const std::vector<keys::Roster>& earlier, const keys::Identity& self);

  [[nodiscard]] const keys::Roster& current() const { return current_; }
  // The key of the session; none: this one is no member.
  [[nodiscard]] const std::optional<keys::SymmetricKey>& key() const { return key_; }
  // Takes a roster that follows the current one and of which this one is a member. False: it is none.
  bool adopt(const keys::Roster& next);

  // Whether it is part of a roster.
  [[nodiscard]] static bool is_part(std::span<const std::byte> datagram);
  // Takes a datagram of another epoch. Whether it is the announcement of somebody who has an older roster.
  bool hear(std::span<const std::byte> announcement, HostTime now);
  // When to ask for answers; none: nobody waits for one.
  [[nodiscard]] std::optional<HostTime> next_answer() const;
  // The parts that are due.
  [[nodiscard]] std::vector<std::vector<std::byte>> answers(HostTime now);
  // Takes a part. The roster, once it is whole and follows the current one. The error: the part is of nobody who has
  // the key of an epoch.
  [[nodiscard]] std::expected<std::optional<keys::Roster>, Refusal> take(std::span<const std::byte> part, HostTime now);

 private:
  struct Epoch {
    keys::SymmetricKey announcing, parts;
    std::optional<HostTime> answer_at{}, answered{};
    std::set<std::size_t> heard{};  // numbers of the current roster's parts, by others, since it was asked for
  };
  struct Part;
  void learn(const keys::Roster& roster);
  void on_answer_of_another(Epoch& epoch, const Part& part, HostTime now);
  [[nodiscard]] std::optional<keys::Roster> add(Part part);
  [[nodiscard]] std::vector<std::string> pieces() const;

  keys::Identity self_;
  keys::Roster current_;
  std::optional<keys::SymmetricKey> key_;
  std::map<std::uint32_t, Epoch> epochs_;  // those whose key this one knows
  std::uint32_t refused_epoch_ = 0;        // the newest roster that does not name this one
  // The parts of the roster that is coming.
  std::uint32_t coming_epoch_ = 0;
  std::vector<std::string> coming_;
};

// The first byte's bits for an epoch.
[[nodiscard]] std::uint8_t epoch_bits(std::uint32_t epoch);

}  // namespace peerd::seal
