#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "peerd/keys/roster.hpp"

namespace peerd::seal {

// Brings the newest roster to members that have an older one, be it that they were away: whoever hears one of them
// announce itself in an epoch that is over sends the roster, in parts that the key of that epoch seals. It has no
// socket and no clock.
class RosterExchange {
 public:
  static constexpr std::size_t kPart_bytes = 1000;
  static constexpr Duration kApart = std::chrono::seconds(2);  // of two times that it is sent

  // `earlier`: rosters of the same world, whose members may come back with them.
  RosterExchange(Roster current, const std::vector<Roster>& earlier, const Identity& self);

  [[nodiscard]] const Roster& current() const { return current_; }
  // The key of the session; none: this one is no member any more.
  [[nodiscard]] const std::optional<SymmetricKey>& key() const { return key_; }
  // Takes a roster that follows the current one. False: it does not.
  bool adopt(const Roster& next);

  // Whether it is part of a roster.
  [[nodiscard]] static bool is_part(std::span<const std::byte> datagram);
  // Somebody may have announced itself in an earlier epoch. Returns the datagrams that bring it the roster, if it is
  // time for them.
  [[nodiscard]] std::vector<std::vector<std::byte>> answer(std::span<const std::byte> announcement, HostTime now);
  // Whether a member of this epoch, or whoever had a roster for it, has sealed the part.
  [[nodiscard]] bool opens(std::span<const std::byte> part) const;
  // A part has come. The roster, once it is whole and follows the current one.
  [[nodiscard]] std::optional<Roster> take(std::span<const std::byte> part);

 private:
  struct Epoch {
    SymmetricKey announcing, parts;
    std::optional<HostTime> answered{};
  };
  void learn(const Roster& roster);

  Identity self_;
  Roster current_;
  std::optional<SymmetricKey> key_;
  std::map<std::uint32_t, Epoch> epochs_;  // those whose key this one knows
  // The parts of the roster that is coming.
  std::uint32_t coming_epoch_ = 0;
  std::vector<std::string> coming_;
};

// The first byte's bits for an epoch.
[[nodiscard]] std::uint8_t epoch_bits(std::uint32_t epoch);

}  // namespace peerd::seal
