#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "peerd/input/console/columns.hpp"

namespace peerd {

using PeerNames = std::map<std::uint64_t, std::string>;  // by the peer's number

// Objects of a reply to "objects" or "status", a row for each: path, owner's name or, where it has none in `names`, its
// number, speed [m/s], position in the world [m], and, of the peer's own, how far its ghost is from the truth [m];
// last, what else moves or hides it.
[[nodiscard]] std::vector<Column> object_columns(const nlohmann::ordered_json& objects, const PeerNames& names = {});

// Other peers of a reply to "peers", a row for each: name, number, delay and round trip [ms], how far its clock is
// ahead [ms] and the error that it publishes [ms], losses in both directions [%], datagrams and bytes that came.
[[nodiscard]] std::vector<Column> peer_columns(const nlohmann::ordered_json& reply);

// The rows as lines, headings first. It is empty where there is no row.
[[nodiscard]] std::string table_of(const std::vector<Column>& columns);

}  // namespace peerd
