#include "peerd/peer/store/part_packer.hpp"

#include <cassert>
#include <expected>
#include <string>
#include <vector>

#include "peerd/input/compression.hpp"
#include "peerd/peer/store/part_row.hpp"

namespace peerd::store {

using replication::AuthorId;

void PartPacker::note(AuthorId author, std::uint64_t bytes) {
  Unpacked& log = unpacked_[author];
  log.bytes += bytes;
  is_due_ = is_due_ || log.bytes >= log.due;
}

DatabaseResult<void> PartPacker::pack(Database& database) {
  is_due_ = false;
  std::map<AuthorId, std::uint64_t> left;
  const auto pack_all = [&]() -> DatabaseResult<void> {
    if (const auto begun = database.run("BEGIN"); !begun) return begun;
    for (const auto& [author, log] : unpacked_) {
      if (log.bytes < log.due) continue;
      const auto packed = pack(database, author);
      if (!packed) return std::unexpected(packed.error());
      left[author] = *packed;
    }
    return database.run("COMMIT");
  };
  const auto done = pack_all();
  if (!done) {
    (void)database.run("ROLLBACK");  // an error that ended the transaction has done so
    for (auto& [author, log] : unpacked_) {
      if (log.bytes >= log.due) log.due = log.bytes + kPacked_bytes;
    }
    return done;
  }
  for (const auto& [author, bytes] : left) {
    if (bytes > 0) {
      unpacked_[author] = {bytes, kPacked_bytes};
    } else {
      unpacked_.erase(author);
    }
  }
  return {};
}

DatabaseResult<std::uint64_t> PartPacker::pack(Database& database, AuthorId author) {
  auto select = database.prepare("SELECT start, bytes FROM parts WHERE author = ? ORDER BY start");
  if (!select) return std::unexpected(select.error());
  auto insert = database.prepare("INSERT INTO packed VALUES (?, ?, ?, ?, ?)");
  if (!insert) return std::unexpected(insert.error());
  auto remove = database.prepare("DELETE FROM parts WHERE author = ? AND start < ?");
  if (!remove) return std::unexpected(remove.error());
  const std::int64_t id = author.value;
  for (;;) {
    std::uint64_t from = 0;
    std::string bytes;
    select->bind(0, id);
    for (bool more = true; more && bytes.size() < kPacked_bytes;) {
      const auto row = select->step();
      if (!row) return std::unexpected(row.error());
      more = *row;
      if (!more) break;
      if (bytes.empty()) from = static_cast<std::uint64_t>(select->number(0));
      assert(from + bytes.size() == static_cast<std::uint64_t>(select->number(0)));  // the store has read them
      const auto part = select->bytes(1);
      bytes.append(reinterpret_cast<const char*>(part.data()), part.size());
    }
    select->reset();
    if (bytes.size() < kPacked_bytes) return bytes.size();
    const std::string frame = compress(bytes);
    insert->bind(0, id);
    insert->bind(1, static_cast<std::int64_t>(from));
    insert->bind(2, static_cast<std::int64_t>(bytes.size()));
    insert->bind(3, part_checksum(author, from, std::as_bytes(std::span(bytes))));
    insert->bind(4, std::as_bytes(std::span(frame)));
    if (const auto inserted = insert->step(); !inserted) return std::unexpected(inserted.error());
    remove->bind(0, id);
    remove->bind(1, static_cast<std::int64_t>(from + bytes.size()));
    if (const auto removed = remove->step(); !removed) return std::unexpected(removed.error());
  }
}

DatabaseResult<void> PartPacker::shrink(Database& database) {
  const auto unused = database.number("PRAGMA freelist_count"), pages = database.number("PRAGMA page_count");
  if (!unused) return std::unexpected(unused.error());
  if (!pages) return std::unexpected(pages.error());
  constexpr std::int64_t kUnusedMin = 64;
  if (*unused < kUnusedMin || *unused * 2 < *pages) return {};
  for (const char* const sql : {"PRAGMA temp_store = MEMORY", "VACUUM", "PRAGMA wal_checkpoint(TRUNCATE)"}) {
    if (const auto done = database.run(sql); !done) return done;
  }
  return {};
}

}  // namespace peerd::store
