#pragma once
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <string_view>

#include "peerd/input/input_error.hpp"

namespace peerd {

inline constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

// The size from which on a file is not read, for a file may be endless (/dev/zero, a pipe). `advice` ends the sentence
// that says so: which option allows more, or what may be wrong.
struct SizeLimit {
  std::uint64_t bytes;
  std::string_view advice;
  int exit_code = 1;  // of the error
};
inline constexpr SizeLimit kSettingsFile{16 * kMiB, "no configuration is so long; is this one?", 2};
inline constexpr SizeLimit kTrackFile{256 * kMiB, "no track is so long; is this one?", 2};
inline constexpr SizeLimit kPeerLogFile{4096 * kMiB, "a shorter run leaves a shorter log"};

// Reads the whole content of a file. The error says why the file cannot be read and what to do.
[[nodiscard]] Result<std::string> read_text_file(const std::filesystem::path& path, const SizeLimit& limit);
// Reads all that a stream still gives; errors begin with `name`.
[[nodiscard]] Result<std::string> read_text(std::istream& in, const std::string& name, const SizeLimit& limit);

// Writes a file, over the one that is there. The error says why that fails. A file that can't be opened for it stays as
// it is; no half of a new one is left.
[[nodiscard]] Result<void> write_text_file(const std::filesystem::path& path, std::string_view text);
// The error of a file that can't be opened to be written, with the system's reason, an errno.
[[nodiscard]] InputError unwritable(const std::filesystem::path& path, int error);
// The same for a file that was opened, and so has lost what it had, but could not be written to its end. It is removed.
[[nodiscard]] InputError half_written(const std::filesystem::path& path, int error);

}  // namespace peerd
