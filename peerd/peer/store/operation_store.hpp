#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/peer/store/database.hpp"
#include "peerd/peer/store/file_folder.hpp"
#include "peerd/peer/store/folder_lock.hpp"
#include "peerd/peer/store/part_packer.hpp"
#include "replication/edits/log/operation_log.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::store {

// The part of one log that a store has.
struct StoredLog {
  replication::AuthorId author;
  std::uint64_t bytes = 0;
  std::uint32_t operations = 0;
  SimTime last_stamp{};
};

// The operations of a world, on a disk: a folder with the file operations.sqlite, and in the file `author` the author
// whose log its peer writes. One process at a time has it.
//
// The store never begins anew by itself: what is there and cannot be read whole is an error, and stays as it is, byte
// for byte. So does what is opened to be read only.
class OperationStore {
 public:
  // The format of new stores; one of the format before becomes one of this when it is opened to be written.
  static constexpr std::int64_t kFormat = 2, kFormatBefore = 1;

  // Opens the store of a world in the folder, and makes it where there is none. `genesis`: the hash of the world's
  // file; `fresh`: the author of the log that a new store begins, or one that is a copy. All that it holds is read and
  // checked.
  [[nodiscard]] static Result<std::unique_ptr<OperationStore>> open(std::unique_ptr<FileFolder> folder,
                                                                    std::uint64_t genesis, replication::Author fresh);
  [[nodiscard]] static Result<std::unique_ptr<OperationStore>> open(FolderLock folder, std::uint64_t genesis,
                                                                    replication::Author fresh);
  // Makes the folder, too, and locks it.
  [[nodiscard]] static Result<std::unique_ptr<OperationStore>> open(const std::filesystem::path& folder,
                                                                    std::uint64_t genesis, replication::Author fresh);
  // Opens the store that is there, of whichever world, to be read only.
  [[nodiscard]] static Result<std::unique_ptr<OperationStore>> open(const std::filesystem::path& folder);

  // Whether there is a store, be it damaged.
  [[nodiscard]] static bool exists(const std::filesystem::path& folder);
  [[nodiscard]] static bool exists(const FileFolder& folder);
  // Whether its file begins as one. Exit codes of the error: 1 it is damaged; 2 it is another program's; 3 it cannot be
  // read.
  [[nodiscard]] static Result<void> check_file(const FileFolder& folder);
  // Whether a store has files of this name.
  [[nodiscard]] static bool is_own_file(std::string_view name);

  [[nodiscard]] std::uint64_t genesis() const { return genesis_; }
  // The line of descent of its operations (replication::LineOfDescent); 0 until somebody has noted another one.
  [[nodiscard]] std::uint64_t line() const { return line_; }
  [[nodiscard]] Result<void> note_line(std::uint64_t line);
  // The author that writes on in this store; nobody: the next peer begins a log of its own.
  [[nodiscard]] replication::AuthorId author() const { return author_.id; }
  [[nodiscard]] std::uint64_t author_salt() const { return author_.salt; }
  // Its peer begins a log of its own, whoever's the one before was.
  void begin_log(replication::Author fresh);
  // Its files are copies, or older ones that have been put back: the author whose log they were for may have written on
  // elsewhere, so the peer begins a log of its own.
  [[nodiscard]] bool is_copy() const { return is_copy_; }
  // The operations that it held when it was opened: whole ones, by author and in order.
  [[nodiscard]] const std::vector<replication::OperationPart>& log() const { return log_; }
  // The same, for somebody who keeps it: log() is empty afterwards.
  [[nodiscard]] std::vector<replication::OperationPart> take_log() { return std::exchange(log_, {}); }
  [[nodiscard]] const std::vector<StoredLog>& logs() const { return logs_; }

  // The size of its file when it was opened, with what was written ahead.
  [[nodiscard]] std::uint64_t file_bytes() const { return file_bytes_; }

  // Adds parts, each of which begins where its log ends and is of whole operations, in one transaction: all of them are
  // on the disk when it returns, or none. Where that fails, the author of this store writes no more in its next life
  // (what it has published might be missing here) unless a later call succeeds, with these parts first.
  [[nodiscard]] Result<void> append(std::span<const replication::OperationPart> parts);
  // Whether the last append() has failed, and not even that could be noted: what this peer publishes from now on, it
  // could contradict in its next life.
  [[nodiscard]] bool must_stop() const { return must_stop_; }
  // Why the file `author` could not be written, so that the next life might begin a log of its own; empty: it is there.
  [[nodiscard]] const std::string& author_error() const { return author_error_; }
  // Why the file could not be compacted when that was due last, so that it takes more room; empty: it was.
  [[nodiscard]] const std::string& packing_error() const { return packing_error_; }

 private:
  OperationStore(std::unique_ptr<FileFolder> folder, Database database)
      : folder_(std::move(folder)), database_(std::move(database)) {}
  [[nodiscard]] static Result<std::unique_ptr<OperationStore>> open_existing(std::unique_ptr<FileFolder> folder);
  [[nodiscard]] Result<void> read();
  [[nodiscard]] Result<void> read_parts();
  [[nodiscard]] Result<void> read_rows(std::string_view sql, replication::OperationLogs& logs);
  [[nodiscard]] DatabaseResult<void> read_line();
  [[nodiscard]] DatabaseResult<void> pack_old();
  void pack();
  [[nodiscard]] Result<void> read_author();
  [[nodiscard]] Result<void> write_author();
  [[nodiscard]] std::uint64_t own_bytes() const;
  [[nodiscard]] DatabaseResult<void> insert(std::span<const replication::OperationPart> parts);
  [[nodiscard]] InputError error(const std::string& sentence, int exit_code) const;
  [[nodiscard]] InputError error(const DatabaseError& why) const;

  std::unique_ptr<FileFolder> folder_;  // outlives the database
  Database database_;
  std::uint64_t genesis_ = 0, line_ = 0, file_bytes_ = 0;
  replication::Author author_;
  std::vector<replication::OperationPart> log_;
  std::vector<StoredLog> logs_;
  bool is_copy_ = false;
  bool author_is_noted_ = false;  // the file `author` is known to be on the disk
  std::string author_error_, packing_error_;
  bool has_packed_ = false;  // the table of packed rows is there
  PartPacker packer_;
  bool must_stop_ = false;
};

}  // namespace peerd::store
