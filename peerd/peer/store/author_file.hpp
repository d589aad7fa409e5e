#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

#include "peerd/input/input_error.hpp"
#include "peerd/peer/store/file_folder.hpp"
#include "replication/edits/log/log_signer.hpp"

namespace peerd::store {

// The file `author` of a store says whose log its peer writes on. It is one line of five fields:
//
//   AUTHOR SELF STORE BYTES SALT
//
// SELF and STORE identify this file itself and the store's file (FileFolder::identity), which no copy shares. BYTES
// is how much of the author's log the store had, at least, when the line was written.
// AUTHOR and SALT are those of replication::Author.
inline constexpr const char* kAuthorFile = "author";

struct StoredAuthor {
  replication::Author author;
  std::uint64_t log_bytes = 0;
  // The file and the store's file are those for which the line was written. Else they are copies, or older ones that
  // have been put back, and the author may have written on elsewhere.
  bool is_original = false;
};

// None: there is no such file. The error says that it cannot be read, or is no author. `store_file`: the name of the
// store's file in the folder.
[[nodiscard]] Result<std::optional<StoredAuthor>> read_author(const FileFolder& folder, std::string_view store_file);
// The file is a new one, and whole, or as it was before.
[[nodiscard]] Result<void> write_author(FileFolder& folder, std::string_view store_file, replication::Author author,
                                        std::uint64_t log_bytes);
// There is no such file afterwards, not even after a power cut.
[[nodiscard]] Result<void> remove_author(FileFolder& folder);

}  // namespace peerd::store
