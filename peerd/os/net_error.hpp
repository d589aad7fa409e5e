#pragma once
#include <cstdint>
#include <string>

namespace peerd::net {

// Why the network could not be had. The sentence is for a person: it says what is wrong and what to do about it.
struct NetError {
  enum class Kind : std::uint8_t {
    kNoSuchInterface,  // no interface of that name
    kNoMulticast,      // there is one, but multicast does not work over it
    kPortBusy,         // another program holds the port and does not share it
    kPermission,       // the system forbids it
    kLimit,            // too many groups, files, regions
    kBadSetting,       // an address that is no multicast group, a TTL out of range
    kOther,
  };
  Kind kind = Kind::kOther;
  std::string sentence;
};

}  // namespace peerd::net
