#include "peerd/net/os/net_error.hpp"

namespace peerd::net {

InputError input_error(const NetError& error) {
  return {"error: " + error.sentence, error.kind == NetError::Kind::kBadSetting ? 2 : 3};
}

}  // namespace peerd::net
