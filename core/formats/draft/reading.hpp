#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <expected>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/vrml/document.hpp"
#include "core/vrml/parse_options.hpp"

namespace peerd::formats {

// Asked lists what a few bytes of a file can ask for in large numbers.
enum class Asked : std::uint8_t {
  kNodes,
  kReferences,  // of nodes to nodes
  kValues,      // numbers of 32 bits, or as many bytes of images
  kCorners,     // of polygons and lines
};
inline constexpr std::size_t kAskedKinds = 4;

// An Expansion counts what the files of a world that are no VRML97 have asked for, all of them together: many short
// files must not grow to many times their size either.
using Expansion = std::array<std::uint64_t, kAskedKinds>;  // by Asked

// A Reading is the state that every reader of a file that is no VRML text has: the file, the document that it becomes,
// and what is said about it.
class Reading {
 public:
  // `begin` is the position of the file's first byte. `so_far` has the files of the same world that were read before.
  Reading(vrml::Document& to, vrml::Problems& reported, const vrml::ParseOptions& asked, vrml::Position begin,
          Expansion& so_far)
      : document(to), problems(reported), options(asked), begin_(begin), so_far_(so_far) {}
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;

  // Reports why the file cannot be read. The result is false, for the caller to return.
  bool fail(std::size_t offset, std::string why) {
    problems.error(at(offset), std::move(why));
    return false;
  }
  // Notes that a part of the file, which stands at `place`, is not kept. However many places lose a thing in the same
  // words, report_losses() says it once.
  void lose(std::string_view what, std::string_view place);
  void report_losses();
  void warn(std::size_t offset, std::string what) { problems.warning(at(offset), std::move(what)); }
  [[nodiscard]] vrml::Position at(std::size_t offset) const { return begin_ + static_cast<vrml::Position>(offset); }

  // Returns whether the document may grow by `more` nodes. A node needs some hundred bytes of
  // memory, and the smallest part of a file that asks for one a dozen.
  [[nodiscard]] bool has_room(std::uint64_t more = 0) const {
    const std::uint64_t nodes = so_far_[static_cast<std::size_t>(Asked::kNodes)] + document.nodes.size() + more;
    return nodes <= std::min<std::uint64_t>(most(Asked::kNodes), options.limits.nodes);
  }
  // Counts what the file asks for. The result is false, and nothing is counted, where that is more than files of this
  // size may ask for.
  [[nodiscard]] bool take(Asked what, std::uint64_t count) {
    std::uint64_t& taken = so_far_[static_cast<std::size_t>(what)];
    if (count > most(what) - std::min(most(what), taken)) return false;
    taken += count;
    return true;
  }
  // Loads a file that this one names, which becomes a part of the world: once, however often and by whatever URLs it is
  // named. The error says why there is none.
  [[nodiscard]] std::expected<std::string_view, std::string> load(std::string_view url, TextKind kind);

  // Loads an image and returns it as a data: URL, so that it goes wherever the scene goes. It counts among the values.
  [[nodiscard]] std::expected<std::string, std::string> load_image(std::string_view url);

  // Adds a point of the file [the file's units] to `points` [m, binary32, +Y up]; false where it is too far away for
  // that, or no number.
  [[nodiscard]] bool add_point(double x, double y, double z, std::vector<float>& points) const {
    const Conversion& c = options.conversion;
    const double unit = c.metres_per_unit;
    const auto add = [&points](double value) {
      const auto rounded = static_cast<float>(value);
      points.push_back(rounded);
      return std::isfinite(rounded);
    };
    const bool first = add(x * unit);
    const bool second = add((c.z_up ? z : y) * unit);
    const bool third = add((c.z_up ? -y : z) * unit);
    return first && second && third;
  }

  vrml::Document& document;
  vrml::Problems& problems;
  const vrml::ParseOptions& options;

 private:
  // All files of a world together may ask for `base`, whatever their size, and for `of_64_bytes` more for each 64 of
  // their bytes. A stepping quaternion of four bytes becomes fifteen values. Corners are counted as indices. A byte is
  // at most one index, but geometries that share indices are counted each.
  struct Rate {
    std::uint64_t base, of_64_bytes;
  };
  static constexpr std::array<Rate, kAskedKinds> kRates{
      {{1U << 15, 1}, {1U << 19, 32}, {1U << 20, 256}, {1U << 20, 128}}};
  [[nodiscard]] std::uint64_t most(Asked what) const {
    const Rate& rate = kRates[static_cast<std::size_t>(what)];
    return options.limits.expansion * (rate.base + problems.bytes() * rate.of_64_bytes / 64);
  }

  struct Loss {
    std::string place;  // the first
    std::size_t count = 0;
  };

  vrml::Position begin_;
  std::map<std::string, Loss, std::less<>> losses_;
  std::map<std::string, std::string_view, std::less<>> loaded_;  // by URL, and by the name of the file
  Expansion& so_far_;
  bool reads_too_much_ = false;  // the same files by other URLs: no further URL is loaded
};

inline constexpr std::string_view kTooManyNodes =
    "with this one there are more nodes than a file of this size may ask for; the option expansion allows more";
inline constexpr std::string_view kTooManyValues =
    "with it there are more values than a file of this size may ask for; the option expansion allows more";
inline constexpr std::string_view kBadPoint = "a coordinate is no number that binary32 can hold";

}  // namespace peerd::formats
