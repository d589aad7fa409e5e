#pragma once
#include <cstddef>
#include <expected>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "peerd/input/input_error.hpp"
#include "peerd/lab/cluster/work_list.hpp"
#include "peerd/peer/store/folder_lock.hpp"

namespace peerd::cluster {

// A hash of some bytes (BLAKE2b, 128 bits), as 32 hexadecimal digits.
[[nodiscard]] std::string hash_hex(std::string_view bytes);
// The same of a list of values, which are not the same as those of another list.
[[nodiscard]] std::string hash_of(const nlohmann::ordered_json& values);

// Everything that decides what the results in a folder are: the same work has the same results, byte for byte.
struct Work {
  std::string kind;                // "sim" or "chaos"
  std::string version;             // of the program, for people
  std::string program;             // hash_hex of its file
  std::string settings;            // hash_hex of all that its runs are made of
  std::vector<std::string> items;  // their names, which are names of files, too
};

// A folder in which processes, on any computers that share it, leave the results of a work's items: each result in a
// file of its own, which is there as a whole or not at all. It belongs to one work: manifest.json says to which.
class WorkFolder {
 public:
  // For whoever has the work done, one process at a time: makes the folder where it is missing. Failures that an
  // earlier start left behind are forgotten. Fails where the folder is another work's or another process has it.
  [[nodiscard]] static Result<WorkFolder> take(const std::filesystem::path& folder, Work work);
  // For a process that does some of the work. Fails where the folder is another work's, as it is on a computer that has
  // another program or other files.
  [[nodiscard]] static Result<WorkFolder> join(const std::filesystem::path& folder, Work work);

  [[nodiscard]] const Work& work() const { return work_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::filesystem::path logs() const { return folder_ / "logs"; }

  // The items that are there.
  struct Standing {
    ItemList missing;  // without a result
    ItemList failed;   // those of them that an error ended
  };
  [[nodiscard]] Result<Standing> standing() const;

  // The result of an item that is not missing. The error says why the file is no such result.
  [[nodiscard]] std::expected<std::string, std::string> result(std::size_t item) const;
  [[nodiscard]] Result<void> keep_result(std::size_t item, std::string_view bytes) const;
  // Makes the item a missing one.
  [[nodiscard]] Result<void> drop_result(std::size_t item) const;

  // The error that ended an item.
  [[nodiscard]] InputError failure(std::size_t item) const;
  [[nodiscard]] Result<void> keep_failure(std::size_t item, const InputError& error) const;

  // The line that keep_job has left last; none: there was none.
  [[nodiscard]] Result<std::optional<std::string>> job() const;
  [[nodiscard]] Result<void> keep_job(const std::string& line) const;

 private:
  WorkFolder(std::filesystem::path folder, Work work, std::optional<store::FolderLock> lock);

  [[nodiscard]] Result<void> compare_manifest() const;
  [[nodiscard]] std::filesystem::path result_file(std::size_t item) const;
  [[nodiscard]] std::filesystem::path failure_file(std::size_t item) const;
  // The beginning of a result's file: the format, the hash of the manifest and the item's name, a line each. The
  // result's bytes follow, and the hash of all that.
  [[nodiscard]] std::string heading(std::size_t item) const;
  [[nodiscard]] Result<void> put(const std::filesystem::path& file, std::string_view bytes) const;

  std::filesystem::path folder_;
  Work work_;
  std::string manifest_;       // the text of manifest.json
  std::string manifest_hash_;  // which results name
  std::optional<store::FolderLock> lock_;
};

}  // namespace peerd::cluster
