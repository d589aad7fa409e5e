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

std::unexpected<InputError> unreadable(const std::string& name) {
  return std::unexpected(InputError{name + ": error: can't be read; is it a file that you may read?", kSystemFailed});
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
  while (in) {
    std::string chunk(kChunk_bytes, '\0');
    in.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    chunk.resize(static_cast<std::size_t>(in.gcount()));
    size_bytes += chunk.size();
    if (size_bytes > limit.bytes) return too_large(name, limit);
    chunks.push_back(std::move(chunk));
  }
  if (in.bad()) return unreadable(name);
  std::string text;
  text.reserve(size_bytes);
  for (std::string& chunk : chunks) text += std::exchange(chunk, {});
  return text;
}

Result<std::string> read_text_file(const std::filesystem::path& path, const SizeLimit& limit) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return std::unexpected(InputError{path.string() + ": error: there is no such file"});
  }
  if (std::filesystem::is_directory(path, error)) return unreadable(path.string());
  if (std::filesystem::is_regular_file(path, error) && std::filesystem::file_size(path, error) > limit.bytes) {
    return too_large(path.string(), limit);
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) return unreadable(path.string());
  return read_text(in, path.string(), limit);
}

Result<void> write_text_file(const std::filesystem::path& path, std::string_view text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  if (file) return {};
  const std::string why = errno != 0 ? std::strerror(errno) : "the reason is unknown";
  return std::unexpected(InputError{path.string() + ": error: can't be written: " + why, kSystemFailed});
}

}  // namespace peerd
