#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "peerd/input/input_error.hpp"
#include "peerd/net/keys/identity.hpp"
#include "peerd/peer/node/describe.hpp"
#include "peerd/peer/store/operation_store.hpp"
#include "peerd/peer/store/stored_world.hpp"
#include "replication/edits/log/log_signer.hpp"
#include "replication/session/line_of_descent.hpp"

namespace peerd {

// The place where a peer keeps the edits of the world.
struct StoreOptions {
  std::optional<std::filesystem::path> folder;  // of --store; empty: no store
  bool by_default = false;                      // without `folder`, a peer has one in its user's own folders
  bool fresh = false;                           // what is there is put aside
  std::uint64_t fresh_line = 0;                 // of descent, of the one that is begun then
  std::optional<SimTime> now{};                 // by this host's clock: later stamps are of a clock that was wrong
  // The line of the peers that the world is from; none: no peers have given it. A store of another line is put aside,
  // or takes theirs (replication::meet).
  std::optional<replication::LineOfDescent> session{};

  [[nodiscard]] bool is_wanted() const { return folder ? !folder->empty() : by_default; }
};

// A world that came from a peer, or from a store, in place of a file.
struct JoinedWorld {
  store::StoredWorld world;
  std::uint64_t session = 0;                       // that its peers are in; 0: nobody has said
  std::vector<replication::OperationPart> logs{};  // each from its beginning
  std::string provided_by{};                       // the peer that gave it; empty: a store has
  std::uint64_t line = 0;                          // of descent, of the logs (replication::LineOfDescent)
};

struct OpenedStore {
  std::unique_ptr<store::OperationStore> store;  // null: there is none
  std::filesystem::path folder;
  std::vector<replication::OperationPart> log;  // all that the peer begins with
  std::uint64_t line = 0;                       // of descent, of that
  std::vector<LogLine> lines;                   // what a person should know
};

// A line of descent that nobody has had before, and that comes after all earlier ones where clocks are right.
[[nodiscard]] std::uint64_t fresh_line();

// Opens the store of a world's peer, or none where none is wanted. `genesis`: the hash of the world's file;
// `identity`: whose operations it will have.
[[nodiscard]] Result<OpenedStore> open_store(const StoreOptions& options, std::uint64_t genesis,
                                             const std::string& peer, const keys::Identity& identity);

// Whether authors have signed all that the store has of theirs. Else somebody has put it there.
[[nodiscard]] Result<void> check_signatures(const OpenedStore& opened, const replication::LogSigner& signer);

// The ends of these logs that are not among those held, each from the first byte that is missing. All are read first: a
// log that is damaged, that its author has not signed, or that contradicts what is held, is an error, which calls them
// by `origin`.
[[nodiscard]] Result<std::vector<replication::OperationPart>> new_parts(
    const std::vector<replication::OperationPart>& held, const std::vector<replication::OperationPart>& more,
    const replication::LogSigner& signer, const std::string& origin);

// Adds the logs that other peers have provided to those of the store, whose signatures are right, and to the store, as
// new_parts() says.
[[nodiscard]] Result<void> add_joined(const std::vector<replication::OperationPart>& provided,
                                      const replication::LogSigner& signer, OpenedStore& opened);

}  // namespace peerd
