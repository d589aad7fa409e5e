#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "peerd/seal/symmetric_key.hpp"

namespace peerd::seal {

// An Invitation brings somebody into a world: its name, and the key of its session. Its text is one line of printable
// ASCII without spaces, "peerd-invite-1:" and both in base64 for URLs, and is as secret as the key.
struct Invitation {
  std::string world;
  SymmetricKey key;
};

inline constexpr std::string_view kInvitationBegin = "peerd-invite-1:";

[[nodiscard]] std::string text_of(const Invitation& invitation);
// None: it is not whole, or no invitation.
[[nodiscard]] std::optional<Invitation> read_invitation(std::string_view text);

}  // namespace peerd::seal
