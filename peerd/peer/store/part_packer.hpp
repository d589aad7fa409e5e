#pragma once
#include <cstddef>
#include <cstdint>
#include <map>

#include "peerd/peer/store/database.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::store {

// Compacts the file of a store: where the parts of a log that it got one by one are kPacked_bytes together, one packed
// row takes their place (zstd), with the same bytes of the log.
class PartPacker {
 public:
  static constexpr std::uint64_t kPacked_bytes = std::uint64_t{64} << 10;

  // The table of packed rows: (author, start, size, checksum, bytes), where `size` bytes of the log begin at `start`.
  static const char* table() {
    return "CREATE TABLE packed (author INTEGER NOT NULL, start INTEGER NOT NULL, size INTEGER NOT NULL, "
           "checksum INTEGER NOT NULL, bytes BLOB NOT NULL, PRIMARY KEY (author, start))";
  }

  // A part of the log has been written.
  void note(replication::AuthorId author, std::uint64_t bytes);
  [[nodiscard]] bool is_due() const { return is_due_; }
  // Packs what is due, in one transaction: all of it, or, with an error, none. Then it is due again with as much more.
  [[nodiscard]] DatabaseResult<void> pack(Database& database);
  // Gives room back that most of the file does not use any more.
  [[nodiscard]] static DatabaseResult<void> shrink(Database& database);

 private:
  struct Unpacked {
    std::uint64_t bytes = 0, due = kPacked_bytes;
  };
  // Packs one log from its first part that is not; returns how many bytes of it are left as they are.
  [[nodiscard]] static DatabaseResult<std::uint64_t> pack(Database& database, replication::AuthorId author);

  std::map<replication::AuthorId, Unpacked> unpacked_;
  bool is_due_ = false;
};

}  // namespace peerd::store
