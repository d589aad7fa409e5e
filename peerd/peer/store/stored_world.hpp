#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/ids.hpp"
#include "peerd/input/input_error.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::store {

// A StoredWorld is the part of a store besides the operations: enough to begin again without the world's file, and
// without anybody else.
struct StoredWorld {
  std::string name;           // for people
  std::uint64_t genesis = 0;  // hash of the world's first files and of its name (config::LoadedWorld::hash)
  std::string settings;       // that all peers of it share (config::shared_settings)
  std::string archive;        // its first files (WorldArchive)

  friend bool operator==(const StoredWorld&, const StoredWorld&) = default;
};

// Puts the world into the folder of a store, unless it is there already. A description that cannot be read stays as it
// is, and is an error.
[[nodiscard]] Result<void> write_world(const std::filesystem::path& folder, const StoredWorld& world);
// None: the folder holds no world. The error says what is damaged.
[[nodiscard]] Result<std::optional<StoredWorld>> read_world_of_store(const std::filesystem::path& folder);

// The folders of this user's stores (default_folder) in which there is a world of that name; with an empty name, of all
// of them. Ascending.
[[nodiscard]] std::vector<std::filesystem::path> stores_of_world(const std::string& name);

// The number by which the peer of this store is known in its world, the same in each of its lives: that of the file
// `peer`, if that is of the author whose log the store continues; else, as for a copy of a store, `fresh` from now on.
[[nodiscard]] Result<PeerId> identity_in(const std::filesystem::path& folder, PeerId fresh,
                                         replication::AuthorId author);

}  // namespace peerd::store
