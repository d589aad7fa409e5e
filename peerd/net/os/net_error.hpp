#pragma once
#include <cstdint>
#include <string>

#include "peerd/input/input_error.hpp"

namespace peerd::net {

// The reason for which an operation on the network failed. The sentence is for a person: it says what is wrong and what
// to do about it.
struct NetError {
  enum class Kind : std::uint8_t {
    kNoSuchInterface,  // no interface of that name
    kNoMulticast,      // multicast does not work over the interface
    kPortBusy,         // another program holds the port and does not share it
    kPermission,       // the system forbids it
    kLimit,            // too many groups, files, regions
    kBadSetting,       // an address that is no multicast group, a TTL out of range
    kOther,
  };
  Kind kind = Kind::kOther;
  std::string sentence;
};

// The error as one of a command: exit code 2 where a setting is wrong, else 3.
[[nodiscard]] InputError input_error(const NetError& error);

}  // namespace peerd::net
