#pragma once
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/formats/world_kind.hpp"
#include "core/scene/reader.hpp"
#include "core/settings/world_settings.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/input/world_archive.hpp"

namespace peerd {

// The path that a URL names, with %-escapes resolved. It is empty where the URL names no file of this machine.
[[nodiscard]] std::optional<std::filesystem::path> local_path(std::string_view url);

// The loader reads the files behind the URLs of Inlines and EXTERNPROTOs: regular files of this machine, by relative
// path, absolute path or file: URL, with %-escapes resolved. It refuses any other URL by name and fetches nothing over
// a network, nor a file of more than `text_bytes`.
[[nodiscard]] FileLoader local_files(std::uint64_t text_bytes = ReadLimits{}.text_bytes);

// How a world's files are read; see ReadOptions.
struct WorldReading {
  bool inlines_when_needed = false;  // ReadOptions::defer_inlines
  bool maps_hierarchies = false;     // hierarchyFiles are used, which no peer does (warn_of_inert_parts)
  std::uint32_t expansion = 1;       // ReadLimits::expansion; multiplies the size that the files may have, too
  bool keeps_archive = false;        // for somebody who passes the world on
  bool lenient = false;              // ReadOptions::lenient
  std::string name = {};             // worlds of one file and two names are two; empty: it has that of its file
  // Values of the side file's keys that count before those in it. Empty ones say nothing.
  std::string collide = {};  // all, none, or paths and patterns with commas between them
  std::string unit = {}, up = {};
};
inline constexpr std::uint32_t kExpansionMax = 1'000'000;

// A world with all files that it includes. A world with errors is a result too; a missing file is an error.
//
// A world that is read leniently and departs from the standard is what was understood: one text in strict VRML97, which
// `text`, `result` and archive_of() have. Whoever gets that text reads it strictly. The problems of the files
// themselves are in `as_written`.
struct WorldFile {
  // A URL of an Inline or an EXTERNPROTO that led to a file, in the order of reading.
  struct Load {
    std::string base, url, name;  // the file that has the URL, and the one that it led to
  };

  formats::WorldKind kind = formats::WorldKind::kVrml;
  bool has_unit = false, has_up = false;  // whether the side file says them
  std::string text;                       // ReadResult::sources may point into it
  ReadResult result;
  std::vector<Load> loads;
  std::string written_text;  // as_written->sources may point into it
  std::optional<ReadResult> as_written;

  // The problems of the files that people wrote, and those files.
  [[nodiscard]] const ReadResult& reported() const { return as_written ? *as_written : result; }
};
// The advice that goes with the errors of a world that is read strictly: that the option --lenient reads on from them.
// It is empty where it would not.
[[nodiscard]] std::string lenient_advice(const ReadResult& result);
// Reads a world's file of any format, with the side file beside it, or an archive (WorldArchive).
//
// The side file says what the format cannot: what collides with what, responses, owners, and the unit and the axis of
// the file's lengths (docs/reference/formats.md).
[[nodiscard]] Result<std::unique_ptr<const WorldFile>> read_world_file(const std::filesystem::path& path,
                                                                       const WorldReading& reading = {});
// Reads a world whose bytes, of a VRML file or an archive, are here already; `name` stands for its path.
[[nodiscard]] Result<std::unique_ptr<const WorldFile>> read_world_bytes(std::string bytes,
                                                                        const std::filesystem::path& name,
                                                                        const WorldReading& reading);
// Reads a world from a stream, such as standard input. The URLs in it start from the current folder.
[[nodiscard]] Result<std::unique_ptr<const WorldFile>> read_world_stream(std::istream& in, const WorldReading& reading);

// The side file of WORLD.glb is WORLD.glb.peerd.toml, its long name, or WORLD.peerd.toml, its short one. The short name
// is only for a world that shares it with no other world in its folder.
inline constexpr std::string_view kSideEnding = ".peerd.toml";
[[nodiscard]] std::filesystem::path long_side_file(const std::filesystem::path& world);
[[nodiscard]] std::filesystem::path short_side_file(const std::filesystem::path& world);
// Returns the side file of a world: that with the long name, or else that with the short one; nothing where there is
// none. Error: it cannot be read, or it may be another world's.
[[nodiscard]] Result<std::optional<std::filesystem::path>> find_side_file(const std::filesystem::path& world);
// Returns the name for a new side file of a world.
[[nodiscard]] std::filesystem::path new_side_file(const std::filesystem::path& world);

// Reads the text of a side file. Errors begin with `name`.
[[nodiscard]] Result<WorldSettings> read_side_file(const std::string& text, const std::string& name);
// Returns the text of a side file with the values of `reading` in the place of its own.
[[nodiscard]] Result<std::string> with_options(const std::string& text, const std::string& name,
                                               const WorldReading& reading);

// All that has been read of a world, as one archive.
[[nodiscard]] WorldArchive archive_of(const WorldFile& world);

}  // namespace peerd
