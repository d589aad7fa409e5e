#include "peerd/daemon/open/peer_parts.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "core/fnv1a.hpp"
#include "peerd/input/path_text.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/input/world_file.hpp"
#include "peerd/net/discovery/beacon.hpp"
#include "peerd/net/seal/operation_signer.hpp"
#include "peerd/peer/config/shared_settings.hpp"
#include "peerd/peer/config/without_effect.hpp"

namespace peerd {
namespace {

Result<const config::PeerSettings*> choose_peer(const config::RunSettings& run, const std::string& name) {
  std::string all;
  std::vector<std::string> names;
  for (const config::PeerSettings& p : run.peers) {
    if (p.name == name || (name.empty() && run.peers.size() == 1)) return &p;
    all += (all.empty() ? "" : ", ") + p.name;
    names.push_back(p.name);
  }
  if (name.empty()) return std::unexpected(InputError{"error: which peer? Say --peer NAME; there are " + all});
  return std::unexpected(InputError{"error: there is no peer \"" + name + "\"; there are " + all});
}

// Reads the world of the configuration, or the one that was provided, and keeps its archive for joining peers and for
// the store. The archive lacks the content of Inlines that are read later.
Result<config::LoadedWorld> read_world_of(const PeerOptions& options, config::Scenario& scenario) {
  scenario.reading.keeps_archive = !scenario.reading.inlines_when_needed &&
                                   (options.store.is_wanted() || scenario.runs.front().transport.discoverable);
  if (!options.joined) return config::load_world(scenario.world, scenario.reading);
  const store::StoredWorld& provided = options.joined->world;
  const auto wrong = [&](const std::string& what) {
    return std::unexpected(InputError{"error: what was provided of \"" + provided.name + "\" " + what, kFinding});
  };
  if (!is_archive(provided.archive)) return wrong("is no archive");  // it would name files of this computer
  auto world = config::load_world(provided.archive, scenario.world, scenario.reading);
  if (world && world->hash != provided.genesis) return wrong("makes another world here");
  return world;
}

// A file's name may have bytes that a world's may not have, and more of them. Two files have two names all the same.
std::string world_name_of(const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  std::string shown = stem;
  if (!is_utf8(stem)) {
    std::ranges::replace_if(
        shown, [](char c) { return static_cast<unsigned char>(c) >= 0x80; }, '?');
  }
  std::string name = printable(shown, discovery::kNameMax_bytes);
  if (name == stem) return name;
  constexpr std::uint64_t kBasis = 0xcbf29ce484222325;  // of FNV-1a
  std::uint64_t hash = kBasis;
  for (const char c : stem) hash = fnv1a(hash, static_cast<unsigned char>(c));
  const std::string ending = fmt::format("~{:08x}", static_cast<std::uint32_t>(hash));
  return printable(shown, discovery::kNameMax_bytes - ending.size()) + ending;
}

}  // namespace

std::string PeerParts::world_name(const PeerOptions& options) const {
  if (options.joined) return options.joined->world.name;
  return scenario.reading.name.empty() ? world_name_of(scenario.world) : scenario.reading.name;
}

Result<config::Scenario> read_configuration(const PeerOptions& options) {
  config::ScenarioRequest request;
  request.file = options.config;
  request.configs = options.overlays;
  request.sets = options.sets;
  request.real = true;
  request.sweep = false;
  if (options.joined) {
    if (auto good = config::check_shared(options.joined->world.settings); !good) return std::unexpected(good.error());
    request.text = options.joined->world.settings;
  }
  return config::read_scenario(request);
}

Result<void> fill_store(const PeerOptions& options, const keys::Identity& identity, const SessionSeal& session_seal,
                        PeerParts& parts) {
  config::PeerSettings& settings = *parts.settings;
  const config::LoadedWorld& world = parts.shared->world;
  auto opened = open_store(options.store, world.hash, settings.name, identity);
  if (!opened) return std::unexpected(opened.error());
  parts.opened = *std::move(opened);
  const auto& store = parts.opened.store;
  parts.author =
      store ? replication::Author{store->author(), store->author_salt()} : seal::fresh_author(identity.public_key());
  parts.signer = std::make_unique<seal::OperationSigner>(
      world.hash, identity, parts.author.salt,
      [&session_seal](const keys::PublicKey& key) { return session_seal.may_write(key); },
      [&session_seal](const keys::PublicKey& key) { return session_seal.writer(key); });
  if (store && options.keeps_id) {
    const auto id = store::identity_in(parts.opened.folder, PeerId{settings.id}, store->author());
    if (!id) return std::unexpected(id.error());
    settings.id = id->value;
  }
  if (auto good = check_signatures(parts.opened, *parts.signer); !good) return good;
  if (options.joined && !options.joined->logs.empty()) {
    if (auto added = add_joined(options.joined->logs, *parts.signer, parts.opened); !added) return added;
  }
  if (!store || world.archive.empty()) return {};
  const store::StoredWorld stored{parts.world_name(options), world.hash, config::shared_settings(parts.run()),
                                  world.archive};
  // The operations are what counts: without its world, the store needs the world's file.
  if (const auto written = store::write_world(parts.opened.folder, stored); !written) {
    parts.opened.lines.push_back({LogLevel::kWarning, written.error().text});
  }
  return {};
}

Result<PeerParts> make_parts(const PeerOptions& options, const WarnPerson& warn) {
  PeerParts parts;
  auto scenario = read_configuration(options);
  if (!scenario) return std::unexpected(scenario.error());
  parts.scenario = *std::move(scenario);
  std::ranges::for_each(parts.scenario.warnings, warn);
  config::RunSettings& run = parts.scenario.runs.front();
  const auto chosen = choose_peer(run, options.peer);
  if (!chosen) return std::unexpected(chosen.error());
  const auto number = static_cast<std::size_t>(*chosen - run.peers.data());
  parts.settings = &run.peers[number];
  auto world = read_world_of(options, parts.scenario);
  if (!world) return std::unexpected(world.error());
  parts.shared = share_world(*std::move(world), parts.scenario.runs);
  parts.session = run.replication.session_hash(parts.shared->world.hash);
  if (options.joined && options.joined->session != 0 && options.joined->session != parts.session) {
    return std::unexpected(InputError{"error: the settings of \"" + options.joined->world.name +
                                          "\" make another session here; is that peer of another version?",
                                      1});
  }
  const Scene& scene = parts.shared->world.scene;
  std::ranges::for_each(config::settings_without_effect(run, scene), warn);
  auto objects = config::resolve(run, scene);
  if (!objects) return std::unexpected(objects.error());
  parts.objects = std::move((*objects)[number]);
  return parts;
}

}  // namespace peerd
