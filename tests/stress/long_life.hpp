#pragma once
#include <cmath>
#include <cstdint>

#include "tests/replication/peer/lan.hpp"

// Two peers that share a world for hours, and how far apart they, and the world, are in the end.
namespace peerd::stress {

// The bounds that hold after any time; README.md lists them.
inline constexpr double kNormBound = 1e-15, kSpinnerBound_rad = 1e-3, kBallBound_m = 1e-12, kBallSpeedBound = 1e-12,
                        kMachineBound_m = 1e-6, kMoverBound_m = 0.5;
inline constexpr std::int64_t kClocksBound_ns = 10'000'000;

struct LongLife {
  double session_s = 0.0;      // simulated
  std::uint64_t ticks = 0;     // of both
  std::uint64_t contacts = 0;  // answered by the ball that bounces
  std::uint64_t updates = 0;
  std::uint64_t lost = 0;                      // peers thought gone, clocks stepped, sleeps: there is no reason for any
  std::map<std::string, std::uint64_t> drops;  // by reason, but for those before the session and of copies
  std::uint64_t old_copies = 0;                // updates that came once more, too old to be taken
  double norm_error = 0.0;                     // the most that an orientation's norm was from 1
  double spinner_error_rad = 0.0;              // the ghost of what turns at 100 rad/s, from the closed form
  double ball_error_m = 0.0;                   // the observer's ghost of the ball from its owner's truth
  double ball_speed_error = 0.0;               // of its speed, which nothing changes; relative
  double mover_error_m = 0.0;                  // ghost of what a formula drives, the worst
  double machine_error_m = 0.0;                // what the world moves by itself, from where its keys have it then
  std::uint64_t machine_differs = 0;           // instants at which the two peers' bits of it were others
  std::int64_t clocks_apart_ns = 0;            // the most that the session times of the two were apart
};

// Runs for `total` at `tick_hz`, and checks every `look`. A ball bounces between walls by physics; SPINNER turns at 100
// rad/s and MOVER goes to and fro, both driven; PLATE is moved by the world's own TimeSensor.
inline LongLife live_for(Duration total, std::uint32_t tick_hz, Duration look) {
  using namespace replication;
  using namespace replication::test;
  const World world(corridor(std::string(kBounces) + "velocityVector 2 0 0 ") + box("SPINNER", "1 1 1", "0 40 0") +
                    box("MOVER", "1 1 1", "0 60 0") + box("PLATE", "1 1 1", "10 80 0") +
                    // PredefinedMotion covers what an interest names.
                    interest("SPINNER", "\"PLATE\"") +
                    "DEF T TimeSensor { cycleInterval 12 loop TRUE }\n"
                    "DEF P PositionInterpolator { key [ 0 0.5 1 ] keyValue [ 10 80 0, 4 80 0, 10 80 0 ] }\n"
                    "ROUTE T.fraction_changed TO P.set_fraction ROUTE P.value_changed TO PLATE.translation\n");
  constexpr double kSpin_rad_s = 100.0;
  const SimTime begin{kEpoch};
  const auto spinner = [&](SimTime t) {
    KinematicState s = moving({0, 40, 0});
    s.angular_velocity_body = {0, 0, kSpin_rad_s};
    return advance(s, to_seconds(t - begin));
  };
  const auto mover = [&](SimTime t) {
    const double s = to_seconds(t - begin);
    return moving({3.0 * std::sin(0.2 * s), 60, 0}, {0.6 * std::cos(0.2 * s), 0, 0}, {-0.12 * std::sin(0.2 * s), 0, 0});
  };
  Lan lan(world, {20ms, 5ms, 0.0, 0.0});
  for (const std::uint32_t id : {1u, 2u}) {
    PeerConfig c = config(id);
    c.tick_hz = tick_hz;
    if (id == 1) {
      c.owned = {{world["BALL"], false}, {world["SPINNER"], true}, {world["MOVER"], true}};
      c.policy.error_threshold_m = 0.05;
      lan.add(c, 0s, {{world["SPINNER"], spinner}, {world["MOVER"], mover}});
    } else {
      lan.add(c, 7s);
    }
  }
  lan.run_until(4s);
  lan.peer(0).announce_start(lan.session_now(0));
  lan.run_until(20s);

  LongLife life;
  const auto count_outputs = [&] {
    for (std::size_t i : {0u, 1u}) {
      life.lost += lan.seen<PeerLost>(i).size() + lan.seen<ClockStepped>(i).size() + lan.seen<HostSuspended>(i).size();
      lan.node(i).outputs.clear();
    }
  };
  count_outputs();
  life.lost = 0;
  const double speed = lan.peer(0).truth(world["BALL"], lan.session_now(0)).velocity.norm();
  // A tick of the lower rate besides what is under way.
  const Duration settled = 300ms + Duration{std::chrono::seconds(1)} / tick_hz;
  for (Duration t = 20s + look; t <= total; t += look) {
    lan.run_until(t);
    count_outputs();
    const SimTime now = std::min(lan.session_now(0), lan.session_now(1)) - settled;
    life.clocks_apart_ns =
        std::max<std::int64_t>(life.clocks_apart_ns, std::abs((lan.session_now(0) - lan.session_now(1)).count()));
    for (std::size_t i : {0u, 1u}) {
      for (const char* name : {"BALL", "SPINNER", "MOVER", "PLATE"}) {
        const KinematicState s = lan.peer(i).ghost(world[name], now);
        life.norm_error = std::max(life.norm_error, std::abs(s.orientation.norm() - 1.0));
      }
    }
    const auto worst = [](double& so_far, double error) { so_far = std::max(so_far, error); };
    worst(life.spinner_error_rad,
          angle_between(lan.peer(1).ghost(world["SPINNER"], now).orientation, spinner(now).orientation));
    worst(life.mover_error_m, (lan.peer(1).ghost(world["MOVER"], now).position - mover(now).position).norm());
    const KinematicState ball = lan.peer(0).truth(world["BALL"], now);
    worst(life.ball_error_m, (lan.peer(1).ghost(world["BALL"], now).position - ball.position).norm());
    worst(life.ball_speed_error, std::abs(ball.velocity.norm() / speed - 1.0));
    const double phase_s = std::fmod(to_seconds(now - *lan.peer(0).world_zero()), 12.0);
    const KinematicState plate = lan.peer(0).ghost(world["PLATE"], now);
    worst(life.machine_error_m, std::abs(plate.position.x() - (phase_s < 6.0 ? 10.0 - phase_s : phase_s - 2.0)));
    life.machine_differs += !same_bits(plate, lan.peer(1).ghost(world["PLATE"], now));
  }
  life.session_s = to_seconds(lan.session_now(0) - begin);
  for (std::size_t i : {0u, 1u}) {
    life.ticks += lan.peer(i).counters().ticks;
    for (const auto& [reason, n] : lan.peer(i).counters().drops) {
      if (reason == "update_time") {
        life.old_copies += n;
      } else if (reason != "not_yet_in_session") {
        life.drops[reason] += n;
      }
    }
  }
  life.contacts = lan.peer(0).motion_counters().contacts / 2;  // the truth's and the ghost's
  life.updates = lan.peer(0).counters().updates_out;
  return life;
}

}  // namespace peerd::stress
