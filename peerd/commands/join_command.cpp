#include "peerd/commands/join_command.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <iostream>
#include <map>
#include <utility>

#include <unistd.h>

#include <spdlog/fmt/fmt.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <nlohmann/json.hpp>

#include "peerd/commands/print.hpp"
#include "peerd/commands/problems.hpp"
#include "peerd/discovery/discovery.hpp"
#include "peerd/input/json_line.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/input/secret_line.hpp"
#include "peerd/input/toml_input.hpp"
#include "peerd/keys/invitation.hpp"
#include "peerd/keys/key_file.hpp"
#include "peerd/os/host_clock.hpp"
#include "peerd/running/roster_file.hpp"
#include "peerd/running/session_seal.hpp"
#include "peerd/snapshot/snapshot_fetch.hpp"
#include "peerd/store/store_folder.hpp"
#include "peerd/store/stored_world.hpp"
#include "peerd/transport/transport_options.hpp"
#include "replication/wire/codec.hpp"

namespace peerd {
namespace {

namespace asio = boost::asio;
using discovery::Found;

constexpr int kNoSuchWorld = 3;
constexpr Duration kAsked = std::chrono::seconds(1);

// The peers of one world that meet each other.
struct World {
  std::string name;
  std::uint64_t session = 0;
  std::vector<Found> peers;

  [[nodiscard]] bool is_sealed() const { return peers.front().beacon.sealed; }
};

Result<std::vector<World>> worlds_here(const config::TransportSettings& settings, Duration time) {
  auto reach = transport_options(settings, {});
  if (!reach) return std::unexpected(reach.error());
  const net::HostClock clock;
  auto found = discovery::ask_who_is_here(clock, reach->multicast, time);
  if (!found) return std::unexpected(input_error(found.error()));
  std::vector<World> worlds;
  for (Found& each : *found) {
    const bool goes_on =
        !worlds.empty() && worlds.back().name == each.beacon.world && worlds.back().session == each.beacon.session;
    if (!goes_on) worlds.push_back({each.beacon.world, each.beacon.session, {}});
    worlds.back().peers.push_back(std::move(each));
  }
  return worlds;
}

nlohmann::ordered_json json_of(const World& world) {
  nlohmann::ordered_json peers = nlohmann::ordered_json::array();
  for (const Found& peer : world.peers) {
    peers.push_back({{"id", peer.beacon.peer.value},
                     {"name", peer.beacon.name},
                     {"address", peer.address.to_string()},
                     {"snapshot_port", peer.beacon.snapshot_port}});
  }
  return {{"name", world.name},
          {"session", fmt::format("{:016x}", world.session)},
          {"protocol", world.peers.front().beacon.protocol},
          {"sealed", world.is_sealed()},
          {"peers", peers}};
}

std::string line_of(const World& world) {
  std::string peers;
  for (const Found& peer : world.peers) {
    peers += (peers.empty() ? "" : ", ") +
             fmt::format("{} (id {}) at {}", peer.beacon.name, peer.beacon.peer.value, peer.address.to_string());
  }
  const std::uint32_t protocol = world.peers.front().beacon.protocol;
  const std::string other = protocol == replication::kProtocolVersion
                                ? ""
                                : fmt::format("; it speaks version {} of the protocol, this program {}", protocol,
                                              replication::kProtocolVersion);
  return fmt::format("{}  (session {:016x}{}): {}{}\n", world.name, world.session, world.is_sealed() ? "" : ", open",
                     peers, other);
}

// The world of that name; with an empty name the only one. Null: there is none.
Result<const World*> choose(const std::vector<World>& worlds, const std::string& name) {
  std::vector<const World*> named;
  for (const World& world : worlds) {
    if (name.empty() || world.name == name) named.push_back(&world);
  }
  if (named.size() > 1) {
    std::string all;
    for (const World* const world : named) all += "\n  " + line_of(*world);
    return std::unexpected(InputError{
        "error: which of these worlds? Say its name, or --from HOST:PORT of one of its peers:" + all, kNoSuchWorld});
  }
  return named.empty() ? nullptr : named.front();
}

Result<snapshot::Provider> provider_at(const std::string& address) {
  const auto colon = address.rfind(':');
  const auto wrong = [&](const std::string& why) {
    return std::unexpected(InputError{"error: --from " + address + ": " + why, 2});
  };
  if (colon == std::string::npos || colon == 0) return wrong("it has to be HOST:PORT, as a peer's log says");
  std::string host = address.substr(0, colon);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  asio::io_context io;
  boost::system::error_code failed;
  const auto found = asio::ip::tcp::resolver(io).resolve(host, address.substr(colon + 1), failed);
  if (failed || found.empty()) return wrong(failed.message());
  return snapshot::Provider{address, found.begin()->endpoint()};
}

Result<std::vector<snapshot::Provider>> providers_of(const World& world) {
  std::vector<snapshot::Provider> providers;
  for (const Found& peer : world.peers) {
    if (peer.beacon.snapshot_port == 0) continue;
    providers.push_back({peer.beacon.name, {peer.address, peer.beacon.snapshot_port}});
  }
  if (!providers.empty()) return providers;
  return std::unexpected(InputError{"error: no peer of \"" + world.name + "\" gives it to who joins", kNoSuchWorld});
}

// In a session by unicast, a joining peer first greets the peers that gave it the world.
Result<void> greet_first(const std::vector<snapshot::Provider>& providers, const std::string& settings,
                         PeerOptions& peer) {
  const auto shared = config::parse_toml(settings, "the settings that were given");
  if (!shared) return std::unexpected(shared.error());
  if (shared->at_path("transport.multicast").value_or(std::string()) != "never") return {};
  const auto port = shared->at_path("transport.port").value_or(std::int64_t{config::kDefaultPort});
  std::vector<std::string> addresses;
  for (const snapshot::Provider& provider : providers) {
    const auto address = provider.at.address();
    addresses.push_back(fmt::format(fmt::runtime(address.is_v6() ? "[{}]:{}" : "{}:{}"), address.to_string(), port));
  }
  peer.sets.push_back("transport.peers=" + json_line(addresses));
  return {};
}

// The key that this user's roster of the world has for this user; none: there is no roster.
Result<std::optional<seal::SessionKey>> key_by_roster(const std::string& world) {
  const auto file = chosen_roster_file({}, world);
  if (!file) return std::nullopt;
  const auto roster = read_roster(*file);
  if (!roster) return std::unexpected(roster.error());
  if (!*roster) return std::nullopt;
  const auto identity = peer_identity({}, [](const LogLine& line) { std::cerr << line.text << '\n'; });
  if (!identity) return std::unexpected(identity.error());
  const auto key = (*roster)->session_key(*identity);
  if (!key) return std::unexpected(not_a_member(*file, *identity));
  return seal::SessionKey{*key, "the roster " + file->string()};
}

// The key of a session that others have begun; none: it is open. Nobody makes one for it.
Result<std::optional<seal::SessionKey>> key_of(const JoinOptions& options, const std::string& world) {
  if (options.open) return std::nullopt;
  if (world.empty() && options.key.key_file.empty()) {
    return std::unexpected(
        InputError{"error: which key? Say the world's name, or --key FILE; --open, if it is open", 2});
  }
  if (options.key.key_file.empty() && options.key.password_file.empty()) {
    auto by_roster = key_by_roster(world);
    if (!by_roster || *by_roster) return by_roster;
  }
  auto key = seal::session_key(options.key, world, seal::IfMissing::kFail);
  if (key) return *std::move(key);
  const bool has_password = !options.key.password_file.empty();
  return std::unexpected(InputError{key.error().text + (has_password ? ""
                                                                     : "; whoever runs that world has its key: --key "
                                                                       "FILE says a copy, and --open that there is "
                                                                       "none"),
                                    key.error().exit_code});
}

Result<JoinedWorld> joined_by_peers(const std::vector<snapshot::Provider>& providers, std::uint64_t session,
                                    const std::string& world, JoinOptions& options) {
  const auto key = key_of(options, world);
  if (!key) return std::unexpected(key.error());
  PeerOptions& peer = options.peer;
  peer.key = *key;
  const auto began = std::chrono::steady_clock::now();
  auto snapshot =
      snapshot::fetch_snapshot(providers, session, {.key = *key ? std::optional((*key)->key) : std::nullopt});
  if (!snapshot) return std::unexpected(InputError{"error: " + snapshot.error(), kNoSuchWorld});
  print_warnings(snapshot->notes);
  if (auto done = greet_first(providers, snapshot->offer.settings, peer); !done) return std::unexpected(done.error());
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  snapshot::Offer& offer = snapshot->offer;
  std::cerr << fmt::format("got \"{}\" from {} in {:.2f} s over {}: {} of its files, operations of {}; {}\n",
                           offer.world, snapshot->provided_by, took_s, counted(snapshot->connections, "connection"),
                           counted(snapshot->archive.size(), "byte"), counted(snapshot->logs.size(), "author"),
                           snapshot->checked_with.empty() ? "nobody else is here to compare it with"
                                                          : snapshot->checked_with + " has the same");
  return JoinedWorld{{offer.world, offer.genesis, std::move(offer.settings), std::move(snapshot->archive)},
                     offer.session,
                     std::move(snapshot->logs)};
}

// Nobody is here: whoever comes back brings the world back.
Result<JoinedWorld> joined_by_store(JoinOptions& options) {
  const auto& folder = options.peer.store.folder;
  std::vector<std::filesystem::path> folders;
  if (folder && !folder->empty()) {
    folders.push_back(*folder);
  } else if (!folder) {
    folders = store::stores_of_world(options.world);
    const auto is_of_this_peer = [&](const std::filesystem::path& each) {
      return each.filename() == options.peer.peer;
    };
    if (std::ranges::count_if(folders, is_of_this_peer) == 1) std::erase_if(folders, std::not_fn(is_of_this_peer));
  }
  const std::string what = options.world.empty() ? "a world" : "\"" + options.world + "\"";
  std::string all;
  for (const auto& each : folders) {
    auto world = store::read_world_of_store(each);
    if (!world) return std::unexpected(world.error());
    all += "\n  " + each.string();
    const bool is_asked_for = *world && (options.world.empty() || (*world)->name == options.world);
    if (!is_asked_for || folders.size() > 1) continue;
    options.peer.store.folder = each;
    std::cerr << fmt::format("no peer of \"{}\" is here: begins with the store {}\n", (*world)->name, each.string());
    return JoinedWorld{**std::move(world), 0, {}};
  }
  if (folders.size() > 1) {
    return std::unexpected(InputError{
        "error: no peer of " + what + " is here, and there is more than one store: say --store DIR with one of" + all,
        kNoSuchWorld});
  }
  return std::unexpected(
      InputError{"error: no peer of " + what +
                     " answers in this network, and this user has no store of it; peerd ls shows who "
                     "is here, and --from HOST:PORT asks one peer",
                 kNoSuchWorld});
}

// The invitation that somebody pastes, or a file has. It may be the whole line that peerd invite prints.
Result<std::optional<seal::Invitation>> pasted_invitation() {
  const auto line = read_secret_line(STDIN_FILENO, "what peerd invite has printed: ", "--invite -");
  if (!line) return std::unexpected(line.error());
  std::string_view text = line->view();
  while (text.ends_with(' ') || text.ends_with('\r')) text.remove_suffix(1);
  return seal::read_invitation(text.substr(text.rfind(' ') + 1));
}

// Keeps the key of an invitation as this user's own of that world.
Result<void> accept_invitation(JoinOptions& options) {
  if (options.invitation.empty()) return {};
  auto pasted = options.invitation == "-"
                    ? pasted_invitation()
                    : Result<std::optional<seal::Invitation>>(seal::read_invitation(options.invitation));
  if (!pasted) return std::unexpected(pasted.error());
  const std::optional<seal::Invitation> invitation = *std::move(pasted);
  if (!invitation)
    return std::unexpected(InputError{"error: --invite: that is no whole invitation of peerd invite", 2});
  if (!options.world.empty() && options.world != invitation->world) {
    return std::unexpected(InputError{"error: the invitation is to \"" + invitation->world + "\"", 2});
  }
  options.world = invitation->world;
  if (invitation->roster) {
    const auto file = chosen_roster_file({}, options.world);
    if (!file) return std::unexpected(InputError{"error: this user has no home for a roster", 2});
    return save_roster(*file, *invitation->roster);
  }
  const auto file = seal::chosen_key_file({}, options.world);
  if (!file) return std::unexpected(file.error());
  if (const auto kept = seal::keep_key(*file, *invitation->key); !kept) return kept;
  std::cerr << "keeps the key of \"" << options.world << "\" in " << file->string() << '\n';
  return {};
}

Result<JoinedWorld> find_world(JoinOptions& options) {
  if (!options.from.empty()) {
    const auto provider = provider_at(options.from);
    if (!provider) return std::unexpected(provider.error());
    return joined_by_peers({*provider}, 0, options.world, options);
  }
  const auto worlds = worlds_here(options.transport, kAsked);
  if (!worlds) return std::unexpected(worlds.error());
  const auto world = choose(*worlds, options.world);
  if (!world) return std::unexpected(world.error());
  if (*world == nullptr) return joined_by_store(options);
  const auto providers = providers_of(**world);
  if (!providers) return std::unexpected(providers.error());
  if (const bool sealed = (*world)->is_sealed(); sealed == options.open) {
    return std::unexpected(
        InputError{"error: \"" + (*world)->name + (sealed ? "\" is sealed" : "\" is open: say --open"), 2});
  }
  return joined_by_peers(*providers, (*world)->session, (*world)->name, options);
}

}  // namespace

int run_ls(const LsOptions& options, std::ostream& out) {
  const auto worlds = worlds_here(options.transport, from_seconds(options.seconds));
  if (!worlds) return failed(worlds.error());
  if (options.json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const World& world : *worlds) all.push_back(json_of(world));
    out << json_line({{"worlds", all}}) << '\n';
    return 0;
  }
  for (const World& world : *worlds) out << line_of(world);
  if (worlds->empty()) out << "no world answers in this network; peerd doctor says what may be in the way\n";
  return 0;
}

int run_join(JoinOptions& options) {
  if (const auto accepted = accept_invitation(options); !accepted) return failed(accepted.error());
  auto given = find_world(options);
  if (!given) return failed(given.error());
  // The path only names the world, in messages and in a capture.
  options.peer.sets.push_back("world=" + json_line(given->world.name));
  options.peer.joined = *std::move(given);
  return run_peer(options.peer);
}

}  // namespace peerd
