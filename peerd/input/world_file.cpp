#include "peerd/input/world_file.hpp"
#include "core/motion/inert_parts.hpp"
#include "core/vrml/gzip.hpp"
#include "core/writer/writer.hpp"
#include "peerd/input/text_file.hpp"

#include <algorithm>
#include <charconv>
#include <istream>
#include <map>
#include <set>
#include <utility>

namespace peerd {
namespace {

constexpr std::string_view kWorldAdvice = "the option expansion allows more, up to 4095 MiB";

}  // namespace

std::optional<std::filesystem::path> local_path(std::string_view url) {
  if (url.starts_with("file:")) {
    url.remove_prefix(5);
    if (url.starts_with("//localhost/")) url.remove_prefix(11);
    if (url.starts_with("//")) url.remove_prefix(2);
  } else if (const std::size_t colon = url.find(':'); colon != std::string_view::npos && colon > 1) {
    // http:, urn: and javascript: name no file. A single letter is a drive of another operating system; it is tried as
    // a file and not found.
    if (url.substr(0, colon).find_first_of("/.\\") == std::string_view::npos) return std::nullopt;
  }
  std::string path;
  for (std::size_t i = 0; i < url.size(); ++i) {
    unsigned char byte = 0;
    const char* const digits = url.data() + i + 1;
    if (url[i] == '%' && i + 2 < url.size() && std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2 &&
        byte != 0) {
      path += static_cast<char>(byte);
      i += 2;
    } else {
      path += url[i];
    }
  }
  if (path.empty()) return std::nullopt;
  return path;
}

FileLoader local_files(std::uint64_t text_bytes) {
  return [text_bytes](std::string_view url, std::string_view base) -> std::expected<LoadedFile, std::string> {
    const auto named = local_path(url);
    if (!named) return std::unexpected("it is no file of this machine");
    const std::filesystem::path path = (std::filesystem::path(base).parent_path() / *named).lexically_normal();
    std::error_code error;
    if (!std::filesystem::exists(path, error)) {
      return std::unexpected(error ? "it can't be read: " + error.message() : "there is no such file");
    }
    if (!std::filesystem::is_regular_file(path, error)) return std::unexpected("it is no regular file");
    if (std::filesystem::file_size(path, error) > text_bytes) return std::unexpected("it is too large");
    auto bytes = read_text_file(path, {text_bytes, kWorldAdvice});
    if (!bytes) {
      const std::string& why = bytes.error().text;  // NAME: error: can't be read: REASON
      const std::size_t said = why.find("can't be read");
      return std::unexpected("it " + (said == std::string::npos ? "can't be read" : why.substr(said)));
    }
    // Links and detours lead to one canonical name, so that a file that includes itself is recognised.
    const std::filesystem::path one = std::filesystem::canonical(path, error);
    return LoadedFile{error ? path.string() : one.string(), std::move(*bytes)};
  };
}

namespace {

// Positions in the texts of a world have 32 bits.
std::uint64_t text_bytes_max(const WorldReading& reading) {
  return std::min<std::uint64_t>(ReadLimits{}.text_bytes * reading.expansion, 4095 * kMiB);
}

// The files around the world at `path`, which keeps the name by which it was asked for, wherever another file names it.
FileLoader files_around(const std::filesystem::path& path, std::uint64_t text_bytes) {
  std::error_code error;
  const std::string one = std::filesystem::canonical(path, error).string();
  return [files = local_files(text_bytes), one, name = path.string()](std::string_view url, std::string_view base) {
    auto loaded = files(url, base);
    if (loaded && loaded->name == one) loaded->name = name;
    return loaded;
  };
}

// The loader gives what `load` gives, and notes it in `loads`.
FileLoader noting(FileLoader load, std::vector<WorldFile::Load>& loads) {
  return [load = std::move(load), &loads](std::string_view url, std::string_view base) {
    auto loaded = load(url, base);
    if (loaded) loads.push_back({std::string(base), std::string(url), loaded->name});
    return loaded;
  };
}

// The URL by which an archive has a world's side file: no file names it so.
constexpr std::string_view kSideUrl = "?peerd.toml";

// Reads the side file of a world, and makes `options` those that it asks for. The errors are those of the side file.
Result<void> read_settings(const std::filesystem::path& path, bool is_archived, const WorldReading& reading,
                           ReadOptions& options, WorldFile& file) {
  std::string text, name = new_side_file(path).string();
  if (is_archived) {
    if (auto found = options.load(kSideUrl, options.name)) {
      if (found->bytes.size() > kMiB) {
        return std::unexpected(InputError{path.string() + ": error: its side file is larger than 1 MiB", kFinding});
      }
      text = std::move(found->bytes);
      name = std::move(found->name);
    }
  } else {
    const auto side = find_side_file(path);
    if (!side) return std::unexpected(side.error());
    if (*side) {
      auto read = read_text_file(**side, {kMiB, "a side file says what to do with a world"});
      if (!read) return std::unexpected(read.error());
      text = std::move(*read);
      name = (*side)->string();
    }
  }
  auto complete = with_options(text, name, reading);
  if (!complete) return std::unexpected(complete.error());
  if (complete->empty()) return {};
  auto settings = read_side_file(*complete, name);
  if (!settings) return std::unexpected(settings.error());
  if (formats::is_text_of_nodes(file.kind) && (settings->has_unit || settings->has_up)) {
    return std::unexpected(InputError{
        name + ": error: a world in VRML97 or X3D says its unit, and has +Y up: unit and up say nothing of it",
        kFinding});
  }
  file.has_unit = settings->has_unit;
  file.has_up = settings->has_up;
  options.conversion = settings->conversion;
  Source source{name, {}, std::make_shared<const std::string>(std::move(*complete)), TextKind::kLines};
  source.text = *source.owned;
  options.amend = amender_of(std::move(*settings), std::move(source), options.limits);
  file.loads.push_back({options.name, std::string(kSideUrl), name});
  return {};
}

// Puts what was understood of a world in the place of its files, where they depart from the standard.
void become_strict(WorldFile& file, ReadOptions options) {
  if (!file.result.scene || file.result.faults == 0) return;
  file.as_written = std::move(file.result);
  file.result = {};
  file.written_text = std::exchange(file.text, {});
  file.loads.clear();
  std::string why;
  if (auto written = write_world(*file.as_written->scene)) {
    file.text = std::move(written->text);
    options.lenient = false;
    options.load = nullptr;  // the text needs no other file
    options.amend = nullptr;
    options.limits.text_bytes = std::max<std::uint64_t>(options.limits.text_bytes, file.text.size());
    file.result = read_world(file.text, options);
    if (file.result.scene) return;
    const auto& problems = file.result.diagnostics;
    why = std::ranges::find(problems, Severity::kError, &Diagnostic::severity)->message;
  } else {
    why = written.error();
  }
  // Its own departures are warnings; only this one is an error.
  file.result = *std::exchange(file.as_written, std::nullopt);
  file.result.scene.reset();
  file.text = std::exchange(file.written_text, {});
  file.result.diagnostics.push_back(
      {Severity::kError, {1, 1}, "what was understood of this world is no world in strict VRML97: " + why, 0, 0});
}

}  // namespace

std::string lenient_advice(const ReadResult& result) {
  const auto errors =
      static_cast<std::size_t>(std::ranges::count(result.diagnostics, Severity::kError, &Diagnostic::severity));
  const auto faults = static_cast<std::size_t>(std::ranges::count_if(
      result.diagnostics, [](const Diagnostic& d) { return d.severity == Severity::kError && d.is_fault; }));
  if (faults == 0) return {};
  const std::string which = faults == errors
                                ? (errors == 1 ? "it" : "them")
                                : std::to_string(faults) + " of these " + std::to_string(errors) + " errors";
  return "note: --lenient (lenient = true of a configuration) reads on from " + which +
         ", as browsers do, with warnings\n";
}

Result<std::unique_ptr<const WorldFile>> read_world_bytes(std::string text, const std::filesystem::path& path,
                                                          const WorldReading& reading) {
  auto file = std::make_unique<WorldFile>();
  ReadOptions options;
  options.name = path.string();
  options.defer_inlines = reading.inlines_when_needed;
  options.limits.expansion = reading.expansion;
  options.limits.text_bytes = text_bytes_max(reading);
  WorldArchive archive;
  if (is_archive(text)) {
    auto unpacked = unpack(text, options.limits.text_bytes);
    if (!unpacked) {
      return std::unexpected(
          InputError{path.string() + ": error: the archive cannot be read: " + unpacked.error(), kFinding});
    }
    archive = *std::move(unpacked);
    text = std::move(archive.files.front().text);
    options.load = archive.loader(options.name);
  } else {
    options.load = files_around(path, options.limits.text_bytes);
  }
  file->kind = formats::kind_of(text, options.name);
  const auto settings = read_settings(path, !archive.files.empty(), reading, options, *file);
  if (!settings) return std::unexpected(settings.error());
  options.load = noting(std::move(options.load), file->loads);
  file->text = std::move(text);
  options.lenient = reading.lenient;
  file->result = read_world(file->text, options);
  warn_of_inert_parts(file->result, reading.maps_hierarchies);
  if (reading.lenient) become_strict(*file, options);
  return file;
}

Result<std::unique_ptr<const WorldFile>> read_world_file(const std::filesystem::path& path,
                                                         const WorldReading& reading) {
  auto text = read_text_file(path, {text_bytes_max(reading), kWorldAdvice});
  if (!text) return std::unexpected(text.error());
  return read_world_bytes(std::move(*text), path, reading);
}

Result<std::unique_ptr<const WorldFile>> read_world_stream(std::istream& in, const WorldReading& reading) {
  constexpr const char* kName = "<stdin>";
  auto text = read_text(in, kName, {text_bytes_max(reading), kWorldAdvice});
  if (!text) return std::unexpected(text.error());
  return read_world_bytes(std::move(*text), kName, reading);
}

WorldArchive archive_of(const WorldFile& world) {
  WorldArchive archive;
  std::map<std::string_view, std::uint32_t> numbers;
  for (const Source& source : world.result.sources) {
    numbers.try_emplace(source.name, static_cast<std::uint32_t>(archive.files.size()));
    archive.files.push_back({"", std::string(source.text)});
  }
  std::set<std::pair<std::uint32_t, std::string_view>> known;
  for (const WorldFile::Load& load : world.loads) {
    const auto in = numbers.find(load.base), file = numbers.find(load.name);
    // A file that was found and could not be read is no part of the world.
    if (in == numbers.end() || file == numbers.end() || !known.emplace(in->second, load.url).second) continue;
    archive.urls.push_back({in->second, load.url, file->second});
    std::string& name = archive.files[file->second].name;
    if (file->second != 0 && name.empty()) name = load.url;
  }
  return archive;
}

}  // namespace peerd
