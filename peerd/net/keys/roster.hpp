#pragma once
#include <cstdint>
#include <expected>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "peerd/net/keys/identity.hpp"
#include "peerd/net/keys/symmetric_key.hpp"

namespace peerd::keys {

// A role says what a member may do. It belongs to its key for good, so that all peers agree on it whenever they hear of
// it: who is to have another role gets another key.
enum class Role : std::uint8_t {
  kObserver,       // looks
  kEditor,         // changes the world
  kAdministrator,  // changes who is a member besides
};
[[nodiscard]] const char* name_of(Role role);
[[nodiscard]] std::optional<Role> role_of(std::string_view name);

struct Member {
  std::string name;  // is_member_name()
  Role role = Role::kEditor;
  PublicKey key;
  bool is_former = false;  // it was removed; what it has done stays
};
// 1 to 64 letters, digits, '-', '_' and '.'.
[[nodiscard]] bool is_member_name(std::string_view name);
// 1 to 255 bytes of a text that a terminal and a file's name can have as it is (is_printable()).
[[nodiscard]] bool is_world_name(std::string_view name);

// A Roster says who the members of a world are. Each change of it is a new epoch of the session, with a new key, which
// it has for each member in a box that only that one opens (X25519, XSalsa20-Poly1305). An administrator signs it. It
// is a text of lines, and not secret but for the names.
class Roster {
 public:
  static constexpr std::size_t kMembersMax = 1000;
  static constexpr std::size_t kText_bytes = std::size_t{1} << 18;  // at most

  // The first one of a world (is_world_name()), whose only member is its administrator, and the key of its session.
  [[nodiscard]] static Roster first(const std::string& world, const std::string& name, const Identity& administrator);
  // The next one, with a new key. The error is a sentence about why not.
  [[nodiscard]] std::expected<Roster, std::string> with(Member added, const Identity& by) const;
  [[nodiscard]] std::expected<Roster, std::string> without(std::string_view name, const Identity& by) const;

  // None: it is no roster, or nobody has signed it whom it names as an administrator.
  [[nodiscard]] static std::optional<Roster> of_text(std::string_view text);
  [[nodiscard]] const std::string& text() const { return text_; }

  // Whether it is a later one of the same world, signed by an administrator of this one.
  [[nodiscard]] bool is_followed_by(const Roster& next) const;

  [[nodiscard]] const std::string& world() const { return world_; }
  [[nodiscard]] std::uint32_t epoch() const { return epoch_; }  // from 1
  [[nodiscard]] const std::vector<Member>& members() const { return members_; }
  [[nodiscard]] const Member* find(const PublicKey& key) const;  // former ones, too; null: there is none
  [[nodiscard]] bool has_member(const PublicKey& key) const;
  // Whether operations by that key count: it is or was an editor or an administrator.
  [[nodiscard]] bool may_write(const PublicKey& key) const;
  // The key of the session in this epoch, for a member; none: it is none, or its box is damaged.
  [[nodiscard]] std::optional<SymmetricKey> session_key(const Identity& of) const;

 private:
  Roster() = default;
  [[nodiscard]] std::expected<Roster, std::string> next(std::vector<Member> members, const Identity& by) const;
  void close(const Identity& by);
  void add(Member member, std::string box);

  std::string world_, text_;
  std::uint32_t epoch_ = 1;
  std::vector<Member> members_;
  std::map<PublicKey, std::size_t> by_key_;  // their places
  std::vector<std::string> boxes_;           // in base64, of each member that is no former one
  PublicKey signed_by_;
};

}  // namespace peerd::keys
