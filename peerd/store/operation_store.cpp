#include "peerd/store/operation_store.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "peerd/input/text_file.hpp"
#include "replication/operations/operation_log.hpp"

namespace peerd::store {
namespace {

namespace fs = std::filesystem;
using replication::AuthorId;
using replication::OperationPart;

// The file says by this number whose it is ("peer", in ASCII).
constexpr std::int64_t kApplication = 0x70656572;
constexpr const char* kFile = "operations.sqlite";
constexpr const char* kAuthorFile = "author";
// A store that is being made has this name until it is whole.
constexpr const char* kUnfinished = "operations.sqlite.new";
constexpr SizeLimit kAuthorLimit{64, "this is not the author of a store", 3};

// A checksum of what a row has (FNV-1a): SQLite's own checks see no byte that has changed within a part.
std::int64_t checksum(AuthorId author, std::uint64_t from, std::span<const std::byte> bytes) {
  std::uint64_t hash = 0xCBF29CE484222325U;
  const auto add = [&](std::uint64_t byte) { hash = (hash ^ byte) * 0x100000001B3U; };
  for (int shift = 0; shift < 32; shift += 8) add(author.value >> shift & 0xFFU);
  for (int shift = 0; shift < 64; shift += 8) add(from >> shift & 0xFFU);
  for (const std::byte byte : bytes) add(std::to_integer<std::uint64_t>(byte));
  return static_cast<std::int64_t>(hash);
}

// The contents of this file or folder outlast a power cut.
bool synchronise(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool done = ::fsync(file) == 0;
  ::close(file);
  return done;
}

DatabaseResult<void> make_file(const fs::path& file, std::uint64_t genesis) {
  auto database = Database::open(file, true);
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
      std::string("COMMIT"),
      std::string("PRAGMA wal_checkpoint(TRUNCATE)")};
  for (const std::string& sql : statements) {
    if (const auto done = database->run(sql.c_str()); !done) return done;
  }
  return {};
}

// Whether the file has the header of a database of this program (SQLite's file format, 1.3). SQLite would take an empty
// file for a new one, and change another program's.
bool begins_as_store(const fs::path& file) {
  std::array<char, 100> header{};
  std::ifstream in(file, std::ios::binary);
  if (!in.read(header.data(), header.size())) return false;
  std::uint32_t application = 0;
  for (std::size_t i = 68; i < 72; ++i) application = application << 8 | static_cast<unsigned char>(header[i]);
  return std::string_view(header.data(), 16) == std::string_view("SQLite format 3\0", 16) &&
         application == kApplication;
}

InputError store_error(const fs::path& folder, const std::string& sentence, int exit_code) {
  return {"error: the store " + folder.string() + " " + sentence, exit_code};
}

// A copy whose author went on writing elsewhere would contradict that log: a copy's peer begins one of its own.
InputError damage(const fs::path& folder, const std::string& what) {
  return store_error(folder, "is damaged: " + what + "; put a copy of it in its place, without the file `author`", 1);
}

InputError store_error(const fs::path& folder, const DatabaseError& why) {
  if (why.is_busy()) {
    return store_error(folder, "is in use by another process; end that one, or give this peer a store of its own", 3);
  }
  if (why.is_corrupt()) return damage(folder, why.text);
  return store_error(folder, "cannot be used: " + why.text, 3);
}

}  // namespace

InputError OperationStore::error(const std::string& sentence, int exit_code) const {
  return store_error(folder_, sentence, exit_code);
}

InputError OperationStore::error(const DatabaseError& why) const { return store_error(folder_, why); }

// The file gets its name once it is whole, so that whatever has this name is a store, or a damaged one.
Result<std::unique_ptr<OperationStore>> OperationStore::open(const fs::path& folder, std::uint64_t genesis,
                                                             AuthorId fresh) {
  assert(fresh != replication::kNoAuthor && fresh.value <= replication::kAuthorMax);
  std::error_code failed;
  fs::create_directories(folder, failed);
  const auto cannot = [&](const std::string& why) {
    return std::unexpected(InputError{"error: the store " + folder.string() + " cannot be made: " + why, 3});
  };
  if (failed) return cannot(failed.message());
  if (!fs::exists(folder / kFile, failed)) {
    if (failed) return cannot(failed.message());
    for (const char* const left : {"-wal", "-shm", "-journal"}) {
      if (fs::exists(folder / (std::string(kFile) + left), failed)) {
        return cannot("there is " + std::string(kFile) + left + ", of a store whose file is gone");
      }
    }
    for (const char* const left : {"", "-wal", "-journal"})
      fs::remove(folder / (kUnfinished + std::string(left)), failed);
    if (const auto made = make_file(folder / kUnfinished, genesis); !made) return cannot(made.error().text);
    fs::rename(folder / kUnfinished, folder / kFile, failed);
    if (failed) return cannot(failed.message());
    if (!synchronise(folder)) return cannot(std::strerror(errno));
  }
  auto store = open_existing(folder);
  if (!store) return store;
  if ((*store)->genesis_ != genesis) {
    return std::unexpected(
        (*store)->error(fmt::format("is of another world: that of the hash {:016x}, and this one has {:016x}",
                                    (*store)->genesis_, genesis),
                        2));
  }
  if ((*store)->author_ == replication::kNoAuthor) {
    (*store)->author_ = fresh;
    if (const auto written = (*store)->write_author(); !written) return std::unexpected(written.error());
  }
  return store;
}

Result<std::unique_ptr<OperationStore>> OperationStore::open(const fs::path& folder) {
  std::error_code failed;
  if (!fs::exists(folder / kFile, failed)) {
    return std::unexpected(InputError{"error: there is no store in " + folder.string(), 2});
  }
  return open_existing(folder);
}

// If that cannot be told, there may be one.
bool OperationStore::exists(const fs::path& folder) {
  std::error_code failed;
  return fs::exists(folder / kFile, failed) || failed;
}

bool OperationStore::is_in_use(const fs::path& folder) {
  if (!begins_as_store(folder / kFile)) return false;
  const auto database = Database::open(folder / kFile, false);
  return !database && database.error().is_busy();
}

Result<std::unique_ptr<OperationStore>> OperationStore::open_existing(const fs::path& folder) {
  if (!begins_as_store(folder / kFile)) {
    return std::unexpected(damage(folder, "its file is empty, or another program's"));
  }
  auto database = Database::open(folder / kFile, false);
  if (!database) return std::unexpected(store_error(folder, database.error()));
  std::unique_ptr<OperationStore> store(new OperationStore(folder, *std::move(database)));
  if (const auto read = store->read(); !read) return std::unexpected(read.error());
  return store;
}

Result<void> OperationStore::read() {
  const auto format = database_.number("PRAGMA user_version");
  if (!format) return std::unexpected(error(format.error()));
  if (*format != kFormat) {
    return std::unexpected(error(fmt::format("has format {}, and this program reads {} alone", *format, kFormat), 2));
  }
  auto check = database_.prepare("PRAGMA integrity_check(1)");
  if (!check) return std::unexpected(error(check.error()));
  const auto row = check->step();
  if (!row) return std::unexpected(error(row.error()));
  if (const std::string found = check->text(0); found != "ok") {
    return std::unexpected(damage(folder_, found));
  }
  const auto genesis = database_.number("SELECT genesis FROM world");
  if (!genesis) return std::unexpected(error(genesis.error()));
  genesis_ = static_cast<std::uint64_t>(*genesis);
  if (const auto parts = read_parts(); !parts) return parts;
  return read_author();
}

Result<void> OperationStore::read_parts() {
  auto select = database_.prepare("SELECT author, start, checksum, bytes FROM parts ORDER BY author, start");
  if (!select) return std::unexpected(error(select.error()));
  replication::OperationLogs logs;
  for (;;) {
    const auto row = select->step();
    if (!row) return std::unexpected(error(row.error()));
    if (!*row) break;
    const std::int64_t author = select->number(0), start = select->number(1);
    const auto damaged = [&](const std::string& why) {
      return std::unexpected(damage(folder_, fmt::format("the log of author {}, at byte {}: {}", author, start, why)));
    };
    if (author < 1 || author > replication::kAuthorMax) return damaged("there is no such author");
    OperationPart part{AuthorId{static_cast<std::uint32_t>(author)}, static_cast<std::uint64_t>(start), {}};
    const auto bytes = select->bytes(3);
    if (start < 0 || bytes.empty() || part.from != logs.length(part.author)) return damaged("a part is missing");
    if (select->number(2) != checksum(part.author, part.from, bytes)) return damaged("its checksum is wrong");
    part.bytes.assign(bytes.begin(), bytes.end());
    const auto operations = logs.restore(part);
    if (!operations) return damaged(operations.error());
    if (logs.whole(part.author) != logs.length(part.author)) return damaged("an operation is cut short");
    log_.push_back(std::move(part));
  }
  for (const replication::LogLength& log : logs.lengths()) {
    logs_.push_back({log.author, log.bytes, logs.last(log.author).number, logs.last_stamp(log.author)});
  }
  return {};
}

Result<void> OperationStore::read_author() {
  std::error_code failed;
  if (!fs::exists(folder_ / kAuthorFile, failed)) return {};
  const auto text = read_text_file(folder_ / kAuthorFile, kAuthorLimit);
  if (!text) return std::unexpected(text.error());
  std::uint32_t number = 0;
  const auto [end, wrong] = std::from_chars(text->data(), text->data() + text->size(), number);
  if (wrong != std::errc() || std::string_view(end) != "\n" || number == 0 || number > replication::kAuthorMax) {
    return std::unexpected(
        error("is damaged: its file `author` is not a number; without that file, the peer begins a "
              "log of its own",
              1));
  }
  author_ = AuthorId{number};
  author_is_noted_ = true;
  return {};
}

Result<void> OperationStore::write_author() {
  const fs::path unfinished = folder_ / (std::string(kAuthorFile) + ".new");
  if (const auto written = write_text_file(unfinished, std::to_string(author_.value) + "\n"); !written) return written;
  std::error_code failed;
  if (synchronise(unfinished)) fs::rename(unfinished, folder_ / kAuthorFile, failed);
  if (failed || !synchronise(folder_)) return std::unexpected(error("cannot be written: its file `author`", 3));
  author_is_noted_ = true;
  return {};
}

DatabaseResult<void> OperationStore::insert(std::span<const OperationPart> parts) {
  auto insert = database_.prepare("INSERT INTO parts VALUES (?, ?, ?, ?)");
  if (!insert) return std::unexpected(insert.error());
  if (const auto begun = database_.run("BEGIN"); !begun) return begun;
  for (const OperationPart& part : parts) {
    insert->bind(0, std::int64_t{part.author.value});
    insert->bind(1, static_cast<std::int64_t>(part.from));
    insert->bind(2, checksum(part.author, part.from, part.bytes));
    insert->bind(3, part.bytes);
    if (const auto done = insert->step(); !done) return std::unexpected(done.error());
  }
  return database_.run("COMMIT");
}

Result<void> OperationStore::append(std::span<const OperationPart> parts) {
  if (parts.empty()) return {};
  const auto done = insert(parts);
  if (done) {
    must_stop_ = false;
    if (!author_is_noted_) (void)write_author();  // without it the next life begins a log of its own
    return {};
  }
  (void)database_.run("ROLLBACK");  // an error that ended the transaction has done so
  std::error_code failed;
  if (author_is_noted_) {  // which takes no room on a full disk
    fs::remove(folder_ / kAuthorFile, failed);
    author_is_noted_ = failed || !synchronise(folder_);
  }
  must_stop_ = author_is_noted_;
  return std::unexpected(error("cannot be written: " + done.error().text + "; is the disk full?", 3));
}

}  // namespace peerd::store
