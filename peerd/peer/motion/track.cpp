#include "peerd/peer/motion/track.hpp"
#include "peerd/input/number.hpp"
#include "peerd/input/text_file.hpp"

#include <algorithm>
#include <expected>
#include <string>
#include <string_view>

#include "peerd/peer/motion/waypoints.hpp"

namespace peerd::motion {
namespace {

constexpr std::string_view kPlaces = "t,x,y,z", kPoses = "t,x,y,z,qw,qx,qy,qz";

// The numbers between the commas. The error says which one is none.
std::expected<std::vector<double>, std::string> numbers(std::string_view line) {
  std::vector<double> row;
  for (;;) {
    const std::size_t comma = std::min(line.find(','), line.size());
    std::string_view cell = line.substr(0, comma);
    while (cell.starts_with(' ')) cell.remove_prefix(1);
    while (cell.ends_with(' ')) cell.remove_suffix(1);
    const auto x = parse_number(cell, kCoordinates);
    if (!x) return std::unexpected(x.error());
    row.push_back(*x);
    if (comma == line.size()) return row;
    line.remove_prefix(comma + 1);
  }
}

struct Rows {
  std::vector<std::vector<double>> rows;
  std::vector<std::size_t> lines;  // line number of each row, from 1
  std::size_t columns = 4;
};

Result<Rows> read_rows(const std::filesystem::path& file) {
  const auto text = read_text_file(file, kTrackFile);
  if (!text) return std::unexpected(text.error());
  Rows read;
  std::string_view rest = *text;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    const auto fail = [&](const std::string& sentence) {
      return std::unexpected(InputError{file.string() + ":" + std::to_string(number) + ": error: " + sentence});
    };
    if (number == 1) {
      if (line != kPlaces && line != kPoses) {
        return fail("the first line must be " + std::string(kPlaces) + " or " + std::string(kPoses));
      }
      read.columns = line == kPlaces ? 4 : 8;
      continue;
    }
    if (line.empty()) continue;
    auto row = numbers(line);
    if (!row || row->size() != read.columns) {
      return fail("write " + std::to_string(read.columns) + " numbers with commas between them" +
                  (row ? "" : "; " + row.error()));
    }
    if (read.columns == 8 && Quat((*row)[4], (*row)[5], (*row)[6], (*row)[7]).norm() == 0.0) {
      return fail("the orientation must not be zero");
    }
    read.rows.push_back(std::move(*row));
    read.lines.push_back(number);
  }
  if (read.rows.empty()) return std::unexpected(InputError{file.string() + ": error: the track has no rows"});
  return read;
}

}  // namespace

Result<LoadedTrack> load_track(const Track& track) {
  auto read = read_rows(track.file);
  if (!read) return std::unexpected(read.error());
  const Waypoints points{read->rows, track.loop, track.corners};
  if (const auto wrong = check(points)) {
    return std::unexpected(InputError{track.file.string() + ":" + std::to_string(read->lines[wrong->row]) +
                                      ": error: " + wrong->sentence});
  }
  LoadedTrack loaded{waypoint_knots(points), read->columns == 8};
  if (loaded.turns) {
    std::vector<Quat> orientations;
    for (const auto& row : read->rows) orientations.push_back(Quat(row[4], row[5], row[6], row[7]).normalized());
    turn_through(orientations, points, loaded.knots);
  }
  return loaded;
}

}  // namespace peerd::motion
