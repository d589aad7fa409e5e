#include "peerd/peer/config/baseline_settings.hpp"

namespace peerd::config {

BaselineSettings read_baseline(TomlReader reader) {
  BaselineSettings s;
  std::size_t system = 0;
  reader.read_word("system", system, {"none", "lockstep", "server"});
  s.system = static_cast<BaselineSystem>(system);
  reader.read("snapshots_hz", s.snapshots_hz, 1, 1000);
  reader.read("interpolation_ms", s.interpolation_ms, 0, 2000);
  reader.read("prediction", s.prediction);
  reader.read("lag_compensation", s.lag_compensation);
  reader.finish();
  return s;
}

}  // namespace peerd::config
