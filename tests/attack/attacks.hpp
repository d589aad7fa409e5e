#pragma once
#include <span>
#include <string_view>

#include "tests/attack/target.hpp"

namespace peerd::attack {

struct Attack {
  std::string_view name, sentence;
  Sent (*run)(const Target& target);
};

// One member that is many, or says that it is another.
[[nodiscard]] std::span<const Attack> identity_attacks();
// Datagrams whose signatures take time to check.
[[nodiscard]] std::span<const Attack> signature_attacks();
// Edits, hellos and claims of a member that keeps to the protocol's form.
[[nodiscard]] std::span<const Attack> edit_attacks();
// Strangers and members who are in the way of a joining peer.
[[nodiscard]] std::span<const Attack> join_attacks();

}  // namespace peerd::attack
