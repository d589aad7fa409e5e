#include "peerd/peer/store/database.hpp"

#include <unistd.h>

#include <cassert>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>

#include <spdlog/fmt/fmt.h>
#include <sqlite3.h>

namespace peerd::store {
namespace {

// SQLite's own words for an error of the operating system say neither which nor why.
DatabaseError sqlite_error(sqlite3* database) {
  assert(database != nullptr);
  const int code = sqlite3_errcode(database) & 0xFF;
  std::string text = sqlite3_errmsg(database);
  const int why = sqlite3_system_errno(database);
  if ((code == SQLITE_IOERR || code == SQLITE_CANTOPEN) && why != 0) text += fmt::format(" ({})", std::strerror(why));
  return {code, text};
}

DatabaseResult<void> set_checkpoint_on_close(sqlite3* database, bool does) {
  if (sqlite3_db_config(database, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, does ? 0 : 1, nullptr) == SQLITE_OK) return {};
  return std::unexpected(sqlite_error(database));
}

}  // namespace

bool DatabaseError::is_busy() const { return code == SQLITE_BUSY || code == SQLITE_LOCKED; }
bool DatabaseError::is_corrupt() const { return code == SQLITE_CORRUPT || code == SQLITE_NOTADB; }

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

void Statement::bind(int parameter, std::int64_t value) {
  note_bound(sqlite3_bind_int64(statement_.get(), parameter + 1, value));
}

void Statement::bind(int parameter, std::span<const std::byte> bytes) {
  note_bound(sqlite3_bind_blob64(statement_.get(), parameter + 1, bytes.data(), bytes.size(), SQLITE_STATIC));
}

// A value that is too large for SQLite, or for the memory.
void Statement::note_bound(int code) {
  assert(code != SQLITE_RANGE && code != SQLITE_MISUSE);
  if (code != SQLITE_OK) unbound_ = sqlite_error(sqlite3_db_handle(statement_.get()));
}

DatabaseResult<bool> Statement::step() {
  if (const auto unbound = std::exchange(unbound_, std::nullopt)) return std::unexpected(*unbound);
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) {
    sqlite3_reset(statement_.get());
    return false;
  }
  const DatabaseError error = sqlite_error(sqlite3_db_handle(statement_.get()));
  sqlite3_reset(statement_.get());
  return std::unexpected(error);
}

void Statement::reset() { sqlite3_reset(statement_.get()); }

std::int64_t Statement::number(int column) const { return sqlite3_column_int64(statement_.get(), column); }

std::string Statement::text(int column) const {
  const auto* const text = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  return text == nullptr ? std::string() : std::string(text);
}

std::span<const std::byte> Statement::bytes(int column) const {
  const void* const data = sqlite3_column_blob(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  return {static_cast<const std::byte*>(data), static_cast<std::size_t>(size)};
}

void Database::Close::operator()(sqlite3* database) const { sqlite3_close(database); }

namespace {

// Whether the file is one of the disk that this process may only read.
bool may_only_be_read(const FileFolder& folder, const std::string& name) {
  if (folder.file_system() != nullptr) return false;
  return ::access((folder.path() / name).c_str(), W_OK) != 0 && (errno == EROFS || errno == EACCES);
}

// A path as a URI, in which some bytes have other meanings.
std::string uri_of(const std::filesystem::path& path) {
  std::string uri = "file:";
  for (const char c : path.string()) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view("/-_.~").contains(c);
    uri += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

}  // namespace

// SQLite would make files beside one whose journal is written ahead, unless it knows that nobody changes it. What has
// been written ahead it does not read then.
DatabaseResult<Database> Database::open_unwritable(const FileFolder& folder, const std::string& name) {
  const auto ahead = folder.size(name + "-wal");
  if (!ahead || ahead->value_or(0) > 0) {
    return std::unexpected(
        DatabaseError{SQLITE_READONLY,
                      "its newest edits, in " + name + "-wal, are read only where it can be written: copy the folder"});
  }
  sqlite3* opened = nullptr;
  const std::string uri = uri_of(std::filesystem::absolute(folder.path()) / name) + "?immutable=1";
  const int code = sqlite3_open_v2(uri.c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  if (opened == nullptr) return std::unexpected(DatabaseError{SQLITE_NOMEM, "there is no memory for it"});
  Database database(opened);
  if (code != SQLITE_OK) return std::unexpected(sqlite_error(opened));
  return database;
}

// In the exclusive mode there is no shared memory beside the file, and its lock goes with the process however it ends.
DatabaseResult<Database> Database::open(const FileFolder& folder, const std::string& name, bool may_create) {
  if (!may_create && may_only_be_read(folder, name)) return open_unwritable(folder, name);
  sqlite3* opened = nullptr;
  const int flags = SQLITE_OPEN_READWRITE | (may_create ? SQLITE_OPEN_CREATE : 0);
  const int code = sqlite3_open_v2((folder.path() / name).c_str(), &opened, flags, folder.file_system());
  if (opened == nullptr) return std::unexpected(DatabaseError{SQLITE_NOMEM, "there is no memory for it"});
  Database database(opened);
  if (code != SQLITE_OK) return std::unexpected(sqlite_error(opened));
  // Closing changes nothing where nothing is written ahead, and removes the empty file that opening has made.
  const auto ahead = folder.size(name + "-wal");
  if (ahead && ahead->value_or(0) > 0 && !may_create) {
    if (const auto set = set_checkpoint_on_close(opened, false); !set) return std::unexpected(set.error());
  }
  for (const char* const sql : {"PRAGMA locking_mode = EXCLUSIVE", "BEGIN EXCLUSIVE", "COMMIT"}) {
    if (const auto done = database.run(sql); !done) return std::unexpected(done.error());
  }
  if (may_create) {
    if (const auto accepted = database.accept(); !accepted) return std::unexpected(accepted.error());
  }
  return database;
}

DatabaseResult<void> Database::accept() {
  for (const char* const sql : {"PRAGMA journal_mode = WAL", "PRAGMA synchronous = FULL"}) {
    if (const auto done = run(sql); !done) return done;
  }
  return set_checkpoint_on_close(database_.get(), true);
}

DatabaseResult<void> Database::run(const char* sql) {
  if (sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr) == SQLITE_OK) return {};
  return std::unexpected(sqlite_error(database_.get()));
}

DatabaseResult<Statement> Database::prepare(std::string_view sql) {
  sqlite3_stmt* prepared = nullptr;
  const int code = sqlite3_prepare_v2(database_.get(), sql.data(), static_cast<int>(sql.size()), &prepared, nullptr);
  if (code != SQLITE_OK) return std::unexpected(sqlite_error(database_.get()));
  return Statement(prepared);
}

DatabaseResult<std::int64_t> Database::number(std::string_view sql) {
  auto statement = prepare(sql);
  if (!statement) return std::unexpected(statement.error());
  const auto row = statement->step();
  if (!row) return std::unexpected(row.error());
  if (!*row) return std::unexpected(DatabaseError{SQLITE_CORRUPT, "it lacks what each store has"});
  return statement->number(0);
}

}  // namespace peerd::store
