#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "peerd/lab/chaos/simulated_disk.hpp"
#include "peerd/peer/store/file_folder.hpp"

struct sqlite3_vfs;

namespace peerd::chaos {

// A simulated disk as a file system of SQLite's (sqlite3_vfs), which knows it by its name while this object lives.
class SimulatedFileSystem {
 public:
  // The disk outlives it.
  explicit SimulatedFileSystem(SimulatedDisk& disk);
  SimulatedFileSystem(const SimulatedFileSystem&) = delete;
  SimulatedFileSystem& operator=(const SimulatedFileSystem&) = delete;
  ~SimulatedFileSystem();

  [[nodiscard]] const char* name() const { return name_.c_str(); }
  [[nodiscard]] SimulatedDisk& disk() const { return disk_; }

 private:
  SimulatedDisk& disk_;
  std::string name_;
  std::unique_ptr<sqlite3_vfs> vfs_;
};

// The folder of a simulated disk, for a store. The file system outlives it.
class SimulatedFolder final : public store::FileFolder {
 public:
  SimulatedFolder(const SimulatedFileSystem& files, std::filesystem::path path)
      : files_(files), path_(std::move(path)) {}

  [[nodiscard]] const std::filesystem::path& path() const override { return path_; }
  [[nodiscard]] const char* file_system() const override { return files_.name(); }
  [[nodiscard]] std::expected<std::optional<std::uint64_t>, std::error_code> size(std::string_view name) const override;
  [[nodiscard]] std::expected<std::string, std::error_code> read(std::string_view name,
                                                                 std::size_t most) const override;
  [[nodiscard]] std::expected<std::string, std::error_code> identity(std::string_view name) const override;
  [[nodiscard]] std::error_code write(std::string_view name, std::string_view bytes) override;
  [[nodiscard]] std::error_code put_in_place(std::string_view unfinished, std::string_view name) override;
  [[nodiscard]] std::error_code remove(std::string_view name) override;
  [[nodiscard]] std::error_code synchronise() override;

 private:
  [[nodiscard]] SimulatedDisk& disk() const { return files_.disk(); }
  // The file of that name, or the error that there is none.
  [[nodiscard]] std::expected<SimulatedDisk::FileRef, std::error_code> existing(std::string_view name) const;

  const SimulatedFileSystem& files_;
  std::filesystem::path path_;
};

}  // namespace peerd::chaos
