#include "peerd/input/text_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <istream>
#include <system_error>
#include <utility>
#include <vector>

namespace peerd {
namespace {

constexpr std::size_t kChunk_bytes = std::size_t{1} << 20;

std::string reason_of(int error) { return error != 0 ? std::strerror(error) : "the reason is unknown"; }

std::unexpected<InputError> unreadable(const std::string& name, int error) {
  return std::unexpected(InputError{name + ": error: can't be read: " + reason_of(error), kSystemFailed});
}

std::unexpected<InputError> too_large(const std::string& name, const SizeLimit& limit) {
  return std::unexpected(InputError{
      name + ": error: it is larger than " + std::to_string(limit.bytes / kMiB) + " MiB; " + std::string(limit.advice),
      limit.exit_code});
}

}  // namespace

Result<std::string> read_text(std::istream& in, const std::string& name, const SizeLimit& limit) {
  // The chunks are joined at the end: a text that grew would be copied, and twice as large, on its way to the limit.
  std::vector<std::string> chunks;
  std::uint64_t size_bytes = 0;
  errno = 0;
  while (in) {
    std::string chunk(kChunk_bytes, '\0');
    in.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    chunk.resize(static_cast<std::size_t>(in.gcount()));
    size_bytes += chunk.size();
    if (size_bytes > limit.bytes) return too_large(name, limit);
    chunks.push_back(std::move(chunk));
  }
  if (in.bad()) return unreadable(name, errno);
  std::string text;
  text.reserve(size_bytes);
  for (std::string& chunk : chunks) text += std::exchange(chunk, {});
  return text;
}

Result<std::string> read_text_file(const std::filesystem::path& path, const SizeLimit& limit) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    // The file may be there, in a folder that may not be searched.
    if (error) return unreadable(path.string(), error.value());
    return std::unexpected(InputError{path.string() + ": error: there is no such file"});
  }
  if (std::filesystem::is_directory(path, error)) return unreadable(path.string(), EISDIR);
  if (std::filesystem::is_regular_file(path, error) && std::filesystem::file_size(path, error) > limit.bytes) {
    return too_large(path.string(), limit);
  }
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) return unreadable(path.string(), errno);
  return read_text(in, path.string(), limit);
}

Result<void> write_text_file(const std::filesystem::path& path, std::string_view text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  if (!file) return std::unexpected(unwritable(path, errno));
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  if (file) return {};
  return std::unexpected(half_written(path, errno));
}

InputError unwritable(const std::filesystem::path& path, int error) {
  return {path.string() + ": error: can't be written: " + reason_of(error), kSystemFailed};
}

// Only a regular file is removed: a device or a pipe stays.
InputError half_written(const std::filesystem::path& path, int error) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored)) std::filesystem::remove(path, ignored);
  return unwritable(path, error);
}

}  // namespace peerd
