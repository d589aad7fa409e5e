#pragma once
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "core/vrml/file_loader.hpp"

namespace peerd {

// A URL in one file of an archive, and the file that it led to.
struct ArchivedUrl {
  std::uint32_t in = 0;  // the number of the file that has the URL
  std::string url;
  std::uint32_t leads_to = 0;
};

struct ArchivedFile {
  std::string name;  // for people; the world's own has none
  std::string text;  // unpacked
};

// A world with all files that it includes, as one sequence of bytes: read elsewhere, it gives the same world and the
// same content_hash(). Nothing in it depends on where the files were.
struct WorldArchive {
  std::vector<ArchivedFile> files;  // the world's own first
  std::vector<ArchivedUrl> urls;

  // A loader of the archive's files, which are called NAME#1, NAME#2 and so on; `name` is the world's own. What the
  // world looked for in vain when it was archived is not found here either. The archive outlives the loader.
  [[nodiscard]] FileLoader loader(std::string name) const;
};

// Whether a file's bytes are those of an archive.
[[nodiscard]] bool is_archive(std::string_view bytes);

// The bytes of an archive, compressed by zstd.
[[nodiscard]] std::string pack(const WorldArchive& archive);
// Parses hostile input: the error says in a few words what is wrong. No more than `text_bytes` are unpacked.
[[nodiscard]] std::expected<WorldArchive, std::string> unpack(std::string_view bytes, std::uint64_t text_bytes);

}  // namespace peerd
