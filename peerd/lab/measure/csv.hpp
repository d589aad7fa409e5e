#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "peerd/lab/measure/run_record.hpp"

namespace peerd::measure {

// Tables for other programs (RFC 4180 with line feeds and a heading line; runs count from 1 as in report.html). Numbers
// are the shortest decimal that reads back to the same binary64, so the same records give the same bytes.

// How many rows a table has, of how many there were.
struct RowCount {
  std::uint64_t written = 0, of = 0;
};

// One row for each ghost sample, or, where there are more than `most` (none: all), for every n-th of a view; where
// there are too many views for some twenty rows each, of every m-th view:
// run,t_s,observer,object,truth_x,truth_y,truth_z,ghost_x,..,shown_z,ghost_error_m,shown_error_m,
// ghost_angle_error_rad. Metres and radians, world frame.
[[nodiscard]] std::string errors_csv(std::span<const RunRecord> runs, std::optional<std::size_t> most = std::nullopt);
[[nodiscard]] RowCount errors_rows(std::span<const RunRecord> runs, std::optional<std::size_t> most);

// One row for each update and each datagram, by time, the updates of an instant first, or, where there are more than
// `most`, every n-th of these rows:
// run,t_s,sender,kind,object,bytes, threshold_m,reason. The bytes of an update are part of its datagram's: sum over one
// kind only.
[[nodiscard]] std::string traffic_csv(std::span<const RunRecord> runs, std::optional<std::size_t> most = std::nullopt);
[[nodiscard]] RowCount traffic_rows(std::span<const RunRecord> runs, std::optional<std::size_t> most);

// One row for each contact, by contact time:
// run,t_s,peer,kind,collider,collidee,normal_x,normal_y,normal_z,reported_at_s,verdict (agreement.hpp). A missed
// contact has no row, because no peer stated it.
[[nodiscard]] std::string collisions_csv(std::span<const RunRecord> runs);

}  // namespace peerd::measure
