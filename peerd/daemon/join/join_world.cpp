#include "peerd/daemon/join/join_world.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "peerd/daemon/join/worlds_here.hpp"
#include "peerd/daemon/open/roster_file.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/input/toml_input.hpp"
#include "peerd/net/keys/key_file.hpp"
#include "peerd/net/snapshot/snapshot_fetch.hpp"
#include "peerd/peer/store/folder_lock.hpp"
#include "peerd/peer/store/store_folder.hpp"
#include "peerd/peer/store/stored_world.hpp"

namespace peerd {
namespace {

namespace asio = boost::asio;

constexpr Duration kAsked = std::chrono::seconds(1);
// The most peers that are asked where several sessions have the world's name. Those without its key give nothing.
constexpr std::size_t kProvidersMax = 64;

Result<snapshot::Provider> provider_at(const std::string& address) {
  const auto colon = address.rfind(':');
  const auto wrong = [&](const std::string& why) {
    return std::unexpected(InputError{"error: --from " + address + ": " + why, kWrongUse});
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

// The peers that give the world to who joins, of all addresses in turn: from one of them a forger may answer for many.
Result<std::vector<snapshot::Provider>> providers_of(const std::vector<const World*>& sessions) {
  std::map<asio::ip::address, std::vector<snapshot::Provider>> by_address;
  for (const World* const world : sessions) {
    for (const discovery::Found& peer : world->peers) {
      if (peer.beacon.snapshot_port == 0) continue;
      by_address[peer.address].push_back({peer.beacon.name, {peer.address, peer.beacon.snapshot_port}});
    }
  }
  std::vector<snapshot::Provider> providers;
  for (std::size_t turn = 0; providers.size() < kProvidersMax; ++turn) {
    const std::size_t before = providers.size();
    for (const auto& [address, all] : by_address) {
      if (turn < all.size() && providers.size() < kProvidersMax) providers.push_back(all[turn]);
    }
    if (providers.size() == before) break;
  }
  if (!providers.empty()) return providers;
  return std::unexpected(
      InputError{"error: no peer of \"" + sessions.front()->name + "\" gives it to who joins", kNoSuchWorld});
}

// In a session by unicast without relays, a joining peer first greets the peers that gave it the world.
Result<void> greet_first(const std::vector<snapshot::Provider>& providers, const std::string& settings,
                         PeerOptions& peer) {
  const auto shared = parse_toml(settings, "the settings that were given");
  if (!shared) return std::unexpected(shared.error());
  if (shared->at_path("transport.multicast").value_or(std::string()) != "never") return {};
  const toml::array* const relays = shared->at_path("transport.relays").as_array();
  if (relays != nullptr && !relays->empty()) return {};
  const auto port = shared->at_path("transport.port").value_or(std::int64_t{net::kDefaultPort});
  std::vector<std::string> addresses;
  for (const snapshot::Provider& provider : providers) {
    const auto address = provider.at.address();
    addresses.push_back(fmt::format(fmt::runtime(address.is_v6() ? "[{}]:{}" : "{}:{}"), address.to_string(), port));
  }
  peer.sets.push_back("transport.peers=" + json_line(addresses));
  return {};
}

// The key that this user's roster of the world has for this user; none: there is no roster.
Result<std::optional<keys::SessionKey>> key_by_roster(const std::string& world, const SayLine& say) {
  const auto file = chosen_roster_file({}, world);
  if (!file) return std::nullopt;
  const auto roster = read_roster(*file);
  if (!roster) return std::unexpected(roster.error());
  if (!*roster) return std::nullopt;
  const auto identity = peer_identity({}, say);
  if (!identity) return std::unexpected(identity.error());
  const auto key = (*roster)->session_key(*identity);
  if (!key) return std::unexpected(not_a_member(*file, *identity));
  return keys::SessionKey{*key, "the roster " + file->string()};
}

// The key of a session that others have begun; none: it is open. Nobody makes one for it.
Result<std::optional<keys::SessionKey>> key_of(const JoinRequest& request, const std::string& world,
                                               const SayLine& say) {
  if (request.open) return std::nullopt;
  if (world.empty() && request.key.key_file.empty()) {
    return std::unexpected(
        InputError{"error: which key? Say the world's name, or --key FILE; --open, if it is open", kWrongUse});
  }
  if (request.key.key_file.empty() && request.key.password_file.empty()) {
    auto by_roster = key_by_roster(world, say);
    if (!by_roster || *by_roster) return by_roster;
  }
  auto key = keys::session_key(request.key, world, keys::IfMissing::kFail);
  if (key) return *std::move(key);
  const bool has_password = !request.key.password_file.empty();
  return std::unexpected(InputError{
      key.error().text + (has_password ? "" : "; whoever runs that world has its key: --key FILE says a copy of it"),
      key.error().exit_code});
}

// `session`: 0 where the providers may be of several.
Result<JoinedWorld> joined_by_peers(const std::vector<snapshot::Provider>& providers, std::uint64_t session,
                                    const std::string& world, const JoinRequest& request, PeerOptions& peer,
                                    const SayLine& say) {
  const auto key = key_of(request, world, say);
  if (!key) return std::unexpected(key.error());
  peer.key = *key;
  const auto began = std::chrono::steady_clock::now();
  snapshot::FetchOptions options{.key = *key ? std::optional((*key)->key) : std::nullopt};
  if (session == 0) options.providers = std::max(options.providers, providers.size());
  auto snapshot = snapshot::fetch_snapshot(providers, session, options);
  if (!snapshot) return std::unexpected(InputError{"error: " + snapshot.error(), kNoSuchWorld});
  for (const std::string& note : snapshot->notes) say({LogLevel::kWarning, note});
  if (auto done = greet_first(providers, snapshot->offer.settings, peer); !done) return std::unexpected(done.error());
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  snapshot::Offer& offer = snapshot->offer;
  say({LogLevel::kInfo,
       fmt::format("got \"{}\" from {} in {:.2f} s over {}: {} of its files, operations of {}; {}", offer.world,
                   snapshot->provided_by, took_s, counted(snapshot->connections, "connection"),
                   counted(snapshot->archive.size(), "byte"), counted(snapshot->logs.size(), "author"),
                   snapshot->checked_with.empty() ? "nobody else is here to compare it with"
                                                  : snapshot->checked_with + " has the same")});
  return JoinedWorld{{offer.world, offer.genesis, std::move(offer.settings), std::move(snapshot->archive)},
                     offer.session,
                     std::move(snapshot->logs),
                     snapshot->provided_by,
                     offer.line};
}

// A peer of this computer that does not answer may be on another network, and works.
Result<void> not_in_use(const std::filesystem::path& store, const std::string& world, const std::string& asked) {
  const auto lock = store::FolderLock::take(store, store::FolderLock::Making::kNone);
  if (lock || lock.error().why != store::LockError::Why::kInUse) return {};
  return std::unexpected(InputError{
      "error: no peer of " + world + " answers by " + asked + ", and a peer on this computer runs with the store " +
          store.string() +
          ": peerd ctl status says over which network it reaches others, for --interface NAME; --store DIR begins "
          "another peer beside it",
      kNoSuchWorld});
}

// Nobody is here: whoever comes back brings the world back.
Result<JoinedWorld> joined_by_store(const JoinRequest& request, const std::string& asked, PeerOptions& peer,
                                    const SayLine& say) {
  const auto& folder = peer.store.folder;
  std::vector<std::filesystem::path> folders;
  if (folder && !folder->empty()) {
    folders.push_back(*folder);
  } else if (!folder) {
    folders = store::stores_of_world(request.world);
    const auto is_of_this_peer = [&](const std::filesystem::path& each) { return each.filename() == peer.peer; };
    if (std::ranges::count_if(folders, is_of_this_peer) == 1) std::erase_if(folders, std::not_fn(is_of_this_peer));
  }
  const std::string what = request.world.empty() ? "a world" : "\"" + request.world + "\"";
  std::string all;
  for (const auto& each : folders) {
    auto world = store::read_world_of_store(each);
    if (!world) return std::unexpected(world.error());
    all += "\n  " + each.string();
    const bool is_asked_for = *world && (request.world.empty() || (*world)->name == request.world);
    if (!is_asked_for || folders.size() > 1) continue;
    if (const auto free = not_in_use(each, what, asked); !free) return std::unexpected(free.error());
    peer.store.folder = each;
    say({LogLevel::kInfo,
         fmt::format("no peer of \"{}\" is here: begins with the store {}", (*world)->name, each.string())});
    return JoinedWorld{.world = **std::move(world)};
  }
  if (folders.size() > 1) {
    return std::unexpected(InputError{"error: no peer of " + what + " answers by " + asked +
                                          ", and there is more than one store: say --store DIR with one of" + all,
                                      kNoSuchWorld});
  }
  return std::unexpected(
      InputError{"error: no peer of " + what + " answers, and this user has no store of it; it was asked for by " +
                     asked + "; --interface NAME and --ipv6 ask elsewhere, and --from HOST:PORT asks one peer",
                 kNoSuchWorld});
}

// The error for a world that answers open to who has not said so, or sealed to who has. Anybody can answer: who has a
// key is not told to do without.
InputError of_the_other_kind(const World& world, const JoinRequest& request, const SayLine& say) {
  const std::string begin = "error: \"" + world.name + "\" ";
  if (world.is_sealed()) return {begin + "is sealed: leave out --open", kWrongUse};
  const auto key = key_of(request, world.name, say);
  const std::string where = world.peers.front().address.to_string();
  return {begin + (key && *key ? "answers from " + where + " alone, and not sealed: that is not the world of your key"
                               : "is open: whoever reaches this network can read and change it; --open joins it"),
          kWrongUse};
}

Result<JoinedWorld> find_world(const JoinRequest& request, PeerOptions& peer, const SayLine& say) {
  if (!request.from.empty()) {
    const auto provider = provider_at(request.from);
    if (!provider) return std::unexpected(provider.error());
    return joined_by_peers({*provider}, 0, request.world, request, peer, say);
  }
  const auto here = worlds_here(request.transport, kAsked);
  if (!here) return std::unexpected(here.error());
  const auto sessions = choose_world(here->worlds, request.world, request.open);
  if (!sessions) return std::unexpected(sessions.error());
  if (sessions->empty()) return joined_by_store(request, here->where, peer, say);
  const World& first = *sessions->front();
  if (first.is_sealed() == request.open) return std::unexpected(of_the_other_kind(first, request, say));
  const auto providers = providers_of(*sessions);
  if (!providers) return std::unexpected(providers.error());
  auto joined = joined_by_peers(*providers, sessions->size() == 1 ? first.session : 0, first.name, request, peer, say);
  if (!joined) return joined;
  for (const World* const world : *sessions) {
    if (world->session != joined->session) {
      say({LogLevel::kWarning, "not used, though it has that name: " + line_of(*world)});
    } else if (world->on_lo) {
      peer.sets.emplace_back("transport.interface=\"lo\"");  // else it would choose another one
    }
  }
  return joined;
}

}  // namespace

Result<void> accept_invitation(const keys::Invitation& invitation, JoinRequest& request, const SayLine& say) {
  if (!request.world.empty() && request.world != invitation.world) {
    return std::unexpected(InputError{"error: the invitation is to \"" + invitation.world + "\"", kWrongUse});
  }
  request.world = invitation.world;
  if (invitation.roster) {
    const auto file = chosen_roster_file({}, request.world);
    if (!file) return std::unexpected(InputError{"error: this user has no home for a roster", kWrongUse});
    return save_roster(*file, *invitation.roster);
  }
  const auto file = keys::chosen_key_file({}, request.world);
  if (!file) return std::unexpected(file.error());
  if (const auto kept = keys::keep_key(*file, *invitation.key); !kept) return kept;
  say({LogLevel::kInfo, "keeps the key of \"" + request.world + "\" in " + file->string()});
  return {};
}

Result<void> join_world(const JoinRequest& request, PeerOptions& peer, const SayLine& say) {
  auto given = find_world(request, peer, say);
  if (!given) return std::unexpected(given.error());
  // The path only names the world, in messages and in a capture.
  peer.sets.push_back("world=" + json_line(given->world.name));
  peer.joined = *std::move(given);
  return {};
}

}  // namespace peerd
