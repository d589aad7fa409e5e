#include "peerd/input/world_archive.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <map>
#include <optional>
#include <utility>

#include "peerd/input/compression.hpp"

namespace peerd {
namespace {

// The first line of an archive; a frame of zstd follows.
constexpr std::string_view kArchiveMagic = "peerd world archive 1\n";
// The longest name or URL [bytes], and the most files and URLs.
constexpr std::uint64_t kNameMax_bytes = 64 * 1024, kCountMax = 1'000'000;

// Numbers are of eight bytes, the least significant first; a string is its length and its bytes.
void append(std::string& out, std::uint64_t number) {
  for (int shift = 0; shift < 64; shift += 8) out += static_cast<char>(number >> shift & 0xff);
}

void append(std::string& out, std::string_view bytes) {
  append(out, static_cast<std::uint64_t>(bytes.size()));
  out += bytes;
}

// Reads what append() has written. After the first thing that is not there it is failed, and gives nothing more.
class Reading {
 public:
  explicit Reading(std::string_view rest) : rest_(rest) {}

  std::uint64_t number(std::uint64_t most) {
    constexpr std::size_t kBytes = 8;
    if (rest_.size() < kBytes) return fail();
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < kBytes; ++i) {
      number |= static_cast<std::uint64_t>(static_cast<unsigned char>(rest_[i])) << (8 * i);
    }
    rest_.remove_prefix(kBytes);
    return number <= most ? number : fail();
  }
  std::string bytes(std::uint64_t most) {
    const std::uint64_t size = number(most);
    if (size > rest_.size()) fail();
    if (failed_) return {};
    std::string bytes(rest_.substr(0, size));
    rest_.remove_prefix(size);
    return bytes;
  }
  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] bool is_over() const { return rest_.empty(); }

 private:
  std::uint64_t fail() {
    failed_ = true;
    rest_ = {};
    return 0;
  }

  std::string_view rest_;
  bool failed_ = false;
};

std::string name_of(const std::string& world, std::uint32_t file) {
  return file == 0 ? world : world + "#" + std::to_string(file);
}

}  // namespace

FileLoader WorldArchive::loader(std::string name) const {
  std::map<std::pair<std::string, std::string>, std::uint32_t> files_by_url;  // by the base's name and the URL
  for (const ArchivedUrl& each : urls) files_by_url[{name_of(name, each.in), each.url}] = each.leads_to;
  return [this, name = std::move(name), files_by_url = std::move(files_by_url)](
             std::string_view url, std::string_view base) -> std::expected<LoadedFile, std::string> {
    const auto found = files_by_url.find({std::string(base), std::string(url)});
    if (found == files_by_url.end()) return std::unexpected("the archive has no such file");
    return LoadedFile{name_of(name, found->second), files[found->second].text};
  };
}

bool is_archive(std::string_view bytes) { return bytes.starts_with(kArchiveMagic); }

std::string pack(const WorldArchive& archive) {
  std::string content;
  append(content, static_cast<std::uint64_t>(archive.files.size()));
  for (const ArchivedFile& file : archive.files) {
    append(content, file.name);
    append(content, file.text);
  }
  append(content, static_cast<std::uint64_t>(archive.urls.size()));
  for (const ArchivedUrl& each : archive.urls) {
    assert(each.in < archive.files.size() && each.leads_to < archive.files.size());
    append(content, static_cast<std::uint64_t>(each.in));
    append(content, each.url);
    append(content, static_cast<std::uint64_t>(each.leads_to));
  }
  return std::string(kArchiveMagic) + compress(content);
}

std::expected<WorldArchive, std::string> unpack(std::string_view bytes, std::uint64_t text_bytes) {
  if (!is_archive(bytes)) return std::unexpected("it is no world archive");
  const auto content = decompress(bytes.substr(kArchiveMagic.size()), text_bytes);
  if (!content) return std::unexpected(content.error());
  Reading reading(*content);
  WorldArchive archive;
  const std::uint64_t files = reading.number(kCountMax);
  for (std::uint64_t i = 0; i < files && !reading.failed(); ++i) {
    std::string name = reading.bytes(kNameMax_bytes);
    archive.files.push_back({std::move(name), reading.bytes(text_bytes)});
  }
  const std::uint64_t urls = reading.number(kCountMax);
  const std::uint64_t last_file = files == 0 ? 0 : files - 1;
  for (std::uint64_t i = 0; i < urls && !reading.failed(); ++i) {
    const auto in = static_cast<std::uint32_t>(reading.number(last_file));
    std::string url = reading.bytes(kNameMax_bytes);
    archive.urls.push_back({in, std::move(url), static_cast<std::uint32_t>(reading.number(last_file))});
  }
  if (reading.failed() || !reading.is_over() || files == 0) return std::unexpected("what it holds is no archive");
  return archive;
}

}  // namespace peerd
