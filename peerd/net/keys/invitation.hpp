#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "peerd/net/keys/roster.hpp"
#include "peerd/net/keys/symmetric_key.hpp"

namespace peerd::keys {

// An Invitation brings somebody into a world: its name, and the key of its session, or the roster of its members. Its
// text is one line of printable ASCII without spaces: "peerd-invite-1:" and name and key in base64 for URLs, as secret
// as the key; or "peerd-invite-2:" and the roster, which its members alone can use.
struct Invitation {
  std::string world;
  std::optional<SymmetricKey> key;  // none: the roster has it
  std::optional<Roster> roster;
};

// Both begin with it.
inline constexpr std::string_view kInvitationBegin = "peerd-invite-";

[[nodiscard]] std::string text_of(const std::string& world, const SymmetricKey& key);
[[nodiscard]] std::string text_of(const Roster& roster);
// None: it is not whole, or no invitation.
[[nodiscard]] std::optional<Invitation> read_invitation(std::string_view text);

}  // namespace peerd::keys
