#include "peerd/daemon/open/roster_file.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

#include "peerd/input/text_file.hpp"
#include "peerd/net/keys/key_file.hpp"
#include "peerd/peer/store/durable_file.hpp"

namespace peerd {
namespace {

namespace fs = std::filesystem;
using keys::Roster;

constexpr SizeLimit kRosterFile{Roster::kText_bytes + 1, "no roster is so long; is this one?"};

std::unexpected<InputError> wrong_roster(const fs::path& file, const std::string& what, int code) {
  return std::unexpected(InputError{"error: the roster " + file.string() + " " + what, code});
}

// The number at the end of FILE.NUMBER; none: the path is another one.
std::optional<std::uint32_t> epoch_of(const fs::path& path, const fs::path& file) {
  const std::string name = path.filename().string(), begin = file.filename().string() + ".";
  std::uint32_t epoch = 0;
  if (!name.starts_with(begin)) return std::nullopt;
  const char* const end = name.data() + name.size();
  const auto [read, failed] = std::from_chars(name.data() + begin.size(), end, epoch);
  return failed == std::errc() && read == end ? std::optional(epoch) : std::nullopt;
}

}  // namespace

std::optional<fs::path> chosen_roster_file(const fs::path& said, const std::string& world) {
  if (!said.empty()) return said;
  auto file = keys::default_key_file(world);
  if (file) file->replace_extension(".roster");
  return file;
}

Result<std::optional<Roster>> read_roster(const fs::path& file) {
  std::error_code failed;
  if (!fs::exists(file, failed) && !failed) return std::nullopt;
  const auto text = read_text_file(file, kRosterFile);
  if (!text) return std::unexpected(text.error());
  auto roster = Roster::of_text(*text);
  if (!roster) return wrong_roster(file, "is damaged, or no administrator has signed it", 1);
  return *std::move(roster);
}

std::vector<Roster> read_earlier_rosters(const fs::path& file) {
  std::vector<Roster> earlier;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(file.parent_path(), failed)) {
    if (!epoch_of(entry.path(), file)) continue;
    if (const auto roster = read_roster(entry.path()); roster && *roster) earlier.push_back(**roster);
  }
  std::ranges::sort(earlier, {}, &Roster::epoch);
  return earlier;
}

Result<void> save_roster(const fs::path& file, const Roster& roster) {
  const auto before = read_roster(file);
  if (!before) return std::unexpected(before.error());
  if (*before && (*before)->text() == roster.text()) return {};
  if (*before && !(*before)->is_followed_by(roster)) {
    return wrong_roster(file, "is a later one, or of another world, or by other administrators", 1);
  }
  std::error_code failed;
  fs::create_directories(file.parent_path(), failed);
  if (*before && !failed) {
    fs::copy_file(file, file.string() + "." + std::to_string((*before)->epoch()), fs::copy_options::overwrite_existing,
                  failed);
  }
  if (failed) return wrong_roster(file, "cannot be kept: " + failed.message(), 3);
  return store::write_durably(file, roster.text());
}

}  // namespace peerd
