#include "peerd/cli/client/peer_tables.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace peerd::peer_tables_test {

using nlohmann::ordered_json;

const ordered_json kObjects = ordered_json::parse(R"([
  {"id":0,"path":"CAR","owner":1,"own":true,"driven":true,"outside":false,"locked_by":"anna","position_m":[1,2.5,-3],
   "velocity_m_s":[3,0,4],"ghost_error_m":0.0125},
  {"id":1,"path":"TOWN/BOX","owner":22,"own":false,"driven":false,"outside":false,"position_m":[0,0,0],
   "velocity_m_s":[0,0,0],"heard":false}])");

TEST(PeerTables, AnObjectHasItsOwnersNameOrNumber) {
  EXPECT_EQ(table_of(object_columns(kObjects, {{1, "ada"}})),
            "object    owner   m/s  at [m]           ghost error [m]\n"
            "CAR       ada    5.00  1.00 2.50 -3.00           0.0125  by a formula, locked by anna\n"
            "TOWN/BOX  22     0.00  0.00 0.00 0.00                 -  not received here\n");
  EXPECT_EQ(object_columns(kObjects)[1].cells, (std::vector<std::string>{"1", "22"}));
}

TEST(PeerTables, NoRowsAreNoTable) { EXPECT_EQ(table_of(object_columns(ordered_json::array())), ""); }

TEST(PeerTables, WhatIsNotKnownOfAPeerIsADash) {
  const ordered_json reply = ordered_json::parse(R"({"clock":{"follows":7},"peers":[
    {"id":7,"name":"ben","delay_ms":0.25,"round_trip_ms":null,"clock_ahead_ms":-1.5,"clock_error_ms":0.125,
     "loss_in":0.015,"loss_out":null,"datagrams_in":12,"bytes_in":3456,"ghosts_differ":2,
     "ghosts_differ_explained":3}]})");
  const auto columns = peer_columns(reply);
  std::vector<std::string> row;
  for (const Column& column : columns) row.push_back(column.cells.at(0));
  EXPECT_EQ(row, (std::vector<std::string>{"ben (followed)", "7", "0.250", "-", "-1.500", "0.125", "1.5", "-", "12",
                                           "3456", "2 +3"}));
}

}  // namespace peerd::peer_tables_test
