#pragma once
#include <utility>

#include "peerd/peer/store/file_folder.hpp"
#include "peerd/peer/store/folder_lock.hpp"

namespace peerd::store {

// A locked folder of the file system.
class DiskFolder final : public FileFolder {
 public:
  explicit DiskFolder(FolderLock lock) : lock_(std::move(lock)) {}

  [[nodiscard]] const std::filesystem::path& path() const override { return lock_.folder(); }
  [[nodiscard]] const char* file_system() const override { return nullptr; }
  [[nodiscard]] std::expected<std::optional<std::uint64_t>, std::error_code> size(std::string_view name) const override;
  [[nodiscard]] std::expected<std::string, std::error_code> read(std::string_view name,
                                                                 std::size_t most) const override;
  // The inode and the time of birth, which a user can set of no file. Where a file system knows no birth, the inode
  // alone.
  [[nodiscard]] std::expected<std::string, std::error_code> identity(std::string_view name) const override;
  [[nodiscard]] std::error_code write(std::string_view name, std::string_view bytes) override;
  [[nodiscard]] std::error_code put_in_place(std::string_view unfinished, std::string_view name) override;
  [[nodiscard]] std::error_code remove(std::string_view name) override;
  [[nodiscard]] std::error_code synchronise() override;

 private:
  FolderLock lock_;
};

}  // namespace peerd::store
