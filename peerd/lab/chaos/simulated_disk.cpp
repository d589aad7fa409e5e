#include "peerd/lab/chaos/simulated_disk.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace peerd::chaos {
namespace {

std::error_code dead() { return std::make_error_code(std::errc::io_error); }

}  // namespace

// What a process sees, what outlasts a power cut, and the changes between the two.
class SimulatedDisk::File {
 public:
  struct Change {
    std::uint64_t at = 0;
    std::optional<std::string> bytes;  // none: the file is cut off there
  };

  void apply(const Change& change) {
    apply(change, bytes);
    changes.push_back(change);
  }
  static void apply(const Change& change, std::string& content) {
    if (!change.bytes) return content.resize(change.at);
    if (content.size() < change.at + change.bytes->size()) content.resize(change.at + change.bytes->size());
    content.replace(change.at, change.bytes->size(), *change.bytes);
  }

  std::uint64_t serial = 0;
  std::string bytes, durable;
  std::vector<Change> changes;  // since it was synchronised
};

void SimulatedDisk::revive(bool power_was_cut) {
  is_dead_ = false;
  dies_in_.reset();
  if (!power_was_cut) return;
  // A file system keeps the order of its names.
  const std::uint64_t kept = random_.below(name_changes_.size() + 1);
  counters_.lost += name_changes_.size() - kept;
  for (std::uint64_t i = 0; i < kept; ++i) apply(name_changes_[i], durable_names_);
  name_changes_.clear();
  names_ = durable_names_;
  for (auto& [name, file] : names_) lose(*file);
}

// Each sector of each change is on the disk or is not, in whichever order they were written.
void SimulatedDisk::lose(File& file) {
  for (const File::Change& change : std::exchange(file.changes, {})) {
    if (!change.bytes) {
      if (random_.chance(0.5)) {
        File::apply(change, file.durable);
      } else {
        ++counters_.lost;
      }
      continue;
    }
    bool is_whole = true;
    for (std::size_t from = 0; from < change.bytes->size();) {
      const std::size_t end = (change.at + from) / kSector_bytes * kSector_bytes + kSector_bytes - change.at;
      const std::size_t size = std::min(end, change.bytes->size()) - from;
      if (random_.chance(0.5)) {
        File::apply({change.at + from, change.bytes->substr(from, size)}, file.durable);
      } else {
        is_whole = false;
      }
      from += size;
    }
    if (!is_whole) ++counters_.lost;
  }
  file.bytes = file.durable;
}

std::uint64_t SimulatedDisk::used() const {
  std::uint64_t bytes = 0;
  for (const auto& [name, file] : names_) bytes += file->bytes.size();
  return bytes;
}

void SimulatedDisk::set_room(std::optional<std::uint64_t> bytes) {
  capacity_ = bytes ? std::optional(used() + *bytes) : std::nullopt;
}

SimulatedDisk::FileRef SimulatedDisk::make_nameless() { return std::make_shared<File>(); }

SimulatedDisk::FileRef SimulatedDisk::find(std::string_view name) const {
  const auto at = names_.find(name);
  return at == names_.end() ? nullptr : at->second;
}

SimulatedDisk::Leave SimulatedDisk::begin_change() {
  if (is_dead_) return {dead(), false};
  ++counters_.writes;
  if (dies_in_ && --*dies_in_ == 0) {
    is_dead_ = true;
    dies_in_.reset();
    return {{}, true};
  }
  if (random_.chance(error_rate_)) {
    ++counters_.refused_error;
    return {std::make_error_code(std::errc::io_error), false};
  }
  return {};
}

SimulatedDisk::Result<std::span<const char>> SimulatedDisk::read(const File& file, std::uint64_t at,
                                                                 std::size_t bytes) const {
  if (is_dead_) return std::unexpected(dead());
  const std::uint64_t from = std::min<std::uint64_t>(at, file.bytes.size());
  return std::span(file.bytes).subspan(from, std::min<std::uint64_t>(bytes, file.bytes.size() - from));
}

SimulatedDisk::Result<std::uint64_t> SimulatedDisk::size(const File& file) const {
  if (is_dead_) return std::unexpected(dead());
  return file.bytes.size();
}

std::uint64_t SimulatedDisk::serial(const File& file) const { return file.serial; }

std::error_code SimulatedDisk::write(File& file, std::uint64_t at, std::span<const char> bytes) {
  const Leave leave = begin_change();
  if (leave.refused) return leave.refused;
  File::Change change{at, std::string(bytes.begin(), bytes.end())};
  if (leave.dies) {
    change.bytes->resize(random_.below(bytes.size() + 1));
    ++counters_.torn;
    file.apply(change);
    return dead();
  }
  const std::uint64_t end = at + bytes.size();
  const std::uint64_t growth = end > file.bytes.size() ? end - file.bytes.size() : 0;
  if (capacity_ && growth > 0 && used() + growth > *capacity_) {
    ++counters_.refused_full;
    return std::make_error_code(std::errc::no_space_on_device);
  }
  file.apply(change);
  return {};
}

std::error_code SimulatedDisk::truncate(File& file, std::uint64_t bytes) {
  const Leave leave = begin_change();
  if (leave.refused) return leave.refused;
  if (!leave.dies || random_.chance(0.5)) file.apply({bytes, std::nullopt});
  return leave.dies ? dead() : std::error_code();
}

std::error_code SimulatedDisk::synchronise(File& file) {
  const Leave leave = begin_change();
  if (leave.refused) return leave.refused;
  if (leave.dies) return dead();
  ++counters_.synchronised;
  file.durable = file.bytes;
  file.changes.clear();
  return {};
}

void SimulatedDisk::apply(const NameChange& change, Names& names) {
  if (!change.old_name.empty()) names.erase(change.old_name);
  if (change.file) {
    names.insert_or_assign(change.name, change.file);
  } else {
    names.erase(change.name);
  }
}

std::error_code SimulatedDisk::change(NameChange change) {
  const Leave leave = begin_change();
  if (leave.refused) return leave.refused;
  if (!leave.dies || random_.chance(0.5)) {
    apply(change, names_);
    name_changes_.push_back(std::move(change));
  }
  return leave.dies ? dead() : std::error_code();
}

SimulatedDisk::Result<SimulatedDisk::FileRef> SimulatedDisk::make(std::string_view name) {
  auto file = std::make_shared<File>();
  file->serial = ++last_serial_;
  if (const auto failed = change({std::string(name), file, {}})) return std::unexpected(failed);
  return file;
}

std::error_code SimulatedDisk::rename(std::string_view from, std::string_view to) {
  const FileRef file = find(from);
  if (!file) return std::make_error_code(std::errc::no_such_file_or_directory);
  return change({std::string(to), file, std::string(from)});
}

std::error_code SimulatedDisk::remove(std::string_view name) {
  if (!find(name)) return is_dead_ ? dead() : std::error_code();
  return change({std::string(name), nullptr, {}});
}

std::error_code SimulatedDisk::synchronise_names() {
  const Leave leave = begin_change();
  if (leave.refused) return leave.refused;
  if (leave.dies) return dead();
  ++counters_.synchronised;
  durable_names_ = names_;
  name_changes_.clear();
  return {};
}

}  // namespace peerd::chaos
