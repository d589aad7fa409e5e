#pragma once
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/around.hpp"
#include "core/scene/scene.hpp"
#include "core/vrml/diagnostics.hpp"
#include "core/vrml/file_loader.hpp"
#include "core/vrml/parse_options.hpp"

namespace peerd {

struct ReadOptions {
  std::string name;  // name of the world, for people; relative URLs start from it
  FileLoader load;   // reads Inlines and EXTERNPROTOs; without it none is found, and each says so
  // An Inline that says how large it is (bboxSize) and is not within anything that a CollisionInterest names is not
  // read, but listed in Scene::pending_inlines. Instances are numbered without it, so all peers of a session must use
  // the same value.
  bool defer_inlines = false;
  Tessellation tessellation{};  // fineness of curved geometry
  ReadLimits limits{};
  vrml::Around around{};  // of a text that is added to a world
  // Neither the text nor its Inlines may be of another format, as in a text that is added to a world which runs: what
  // such a text may expand to is limited for VRML97 alone (ReadLimits::of_added).
  bool only_vrml = false;
  // The times of TimeSensors count from the world's beginning, as in a text that is added to a world which runs. The
  // times in a file count from 1970 (core/animation/file_times.hpp).
  bool world_times = false;
  // Departures from the standard that browsers read on from are warnings (docs/reference/lenient.md). The scene is then
  // what was understood, and write_world() says it in strict VRML97.
  bool lenient = false;
  Conversion conversion{};  // of the lengths and axes of a file that is no VRML97
  // Changes the document of a world before the scene is made of it (core/settings).
  std::function<void(vrml::Document&, vrml::Problems&)> amend;
};

struct ReadResult {
  std::optional<Scene> scene;           // there exactly where no diagnostic is an error
  std::vector<Diagnostic> diagnostics;  // in the order of the texts
  std::size_t faults = 0;               // departures that a lenient reading goes on from
  std::vector<Source> sources;          // the world's own text first; `text` of that is the caller's unless unpacked
};

// Reads a world of any format (core/formats/world_kind.hpp). VRML97 (ISO/IEC 14772-1) has the extensions of appendix C
// of the thesis, and its text may be packed with gzip. The result is a pure function of the text and of what `load`
// gives: no file is opened here. All problems that one reading finds are reported. Time is linear in the texts and in
// what they expand to for worlds as people write them, memory a small multiple of what is kept; what both can grow to
// is limited (ReadLimits).
[[nodiscard]] ReadResult read_world(std::string_view text, const ReadOptions& options = {});

// Reads the content of an Inline that was left for later, with options like those of its world: a scene of its own, in
// the frame of the Inline.
[[nodiscard]] ReadResult read_inline(const PendingInline& pending, const ReadOptions& options);

[[nodiscard]] std::string render(const ReadResult& result, const Diagnostic& diagnostic);

// Returns a number for a world and all files that it is made of, in the order in which they were read (FNV-1a). Peers
// of one session compare it.
[[nodiscard]] std::uint64_t content_hash(const ReadResult& result);

}  // namespace peerd
