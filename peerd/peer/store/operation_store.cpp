#include "peerd/peer/store/operation_store.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <string_view>
#include <system_error>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "peerd/input/compression.hpp"
#include "peerd/peer/store/author_file.hpp"
#include "peerd/peer/store/disk_folder.hpp"
#include "peerd/peer/store/part_row.hpp"
#include "peerd/peer/store/store_error.hpp"
#include "peerd/peer/store/world_files.hpp"

namespace peerd::store {
namespace {

namespace fs = std::filesystem;
using replication::AuthorId;
using replication::OperationPart;

// The file says by this number whose it is ("peer", in ASCII).
constexpr std::int64_t kApplication = 0x70656572;
constexpr const char* kFile = "operations.sqlite";
// A packed row has less: what is packed is read a part at a time, and a peer takes no world that is larger.
constexpr std::int64_t kPackedMax_bytes = std::int64_t{1} << 30;
// A store that is being made has this name until it is whole.
constexpr const char* kUnfinished = "operations.sqlite.new";

DatabaseResult<void> make_file(const FileFolder& folder, const char* name, std::uint64_t genesis) {
  auto database = Database::open(folder, name, true);
  if (!database) return std::unexpected(database.error());
  const std::string world = "INSERT INTO world VALUES (" + std::to_string(static_cast<std::int64_t>(genesis)) + ")";
  const std::string application = "PRAGMA application_id = " + std::to_string(kApplication);
  const std::string format = "PRAGMA user_version = " + std::to_string(OperationStore::kFormat);
  const std::array statements{
      std::string("BEGIN"),
      application,
      format,
      std::string("CREATE TABLE world (genesis INTEGER NOT NULL)"),
      world,
      std::string("CREATE TABLE parts (author INTEGER NOT NULL, start INTEGER NOT NULL, checksum INTEGER NOT NULL, "
                  "bytes BLOB NOT NULL, PRIMARY KEY (author, start))"),
      std::string(PartPacker::table()),
      std::string("COMMIT"),
      std::string("PRAGMA wal_checkpoint(TRUNCATE)")};
  for (const std::string& sql : statements) {
    if (const auto done = database->run(sql.c_str()); !done) return done;
  }
  return {};
}

InputError damage(const fs::path& folder, const std::string& what) {
  return store_error(folder, "is damaged: " + what + "; put a copy of it in its place", 1);
}

InputError database_error(const fs::path& folder, const DatabaseError& why) {
  if (why.is_busy()) return in_use(folder);
  if (why.is_corrupt()) return damage(folder, why.text);
  return store_error(folder, "cannot be used: " + why.text, 3);
}

InputError lock_error(const fs::path& folder, const LockError& why) {
  switch (why.why) {
    case LockError::Why::kInUse:
      return in_use(folder);
    case LockError::Why::kMissing:
      return {"error: there is no store in " + folder.string(), kWrongUse};
    case LockError::Why::kFailed:
      break;
  }
  return store_error(folder, "cannot be used: " + why.text, 3);
}

// Makes the store's file. It gets its name once it is whole, so that whatever has this name is a store, or a damaged
// one.
Result<void> make_store(FileFolder& folder, std::uint64_t genesis) {
  const auto cannot = [&](const std::string& why) {
    return std::unexpected(store_error(folder.path(), "cannot be made: " + why, 3));
  };
  for (const char* const left : {"-wal", "-shm", "-journal"}) {
    const auto size = folder.size(std::string(kFile) + left);
    if (!size) return cannot(size.error().message());
    if (*size) return cannot("there is " + std::string(kFile) + left + ", of a store whose file is gone");
  }
  for (const char* const left : {"", "-wal", "-journal"}) {
    if (const auto failed = folder.remove(kUnfinished + std::string(left))) return cannot(failed.message());
  }
  if (const auto made = make_file(folder, kUnfinished, genesis); !made) return cannot(made.error().text);
  if (const auto failed = folder.put_in_place(kUnfinished, kFile)) return cannot(failed.message());
  return {};
}

}  // namespace

InputError OperationStore::error(const std::string& sentence, int exit_code) const {
  return store_error(folder_->path(), sentence, exit_code);
}

InputError OperationStore::error(const DatabaseError& why) const { return database_error(folder_->path(), why); }

Result<std::unique_ptr<OperationStore>> OperationStore::open(std::unique_ptr<FileFolder> folder, std::uint64_t genesis,
                                                             replication::Author fresh) {
  assert(fresh.id != replication::kNoAuthor && fresh.id.value <= replication::kAuthorMax);
  const auto size = folder->size(kFile);
  if (!size) return std::unexpected(store_error(folder->path(), "cannot be used: " + size.error().message(), 3));
  if (!*size) {
    if (const auto made = make_store(*folder, genesis); !made) return std::unexpected(made.error());
  }
  auto opened = open_existing(std::move(folder));
  if (!opened) return opened;
  OperationStore& store = **opened;
  if (store.genesis_ != genesis) {
    return std::unexpected(store.error(
        fmt::format("is of another world: that of the hash {:016x}, and this one has {:016x}", store.genesis_, genesis),
        2));
  }
  if (const auto accepted = store.database_.accept(); !accepted) return std::unexpected(store.error(accepted.error()));
  if (const auto packed = store.pack_old(); !packed) store.packing_error_ = store.error(packed.error()).text;
  if (store.author() == replication::kNoAuthor) store.author_ = fresh;
  // A file that is made anew with each opening tells an older one that is put back in its place. On a full disk it is
  // the one from before, or none, so that the next life begins a log of its own: author_error() says so.
  (void)store.write_author();
  return opened;
}

Result<std::unique_ptr<OperationStore>> OperationStore::open(FolderLock folder, std::uint64_t genesis,
                                                             replication::Author fresh) {
  return open(std::make_unique<DiskFolder>(std::move(folder)), genesis, fresh);
}

Result<std::unique_ptr<OperationStore>> OperationStore::open(const fs::path& folder, std::uint64_t genesis,
                                                             replication::Author fresh) {
  auto lock = FolderLock::take(folder, FolderLock::Making::kFolders);
  if (!lock) return std::unexpected(lock_error(folder, lock.error()));
  return open(*std::move(lock), genesis, fresh);
}

Result<std::unique_ptr<OperationStore>> OperationStore::open(const fs::path& folder) {
  auto lock = FolderLock::take(folder, FolderLock::Making::kNone);
  if (!lock) return std::unexpected(lock_error(folder, lock.error()));
  if (!exists(folder)) return std::unexpected(lock_error(folder, {LockError::Why::kMissing, {}}));
  return open_existing(std::make_unique<DiskFolder>(*std::move(lock)));
}

// If that cannot be told, there may be one.
bool OperationStore::exists(const fs::path& folder) {
  std::error_code failed;
  return fs::exists(folder / kFile, failed) || failed;
}

bool OperationStore::exists(const FileFolder& folder) {
  const auto size = folder.size(kFile);
  return !size || *size;
}

// Reads the header of the file (SQLite's file format, 1.3). SQLite would take an empty file for a new one, and change
// another program's.
Result<void> OperationStore::check_file(const FileFolder& folder) {
  constexpr std::size_t kHeader_bytes = 100;
  const auto header = folder.read(kFile, kHeader_bytes);
  if (!header) {
    return std::unexpected(
        store_error(folder.path(), fmt::format("cannot be read: its file {}: {}", kFile, header.error().message()), 3));
  }
  if (header->size() < kHeader_bytes || !header->starts_with(std::string_view("SQLite format 3\0", 16))) {
    return std::unexpected(damage(folder.path(), fmt::format("its file {} is empty, or another program's", kFile)));
  }
  std::uint32_t application = 0;
  for (std::size_t i = 68; i < 72; ++i) application = application << 8 | static_cast<unsigned char>((*header)[i]);
  if (application != kApplication) {
    return std::unexpected(
        store_error(folder.path(), fmt::format("is none: its file {} is another program's", kFile), 2));
  }
  return {};
}

bool OperationStore::is_own_file(std::string_view name) {
  for (const std::string_view file : {std::string_view(kFile), std::string_view(kUnfinished)}) {
    if (!name.starts_with(file)) continue;
    const std::string_view end = name.substr(file.size());
    if (end.empty() || end == "-wal" || end == "-shm" || end == "-journal") return true;
  }
  if (name.ends_with(".new")) name.remove_suffix(4);  // one that is being made
  return name == kAuthorFile || std::ranges::find(kWorldFiles, name) != kWorldFiles.end();
}

Result<std::unique_ptr<OperationStore>> OperationStore::open_existing(std::unique_ptr<FileFolder> folder) {
  if (const auto good = check_file(*folder); !good) return std::unexpected(good.error());
  auto database = Database::open(*folder, kFile, false);
  if (!database) return std::unexpected(database_error(folder->path(), database.error()));
  std::unique_ptr<OperationStore> store(new OperationStore(std::move(folder), *std::move(database)));
  if (const auto read = store->read(); !read) return std::unexpected(read.error());
  return store;
}

Result<void> OperationStore::read() {
  const auto format = database_.number("PRAGMA user_version");
  if (!format) return std::unexpected(error(format.error()));
  if (*format != kFormat && *format != kFormatBefore) {
    return std::unexpected(
        error(fmt::format("has format {}, and this program reads {} and {}", *format, kFormatBefore, kFormat), 2));
  }
  has_packed_ = *format == kFormat;
  auto check = database_.prepare("PRAGMA integrity_check(1)");
  if (!check) return std::unexpected(error(check.error()));
  const auto row = check->step();
  if (!row) return std::unexpected(error(row.error()));
  if (std::string found = check->text(0); found != "ok") {
    std::ranges::replace(found, '\n', ' ');
    return std::unexpected(damage(folder_->path(), found));
  }
  const auto genesis = database_.number("SELECT genesis FROM world");
  if (!genesis) return std::unexpected(error(genesis.error()));
  genesis_ = static_cast<std::uint64_t>(*genesis);
  if (const auto line = read_line(); !line) return std::unexpected(error(line.error()));
  const auto pages = database_.number("PRAGMA page_count"), page_bytes = database_.number("PRAGMA page_size");
  if (!pages) return std::unexpected(error(pages.error()));
  if (!page_bytes) return std::unexpected(error(page_bytes.error()));
  file_bytes_ = static_cast<std::uint64_t>(*pages) * static_cast<std::uint64_t>(*page_bytes);
  if (const auto parts = read_parts(); !parts) return parts;
  return read_author();
}

Result<void> OperationStore::read_parts() {
  replication::OperationLogs logs;
  // Packed rows of a log come before those that are not.
  if (has_packed_) {
    const auto read = read_rows("SELECT author, start, checksum, bytes, size FROM packed ORDER BY author, start", logs);
    if (!read) return read;
  }
  const auto read = read_rows("SELECT author, start, checksum, bytes, -1 FROM parts ORDER BY author, start", logs);
  if (!read) return read;
  for (const replication::LogLength& log : logs.lengths()) {
    logs_.push_back({log.author, log.bytes, logs.last(log.author).number, logs.last_stamp(log.author)});
  }
  return {};
}

Result<void> OperationStore::read_rows(std::string_view sql, replication::OperationLogs& logs) {
  auto select = database_.prepare(sql);
  if (!select) return std::unexpected(error(select.error()));
  for (;;) {
    const auto row = select->step();
    if (!row) return std::unexpected(error(row.error()));
    if (!*row) return {};
    const std::int64_t author = select->number(0), start = select->number(1), packed_size = select->number(4);
    const auto damaged = [&](const std::string& why) {
      return std::unexpected(
          damage(folder_->path(), fmt::format("the log of author {}, at byte {}: {}", author, start, why)));
    };
    if (author < 1 || author > replication::kAuthorMax) return damaged("there is no such author");
    OperationPart part{AuthorId{static_cast<std::uint32_t>(author)}, static_cast<std::uint64_t>(start), {}};
    const auto bytes = select->bytes(3);
    if (start < 0 || bytes.empty() || part.from != logs.length(part.author)) return damaged("a part is missing");
    if (packed_size < 0) {
      part.bytes.assign(bytes.begin(), bytes.end());
      packer_.note(part.author, bytes.size());
    } else {
      const std::string_view frame(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      if (packed_size > kPackedMax_bytes) return damaged("its size is wrong");
      const auto unpacked = decompress(frame, static_cast<std::size_t>(packed_size));
      if (!unpacked) return damaged(unpacked.error());
      const auto whole = std::as_bytes(std::span(*unpacked));
      if (unpacked->size() != static_cast<std::size_t>(packed_size) || whole.empty())
        return damaged("its size is wrong");
      part.bytes.assign(whole.begin(), whole.end());
    }
    if (select->number(2) != part_checksum(part.author, part.from, part.bytes)) return damaged("its checksum is wrong");
    const auto operations = logs.restore(part);
    if (!operations) return damaged(operations.error());
    if (logs.whole(part.author) != logs.length(part.author)) return damaged("an operation is cut short");
    log_.push_back(std::move(part));
  }
}

// A store of the format before gets the table of packed rows.
DatabaseResult<void> OperationStore::pack_old() {
  if (!has_packed_) {
    const std::string format = "PRAGMA user_version = " + std::to_string(kFormat);
    for (const char* const sql : {"BEGIN", PartPacker::table(), format.c_str(), "COMMIT"}) {
      if (const auto done = database_.run(sql); !done) {
        (void)database_.run("ROLLBACK");  // an error that ended the transaction has done so
        return done;
      }
    }
    has_packed_ = true;
  }
  if (!packer_.is_due()) return {};
  if (const auto packed = packer_.pack(database_); !packed) return packed;
  return PartPacker::shrink(database_);
}

// Stores of line 0 have no such table.
DatabaseResult<void> OperationStore::read_line() {
  const auto tables = database_.number("SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name = 'descent'");
  if (!tables) return std::unexpected(tables.error());
  if (*tables == 0) return {};
  const auto line = database_.number("SELECT line FROM descent");
  if (!line) return std::unexpected(line.error());
  line_ = static_cast<std::uint64_t>(*line);
  return {};
}

Result<void> OperationStore::note_line(std::uint64_t line) {
  if (line == line_) return {};
  const std::string row = fmt::format("INSERT INTO descent VALUES ({})", static_cast<std::int64_t>(line));
  for (const char* const sql : {"BEGIN", "CREATE TABLE IF NOT EXISTS descent (line INTEGER NOT NULL)",
                                "DELETE FROM descent", row.c_str(), "COMMIT"}) {
    if (const auto done = database_.run(sql); !done) {
      (void)database_.run("ROLLBACK");  // an error that ended the transaction has done so
      return std::unexpected(error("cannot note where its edits descend from: " + done.error().text, 3));
    }
  }
  line_ = line;
  return {};
}

std::uint64_t OperationStore::own_bytes() const {
  const auto own = std::ranges::find(logs_, author(), &StoredLog::author);
  return own == logs_.end() ? 0 : own->bytes;
}

Result<void> OperationStore::read_author() {
  const auto stored = store::read_author(*folder_, kFile);
  if (!stored) return std::unexpected(stored.error());
  if (!*stored) return {};
  author_ = (*stored)->author;
  is_copy_ = !(*stored)->is_original || own_bytes() < (*stored)->log_bytes;
  if (is_copy_) author_ = {};
  return {};
}

void OperationStore::begin_log(replication::Author fresh) {
  author_ = fresh;
  (void)write_author();  // author_error() says why it is not
}

Result<void> OperationStore::write_author() {
  const auto written = store::write_author(*folder_, kFile, author_, own_bytes());
  author_is_noted_ = written.has_value();
  author_error_ = written ? "" : written.error().text;
  return written;
}

DatabaseResult<void> OperationStore::insert(std::span<const OperationPart> parts) {
  auto insert = database_.prepare("INSERT INTO parts VALUES (?, ?, ?, ?)");
  if (!insert) return std::unexpected(insert.error());
  if (const auto begun = database_.run("BEGIN"); !begun) return begun;
  for (const OperationPart& part : parts) {
    insert->bind(0, std::int64_t{part.author.value});
    insert->bind(1, static_cast<std::int64_t>(part.from));
    insert->bind(2, part_checksum(part.author, part.from, part.bytes));
    insert->bind(3, part.bytes);
    if (const auto done = insert->step(); !done) return std::unexpected(done.error());
  }
  return database_.run("COMMIT");
}

// The parts are safe already; those that cannot be packed now are packed later.
void OperationStore::pack() {
  if (!has_packed_ || !packer_.is_due()) return;
  const auto packed = packer_.pack(database_);
  packing_error_ = packed ? "" : error(packed.error()).text;
}

// After a failure the file `author` may be there even where it was not written for good, so it is removed in any case.
// That takes no room on a full disk.
Result<void> OperationStore::append(std::span<const OperationPart> parts) {
  if (parts.empty()) return {};
  const auto done = insert(parts);
  if (done) {
    must_stop_ = false;
    if (!author_is_noted_) (void)write_author();  // author_error() says why it is not
    for (const OperationPart& part : parts) packer_.note(part.author, part.bytes.size());
    pack();
    return {};
  }
  (void)database_.run("ROLLBACK");  // an error that ended the transaction has done so
  const auto removed = remove_author(*folder_);
  author_is_noted_ = false;
  must_stop_ = !removed;
  return std::unexpected(error("cannot be written: " + done.error().text + "; is the disk full?" +
                                   (removed ? "" : " This peer ends, because " + removed.error().text),
                               3));
}

}  // namespace peerd::store
