#include "peerd/cli/client/peer_tables.hpp"

#include <cstdint>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "core/math.hpp"

namespace peerd {
namespace {

using Json = nlohmann::ordered_json;

Vec3 vector_of(const Json& v) { return {v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>()}; }

std::string number_or_dash(const Json& value, int decimals, double scale = 1.0) {
  return value.is_null() ? "-" : fixed(scale * value.get<double>(), decimals);
}

std::string remark_on(const Json& object) {
  if (!object.value("heard", true)) return "not received here";
  if (object.value("outside", false)) return "by a program outside";
  return object.at("driven").get<bool>() ? "by a formula" : "";
}

std::string remarks_on(const Json& object) {
  std::string remarks = remark_on(object);
  const auto add = [&](const std::string& remark) { remarks += (remarks.empty() ? "" : ", ") + remark; };
  if (object.contains("differs_m")) add(fmt::format("peers differ by {:.3g} m", object.at("differs_m").get<double>()));
  if (object.contains("locked_by")) add("locked by " + object.at("locked_by").get<std::string>());
  return remarks;
}

}  // namespace

std::vector<Column> object_columns(const Json& objects, const PeerNames& names) {
  Column path{"", "object", false, {}}, owner{"", "owner", names.empty(), {}}, speed{"", "m/s", true, {}},
      position{"", "at [m]", false, {}}, error{"", "ghost error [m]", true, {}}, remark{"", "", false, {}};
  for (const Json& object : objects) {
    const Vec3 at = vector_of(object.at("position_m"));
    path.cells.push_back(object.at("path").get<std::string>());
    const auto number = object.at("owner").get<std::uint64_t>();
    const auto named = names.find(number);
    owner.cells.push_back(named != names.end() ? named->second : std::to_string(number));
    speed.cells.push_back(fixed(vector_of(object.at("velocity_m_s")).norm(), 2));
    position.cells.push_back(fmt::format("{:.2f} {:.2f} {:.2f}", at.x(), at.y(), at.z()));
    error.cells.push_back(number_or_dash(object.value("ghost_error_m", Json(nullptr)), 4));
    remark.cells.push_back(remarks_on(object));
  }
  return {path, owner, speed, position, error, remark};
}

std::vector<Column> peer_columns(const Json& reply) {
  Column name{"", "peer", false, {}}, id{"", "id", true, {}}, delay{"", "delay [ms]", true, {}},
      round_trip{"", "round trip [ms]", true, {}}, ahead{"clock", "ahead [ms]", true, {}},
      error{"clock", "error [ms]", true, {}}, lost_here{"lost", "here [%]", true, {}},
      lost_there{"lost", "there [%]", true, {}}, datagrams{"received", "datagrams", true, {}},
      bytes{"received", "bytes", true, {}}, differ{"ghosts", "differ", true, {}};
  for (const Json& peer : reply.at("peers")) {
    const bool is_followed = reply.at("clock").at("follows") == peer.at("id");
    name.cells.push_back(peer.at("name").get<std::string>() + (is_followed ? " (followed)" : ""));
    id.cells.push_back(std::to_string(peer.at("id").get<std::uint64_t>()));
    delay.cells.push_back(number_or_dash(peer.at("delay_ms"), 3));
    round_trip.cells.push_back(number_or_dash(peer.at("round_trip_ms"), 3));
    ahead.cells.push_back(number_or_dash(peer.at("clock_ahead_ms"), 3));
    error.cells.push_back(number_or_dash(peer.at("clock_error_ms"), 3));
    lost_here.cells.push_back(number_or_dash(peer.at("loss_in"), 1, 100.0));
    lost_there.cells.push_back(number_or_dash(peer.at("loss_out"), 1, 100.0));
    datagrams.cells.push_back(std::to_string(peer.at("datagrams_in").get<std::uint64_t>()));
    bytes.cells.push_back(std::to_string(peer.at("bytes_in").get<std::uint64_t>()));
    const auto differing = peer.value("ghosts_differ", std::uint64_t{0});
    const auto explained = peer.value("ghosts_differ_explained", std::uint64_t{0});
    differ.cells.push_back(std::to_string(differing) + (explained > 0 ? " +" + std::to_string(explained) : ""));
  }
  return {name, id, delay, round_trip, ahead, error, lost_here, lost_there, datagrams, bytes, differ};
}

std::string table_of(const std::vector<Column>& columns) {
  std::string lines;
  if (!columns.empty() && !columns.front().cells.empty()) append_rows(lines, columns);
  return lines;
}

}  // namespace peerd
