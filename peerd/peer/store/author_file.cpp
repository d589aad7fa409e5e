#include "peerd/peer/store/author_file.hpp"

#include <array>
#include <cassert>
#include <charconv>
#include <string>
#include <string_view>
#include <system_error>

#include <spdlog/fmt/fmt.h>

#include "peerd/peer/store/store_error.hpp"

namespace peerd::store {
namespace {

using replication::Author;

// A longer file is no author.
constexpr std::size_t kAuthorMax_bytes = 256;

InputError failure(const FileFolder& folder, const char* what, const std::error_code& why) {
  return store_error(folder.path(), fmt::format("cannot be {}: its file `{}`: {}", what, kAuthorFile, why.message()),
                     3);
}

std::array<std::string_view, 5> fields_of(std::string_view line) {
  std::array<std::string_view, 5> fields;
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

Result<std::optional<StoredAuthor>> read_author(const FileFolder& folder, std::string_view store_file) {
  const auto size = folder.size(kAuthorFile);
  if (!size) return std::unexpected(failure(folder, "read", size.error()));
  if (!*size) return std::nullopt;
  const auto text = folder.read(kAuthorFile, kAuthorMax_bytes + 1);
  if (!text) return std::unexpected(failure(folder, "read", text.error()));
  const auto fields = fields_of(std::string_view(*text).substr(0, text->find('\n')));
  StoredAuthor stored;
  if (text->size() > kAuthorMax_bytes || !read_number(fields[0], stored.author.id.value) ||
      stored.author.id == replication::kNoAuthor || stored.author.id.value > replication::kAuthorMax ||
      !text->ends_with('\n')) {
    return std::unexpected(store_error(
        folder.path(),
        "is damaged: its file `author` is not a number; without that file, the peer begins a log of its own", 1));
  }
  const auto self = folder.identity(kAuthorFile), store = folder.identity(store_file);
  if (!self) return std::unexpected(failure(folder, "read", self.error()));
  if (!store) return std::unexpected(failure(folder, "read", store.error()));
  // Nobody has signed what earlier versions wrote: they had no salt.
  if (!fields[4].empty() && !read_number(fields[4], stored.author.salt)) stored.author.salt = 0;
  stored.is_original = read_number(fields[3], stored.log_bytes) && *self == fields[1] && *store == fields[2];
  return stored;
}

Result<void> write_author(FileFolder& folder, std::string_view store_file, Author author, std::uint64_t log_bytes) {
  assert(author.id != replication::kNoAuthor);
  const auto unwritten = [&](const std::error_code& why) { return std::unexpected(failure(folder, "written", why)); };
  const std::string unfinished = std::string(kAuthorFile) + ".new";
  // The file must be a new one.
  if (const auto failed = folder.remove(unfinished)) return unwritten(failed);
  if (const auto failed = folder.write(unfinished, "")) return unwritten(failed);
  const auto self = folder.identity(unfinished), store = folder.identity(store_file);
  if (!self) return unwritten(self.error());
  if (!store) return unwritten(store.error());
  const std::string line = fmt::format("{} {} {} {} {}\n", author.id.value, *self, *store, log_bytes, author.salt);
  if (const auto failed = folder.write(unfinished, line)) return unwritten(failed);
  if (const auto failed = folder.put_in_place(unfinished, kAuthorFile)) return unwritten(failed);
  return {};
}

Result<void> remove_author(FileFolder& folder) {
  std::error_code failed = folder.remove(kAuthorFile);
  if (!failed) failed = folder.synchronise();
  if (failed) {
    return std::unexpected(store_error(
        folder.path(),
        fmt::format("cannot be written: its file `{}`: it cannot be removed: {}", kAuthorFile, failed.message()), 3));
  }
  return {};
}

}  // namespace peerd::store
