#include "peerd/net/keys/roster.hpp"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "peerd/input/printable.hpp"
#include "peerd/net/keys/base64.hpp"

namespace peerd::keys {
namespace {

constexpr std::string_view kRosterBegin = "peerd-roster-1 ", kRosterUse = "roster";
constexpr std::size_t kBox_bytes = crypto_box_SEALBYTES + SymmetricKey::kBytes;
constexpr std::size_t kRosterWorldMax_bytes = 255;

// The box of a key that only the member opens. None: its key is no point of the curve.
std::optional<std::string> boxed(const SymmetricKey& key, const PublicKey& member) {
  std::array<std::uint8_t, crypto_box_PUBLICKEYBYTES> curve{};
  if (crypto_sign_ed25519_pk_to_curve25519(curve.data(), member.bytes().data()) != 0) return std::nullopt;
  std::array<std::uint8_t, kBox_bytes> box{};
  if (crypto_box_seal(box.data(), key.data(), SymmetricKey::kBytes, curve.data()) != 0) return std::nullopt;
  return base64_of(box);
}

// Takes the text up to the next separator.
std::string_view take(std::string_view& text, char until) {
  const std::size_t end = std::min(text.find(until), text.size());
  const std::string_view taken = text.substr(0, end);
  text.remove_prefix(std::min(text.size(), end + 1));
  return taken;
}

// "member NAME ROLE KEY BOX" or "former NAME ROLE KEY".
std::optional<Member> read_member(std::string_view line, std::string& box) {
  const std::string_view kind = take(line, ' ');
  Member member;
  member.name = take(line, ' ');
  const auto role = role_of(take(line, ' '));
  const auto key = PublicKey::of_text(take(line, ' '));
  if ((kind != "member" && kind != "former") || !is_member_name(member.name) || !role || !key) return std::nullopt;
  member.role = *role;
  member.key = *key;
  member.is_former = kind == "former";
  box = line;
  if (box.empty() != member.is_former) return std::nullopt;
  return member;
}

}  // namespace

const char* name_of(Role role) {
  switch (role) {
    case Role::kObserver:
      return "observer";
    case Role::kEditor:
      return "editor";
    case Role::kAdministrator:
      return "administrator";
  }
  return "?";
}

std::optional<Role> role_of(std::string_view name) {
  for (const Role role : {Role::kObserver, Role::kEditor, Role::kAdministrator}) {
    if (name == name_of(role)) return role;
  }
  return std::nullopt;
}

bool is_member_name(std::string_view name) {
  const auto is_good = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
           c == '.';
  };
  return !name.empty() && name.size() <= 64 && std::ranges::all_of(name, is_good);
}

bool is_world_name(std::string_view name) {
  return !name.empty() && name.size() <= kRosterWorldMax_bytes && is_printable(name);
}

Roster Roster::first(const std::string& world, const std::string& name, const Identity& administrator) {
  assert(is_world_name(world));
  Roster roster;
  roster.world_ = world;
  roster.members_ = {{name, Role::kAdministrator, administrator.public_key()}};
  roster.close(administrator);
  return roster;
}

void Roster::add(Member member, std::string box) {
  by_key_.emplace(member.key, members_.size());
  members_.push_back(std::move(member));
  boxes_.push_back(std::move(box));
}

// Draws the epoch's key, boxes it for each member, and signs the whole.
void Roster::close(const Identity& by) {
  const SymmetricKey key = SymmetricKey::random();
  text_ = fmt::format("{}{} {}\n", kRosterBegin, epoch_, world_);
  for (Member& member : std::exchange(members_, {})) {
    const std::string box = member.is_former ? "" : boxed(key, member.key).value_or("-");
    text_ += fmt::format("{} {} {} {}{}{}\n", member.is_former ? "former" : "member", member.name, name_of(member.role),
                         member.key.text(), box.empty() ? "" : " ", box);
    add(std::move(member), box);
  }
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(text_.data()), text_.size());
  signed_by_ = by.public_key();
  const auto signature = by.sign(kRosterUse, bytes);
  text_ += fmt::format("signed {} {}\n", signed_by_.text(), base64_of(signature));
}

std::expected<Roster, std::string> Roster::next(std::vector<Member> members, const Identity& by) const {
  const Member* const administrator = find(by.public_key());
  if (administrator == nullptr || administrator->is_former || administrator->role != Role::kAdministrator) {
    return std::unexpected("you are no administrator of \"" + world_ + "\"");
  }
  const auto leads = [](const Member& each) { return each.role == Role::kAdministrator && !each.is_former; };
  if (std::ranges::none_of(members, leads)) return std::unexpected("nobody would be an administrator any more");
  Roster next;
  next.world_ = world_;
  next.epoch_ = epoch_ + 1;
  next.members_ = std::move(members);
  next.close(by);
  return next;
}

std::expected<Roster, std::string> Roster::with(Member added, const Identity& by) const {
  if (!is_member_name(added.name)) {
    return std::unexpected("\"" + added.name + "\" is no name: letters, digits, '-', '_' and '.', 64 at most");
  }
  if (members_.size() >= kMembersMax) return std::unexpected("there are too many members");
  if (find(added.key) != nullptr) {
    return std::unexpected("that key is or was " + find(added.key)->name +
                           "'s; a member that comes back, or gets another "
                           "role, has a new key (peerd keygen)");
  }
  const auto same = [&](const Member& each) { return !each.is_former && each.name == added.name; };
  if (std::ranges::any_of(members_, same)) return std::unexpected("there is a member " + added.name);
  if (!boxed(SymmetricKey::random(), added.key)) return std::unexpected("that is no key");
  std::vector<Member> members = members_;
  members.push_back(std::move(added));
  return next(std::move(members), by);
}

std::expected<Roster, std::string> Roster::without(std::string_view name, const Identity& by) const {
  std::vector<Member> members = members_;
  const auto removed =
      std::ranges::find_if(members, [&](const Member& each) { return !each.is_former && each.name == name; });
  if (removed == members.end()) return std::unexpected("there is no member " + std::string(name));
  removed->is_former = true;
  return next(std::move(members), by);
}

std::optional<Roster> Roster::of_text(std::string_view text) {
  if (text.size() > kText_bytes || !text.starts_with(kRosterBegin) || !text.ends_with('\n')) return std::nullopt;
  Roster roster;
  roster.text_ = text;
  std::string_view rest = text.substr(kRosterBegin.size());
  const std::string_view epoch = take(rest, ' ');
  const auto [end, wrong] = std::from_chars(epoch.data(), epoch.data() + epoch.size(), roster.epoch_);
  roster.world_ = take(rest, '\n');
  if (wrong != std::errc() || end != epoch.data() + epoch.size() || roster.epoch_ == 0) return std::nullopt;
  if (!is_world_name(roster.world_)) return std::nullopt;
  while (!rest.starts_with("signed ")) {
    std::string box;
    const auto member = read_member(take(rest, '\n'), box);
    if (!member || roster.find(member->key) != nullptr || roster.members_.size() >= kMembersMax) return std::nullopt;
    roster.add(*member, std::move(box));
  }
  const std::string_view is_signed = text.substr(0, text.size() - rest.size());
  std::string_view line = take(rest, '\n');
  if (!rest.empty()) return std::nullopt;
  (void)take(line, ' ');
  const auto by = PublicKey::of_text(take(line, ' '));
  PublicKey::Signature signature{};
  if (!by || read_base64(line, signature) != signature.size()) return std::nullopt;
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(is_signed.data()), is_signed.size());
  if (!by->has_signed(kRosterUse, bytes, signature)) return std::nullopt;
  roster.signed_by_ = *by;
  const Member* const administrator = roster.find(*by);
  if (administrator == nullptr || administrator->role != Role::kAdministrator) return std::nullopt;
  return roster;
}

bool Roster::is_followed_by(const Roster& next) const {
  const Member* const by = find(next.signed_by_);
  return next.world_ == world_ && next.epoch_ > epoch_ && by != nullptr && !by->is_former &&
         by->role == Role::kAdministrator;
}

const Member* Roster::find(const PublicKey& key) const {
  const auto place = by_key_.find(key);
  return place == by_key_.end() ? nullptr : &members_[place->second];
}

bool Roster::has_member(const PublicKey& key) const {
  const Member* const member = find(key);
  return member != nullptr && !member->is_former;
}

bool Roster::may_write(const PublicKey& key) const {
  const Member* const member = find(key);
  return member != nullptr && member->role != Role::kObserver;
}

std::optional<SymmetricKey> Roster::session_key(const Identity& of) const {
  const auto place = by_key_.find(of.public_key());
  std::array<std::uint8_t, kBox_bytes> box{};
  if (place == by_key_.end() || read_base64(boxes_[place->second], box) != kBox_bytes) return std::nullopt;
  return of.open_box(box);
}

}  // namespace peerd::keys
