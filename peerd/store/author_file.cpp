#include "peerd/store/author_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>

#include <spdlog/fmt/fmt.h>

#include "peerd/input/text_file.hpp"
#include "peerd/store/store_error.hpp"
#include "peerd/store/synchronise.hpp"

namespace peerd::store {
namespace {

namespace fs = std::filesystem;
using replication::AuthorId;

constexpr SizeLimit kAuthorLimit{256, "this is not the author of a store", 3};

InputError unwritable(const fs::path& folder, const std::string& why) {
  return store_error(folder, std::string("cannot be written: its file `") + kAuthorFile + "`: " + why, 3);
}

// The inode and the time of birth, which a user can set of no file. Where a file system knows no birth, the inode
// alone.
std::optional<std::string> identity_of(const fs::path& file) {
  struct statx known {};
  if (::statx(AT_FDCWD, file.c_str(), 0, STATX_INO | STATX_BTIME, &known) != 0) return std::nullopt;
  if ((known.stx_mask & STATX_BTIME) == 0) return fmt::format("{}", known.stx_ino);
  return fmt::format("{}@{}.{:09}", known.stx_ino, known.stx_btime.tv_sec, known.stx_btime.tv_nsec);
}

std::array<std::string_view, 4> fields_of(std::string_view line) {
  std::array<std::string_view, 4> fields;
  for (std::string_view& field : fields) {
    field = line.substr(0, line.find(' '));
    line.remove_prefix(std::min(line.size(), field.size() + 1));
  }
  return fields;
}

template <class Number>
bool read_number(std::string_view text, Number& number) {
  const char *const begin = text.data(), *const end = begin + text.size();
  const auto [read, wrong] = std::from_chars(begin, end, number);
  return wrong == std::errc() && read == end;
}

}  // namespace

Result<std::optional<StoredAuthor>> read_author(const fs::path& folder, const fs::path& store_file) {
  const fs::path file = folder / kAuthorFile;
  std::error_code failed;
  const bool is_there = fs::exists(fs::symlink_status(file, failed));
  if (!is_there && failed && failed != std::errc::no_such_file_or_directory) {
    return std::unexpected(store_error(folder, "cannot be read: its file `author`: " + failed.message(), 3));
  }
  if (!is_there) return std::nullopt;
  const auto text = read_text_file(file, kAuthorLimit);
  if (!text) return std::unexpected(text.error());
  const auto fields = fields_of(std::string_view(*text).substr(0, text->find('\n')));
  StoredAuthor stored;
  if (!read_number(fields[0], stored.author.value) || stored.author == replication::kNoAuthor ||
      stored.author.value > replication::kAuthorMax || !text->ends_with('\n')) {
    return std::unexpected(store_error(
        folder, "is damaged: its file `author` is not a number; without that file, the peer begins a log of its own",
        1));
  }
  stored.is_original = read_number(fields[3], stored.log_bytes) && identity_of(file) == fields[1] &&
                       identity_of(store_file) == fields[2];
  return stored;
}

Result<void> write_author(const fs::path& folder, const fs::path& store_file, AuthorId author,
                          std::uint64_t log_bytes) {
  assert(author != replication::kNoAuthor);
  const fs::path unfinished = folder / (std::string(kAuthorFile) + ".new");
  std::error_code failed;
  fs::remove(unfinished, failed);  // the file must be a new one
  if (failed) return std::unexpected(unwritable(folder, failed.message()));
  if (const auto made = write_text_file(unfinished, ""); !made) return made;
  const auto self = identity_of(unfinished), store = identity_of(store_file);
  if (!self || !store) return std::unexpected(unwritable(folder, std::strerror(errno)));
  const std::string line = fmt::format("{} {} {} {}\n", author.value, *self, *store, log_bytes);
  if (const auto written = write_text_file(unfinished, line); !written) return written;
  failed = put_in_place(unfinished, folder / kAuthorFile);
  if (failed) return std::unexpected(unwritable(folder, failed.message()));
  return {};
}

Result<void> remove_author(const fs::path& folder) {
  std::error_code failed;
  fs::remove(folder / kAuthorFile, failed);
  if (!failed) failed = synchronise(folder);
  if (failed) return std::unexpected(unwritable(folder, "it cannot be removed: " + failed.message()));
  return {};
}

}  // namespace peerd::store
