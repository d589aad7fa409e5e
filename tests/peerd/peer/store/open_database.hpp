#pragma once
#include <filesystem>

#include "peerd/peer/store/database.hpp"
#include "peerd/peer/store/disk_folder.hpp"

namespace peerd::testing_support {

// Opens a database in a folder that no store uses now.
inline store::DatabaseResult<store::Database> open_database(const std::filesystem::path& file, bool may_create) {
  const store::DiskFolder folder(store::FolderLock::take(file.parent_path(), store::FolderLock::Making::kNone).value());
  return store::Database::open(folder, file.filename().string(), may_create);
}

}  // namespace peerd::testing_support
