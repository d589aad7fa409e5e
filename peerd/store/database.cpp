#include "peerd/store/database.hpp"

#include <cassert>

#include <sqlite3.h>

namespace peerd::store {
namespace {

DatabaseError sqlite_error(sqlite3* database) {
  assert(database != nullptr);
  return {sqlite3_errcode(database) & 0xFF, sqlite3_errmsg(database)};
}

}  // namespace

bool DatabaseError::is_busy() const { return code == SQLITE_BUSY || code == SQLITE_LOCKED; }
bool DatabaseError::is_corrupt() const { return code == SQLITE_CORRUPT || code == SQLITE_NOTADB; }

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

void Statement::bind(int parameter, std::int64_t value) {
  [[maybe_unused]] const int code = sqlite3_bind_int64(statement_.get(), parameter + 1, value);
  assert(code == SQLITE_OK);
}

void Statement::bind(int parameter, std::span<const std::byte> bytes) {
  [[maybe_unused]] const int code =
      sqlite3_bind_blob64(statement_.get(), parameter + 1, bytes.data(), bytes.size(), SQLITE_STATIC);
  assert(code == SQLITE_OK);
}

DatabaseResult<bool> Statement::step() {
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

// In the exclusive mode there is no shared memory beside the file, and its lock goes with the process however it ends.
DatabaseResult<Database> Database::open(const std::filesystem::path& file, bool may_create) {
  sqlite3* opened = nullptr;
  const int flags = SQLITE_OPEN_READWRITE | (may_create ? SQLITE_OPEN_CREATE : 0);
  const int code = sqlite3_open_v2(file.c_str(), &opened, flags, nullptr);
  if (opened == nullptr) return std::unexpected(DatabaseError{SQLITE_NOMEM, "there is no memory for it"});
  Database database(opened);
  if (code != SQLITE_OK) return std::unexpected(sqlite_error(opened));
  for (const char* const sql : {"PRAGMA locking_mode = EXCLUSIVE", "PRAGMA journal_mode = WAL",
                                "PRAGMA synchronous = FULL", "BEGIN EXCLUSIVE", "COMMIT"}) {
    if (const auto done = database.run(sql); !done) return std::unexpected(done.error());
  }
  return database;
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
