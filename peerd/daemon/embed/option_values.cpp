#include "peerd/daemon/embed/option_values.hpp"

#include <charconv>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "peerd/daemon/join/join_world.hpp"
#include "peerd/net/keys/invitation.hpp"

namespace peerd::embed {
namespace {

constexpr std::uint32_t kPortMax = 65'535;
constexpr int kWrongOptions = 2;  // exit code

std::optional<std::uint32_t> whole_number(const std::string& text) {
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || number == 0) return std::nullopt;
  return number;
}

std::optional<bool> yes_or_no(const std::string& text) {
  if (text == "yes") return true;
  if (text == "no") return false;
  return std::nullopt;
}

}  // namespace

OptionValues::OptionValues() {
  options_.store.folder = "";
  options_.control = "";
}

bool OptionValues::set(const std::string& name, const std::string& value) {
  const std::map<std::string, std::string*> texts{
      {"world", &flags_.world}, {"world-name", &flags_.world_name},  {"name", &flags_.name},
      {"peer", &options_.peer}, {"interface", &flags_.interface},    {"group", &flags_.group},
      {"key", &flags_.key},     {"password-file", &flags_.password}, {"from", &from_},
      {"invite", &invitation_}, {"collide", &flags_.collide},        {"unit", &flags_.unit},
      {"up", &flags_.up}};
  const std::map<std::string, std::optional<std::uint32_t>*> numbers{{"id", &flags_.id}, {"port", &flags_.port}};
  const std::map<std::string, bool*> flags{{"open", &flags_.open},
                                           {"lenient", &flags_.lenient},
                                           {"fresh", &options_.store.fresh},
                                           {"take-over", &options_.take_over},
                                           {"verbose", &options_.verbose}};
  if (const auto at = texts.find(name); at != texts.end()) {
    *at->second = value;
    return true;
  }
  if (const auto at = numbers.find(name); at != numbers.end()) {
    const auto number = whole_number(value);
    if (!number || (name == "port" && *number > kPortMax)) return false;
    *at->second = number;
    return true;
  }
  if (const auto at = flags.find(name); at != flags.end()) {
    const auto flag = yes_or_no(value);
    if (flag) *at->second = *flag;
    return flag.has_value();
  }
  if (name == "own") {
    flags_.owns.push_back(value);
  } else if (name == "join") {
    join_ = value;
  } else if (name == "set") {
    options_.sets.push_back(value);
  } else if (name == "config") {
    options_.config = value;
  } else if (name == "store") {
    options_.store.folder = value;
  } else if (name == "control") {
    options_.control = value;
  } else if (name == "view") {
    options_.view = value;
  } else {
    return false;
  }
  return true;
}

Result<void> OptionValues::check() const {
  const auto wrong = [](const char* why) { return std::unexpected(InputError{why, kWrongOptions}); };
  const int worlds = int(!options_.config.empty()) + int(!flags_.world.empty()) + int(joins());
  if (worlds == 0) return wrong("error: give a configuration, a world, or one to join");
  if (joins() && worlds > 1) return wrong("error: a world that is joined has no file and no configuration");
  if (joins() && !flags_.world_name.empty()) return wrong("error: a world that is joined has its name");
  if (flags_.open && !(flags_.key.empty() && flags_.password.empty() && invitation_.empty())) {
    return wrong("error: what is open has no key, no password and no invitation");
  }
  if (!options_.config.empty() && (!flags_.name.empty() || flags_.id || !flags_.owns.empty())) {
    return wrong("error: name, id and own describe a peer without a configuration");
  }
  return {};
}

Result<PeerOptions> OptionValues::peer_options() const {
  if (const auto good = check(); !good) return std::unexpected(good.error());
  PeerOptions options = options_;
  options.embedded = true;
  options.log_to = log_to ? log_to : [](const LogLine&) {};
  RunFlags flags = flags_;
  if (joins()) flags.group.clear();  // it is the session's
  options.sets = as_settings(flags, options);
  if (!joins()) return options;
  if (const auto joined = join(options); !joined) return std::unexpected(joined.error());
  return options;
}

Result<void> OptionValues::join(PeerOptions& options) const {
  JoinRequest request;
  request.world = join_.value_or("");
  request.from = from_;
  request.transport.interface = flags_.interface;
  if (!flags_.group.empty()) request.transport.group = flags_.group;
  request.key = {flags_.key, flags_.password};
  request.open = flags_.open;
  if (!invitation_.empty()) {
    const auto invitation = keys::read_invitation(invitation_);
    if (!invitation) return std::unexpected(InputError{"error: that is no whole invitation", kWrongOptions});
    if (const auto kept = accept_invitation(*invitation, request, options.log_to); !kept) return kept;
  }
  return join_world(request, options, options.log_to);
}

}  // namespace peerd::embed
