#pragma once
#include <boost/asio/ip/address.hpp>

#include "peerd/peer/record/setup.hpp"

namespace peerd::record {

// A setup of which no field has its default.
inline Setup some_setup(const net::GroupPlan& groups = {boost::asio::ip::make_address("ff15::1:0:0"), 47474, 9, 2048}) {
  Setup s;
  s.peer = "a";
  s.configuration = "x = \"ä\"\n";
  s.file = "/some/where/s.toml";
  s.world = "/some/where/w.wrl";
  s.world_hash = 0xFEDC'BA98'7654'3210;
  s.reading = {.inlines_when_needed = true, .expansion = 7};
  s.options.late = true;
  s.options.incarnation = ~std::uint64_t{0};
  s.options.wait_for = {{PeerId{1}, ""}, {PeerId{4'000'000'000}, ""}};
  s.options.start_lead = Duration{5};
  s.options.clock_offset = Duration{-3};
  s.options.keep_log = false;
  s.options.sample_hz = 50;
  s.groups = groups;
  return s;
}

}  // namespace peerd::record
