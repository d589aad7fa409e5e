#include "peerd/daemon/open/run_flags.hpp"

#include <filesystem>
#include <random>

#include "peerd/input/json_text.hpp"
#include "peerd/input/path_text.hpp"
#include "peerd/net/transport/transport_options.hpp"

namespace peerd {
namespace {

// A number for a peer that was given none: peers that start at one instant have two, too. Configured peers have lower
// numbers and therefore go first in decisions.
std::uint32_t random_number() {
  std::random_device random;
  return std::uniform_int_distribution<std::uint32_t>(1'000'000'000, 3'999'999'999)(random);
}

}  // namespace

std::vector<std::string> network_settings(const RunFlags& flags) {
  std::vector<std::string> sets;
  if (!flags.interface.empty()) sets.push_back("transport.interface=" + json_line(flags.interface));
  if (!flags.group.empty()) sets.push_back("transport.group=" + json_line(flags.group));
  if (flags.ipv6) sets.push_back("transport.group=" + json_line(net::kIpv6Group));
  if (flags.port) sets.push_back("transport.port=" + std::to_string(*flags.port));
  if (!flags.relays.empty()) sets.push_back("transport.relays=" + json_line(flags.relays));
  return sets;
}

std::vector<std::string> as_settings(const RunFlags& flags, PeerOptions& options) {
  std::vector<std::string> sets;
  if (!flags.world.empty()) sets.push_back("world=" + json_line(path_text(std::filesystem::absolute(flags.world))));
  if (!flags.world_name.empty()) sets.push_back("world_name=" + json_line(flags.world_name));
  if (flags.lenient) sets.emplace_back("lenient=true");
  if (!flags.collide.empty()) sets.push_back("collide=" + json_line(flags.collide));
  if (!flags.unit.empty()) sets.push_back("unit=" + json_line(flags.unit));
  if (!flags.up.empty()) sets.push_back("up=" + json_line(flags.up));
  if (options.config.empty()) {
    options.peer = flags.name.empty() ? "peer" : flags.name;
    sets.push_back("peer." + options.peer + ".id=" + std::to_string(flags.id ? *flags.id : random_number()));
    sets.push_back("peer." + options.peer + ".owns=" + json_line(flags.owns));
    options.keeps_id = !flags.id;
  }
  for (const std::string& set : network_settings(flags)) sets.push_back(set);
  if (!flags.nats.empty()) sets.push_back("transport.nats=" + json_line(flags.nats));
  if (flags.open) sets.emplace_back("transport.sealed=false");
  if (!flags.key.empty()) {
    sets.push_back("transport.key_file=" + json_line(std::filesystem::absolute(flags.key).string()));
  }
  if (!flags.password.empty()) {
    const auto file = flags.password == "-" ? flags.password : std::filesystem::absolute(flags.password).string();
    sets.push_back("transport.password_file=" + json_line(file));
  }
  sets.insert(sets.end(), options.sets.begin(), options.sets.end());
  return sets;
}

}  // namespace peerd
