#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include "core/time.hpp"
#include "replication/edits/log/log_bytes.hpp"
#include "replication/edits/log/signed_log.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {

// The logs of all authors, as far as this peer holds them. Parts of a log come in any order, from anybody; the
// operations of each log come out whole and in their order. Nothing here trusts a part: errors are names of drop
// reasons. One thread at a time, also for reading, which keeps what it has unpacked.
class OperationLogs {
 public:
  // Bytes behind a gap, which wait for it, are kept up to these limits, of one author and of all. Each run of them
  // counts kAheadRun_bytes besides.
  static constexpr std::size_t kAheadOfOneMax_bytes = 2 * kOperationMax_bytes;
  static constexpr std::size_t kAheadMax_bytes = 8 * kOperationMax_bytes;
  static constexpr std::size_t kAheadRun_bytes = 64;
  static constexpr std::size_t kAuthorsMax = 65'536;

  // `own`: the author whose log this peer writes; nobody else adds to it. kNoAuthor: it writes none. `signer`, which
  // outlives this: it signs the own log, and no operation of another is taken that its author has not signed; null:
  // nothing is signed, and nothing checked.
  explicit OperationLogs(AuthorId own = kNoAuthor, const LogSigner* signer = nullptr) : own_(own), signer_(signer) {}

  // Appends an operation of the own author, whose number and stamp follow those of the last one. Refuses what is larger
  // than kOperationMax_bytes ("operation_too_large") and what receivers could not read, by the names of
  // decode_operation(); and everything where the store's log ends within an operation ("log_cut_short"), or where the
  // signer may not write (a sentence).
  [[nodiscard]] std::expected<void, const char*> append(const Operation& operation);

  // Takes a part from another peer. Returns the operations that have become whole by it, in the order of the log.
  // Errors: "forked_log": it differs from what is held at that place; nothing is taken, and bytes behind a gap that
  // differ from it are dropped. "own_log": it adds to the own log. "operations_ahead": there is no room to keep it
  // until the gap before it is filled. "too_many_authors". kForgedOperation, kUnsignedOperation, or why its author's
  // key may not write (LogSigner::refused): the bytes from there on are dropped. Else the log is unreadable from an
  // operation on, and says why (unreadable()).
  [[nodiscard]] std::expected<std::vector<Operation>, const char*> receive(const OperationPart& part);
  // Takes a part from this peer's own store; it may add to the own log.
  [[nodiscard]] std::expected<std::vector<Operation>, const char*> restore(const OperationPart& part);

  // How many bytes of each log are held, from the first on; ascending by author, without empty ones.
  [[nodiscard]] std::vector<LogLength> lengths() const;
  [[nodiscard]] std::uint64_t length(AuthorId author) const;
  [[nodiscard]] bool empty() const { return logs_.empty(); }
  // So many of these bytes are whole operations.
  [[nodiscard]] std::uint64_t whole(AuthorId author) const;
  // The number of the last whole operation of a log, and its stamp; 0 and SimTime{} before the first.
  [[nodiscard]] OperationId last(AuthorId author) const;
  [[nodiscard]] SimTime last_stamp(AuthorId author) const;
  // The bytes of a range as far as they are held without a gap; empty where none of its first ones are.
  [[nodiscard]] std::vector<std::byte> bytes(const OperationRange& range) const;
  // The number of these.
  [[nodiscard]] std::uint64_t held_bytes(const OperationRange& range) const;
  // A whole operation that is held.
  [[nodiscard]] Operation operation(OperationId id) const;
  // The key in the first operation of a log; empty: it has none, or is not held.
  [[nodiscard]] std::vector<std::byte> key(AuthorId author) const;
  // Returns what is missing here of the logs that are so long, as ascending ranges: the first ones, so many at most.
  // Unreadable logs and the own one miss nothing.
  [[nodiscard]] std::vector<OperationRange> missing(std::span<const LogLength> of_another,
                                                    std::size_t most = std::numeric_limits<std::size_t>::max()) const;
  // Why nobody can read on in a log: from such an operation on nothing of it is held or taken. Null: it is readable.
  [[nodiscard]] const char* unreadable(AuthorId author) const;

  // The bytes that wait behind gaps, kAheadRun_bytes of each run included.
  [[nodiscard]] std::size_t ahead_bytes() const { return ahead_bytes_; }

 private:
  using Runs = std::map<std::uint64_t, std::vector<std::byte>>;  // by their first byte; they do not overlap
  // A Mark says where the operation of that number begins.
  struct Mark {
    std::uint32_t number = 0;
    std::uint64_t from = 0;
  };
  struct Log {
    LogBytes bytes;
    std::size_t whole = 0;    // so many of them are whole operations
    std::vector<Mark> marks;  // kMark_bytes apart or more; from the first operation on
    std::uint32_t last_number = 0;
    SimTime last_stamp{};
    SignedLog signatures;
    Runs ahead;  // behind a gap
    std::size_t ahead_bytes = 0;
    const char* unreadable = nullptr;
  };

  // Finding an operation skips so many bytes at most, and one operation.
  static constexpr std::size_t kMark_bytes = 1024;

  [[nodiscard]] const Log* find(AuthorId author) const;
  static void note_whole(Log& log, const Operation& operation, std::size_t size_bytes);
  [[nodiscard]] std::expected<std::vector<Operation>, const char*> take(const OperationPart& part);
  [[nodiscard]] bool differs(Log& log, const OperationPart& part);
  [[nodiscard]] const char* keep_ahead(Log& log, const OperationPart& part);
  void join(Log& log, const OperationPart& part);
  void drop_ahead(Log& log, Runs::iterator run);
  void drop_behind_whole(Log& log);
  struct Reading {
    std::vector<Operation> operations;
    const char* wrong = nullptr;  // why bytes behind them were dropped
  };
  [[nodiscard]] Reading read_on(AuthorId author, Log& log);

  AuthorId own_;
  const LogSigner* signer_;
  std::map<AuthorId, Log> logs_;
  std::size_t ahead_bytes_ = 0;
  mutable LogBytes::Unpacked unpacked_;  // a copy of what logs_ have
};

}  // namespace peerd::replication
