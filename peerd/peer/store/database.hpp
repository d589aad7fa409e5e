#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "peerd/peer/store/file_folder.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace peerd::store {

// Why SQLite has not done something.
struct DatabaseError {
  int code = 0;  // SQLite's primary result code
  std::string text;

  [[nodiscard]] bool is_busy() const;     // another process has the file
  [[nodiscard]] bool is_corrupt() const;  // the file is none of SQLite's, or damaged
};
template <class T>
using DatabaseResult = std::expected<T, DatabaseError>;

// A statement of SQL, compiled once. Columns and parameters count from 0. A parameter that could not be bound is an
// error of the next step.
class Statement {
 public:
  void bind(int parameter, std::int64_t value);
  // The bytes stay where they are until the statement has run.
  void bind(int parameter, std::span<const std::byte> bytes);
  // The next row, false: there is none. After an error or the last row the statement begins anew.
  [[nodiscard]] DatabaseResult<bool> step();
  // It begins anew, before its last row.
  void reset();
  [[nodiscard]] std::int64_t number(int column) const;
  [[nodiscard]] std::string text(int column) const;
  [[nodiscard]] std::span<const std::byte> bytes(int column) const;  // until the next step

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  explicit Statement(sqlite3_stmt* statement) : statement_(statement) {}

  void note_bound(int code);

  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  std::optional<DatabaseError> unbound_;
};

// A file of SQLite that this process has for itself: written ahead (WAL), and synchronised with the disk by each
// transaction.
class Database {
 public:
  // Makes the file where `may_create`; else there must be one, which stays byte for byte as it is, and so does what is
  // written ahead of it, until accept(). Another process that has it is an error, at once. Where the file system can't
  // be written, accept() fails.
  [[nodiscard]] static DatabaseResult<Database> open(const FileFolder& folder, const std::string& name,
                                                     bool may_create);

  // The file is one of ours: it may be written from now on, and when it is closed, all that is written ahead goes
  // there.
  [[nodiscard]] DatabaseResult<void> accept();

  [[nodiscard]] DatabaseResult<void> run(const char* sql);
  [[nodiscard]] DatabaseResult<Statement> prepare(std::string_view sql);
  // The only number that a query returns.
  [[nodiscard]] DatabaseResult<std::int64_t> number(std::string_view sql);

 private:
  struct Close {
    void operator()(sqlite3* database) const;
  };
  explicit Database(sqlite3* database) : database_(database) {}
  [[nodiscard]] static DatabaseResult<Database> open_unwritable(const FileFolder& folder, const std::string& name);

  std::unique_ptr<sqlite3, Close> database_;
};

}  // namespace peerd::store
