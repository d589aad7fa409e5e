#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace peerd::store {

// The files of one folder as a store needs them: those of a disk (DiskFolder), or of a simulated one.
class FileFolder {
 public:
  virtual ~FileFolder() = default;

  [[nodiscard]] virtual const std::filesystem::path& path() const = 0;
  // The name by which SQLite knows the file system (sqlite3_vfs) that has these files; null: the system's own.
  [[nodiscard]] virtual const char* file_system() const = 0;

  // The bytes of a file; none: there is no such file.
  [[nodiscard]] virtual std::expected<std::optional<std::uint64_t>, std::error_code> size(
      std::string_view name) const = 0;
  // The first bytes of a file, at most `most`.
  [[nodiscard]] virtual std::expected<std::string, std::error_code> read(std::string_view name,
                                                                         std::size_t most) const = 0;
  // The stamp tells this file from its copies and from every file that has had its name.
  [[nodiscard]] virtual std::expected<std::string, std::error_code> identity(std::string_view name) const = 0;

  // Makes a file, or writes over the one that is there. Nothing of it need outlast a power cut.
  [[nodiscard]] virtual std::error_code write(std::string_view name, std::string_view bytes) = 0;
  // Gives the unfinished file the name, for good: after a power cut the name has either what it had, or all of this.
  [[nodiscard]] virtual std::error_code put_in_place(std::string_view unfinished, std::string_view name) = 0;
  // A file that is not there is no error. The name may be there again after a power cut, until synchronise().
  [[nodiscard]] virtual std::error_code remove(std::string_view name) = 0;
  // All names outlast a power cut.
  [[nodiscard]] virtual std::error_code synchronise() = 0;
};

}  // namespace peerd::store
