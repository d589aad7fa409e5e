// Users get invitations and texts of keys from others, or from files. An invitation that is read is the one that its
// text is of.
#include <cstdint>
#include <string_view>

#include "peerd/net/keys/invitation.hpp"
#include "tests/fuzz/fuzz.hpp"

using peerd::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace peerd::keys;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto invitation = read_invitation(text)) {
    require((invitation->roster ? text_of(*invitation->roster) : text_of(invitation->world, *invitation->key)) == text);
  }
  if (const auto roster = Roster::of_text(text)) require(roster->text() == text);
  (void)PublicKey::of_text(text);
  if (const auto identity = Identity::of_text(text)) require(identity->text() == text);
  if (const auto key = SymmetricKey::of_text(text)) require(key->text() == text);
  // Its checksum is right for once, so that what it is of is read, too.
  constexpr std::size_t kNameMax_bytes = 300;
  const std::string name(text.substr(0, kNameMax_bytes));
  const SymmetricKey key = SymmetricKey::random();
  const auto again = read_invitation(text_of(name, key));
  require(again.has_value() == is_world_name(name));
  if (again) require(again->world == name && *again->key == key);
  return 0;
}
