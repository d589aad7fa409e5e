#pragma once
#include <span>
#include <string>

#include "peerd/measure/run_record.hpp"

namespace peerd::report {

// Tables for other programs (RFC 4180 with line feeds; a heading line; runs count from 1 as in run-001.svg). Numbers
// are the shortest decimal that reads back to the same binary64, so the same records give the same bytes.

// A row a belief: run,t_s,observer,object,truth_x,truth_y,truth_z,ghost_x,..,shown_z,ghost_error_m,shown_error_m,
// ghost_angle_error_rad. Metres and radians, world frame.
[[nodiscard]] std::string errors_csv(std::span<const RunRecord> runs);

// A row an update and a row a datagram, by time, the updates of an instant first: run,t_s,sender,kind,object,bytes,
// threshold_m,reason. Bytes of an update are inside those of its datagram: sum over one kind only.
[[nodiscard]] std::string traffic_csv(std::span<const RunRecord> runs);

// A row a contact, by contact time:
// run,t_s,peer,kind,collider,collidee,normal_x,normal_y,normal_z,reported_at_s,verdict (agreement.hpp). Missed contacts
// have no row: nobody said anything.
[[nodiscard]] std::string collisions_csv(std::span<const RunRecord> runs);

}  // namespace peerd::report
