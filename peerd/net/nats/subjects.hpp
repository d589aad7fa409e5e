#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "core/ids.hpp"

namespace peerd::nats {

// The subjects of one session's regions:
//
//   PREFIX.WORLD.any.0              region 0, the whole scene
//   PREFIX.WORLD.SESSION.REGION     any other region
//
// WORLD is the world's name as one token, SESSION the session's hash as 16 hexadecimal digits, REGION a decimal number.
// Region 0 is that of all worlds of one name, so that a peer that has another version of a world notices it.
class Subjects {
 public:
  // Precondition: net::is_subject(prefix), and the name of the world is not empty.
  Subjects(std::string_view prefix, std::string_view world, std::uint64_t session);

  [[nodiscard]] std::string of(RegionId region) const;
  // The subject of all regions but 0, with a wildcard; for people.
  [[nodiscard]] std::string all() const { return regions_ + "*"; }

 private:
  std::string whole_scene_, regions_;
};

// The text as one token: bytes other than letters, digits, '-' and '_' become '%' and two hexadecimal digits.
[[nodiscard]] std::string token(std::string_view text);

}  // namespace peerd::nats
