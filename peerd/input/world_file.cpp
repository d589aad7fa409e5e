#include "peerd/input/world_file.hpp"
#include "core/motion/inert_parts.hpp"
#include "peerd/input/text_file.hpp"

#include <charconv>
#include <istream>
#include <utility>

namespace peerd::config {
namespace {

constexpr std::string_view kWorldAdvice = "the option expansion allows more, up to 4095 MiB";

}  // namespace

std::optional<std::filesystem::path> local_path(std::string_view url) {
  if (url.starts_with("file:")) {
    url.remove_prefix(5);
    if (url.starts_with("//localhost/")) url.remove_prefix(11);
    if (url.starts_with("//")) url.remove_prefix(2);
  } else if (const std::size_t colon = url.find(':'); colon != std::string_view::npos && colon > 1) {
    // http:, urn: and javascript: name no file. A single letter is a drive of another operating system; it is tried as
    // a file and not found.
    if (url.substr(0, colon).find_first_of("/.\\") == std::string_view::npos) return std::nullopt;
  }
  std::string path;
  for (std::size_t i = 0; i < url.size(); ++i) {
    unsigned char byte = 0;
    const char* const digits = url.data() + i + 1;
    if (url[i] == '%' && i + 2 < url.size() && std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2 &&
        byte != 0) {
      path += static_cast<char>(byte);
      i += 2;
    } else {
      path += url[i];
    }
  }
  if (path.empty()) return std::nullopt;
  return path;
}

FileLoader local_files(std::uint64_t text_bytes) {
  return [text_bytes](std::string_view url, std::string_view base) -> std::expected<LoadedFile, std::string> {
    const auto named = local_path(url);
    if (!named) return std::unexpected("it is no file of this machine");
    const std::filesystem::path path = (std::filesystem::path(base).parent_path() / *named).lexically_normal();
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return std::unexpected("there is no such file");
    if (!std::filesystem::is_regular_file(path, error)) return std::unexpected("it is no regular file");
    if (std::filesystem::file_size(path, error) > text_bytes) return std::unexpected("it is too large");
    auto bytes = read_text_file(path, {text_bytes, kWorldAdvice});
    if (!bytes) return std::unexpected("it can't be read");
    // Links and detours lead to one canonical name, so that a file that includes itself is recognised.
    const std::filesystem::path one = std::filesystem::canonical(path, error);
    return LoadedFile{error ? path.string() : one.string(), std::move(*bytes)};
  };
}

namespace {

// Positions in the texts of a world have 32 bits.
std::uint64_t text_bytes_max(const WorldReading& reading) {
  return std::min<std::uint64_t>(ReadLimits{}.text_bytes * reading.expansion, 4095 * kMiB);
}

// Reads the world of that text. `path` is its name, from which the URLs in it start.
std::unique_ptr<const WorldFile> read_text_of_world(std::string text, const std::filesystem::path& path,
                                                    const WorldReading& reading) {
  auto file = std::make_unique<WorldFile>();
  file->text = std::move(text);
  ReadOptions options;
  options.name = path.string();
  options.defer_inlines = reading.inlines_when_needed;
  options.limits.expansion = reading.expansion;
  options.limits.text_bytes = text_bytes_max(reading);
  // The world keeps the name by which it was asked for, wherever another file names it.
  std::error_code error;
  const std::string one = std::filesystem::canonical(path, error).string();
  options.load = [files = local_files(options.limits.text_bytes), one, name = options.name](std::string_view url,
                                                                                            std::string_view base) {
    auto loaded = files(url, base);
    if (loaded && loaded->name == one) loaded->name = name;
    return loaded;
  };
  file->result = read_world(file->text, options);
  warn_of_inert_parts(file->result, reading.maps_hierarchies);
  return file;
}

}  // namespace

Result<std::unique_ptr<const WorldFile>> read_world_file(const std::filesystem::path& path,
                                                         const WorldReading& reading) {
  auto text = read_text_file(path, {text_bytes_max(reading), kWorldAdvice});
  if (!text) return std::unexpected(text.error());
  return read_text_of_world(std::move(*text), path, reading);
}

Result<std::unique_ptr<const WorldFile>> read_world_stream(std::istream& in, const WorldReading& reading) {
  constexpr const char* kName = "<stdin>";
  auto text = read_text(in, kName, {text_bytes_max(reading), kWorldAdvice});
  if (!text) return std::unexpected(text.error());
  return read_text_of_world(std::move(*text), kName, reading);
}

}  // namespace peerd::config
