#include "peerd/lab/cluster/work_folder.hpp"

#include <array>
#include <cassert>
#include <charconv>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <sodium.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/peer/store/synchronise.hpp"

namespace peerd::cluster {
namespace {

namespace fs = std::filesystem;

constexpr int kManifestFormat = 1;
constexpr const char* kManifestFile = "manifest.json";
constexpr const char* kJobFile = "job";
constexpr const char* kResult = ".result";
constexpr const char* kFailure = ".failed";
constexpr std::string_view kMagic = "peerd result 2\n";  // 2: the format of this frame
constexpr std::size_t kHash_digits = 32;
constexpr SizeLimit kManifest{kMiB, "no manifest is so long"};
constexpr SizeLimit kResultFile{4096 * kMiB, "no result is so long"};

InputError environment(const std::string& sentence) { return {"error: " + sentence, kSystemFailed}; }

std::string manifest_of(const Work& work) {
  const nlohmann::ordered_json json{{"format", kManifestFormat},
                                    {"kind", work.kind},
                                    {"version", work.version},
                                    {"program", work.program},
                                    {"settings", work.settings},
                                    {"items", work.items.size()},
                                    {"names", hash_hex(nlohmann::json(work.items).dump(-1, ' ', true))}};
  return json_text(json, 1) + '\n';
}

// The difference of a folder's manifest from that of the work at hand.
std::string difference(const std::string& theirs, const Work& work) {
  const auto json = json_if_valid(theirs);
  if (!json.is_object()) return "its manifest.json is damaged";
  const auto differs = [&](const char* key, const std::string& mine) {
    return json.value(key, nlohmann::json()) != mine;
  };
  if (json.value("format", nlohmann::json()) != kManifestFormat) return "its manifest.json is of another format";
  if (differs("kind", work.kind)) return "it is of other runs";
  if (differs("version", work.version)) return "the program is " + work.version + " here and was another version there";
  if (differs("settings", work.settings)) return "the scenario, its settings, its seeds or its world are others";
  if (differs("program", work.program)) return "the program's file is another one, though of the same version";
  return "it has other runs";
}

}  // namespace

std::string hash_hex(std::string_view bytes) {
  if (sodium_init() < 0) throw std::runtime_error("libsodium finds no entropy on this system");
  std::array<unsigned char, kHash_digits / 2> hash{};
  const int failed = crypto_generichash(hash.data(), hash.size(), reinterpret_cast<const unsigned char*>(bytes.data()),
                                        bytes.size(), nullptr, 0);
  assert(failed == 0);
  (void)failed;
  std::string text;
  for (const unsigned char byte : hash) text += fmt::format("{:02x}", byte);
  return text;
}

std::string hash_of(const nlohmann::ordered_json& values) {
  std::string bytes;
  nlohmann::ordered_json::to_msgpack(values, bytes);
  return hash_hex(bytes);
}

WorkFolder::WorkFolder(fs::path folder, Work work, std::optional<store::FolderLock> lock)
    : folder_(std::move(folder)),
      work_(std::move(work)),
      manifest_(manifest_of(work_)),
      manifest_hash_(hash_hex(manifest_)),
      lock_(std::move(lock)) {}

Result<WorkFolder> WorkFolder::take(const fs::path& folder, Work work) {
  auto lock = store::FolderLock::take(folder, store::FolderLock::Making::kFolders);
  if (!lock) {
    if (lock.error().why == store::LockError::Why::kInUse) {
      return std::unexpected(environment(folder.string() + " is in use: this sweep is running already"));
    }
    return std::unexpected(environment(folder.string() + " can't be used: " + lock.error().text));
  }
  WorkFolder taken(folder, std::move(work), *std::move(lock));
  for (const char* part : {"results", "logs"}) {
    if (const auto error = store::make_folders(folder / part)) {
      return std::unexpected(environment("can't make the folder " + (folder / part).string() + ": " + error.message()));
    }
  }
  std::error_code error;
  if (!fs::exists(folder / kManifestFile, error)) {
    if (auto put = taken.put(folder / kManifestFile, taken.manifest_); !put) return std::unexpected(put.error());
  } else if (auto same = taken.compare_manifest(); !same) {
    return std::unexpected(same.error());
  }
  const auto standing = taken.standing();
  if (!standing) return std::unexpected(standing.error());
  for (const std::size_t item : standing->failed) {
    if (!fs::remove(taken.failure_file(item), error)) {
      return std::unexpected(environment(taken.failure_file(item).string() + " can't be removed: " + error.message()));
    }
  }
  return taken;
}

Result<WorkFolder> WorkFolder::join(const fs::path& folder, Work work) {
  WorkFolder joined(folder, std::move(work), std::nullopt);
  if (auto same = joined.compare_manifest(); !same) return std::unexpected(same.error());
  return joined;
}

Result<void> WorkFolder::compare_manifest() const {
  const auto text = read_text_file(folder_ / kManifestFile, kManifest);
  if (!text) return std::unexpected(text.error());
  if (*text == manifest_) return {};
  return std::unexpected(InputError{"error: " + folder_.string() + " has results of another sweep: " +
                                        difference(*text, work_) + "; choose another --out, or remove that folder",
                                    2});
}

fs::path WorkFolder::result_file(std::size_t item) const { return folder_ / "results" / (work_.items[item] + kResult); }
fs::path WorkFolder::failure_file(std::size_t item) const {
  return folder_ / "results" / (work_.items[item] + kFailure);
}

// One reading of the folder's names, because on a network's file system that is one question, and asks for what is new.
Result<WorkFolder::Standing> WorkFolder::standing() const {
  std::set<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(folder_ / "results", error), end; !error && it != end; it.increment(error)) {
    names.insert(it->path().filename().string());
  }
  if (error) {
    return std::unexpected(environment((folder_ / "results").string() + " can't be read: " + error.message()));
  }
  Standing standing;
  for (std::size_t item = 0; item < work_.items.size(); ++item) {
    if (names.contains(work_.items[item] + kResult)) continue;
    standing.missing.push_back(item);
    if (names.contains(work_.items[item] + kFailure)) standing.failed.push_back(item);
  }
  return standing;
}

std::string WorkFolder::heading(std::size_t item) const {
  return fmt::format("{}{}\n{}\n", kMagic, manifest_hash_, work_.items[item]);
}

std::expected<std::string, std::string> WorkFolder::result(std::size_t item) const {
  const auto file = read_text_file(result_file(item), kResultFile);
  if (!file) return std::unexpected(file.error().text);
  if (file->size() < kHash_digits) return std::unexpected("it is cut off");
  const std::string_view framed = std::string_view(*file).substr(0, file->size() - kHash_digits);
  if (hash_hex(framed) != std::string_view(*file).substr(framed.size())) return std::unexpected("it is damaged");
  if (!framed.starts_with(kMagic)) return std::unexpected("it is no result");
  if (!framed.starts_with(heading(item))) return std::unexpected("it is of another run");
  return std::string(framed.substr(heading(item).size()));
}

Result<void> WorkFolder::keep_result(std::size_t item, std::string_view bytes) const {
  const std::string framed = heading(item).append(bytes);
  return put(result_file(item), framed + hash_hex(framed));
}

Result<void> WorkFolder::drop_result(std::size_t item) const {
  std::error_code error;
  fs::remove(result_file(item), error);
  if (error) return std::unexpected(environment(result_file(item).string() + " can't be removed: " + error.message()));
  return {};
}

InputError WorkFolder::failure(std::size_t item) const {
  const auto file = read_text_file(failure_file(item), kManifest);
  if (!file) return file.error();
  int code = 0;
  const auto [end, wrong] = std::from_chars(file->data(), file->data() + file->size(), code);
  if (wrong != std::errc() || end == file->data() + file->size() || *end != '\n') {
    return environment(failure_file(item).string() + " is damaged");
  }
  return {std::string(end + 1, file->data() + file->size()), code};
}

Result<void> WorkFolder::keep_failure(std::size_t item, const InputError& error) const {
  return put(failure_file(item), fmt::format("{}\n{}", error.exit_code, error.text));
}

Result<std::optional<std::string>> WorkFolder::job() const {
  std::error_code error;
  if (!fs::exists(folder_ / kJobFile, error)) return std::nullopt;
  auto text = read_text_file(folder_ / kJobFile, kManifest);
  if (!text) return std::unexpected(text.error());
  return text->substr(0, text->find('\n'));
}

Result<void> WorkFolder::keep_job(const std::string& line) const { return put(folder_ / kJobFile, line + '\n'); }

// Two processes may write one file at a time, where a task was started again: each has a name of its own until it is
// complete.
Result<void> WorkFolder::put(const fs::path& file, std::string_view bytes) const {
  std::array<char, 256> host{};
  if (gethostname(host.data(), host.size() - 1) != 0) host[0] = '\0';
  const fs::path unfinished = fmt::format("{}.{}.{}.new", file.string(), host.data(), getpid());
  if (auto written = write_text_file(unfinished, bytes); !written) return written;
  if (const auto error = store::put_in_place(unfinished, file)) {
    return std::unexpected(environment(file.string() + " can't be written: " + error.message()));
  }
  return {};
}

}  // namespace peerd::cluster
