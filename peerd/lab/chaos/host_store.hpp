#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "peerd/lab/chaos/simulated_disk.hpp"
#include "peerd/lab/chaos/simulated_folder.hpp"
#include "peerd/peer/store/operation_store.hpp"
#include "peerd/peer/store/store_keeper.hpp"
#include "replication/edits/log/operation_log.hpp"

namespace peerd::chaos {

// The store of one host on its simulated disk, which outlasts the host's lives.
class HostStore {
 public:
  HostStore(Random random, std::filesystem::path path) : disk_(random), files_(disk_), path_(std::move(path)) {}

  [[nodiscard]] SimulatedDisk& disk() { return disk_; }

  struct Opened {
    replication::AuthorId author;
    std::vector<replication::OperationPart> log;
    std::optional<replication::AuthorId> lost;  // of this author the store had more
  };
  // A life begins. `fresh`: the author of a log that begins.
  [[nodiscard]] Result<Opened> open(std::uint64_t genesis, replication::AuthorId fresh);
  // Whether there is a store, be it damaged.
  [[nodiscard]] bool exists() const;
  // The peer has begun, and has what the store had.
  void keep(const replication::OperationLogs& logs);
  // Null: this life has no store.
  [[nodiscard]] const store::StoreKeeper* keeper() const { return keeper_ ? &*keeper_ : nullptr; }
  void add(const store::UnstoredGrowth::Growth& growth, HostTime now);
  [[nodiscard]] store::StoreKeeper::Written write(HostTime now);
  // The life ends well, and what it has written stays.
  void close();
  // It ends without a word; where the power was cut, nothing remains but what was synchronised.
  void crash(bool power_was_cut);

 private:
  SimulatedDisk disk_;
  SimulatedFileSystem files_;
  std::filesystem::path path_;
  std::unique_ptr<store::OperationStore> store_;
  std::optional<store::StoreKeeper> keeper_;
  std::map<replication::AuthorId, std::uint64_t> added_,
      promised_;  // bytes that the store is to have, and says to have
};

}  // namespace peerd::chaos
