#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>

#include "peerd/input/input_error.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::store {

// The file `author` of a store says whose log its peer writes on. It is one line of four fields:
//
//   AUTHOR SELF STORE BYTES
//
// SELF and STORE identify this file itself and the store's file by inode and time of birth, which no copy shares. BYTES
// is how much of the author's log the store had, at least, when the line was written.
inline constexpr const char* kAuthorFile = "author";

struct StoredAuthor {
  replication::AuthorId author;
  std::uint64_t log_bytes = 0;
  // The file and the store's file are those for which the line was written. Else they are copies, or older ones that
  // have been put back, and the author may have written on elsewhere.
  bool is_original = false;
};

// None: there is no such file. The error says that it cannot be read, or is no author.
[[nodiscard]] Result<std::optional<StoredAuthor>> read_author(const std::filesystem::path& folder,
                                                              const std::filesystem::path& store_file);
// The file is a new one, and whole, or as it was before.
[[nodiscard]] Result<void> write_author(const std::filesystem::path& folder, const std::filesystem::path& store_file,
                                        replication::AuthorId author, std::uint64_t log_bytes);
// There is no such file afterwards, not even after a power cut.
[[nodiscard]] Result<void> remove_author(const std::filesystem::path& folder);

}  // namespace peerd::store
