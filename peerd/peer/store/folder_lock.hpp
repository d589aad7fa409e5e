#pragma once
#include <expected>
#include <filesystem>
#include <string>
#include <utility>

namespace peerd::store {

// Why a folder is not locked.
struct LockError {
  enum class Why : unsigned char { kInUse, kMissing, kFailed };
  Why why = Why::kFailed;
  std::string text;  // of kFailed
};

// A folder that no other process of this program may use as a store while this object lives (flock(2)). The system ends
// the lock with the process, however that ends; nothing of it is left in the folder. A folder keeps its lock when it
// gets another name.
class FolderLock {
 public:
  enum class Making : unsigned char { kNone, kFolders };

  // kFolders: makes the folder, and those that lead there, where they are missing. It does not wait.
  [[nodiscard]] static std::expected<FolderLock, LockError> take(const std::filesystem::path& folder, Making making);

  FolderLock(FolderLock&& other) noexcept : folder_(std::move(other.folder_)), file_(std::exchange(other.file_, -1)) {}
  FolderLock& operator=(FolderLock&& other) noexcept;
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }  // by the name that it was locked by

 private:
  FolderLock(std::filesystem::path folder, int file) : folder_(std::move(folder)), file_(file) {}

  std::filesystem::path folder_;
  int file_ = -1;  // -1: moved from
};

}  // namespace peerd::store
