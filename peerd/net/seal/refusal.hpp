#pragma once
#include <cstddef>
#include <cstdint>

namespace peerd::seal {

// Why a datagram was not opened, or an announcement not taken.
enum class Refusal : std::uint8_t {
  kOpen,         // it is not sealed: its sender was started with --open, or is an older program
  kOwn,          // it has this peer's number, and no other process of this peer has sent it
  kUnproven,     // nothing shows that its sender runs at present: no announcement of its boot has named this process's
  kForged,       // no key opens it: another session's, or damaged, or forged
  kReplayed,     // it has come before, or is older than kWidth counters of its region
  kTooMany,      // of a boot in whose place so many others of its peer came that it was given up
  kNoMember,     // its sender's key is no member's
  kImpostor,     // its sender's number is another key's
  kUnsigned,     // by somebody who has the session's key, and not by its sender
  kWrongSender,  // what it says is of another sender, or nothing that peers say
  kObserver,     // its sender may only look
  kOtherEpoch,   // of another epoch: its sender has another roster, or none
  kUnchecked,    // a signature is to be checked, which the caller does not want now
};
inline constexpr std::size_t kRefusals = 13;

}  // namespace peerd::seal
