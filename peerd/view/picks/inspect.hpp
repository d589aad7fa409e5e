#pragma once
#include <nlohmann/json_fwd.hpp>

#include "core/ids.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd::view {

// The reply to "inspect" of an instance that is there: {"id","path","def","type","owner","own","driven","threshold_m",
// "fields":{NAME:VRML TEXT},"data":{KEY:VALUE}}. Fields are those that the world's text gives, or edits have set; a
// value of nodes, or one that is long, is cut. NAME of a node field is written as TYPE { .. }.
[[nodiscard]] nlohmann::ordered_json inspect(const PeerNode& node, ObjectId object);

}  // namespace peerd::view
