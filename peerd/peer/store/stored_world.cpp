#include "peerd/peer/store/stored_world.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/peer/store/durable_file.hpp"
#include "peerd/peer/store/store_folder.hpp"
#include "peerd/peer/store/world_files.hpp"

namespace peerd::store {
namespace {

namespace fs = std::filesystem;

constexpr const char *kArchive = kWorldFiles[0], *kDescription = kWorldFiles[1], *kPeer = kWorldFiles[2];
constexpr int kFormat = 1;
constexpr SizeLimit kArchiveMax{4096 * kMiB, "no world is so large"};
constexpr SizeLimit kDescriptionMax{16 * kMiB, "no description of a world is so long"};
constexpr SizeLimit kPeerMax{64, "it holds a number"};

InputError damaged(const fs::path& file, const std::string& why) {
  return {"error: " + file.string() + " is damaged: " + why, kFinding};
}

// Reads the world without its archive.
Result<std::optional<StoredWorld>> read_description(const fs::path& folder) {
  std::error_code failed;
  if (!fs::exists(folder / kDescription, failed) && !failed) return std::nullopt;
  const auto text = read_text_file(folder / kDescription, kDescriptionMax);
  if (!text) return std::unexpected(text.error());
  StoredWorld world;
  try {
    const auto description = parse_json(*text);
    if (const int format = description.at("format").get<int>(); format != kFormat) {
      return std::unexpected(InputError{"error: " + (folder / kDescription).string() + " is of format " +
                                            std::to_string(format) + ", and this program reads " +
                                            std::to_string(kFormat),
                                        1});
    }
    world.name = description.at("name").get<std::string>();
    world.settings = description.at("settings").get<std::string>();
    const auto genesis = description.at("genesis").get<std::string>();
    const char* const end = genesis.data() + genesis.size();
    if (std::from_chars(genesis.data(), end, world.genesis, 16).ptr != end) {
      return std::unexpected(damaged(folder / kDescription, "its genesis is no number"));
    }
  } catch (const nlohmann::json::exception& e) {
    return std::unexpected(damaged(folder / kDescription, e.what()));
  }
  return world;
}

}  // namespace

// The description last: where it is, the archive is, too.
Result<void> write_world(const fs::path& folder, const StoredWorld& world) {
  const auto there = read_description(folder);
  if (!there) return std::unexpected(there.error());  // what is not understood is not overwritten
  std::error_code failed;
  const bool has_archive = *there && (*there)->genesis == world.genesis && fs::exists(folder / kArchive, failed);
  if (has_archive && (*there)->name == world.name && (*there)->settings == world.settings) return {};
  const nlohmann::ordered_json description{{"format", kFormat},
                                           {"name", world.name},
                                           {"genesis", fmt::format("{:016x}", world.genesis)},
                                           {"settings", world.settings}};
  if (!has_archive) {
    if (auto written = write_durably(folder / kArchive, world.archive); !written) return written;
  }
  return write_durably(folder / kDescription, json_line(description) + '\n');
}

Result<std::optional<StoredWorld>> read_world_of_store(const fs::path& folder) {
  auto world = read_description(folder);
  if (!world || !*world) return world;
  auto archive = read_text_file(folder / kArchive, kArchiveMax);
  if (!archive) return std::unexpected(archive.error());
  (*world)->archive = *std::move(archive);
  return world;
}

std::vector<fs::path> stores_of_world(const std::string& name) {
  std::vector<fs::path> found;
  const auto state = state_folder();
  std::error_code failed;
  if (!state || !fs::is_directory(*state, failed)) return found;
  for (const auto& genesis : fs::directory_iterator(*state, failed)) {
    if (!genesis.is_directory(failed)) continue;
    for (const auto& folder : fs::directory_iterator(genesis.path(), failed)) {
      if (folder.path().filename().string().find(".before") != std::string::npos) continue;  // it was put aside
      const auto world = read_description(folder.path());
      if (world && *world && (name.empty() || (*world)->name == name)) found.push_back(folder.path());
    }
  }
  std::ranges::sort(found);
  return found;
}

Result<PeerId> identity_in(const fs::path& folder, PeerId fresh, replication::AuthorId author) {
  const fs::path file = folder / kPeer;
  std::error_code failed;
  if (fs::exists(file, failed) || failed) {
    const auto text = read_text_file(file, kPeerMax);
    if (!text) return std::unexpected(text.error());
    std::uint32_t peer = 0, of_author = 0;
    const char *const begin = text->data(), *const end = begin + text->size();
    const auto first = std::from_chars(begin, end, peer);
    const bool has_more = first.ec == std::errc{} && first.ptr != end && *first.ptr == ' ';
    const auto second = has_more ? std::from_chars(first.ptr + 1, end, of_author) : first;
    if (!has_more || second.ec != std::errc{} || std::string_view(second.ptr, end) != "\n" || peer == 0) {
      return std::unexpected(damaged(file, "it holds no number of a peer and of an author"));
    }
    if (replication::AuthorId{of_author} == author) return PeerId{peer};
  }
  auto written = write_durably(file, fmt::format("{} {}\n", fresh.value, author.value));
  if (!written) return std::unexpected(written.error());
  return fresh;
}

}  // namespace peerd::store
