#include "peerd/peer/store/disk_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>

#include <spdlog/fmt/fmt.h>

#include "peerd/peer/store/synchronise.hpp"

namespace peerd::store {
namespace {

namespace fs = std::filesystem;

std::error_code last_error() { return {errno, std::generic_category()}; }

}  // namespace

std::expected<std::optional<std::uint64_t>, std::error_code> DiskFolder::size(std::string_view name) const {
  std::error_code failed;
  const fs::path file = path() / name;
  const fs::file_status status = fs::status(file, failed);
  if (status.type() == fs::file_type::not_found) return std::nullopt;
  if (failed) return std::unexpected(failed);
  const std::uint64_t bytes = fs::file_size(file, failed);
  if (failed) return std::unexpected(failed);
  return bytes;
}

std::expected<std::string, std::error_code> DiskFolder::read(std::string_view name, std::size_t most) const {
  const int file = ::open((path() / name).c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return std::unexpected(last_error());
  std::string bytes(most, '\0');
  std::size_t size = 0;
  ssize_t got = 1;
  while (got > 0 && size < most) {
    got = ::read(file, bytes.data() + size, most - size);
    if (got > 0) size += static_cast<std::size_t>(got);
    if (got < 0 && errno == EINTR) got = 1;
  }
  const std::error_code failed = got < 0 ? last_error() : std::error_code();
  ::close(file);
  if (failed) return std::unexpected(failed);
  bytes.resize(size);
  return bytes;
}

std::expected<std::string, std::error_code> DiskFolder::identity(std::string_view name) const {
  struct statx known {};
  const fs::path file = path() / name;
  if (::statx(AT_FDCWD, file.c_str(), 0, STATX_INO | STATX_BTIME, &known) != 0) return std::unexpected(last_error());
  if ((known.stx_mask & STATX_BTIME) == 0) return fmt::format("{}", known.stx_ino);
  return fmt::format("{}@{}.{:09}", known.stx_ino, known.stx_btime.tv_sec, known.stx_btime.tv_nsec);
}

std::error_code DiskFolder::write(std::string_view name, std::string_view bytes) {
  errno = 0;
  std::ofstream file(path() / name, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (file) return {};
  return errno != 0 ? last_error() : std::make_error_code(std::errc::io_error);
}

std::error_code DiskFolder::put_in_place(std::string_view unfinished, std::string_view name) {
  return store::put_in_place(path() / unfinished, path() / name);
}

std::error_code DiskFolder::remove(std::string_view name) {
  std::error_code failed;
  fs::remove(path() / name, failed);
  return failed;
}

std::error_code DiskFolder::synchronise() { return store::synchronise(path()); }

}  // namespace peerd::store
