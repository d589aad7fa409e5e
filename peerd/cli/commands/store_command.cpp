#include "peerd/cli/commands/store_command.hpp"

#include <cassert>
#include <ostream>
#include <utility>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "core/writer/writer.hpp"
#include "peerd/cli/shell/print.hpp"
#include "peerd/cli/shell/problems.hpp"
#include "peerd/daemon/open/peer_store.hpp"
#include "peerd/daemon/open/roster_file.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/net/seal/operation_signer.hpp"
#include "peerd/peer/store/operation_store.hpp"
#include "peerd/peer/store/stored_world.hpp"
#include "replication/edits/log/operation_log.hpp"
#include "replication/edits/scene/living_scene.hpp"

namespace peerd {
namespace {

using store::OperationStore;
using store::StoredLog;

double stamp_s(const StoredLog& log) { return to_seconds(log.last_stamp.time_since_epoch()); }

nlohmann::ordered_json store_json(const StoreCheckOptions& options, const OperationStore& store) {
  nlohmann::ordered_json logs = nlohmann::ordered_json::array();
  std::uint64_t bytes = 0, operations = 0;
  for (const StoredLog& log : store.logs()) {
    logs.push_back({{"author", log.author.value},
                    {"bytes", log.bytes},
                    {"operations", log.operations},
                    {"last_stamp_s", stamp_s(log)}});
    bytes += log.bytes;
    operations += log.operations;
  }
  const bool has_author = store.author() != replication::kNoAuthor;
  return {{"store", options.folder.string()},
          {"genesis", fmt::format("{:016x}", store.genesis())},
          {"author", has_author ? nlohmann::ordered_json(store.author().value) : nlohmann::ordered_json(nullptr)},
          {"bytes", bytes},
          {"operations", operations},
          {"file_bytes", store.file_bytes()},
          {"logs", std::move(logs)}};
}

// The roster that this user has of the world; none: it has none.
Result<std::optional<keys::Roster>> roster_of(const std::string& world) {
  const auto file = chosen_roster_file({}, world);
  return file ? read_roster(*file) : Result<std::optional<keys::Roster>>(std::nullopt);
}

// The scene that the operations of the store make.
std::shared_ptr<const Scene> living_scene(const OperationStore& store, const Scene& file,
                                          const std::optional<keys::Roster>& roster) {
  replication::OperationLogs logs;
  replication::LivingScene living(file, {}, {}, [&](replication::AuthorId author) {
    const auto key = seal::public_key_in(logs.key(author));
    if (!key) return replication::writer_without_key(author);
    return roster ? seal::writer_by(*roster, *key) : seal::writer_without_roster(*key);
  });
  for (const replication::OperationPart& part : store.log()) {
    auto operations = logs.restore(part);
    assert(operations);  // the store has read them
    for (replication::Operation& operation : *operations) living.add(std::move(operation));
  }
  (void)living.apply(SimTime::max(), SimTime::max());
  return living.scene();
}

// The world that the store's operations begin with: the file that was named, or what the store keeps of it.
Result<config::LoadedWorld> first_world(const StoreExportOptions& options, std::uint64_t genesis) {
  if (!options.world.empty()) {
    auto world = config::load_world(options.world, options.reading);
    if (!world || world->hash == genesis) return world;
    return std::unexpected(InputError{
        fmt::format("error: the store {} is of another world: that of the hash {:016x}, and {} has {:016x}; without "
                    "--world, it begins with the world that the store keeps",
                    options.folder.string(), genesis, options.world.string(), world->hash),
        2});
  }
  const auto kept = store::read_world_of_store(options.folder);
  if (!kept) return std::unexpected(kept.error());
  if (!*kept || (*kept)->genesis != genesis) {
    return std::unexpected(InputError{
        "error: the store " + options.folder.string() + " keeps no world: say --world FILE, with which it began", 2});
  }
  return config::load_world((*kept)->archive, options.folder, options.reading);
}

}  // namespace

int run_store_check(const StoreCheckOptions& options, std::ostream& out) {
  const auto store = OperationStore::open(options.folder);
  if (!store) return failed(store.error());
  const nlohmann::ordered_json all = store_json(options, **store);
  if (options.json) {
    out << json_text(all) << '\n';
    return 0;
  }
  out << fmt::format("{}: {} of {}, {} in a file of {}; of the world with the hash {}\n", options.folder.string(),
                     counted(all.at("operations").get<std::uint64_t>(), "operation"),
                     counted((*store)->logs().size(), "author"), counted(all.at("bytes").get<std::uint64_t>(), "byte"),
                     counted((*store)->file_bytes(), "byte"), all.at("genesis").get<std::string>());
  for (const StoredLog& log : (*store)->logs()) {
    const bool own = log.author == (*store)->author();
    out << fmt::format("author {}{}: {}, {}, the last of session time {:.3f} s\n", log.author.value,
                       own ? ", this store's own" : "", counted(std::uint64_t{log.operations}, "operation"),
                       counted(log.bytes, "byte"), stamp_s(log));
  }
  return 0;
}

int run_store_export(const StoreExportOptions& options, std::ostream& out) {
  const auto store = OperationStore::open(options.folder);
  if (!store) return failed(store.error());
  const auto world = first_world(options, (*store)->genesis());
  if (!world) return failed(world.error());
  const auto kept = store::read_world_of_store(options.folder);
  if (!kept) return failed(kept.error());
  const auto roster = roster_of(*kept ? (*kept)->name : options.world.stem().string());
  if (!roster) return failed(roster.error());
  const auto written = write_world(*living_scene(**store, world->scene, *roster));
  if (!written) return failed({"error: " + written.error(), kFinding});
  if (options.file.empty()) {
    out << written->text;
    return 0;
  }
  const auto saved = write_text_file(options.file, written->text);
  return saved ? 0 : failed(saved.error());
}

int run_store_merge(const StoreMergeOptions& options, std::ostream& out) {
  const auto from = OperationStore::open(options.from);
  if (!from) return failed(from.error());
  if (!OperationStore::exists(options.into)) {
    return failed({"error: there is no store in " + options.into.string(), kWrongUse});
  }
  // A store that is a copy begins a log, which the next peer does not go on with: it is not of its identity.
  const keys::Identity nobody = keys::Identity::random();
  const replication::Author fresh = seal::fresh_author(nobody.public_key());
  const auto into = OperationStore::open(options.into, (*from)->genesis(), fresh);
  if (!into) return failed(into.error());
  const seal::OperationSigner signer((*from)->genesis(), nobody, fresh.salt,
                                     [](const keys::PublicKey&) { return true; });
  const auto added = new_parts((*into)->log(), (*from)->log(), signer, "in " + options.from.string());
  if (!added) return failed(added.error());
  if (const auto stored = (*into)->append(*added); !stored) return failed(stored.error());
  std::uint64_t bytes = 0;
  for (const replication::OperationPart& part : *added) bytes += part.bytes.size();
  out << fmt::format("{}: {} of {} more, of {}; its session has them once a peer runs with it\n", options.into.string(),
                     counted(bytes, "byte"), counted(added->size(), "part"), options.from.string());
  return 0;
}

}  // namespace peerd
