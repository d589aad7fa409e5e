#include "peerd/daemon/open/peer_store.hpp"

#include <sys/statvfs.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <iterator>
#include <map>
#include <random>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "peerd/input/printable.hpp"
#include "peerd/net/seal/operation_signer.hpp"
#include "peerd/peer/store/store_folder.hpp"
#include "replication/edits/log/operation_log.hpp"
#include "replication/edits/log/signed_log.hpp"

namespace peerd {
namespace {

std::string store_line(const store::OperationStore& store, const std::filesystem::path& folder) {
  std::uint64_t operations = 0;
  for (const store::StoredLog& log : store.logs()) operations += log.operations;
  return fmt::format("the store {} has {} of {}; this peer is author {}", folder.string(),
                     counted(operations, "operation"), counted(store.logs().size(), "author"), store.author().value);
}

// Locks the folder of the store, and puts aside what is in it where it is to be a fresh one.
Result<store::FolderLock> lock_store(const StoreOptions& options, const std::filesystem::path& folder, bool by_default,
                                     std::vector<LogLine>& lines) {
  const auto lock_again = [&] { return by_default ? store::lock_first_free(folder) : store::lock_folder(folder); };
  auto lock = lock_again();
  if (!lock || !options.fresh) return lock;
  const auto locked = lock->folder();
  const auto aside = store::put_aside(*std::move(lock));
  if (!aside) return std::unexpected(aside.error());
  if (*aside) {
    lines.push_back(
        {LogLevel::kInfo, fmt::format("the store before is now {}; `peerd store merge {} {}` brings its edits in",
                                      (*aside)->string(), (*aside)->string(), locked.string())});
  }
  return by_default ? lock_again() : store::lock_folder(locked);
}

// The stamps of a log grow. Where the last one is of a clock that was wrong, all later ones would be as far ahead, and
// no peer would show an edit before its time: the peer begins another log.
void begin_before_stamps(const StoreOptions& options, replication::Author fresh, store::OperationStore& store,
                         std::vector<LogLine>& lines) {
  const auto own = std::ranges::find(store.logs(), store.author(), &store::StoredLog::author);
  if (!options.now || own == store.logs().end()) return;
  const Duration ahead = own->last_stamp - *options.now;
  if (ahead <= replication::kStampAheadMax) return;
  store.begin_log(fresh);
  lines.push_back({LogLevel::kWarning,
                   fmt::format("edits of this peer in its store are stamped up to {:.0f} s ahead of this computer's "
                               "clock, which was wrong then, or is: it begins another log, so that new edits take "
                               "effect at once; in a session whose time is not there yet, others see the old ones "
                               "only then",
                               to_seconds(ahead))});
}

enum class Disk { kWritable, kReadOnly, kFull };

// The state of the disk where the folder is, or would be; writable where nothing is known of it.
Disk disk_of(std::filesystem::path folder) {
  std::error_code failed;
  folder = std::filesystem::absolute(folder, failed);
  while (!std::filesystem::exists(folder, failed) && folder.has_relative_path()) folder = folder.parent_path();
  struct statvfs disk {};
  if (statvfs(folder.c_str(), &disk) != 0) return Disk::kWritable;
  if ((disk.f_flag & ST_RDONLY) != 0) return Disk::kReadOnly;
  return disk.f_bavail == 0 ? Disk::kFull : Disk::kWritable;
}

// A store that can't be written: the peer begins with what it has, if there is one, and keeps nothing of what comes. It
// writes in no log of the store, which it could contradict in its next life.
Result<OpenedStore> open_unwritable(const std::filesystem::path& folder, std::uint64_t genesis, Disk disk) {
  assert(disk != Disk::kWritable);
  const std::string_view why = disk == Disk::kFull ? "its disk is full" : "its file system is read-only";
  OpenedStore opened;
  if (!store::OperationStore::exists(folder)) {
    opened.lines.push_back(
        {LogLevel::kWarning, fmt::format("runs without a store: {} can't be made, {}", folder.string(), why)});
    return opened;
  }
  const auto store = store::OperationStore::open(folder);
  if (!store) return std::unexpected(store.error());
  if ((*store)->genesis() != genesis) {
    return std::unexpected(InputError{"error: the store " + folder.string() + " is of another world", kWrongUse});
  }
  opened.folder = folder;
  opened.log = (*store)->take_log();
  opened.lines.push_back(
      {LogLevel::kWarning,
       fmt::format("begins with the store {}, and keeps no edits from now on: {}", folder.string(), why)});
  return opened;
}

// Nobody has asked for the store of a peer that has one by default: where it can't be made, the peer runs without.
Result<OpenedStore> open_as_it_is(const StoreOptions& options, std::uint64_t genesis, const std::string& peer,
                                  const keys::Identity& identity) {
  OpenedStore opened;
  const bool by_default = !options.folder && options.by_default;
  const auto folder = by_default ? store::default_folder(genesis, peer) : options.folder;
  if (by_default && !folder) {
    opened.lines.push_back({LogLevel::kWarning, "runs without a store: this user has no home; say --store DIR"});
  }
  if (!folder || folder->empty()) return opened;
  auto lock = lock_store(options, *folder, by_default, opened.lines);
  const std::filesystem::path at = lock ? lock->folder() : *folder;
  const Disk disk = disk_of(at);
  if (disk == Disk::kReadOnly) {
    lock = std::unexpected(InputError{});  // this one ends: reading takes one of its own
    return open_unwritable(at, genesis, disk);
  }
  const replication::Author fresh = seal::fresh_author(identity.public_key());
  auto store = lock ? store::OperationStore::open(*std::move(lock), genesis, fresh) : std::unexpected(lock.error());
  if (!store && store.error().exit_code == kSystemFailed && disk == Disk::kFull) {
    return open_unwritable(at, genesis, disk);
  }
  if (!store && by_default && !store::OperationStore::exists(at)) {
    opened.lines.push_back({LogLevel::kWarning, "runs without a store: " + store.error().text});
    return opened;
  }
  if (!store) return std::unexpected(store.error());
  opened.store = *std::move(store);
  opened.folder = at;
  if (seal::author_of(identity.public_key(), opened.store->author_salt()) != opened.store->author()) {
    opened.store->begin_log(fresh);
    opened.lines.push_back(
        {LogLevel::kWarning, "the store's log is by another identity: this peer begins a log of its own"});
  }
  begin_before_stamps(options, fresh, *opened.store, opened.lines);
  if (options.fresh) {
    if (auto noted = opened.store->note_line(options.fresh_line); !noted) return std::unexpected(noted.error());
  }
  opened.line = opened.store->line();
  opened.lines.push_back({LogLevel::kInfo, store_line(*opened.store, at)});
  if (opened.store->is_copy()) {
    opened.lines.push_back(
        {LogLevel::kWarning,
         "the store is a copy, or an older one that was put back: this peer begins a log of its own"});
  }
  if (!opened.store->author_error().empty()) {
    opened.lines.push_back({LogLevel::kWarning, opened.store->author_error()});
  }
  if (!opened.store->packing_error().empty()) {
    opened.lines.push_back(
        {LogLevel::kWarning, "the store takes more room than it needs: " + opened.store->packing_error()});
  }
  opened.log = opened.store->take_log();
  return opened;
}

constexpr const char* kEditsOfBefore =
    "this world's session was begun anew (--fresh), and the edits of the store do not belong there";

}  // namespace

std::uint64_t fresh_line() {
  constexpr int kRandom_bits = 24;
  std::random_device random;
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto now_s = static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::seconds>(now).count());
  return now_s << kRandom_bits | (random() & ((1U << kRandom_bits) - 1));
}

Result<OpenedStore> open_store(const StoreOptions& options, std::uint64_t genesis, const std::string& peer,
                               const keys::Identity& identity) {
  auto opened = open_as_it_is(options, genesis, peer, identity);
  if (!opened || !options.session) return opened;
  const replication::LineOfDescent own{opened->line, !opened->log.empty(), false};
  const auto meeting = replication::meet(own, *options.session);
  if (meeting == replication::LineMeeting::kTake) {
    opened->line = options.session->line;
    if (!opened->store) return opened;
    if (auto noted = opened->store->note_line(opened->line); !noted) return std::unexpected(noted.error());
  }
  if (meeting != replication::LineMeeting::kGoOver) return opened;
  if (!opened->store) {  // it can't be written, nor put aside
    opened->log.clear();
    opened->line = options.session->line;
    opened->lines.push_back({LogLevel::kWarning, "begins without the edits of its store, which are of another line"});
    return opened;
  }
  opened->store.reset();
  StoreOptions anew = options;
  anew.fresh = true;
  anew.fresh_line = options.session->line;
  auto fresh = open_as_it_is(anew, genesis, peer, identity);
  if (fresh) fresh->lines.insert(fresh->lines.begin(), {LogLevel::kWarning, kEditsOfBefore});
  return fresh;
}

Result<void> check_signatures(const OpenedStore& opened, const replication::LogSigner& signer) {
  std::map<replication::AuthorId, replication::SignedLog> logs;
  for (const replication::OperationPart& part : opened.log) {  // each of whole operations
    const auto checked = logs[part.author].check(signer, part.author, part.bytes);
    if (checked.wrong == nullptr && checked.bytes == part.bytes.size()) continue;
    return std::unexpected(InputError{
        fmt::format("error: the store {} has operations of author {} that their author has not signed; --fresh puts "
                    "the store aside",
                    opened.folder.string(), part.author.value),
        1});
  }
  return {};
}

Result<std::vector<replication::OperationPart>> new_parts(const std::vector<replication::OperationPart>& held,
                                                          const std::vector<replication::OperationPart>& more,
                                                          const replication::LogSigner& signer,
                                                          const std::string& origin) {
  replication::OperationLogs logs(replication::kNoAuthor, &signer);
  for (const replication::OperationPart& part : held) {
    [[maybe_unused]] const auto read = logs.restore(part);
    assert(read);
  }
  std::vector<replication::OperationPart> added;
  for (const replication::OperationPart& part : more) {
    const std::uint64_t before = logs.length(part.author);
    const std::uint64_t end = std::max<std::uint64_t>(before, part.from + part.bytes.size());
    const auto read = logs.restore(part);
    if (!read || logs.whole(part.author) != end) {
      const std::string why = read ? "it is cut short or damaged" : read.error();
      return std::unexpected(
          InputError{fmt::format("error: the log of author {} {} can't be used: {}{}", part.author.value, origin, why,
                                 before > 0 ? "; the store has some of it: --fresh puts that aside" : ""),
                     1});
    }
    const auto tail = logs.bytes({part.author, before, end});
    if (!tail.empty()) added.push_back({part.author, before, {tail.begin(), tail.end()}});
  }
  return added;
}

Result<void> add_joined(const std::vector<replication::OperationPart>& provided, const replication::LogSigner& signer,
                        OpenedStore& opened) {
  auto added = new_parts(opened.log, provided, signer, "that was provided");
  if (!added) return std::unexpected(added.error());
  if (opened.store) {
    if (auto stored = opened.store->append(*added); !stored) return stored;
  }
  std::ranges::move(*added, std::back_inserter(opened.log));
  return {};
}

}  // namespace peerd
