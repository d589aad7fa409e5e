#pragma once
#include <cmath>
#include <vector>

#include "peerd/lab/measure/run_record.hpp"

namespace peerd::measure::samples {

inline constexpr PeerId kA{1}, kB{2}, kC{3};
inline constexpr ObjectId kCar{10}, kCube{11}, kWall{17};

// Peers a, b, c; a runs CAR, b runs CUBE; nothing has happened.
inline RunRecord quiet_run(double duration_s = 10.0) {
  return {.params = nlohmann::ordered_json::object(),
          .duration_s = duration_s,
          .peers = {{kA, "a"}, {kB, "b"}, {kC, "c"}},
          .objects = {{kCar, "CAR", kA}, {kCube, "CUBE", kB}}};
}

inline GhostSample ghost_sample(double t_s, PeerId observer, ObjectId object, const Vec3& truth, const Vec3& ghost) {
  GhostSample s{.t_s = t_s, .observer = observer, .object = object};
  s.truth.position = truth;
  s.ghost.position = ghost;
  s.shown.position = 0.5 * (truth + ghost);
  s.seen = s.truth;
  return s;
}

// CAR zigzags in x while it goes along -z; ghosts at b and c lag behind by `lag_s`. CUBE lies still.
inline RunRecord zigzag_run(double lag_s, int ticks = 100) {
  RunRecord run = quiet_run();
  const auto car = [](double t_s) { return Vec3(std::abs(std::fmod(t_s, 4.0) - 2.0), 0.0, -3.0 * t_s); };
  const auto time_of = [&](int i) { return run.duration_s * i / ticks; };
  for (const PeerId observer : {kA, kB, kC}) {  // in the order (observer, object, t_s) of the contract
    for (int i = 0; observer != kA && i < ticks; ++i) {
      run.ghost_samples.push_back(
          ghost_sample(time_of(i), observer, kCar, car(time_of(i)), car(std::max(0.0, time_of(i) - lag_s))));
    }
    for (int i = 0; observer != kB && i < ticks; ++i) {
      run.ghost_samples.push_back(ghost_sample(time_of(i), observer, kCube, {8, 0, 0}, {8, 0, 0}));
    }
  }
  for (int i = 0; i < 5; ++i) {
    run.updates.push_back({2.0 * i, kA, kCar, 31, 0.5, i == 0 ? "first" : "error"});
    run.datagrams.push_back({2.0 * i, kA, 98});
  }
  run.updates.push_back({9.0, kB, kCube, 31, 0.5, "time"});
  run.contacts.push_back({2.0, kA, "owner", kCar, kWall, Vec3::UnitX(), 2.01});
  run.contacts.push_back({2.1, kB, "predicted", kCar, kWall, Vec3::UnitX(), 2.15});
  run.counters = {{"drops", 3}};
  return run;
}

inline std::vector<RunRecord> zigzag_sweep() {
  std::vector<RunRecord> runs;
  for (const char* approach : {"dr", "dr+rcp"}) {
    for (const int latency_ms : {5, 100, 500}) {
      runs.push_back(zigzag_run(1e-3 * latency_ms));
      runs.back().params = {{"replication.approach", approach}, {"network.latency_ms", latency_ms}};
    }
  }
  return runs;
}

}  // namespace peerd::measure::samples
