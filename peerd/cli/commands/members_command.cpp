#include "peerd/cli/commands/members_command.hpp"

#include <optional>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/cli/shell/print.hpp"
#include "peerd/daemon/open/roster_file.hpp"
#include "peerd/net/keys/key_file.hpp"
#include "peerd/net/keys/roster.hpp"

namespace peerd {
namespace {

using keys::Member;
using keys::Roster;

std::unexpected<InputError> refused(const std::string& what) {
  return std::unexpected(InputError{"error: " + what, kWrongUse});
}

Result<Member> member_of(std::string_view text, const std::string& role_name) {
  const std::size_t equals = text.find('=');
  const auto key = equals == std::string_view::npos ? std::nullopt : keys::PublicKey::of_text(text.substr(equals + 1));
  if (!key) {
    return refused("--add " + std::string(text) + ": say NAME=KEY, with the key that peerd keygen has printed there");
  }
  const auto role = keys::role_of(role_name);
  if (!role) return refused("--role " + role_name + ": there are observer, editor and administrator");
  return Member{std::string(text.substr(0, equals)), *role, *key};
}

// Makes the roster that is wanted; it is the same one where nothing is to change.
Result<Roster> changed(const std::optional<Roster>& before, const MembersOptions& options,
                       const keys::Identity& identity) {
  if (before && !options.begin.empty()) return refused("\"" + options.world + "\" has a roster already");
  if (!before && options.begin.empty()) {
    return refused("\"" + options.world +
                   "\" has no roster: whoever has its key is in; --begin NAME begins one, with " +
                   "this user as its administrator");
  }
  if (!before && !keys::is_world_name(options.world))
    return refused("a world with a roster has a name of 1 to 255 bytes, none of them a control character");
  if (!before && !keys::is_member_name(options.begin)) return refused("--begin " + options.begin + ": that is no name");
  Roster roster = before ? *before : Roster::first(options.world, options.begin, identity);
  for (const std::string& text : options.add) {
    auto member = member_of(text, options.role);
    if (!member) return std::unexpected(member.error());
    auto next = roster.with(*std::move(member), identity);
    if (!next) return refused(next.error());
    roster = *std::move(next);
  }
  for (const std::string& name : options.remove) {
    auto next = roster.without(name, identity);
    if (!next) return refused(next.error());
    roster = *std::move(next);
  }
  return roster;
}

nlohmann::ordered_json as_json(const Roster& roster) {
  nlohmann::ordered_json members = nlohmann::ordered_json::array();
  for (const Member& each : roster.members()) {
    members.push_back({{"name", each.name},
                       {"role", keys::name_of(each.role)},
                       {"former", each.is_former},
                       {"key", each.key.text()}});
  }
  return {{"world", roster.world()}, {"epoch", roster.epoch()}, {"members", std::move(members)}};
}

}  // namespace

int run_members(const MembersOptions& options, std::ostream& out) {
  const auto file = chosen_roster_file(options.roster, options.world);
  if (!file) return failed(InputError{"error: this user has no home for a roster: say --roster FILE", kWrongUse});
  const auto before = read_roster(*file);
  if (!before) return failed(before.error());
  const auto identity_file = keys::chosen_identity_file(options.identity);
  if (!identity_file) return failed(identity_file.error());
  const auto identity = keys::read_or_make_identity(*identity_file);
  if (!identity) return failed(identity.error());
  const auto roster = changed(*before, options, *identity);
  if (!roster) return failed(roster.error());
  if (const auto saved = save_roster(*file, *roster); !saved) return failed(saved.error());
  if (options.json) {
    out << as_json(*roster) << '\n';
    return 0;
  }
  out << fmt::format("\"{}\", epoch {}\n", roster->world(), roster->epoch());
  for (const Member& each : roster->members()) {
    out << fmt::format("  {:<20} {:<14} {}{}\n", each.name, keys::name_of(each.role), each.key.text(),
                       each.is_former ? " (former)" : "");
  }
  return 0;
}

}  // namespace peerd
