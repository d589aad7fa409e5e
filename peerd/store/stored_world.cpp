#include "peerd/store/stored_world.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/input/json_line.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/store/durable_file.hpp"
#include "peerd/store/store_folder.hpp"
#include "peerd/store/world_files.hpp"

namespace peerd::store {
namespace {

namespace fs = std::filesystem;

constexpr const char *kArchive = kWorldFiles[0], *kDescription = kWorldFiles[1], *kPeer = kWorldFiles[2];
constexpr int kFormat = 1;
constexpr SizeLimit kArchiveMax{4096 * kMiB, "no world is so large"};
constexpr SizeLimit kDescriptionMax{16 * kMiB, "no description of a world is so long"};
constexpr SizeLimit kPeerMax{64, "it holds a number"};

InputError damaged(const fs::path& file, const std::string& why) {
  return {"error: " + file.string() + " is damaged: " + why, 1};
}

}  // namespace

// The description last: where it is, the archive is, too.
Result<void> write_world(const fs::path& folder, const StoredWorld& world) {
  if (const auto there = read_world_of_store(folder); there && *there && **there == world) return {};
  const nlohmann::ordered_json description{{"format", kFormat},
                                           {"name", world.name},
                                           {"genesis", fmt::format("{:016x}", world.genesis)},
                                           {"settings", world.settings}};
  if (auto written = write_durably(folder / kArchive, world.archive); !written) return written;
  return write_durably(folder / kDescription, json_line(description) + '\n');
}

Result<std::optional<StoredWorld>> read_world_of_store(const fs::path& folder) {
  std::error_code failed;
  if (!fs::exists(folder / kDescription, failed)) return std::nullopt;
  const auto text = read_text_file(folder / kDescription, kDescriptionMax);
  if (!text) return std::unexpected(text.error());
  StoredWorld world;
  try {
    const auto description = nlohmann::json::parse(*text);
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
  auto archive = read_text_file(folder / kArchive, kArchiveMax);
  if (!archive) return std::unexpected(archive.error());
  world.archive = *std::move(archive);
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
      if (!fs::exists(folder.path() / kDescription, failed)) continue;
      const auto world = read_world_of_store(folder.path());
      if (world && *world && (name.empty() || (*world)->name == name)) found.push_back(folder.path());
    }
  }
  std::ranges::sort(found);
  return found;
}

Result<PeerId> identity_in(const fs::path& folder, PeerId fresh, bool is_copy) {
  const fs::path file = folder / kPeer;
  std::error_code failed;
  if (is_copy || !fs::exists(file, failed)) {
    if (auto written = write_durably(file, std::to_string(fresh.value) + '\n'); !written) {
      return std::unexpected(written.error());
    }
    return fresh;
  }
  const auto text = read_text_file(file, kPeerMax);
  if (!text) return std::unexpected(text.error());
  std::uint32_t number = 0;
  const char* const end = text->data() + text->size();
  const auto [rest, error] = std::from_chars(text->data(), end, number);
  if (error != std::errc{} || number == 0 || std::string_view(rest, end) != "\n") {
    return std::unexpected(damaged(file, "it holds no number of a peer"));
  }
  return PeerId{number};
}

}  // namespace peerd::store
