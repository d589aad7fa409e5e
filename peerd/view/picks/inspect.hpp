#pragma once
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/ids.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd::view {

// The reply to "inspect" of an instance that is there: {"id","path","def","type","owner","own","driven","threshold_m",
// "fields":{NAME:VRML TEXT},"data":{KEY:VALUE}}. Fields are those that the world's text gives, or edits have set; a
// value of nodes, or one that is long, is cut. NAME of a node field is written as TYPE { .. }.
[[nodiscard]] nlohmann::ordered_json inspect(const PeerNode& node, ObjectId object);
// The same of any node, by a path as find_node() takes it. Where it is no instance, "id" is null, "path" is as it was
// asked for, and nobody owns it. {"ok":false,"error"}: there is none.
[[nodiscard]] nlohmann::ordered_json inspect(const PeerNode& node, const std::string& path);

}  // namespace peerd::view
