// Random networks against an event model that knows nothing of closed forms: it passes events, tick by tick, wave by
// wave, over all ROUTEs, with times in whole ticks. It shares no code with what it checks.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>

#include "core/animation/animation.hpp"

namespace peerd::animation::oracle_test {

constexpr int kTicksPerSecond = 64;
constexpr int kTicks = 8 * kTicksPerSecond;

double seconds(long ticks) { return static_cast<double>(ticks) / kTicksPerSecond; }

struct Numbers {
  double x = 0, y = 0, z = 0;
};
using Slot = std::pair<std::uint32_t, std::string>;  // node and field

struct Event {
  long tick = 0;
  Slot slot;
  FieldType type = FieldType::kFloat;
  double value = 0;  // times in ticks
};

class Oracle {
 public:
  Oracle(const Network& network, const std::vector<Event>& events) : network_(network), events_(events) {
    for (std::uint32_t n = 0; n < network.nodes.size(); ++n) {
      if (const auto* f = std::get_if<TimeSensorFields>(&network.nodes[n])) {
        Sensor s;
        s.interval = std::lround(f->cycle_interval * kTicksPerSecond);
        s.start = std::lround(f->start_time * kTicksPerSecond);
        s.stop = std::lround(f->stop_time * kTicksPerSecond);
        s.enabled = f->enabled;
        s.loop = f->loop;
        s.over = s.start <= 0;
        sensors_[n] = s;
      }
    }
  }

  void tick(long now) {
    now_ = now;
    std::set<std::uint32_t> started;
    for (int step = 0; step < 50; ++step) {
      std::map<Slot, Numbers> wave;
      for (auto& [n, s] : sensors_) look(n, s, step, started, wave);
      std::map<Slot, Numbers> arriving;
      if (step == 0) {
        for (const Event& e : events_) {
          if (e.tick == now) arriving[e.slot] = {e.value};
        }
      }
      if (wave.empty() && arriving.empty() && step > 0) return;
      std::set<Slot> sent;
      for (const auto& [slot, value] : wave) {
        sent.insert(slot);
        values_[slot] = value;
      }
      while (true) {
        // set_stopTime before set_startTime; the other orders are ours
        for (const char* order : {"stopTime", "enabled", "loop", "cycleInterval", "startTime", ""}) {
          for (const auto& [slot, value] : arriving) {
            const bool sensor = sensors_.contains(slot.first);
            if (sensor ? slot.second != order : *order != 0) continue;
            if (const auto out = take(slot, value)) {
              const Slot from = out->first;
              sent.insert(from);
              values_[from] = out->second;
              wave[from] = out->second;
            }
          }
        }
        arriving.clear();
        if (wave.empty()) break;
        for (const Route& r : network_.routes) {
          const auto from = wave.find({r.from_node, r.from_field});
          if (from == wave.end()) continue;
          const bool interpolator = std::holds_alternative<Interpolator>(network_.nodes[r.to_node]);
          if (sent.contains({r.to_node, interpolator ? "value_changed" : r.to_field})) continue;
          arriving[{r.to_node, r.to_field}] = from->second;
        }
        wave.clear();
      }
    }
    FAIL() << "no end at tick " << now;
  }

  [[nodiscard]] const Numbers* value(const Slot& slot) const {
    const auto v = values_.find(slot);
    return v == values_.end() ? nullptr : &v->second;
  }

 private:
  struct Sensor {
    long interval = 1, start = 0, stop = 0;
    bool enabled = true, loop = false;
    bool active = false, over = false;
    long began = -1;
    double final_fraction = 0;
    bool must_say_stopped = false;
  };

  [[nodiscard]] double fraction(const Sensor& s) const {
    const long phase = (now_ - s.start) % s.interval;
    if (phase == 0 && now_ > s.start) return 1.0;
    return static_cast<double>(phase) / static_cast<double>(s.interval);
  }

  void deactivate(Sensor& s) {
    s.active = false;
    s.final_fraction = fraction(s);
    if (!s.loop && now_ >= s.start + s.interval) s.over = true;
  }

  void look(std::uint32_t n, Sensor& s, int step, std::set<std::uint32_t>& started, std::map<Slot, Numbers>& wave) {
    const auto say_stopped = [&] {
      wave[{n, "isActive"}] = {0.0};
      wave[{n, "time"}] = {static_cast<double>(now_)};
      wave[{n, "fraction_changed"}] = {s.final_fraction};
    };
    if (s.must_say_stopped) {
      s.must_say_stopped = false;
      say_stopped();
    } else if (s.active) {
      if (step > 0) return;
      const bool boundary = now_ > s.began && (now_ - s.start) % s.interval == 0;
      if ((s.stop > s.start && now_ >= s.stop) || (!s.loop && boundary)) {
        deactivate(s);
        say_stopped();
        return;
      }
      wave[{n, "time"}] = {static_cast<double>(now_)};
      wave[{n, "fraction_changed"}] = {fraction(s)};
      if (boundary) wave[{n, "cycleTime"}] = {static_cast<double>(now_)};
    } else if (s.enabled && now_ >= s.start && !(s.stop > s.start && now_ >= s.stop) &&
               (s.loop || (!s.over && now_ < s.start + s.interval)) && started.insert(n).second) {
      s.active = true;
      s.began = now_;
      wave[{n, "isActive"}] = {1.0};
      wave[{n, "time"}] = {static_cast<double>(now_)};
      wave[{n, "fraction_changed"}] = {fraction(s)};
      wave[{n, "cycleTime"}] = {static_cast<double>(now_ - (now_ - s.start) % s.interval)};
    }
  }

  std::optional<std::pair<Slot, Numbers>> take(const Slot& slot, const Numbers& value) {
    if (const auto* i = std::get_if<Interpolator>(&network_.nodes[slot.first])) {
      const int width = i->type == InterpolatorType::kPosition ? 3 : 1;
      const int keys = static_cast<int>(i->key.size());
      int k = 0;
      while (k + 1 < keys && value.x >= i->key[k + 1]) ++k;
      double w = 0;
      if (value.x > i->key[0] && k + 1 < keys) w = (value.x - i->key[k]) / (i->key[k + 1] - i->key[k]);
      double out[3] = {};
      for (int c = 0; c < width; ++c) {
        out[c] = i->key_value[k * width + c];
        if (w > 0) out[c] = (1 - w) * out[c] + w * i->key_value[(k + 1) * width + c];
      }
      return std::pair(Slot{slot.first, "value_changed"}, Numbers{out[0], out[1], out[2]});
    }
    if (const auto s = sensors_.find(slot.first); s != sensors_.end()) {
      if (!set(s->second, slot.second, value.x)) return std::nullopt;
    }
    return std::pair(slot, value);
  }

  bool set(Sensor& s, const std::string& field, double x) {
    const long ticks = std::lround(x);
    if (field == "loop") {
      s.loop = x != 0;
    } else if (field == "enabled") {
      if (s.active && x == 0) {
        deactivate(s);
        s.must_say_stopped = true;
      }
      s.enabled = x != 0;
    } else if (field == "startTime") {
      if (s.active) return false;
      s.start = ticks;
      s.over = false;
    } else if (field == "cycleInterval") {
      if (s.active || ticks <= 0) return false;
      s.interval = ticks;
    } else if (field == "stopTime") {
      if (s.active && ticks <= s.start) return false;
      if (s.active && ticks <= now_) {
        deactivate(s);
        s.must_say_stopped = true;
      }
      s.stop = ticks;
    }
    return true;
  }

  const Network& network_;
  const std::vector<Event>& events_;
  std::map<std::uint32_t, Sensor> sensors_;
  std::map<Slot, Numbers> values_;
  long now_ = 0;
};

struct World {
  Network network;
  std::vector<Event> events;
  std::vector<std::pair<Slot, FieldType>> fields;  // those that events may reach, "value_changed" of interpolators
};

class Generator {
 public:
  explicit Generator(unsigned seed) : random_(seed) {}
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  double real() { return std::uniform_real_distribution<double>(0, 1)(random_); }

  World world() {
    World w;
    std::map<FieldType, std::vector<Slot>> outs, ins;
    const auto exposed = [&](std::uint32_t n, const char* name, FieldType type) {
      outs[type].push_back({n, name});
      ins[type].push_back({n, name});
      w.fields.push_back({{n, name}, type});
    };
    const auto next = [&] { return static_cast<std::uint32_t>(w.network.nodes.size()); };
    for (int i = 1 + below(4); i > 0; --i) {
      const std::uint32_t n = next();
      TimeSensorFields f;
      f.cycle_interval = seconds(1 + below(3 * kTicksPerSecond));
      f.enabled = below(4) > 0;
      f.loop = below(2) > 0;
      f.start_time = seconds(below(5 * kTicksPerSecond) - kTicksPerSecond);
      f.stop_time = below(2) ? 0.0 : seconds(below(6 * kTicksPerSecond));
      w.network.nodes.push_back(f);
      outs[FieldType::kBool].push_back({n, "isActive"});
      outs[FieldType::kTime].push_back({n, "cycleTime"});
      outs[FieldType::kTime].push_back({n, "time"});
      for (int k = 0; k < 3; ++k) outs[FieldType::kFloat].push_back({n, "fraction_changed"});
      for (const char* name : {"startTime", "stopTime", "cycleInterval"}) exposed(n, name, FieldType::kTime);
      for (const char* name : {"enabled", "loop"}) exposed(n, name, FieldType::kBool);
    }
    for (int i = below(5); i > 0; --i) {
      const std::uint32_t n = next();
      const bool position = below(2) > 0;
      std::vector<float> key(1 + below(4)), value(key.size() * (position ? 3 : 1));
      for (float& k : key) k = static_cast<float>(below(17)) / 16.0f;
      std::ranges::sort(key);
      key.erase(std::ranges::unique(key).begin(), key.end());
      for (float& v : value) v = static_cast<float>(below(33)) / 16.0f;
      const auto type = position ? InterpolatorType::kPosition : InterpolatorType::kScalar;
      w.network.nodes.push_back(Interpolator{type, key, value});
      ins[FieldType::kFloat].push_back({n, "set_fraction"});
      outs[position ? FieldType::kVec3 : FieldType::kFloat].push_back({n, "value_changed"});
      w.fields.push_back({{n, "value_changed"}, position ? FieldType::kVec3 : FieldType::kFloat});
    }
    for (int i = 1 + below(4); i > 0; --i) {
      const std::uint32_t n = next();
      w.network.nodes.push_back(PlainNode{});
      exposed(n, "b", FieldType::kBool);
      exposed(n, "t", FieldType::kTime);
      exposed(n, "f", FieldType::kFloat);
      exposed(n, "p", FieldType::kVec3);
    }
    const FieldType types[] = {FieldType::kBool, FieldType::kTime, FieldType::kFloat, FieldType::kFloat,
                               FieldType::kVec3};
    for (int i = 3 + below(14); i > 0; --i) {
      const FieldType type = types[below(5)];
      const auto& from = outs[type];
      const auto& to = ins[type];
      if (from.empty() || to.empty()) continue;
      const Slot& a = from[below(static_cast<int>(from.size()))];
      const Slot& b = to[below(static_cast<int>(to.size()))];
      if (std::ranges::any_of(w.network.routes, [&](const Route& r) {
            return Slot{r.from_node, r.from_field} == a && Slot{r.to_node, r.to_field} == b;
          })) {
        continue;  // the first of repeated ROUTEs counts (4.10.2)
      }
      w.network.routes.push_back({a.first, a.second, b.first, b.second, type});
    }
    for (int i = below(6); i > 0; --i) {
      const FieldType type = types[below(3)];
      const Slot& slot = ins[type][below(static_cast<int>(ins[type].size()))];
      const long tick = below(kTicks);
      double value = below(2);
      if (type == FieldType::kTime) value = static_cast<double>(tick + (below(3) ? 0 : below(128) - 64));
      if (type == FieldType::kFloat) value = real();
      if (std::ranges::any_of(w.events, [&](const Event& e) { return e.tick == tick && e.slot == slot; })) continue;
      w.events.push_back({tick, slot, type, value});
    }
    return w;
  }

 private:
  std::mt19937 random_;
};

void dump(const World& w) {
  for (std::uint32_t n = 0; n < w.network.nodes.size(); ++n) {
    if (const auto* f = std::get_if<TimeSensorFields>(&w.network.nodes[n])) {
      std::printf("%u TimeSensor interval %g enabled %d loop %d start %g stop %g (ticks)\n", n, f->cycle_interval * 64,
                  f->enabled, f->loop, f->start_time * 64, f->stop_time * 64);
    }
  }
  for (const Route& r : w.network.routes) {
    std::printf("ROUTE %u.%s TO %u.%s\n", r.from_node, r.from_field.c_str(), r.to_node, r.to_field.c_str());
  }
  for (const Event& e : w.events) {
    std::printf("at %ld deliver %u.%s %g\n", e.tick, e.slot.first, e.slot.second.c_str(), e.value);
  }
}

void deliver(Animation& a, const Event& e) {
  Value v;
  v.set(e.type, e.type == FieldType::kTime ? e.value / kTicksPerSecond : e.value);
  ASSERT_EQ(a.deliver(seconds(e.tick), e.slot.first, e.slot.second, v), std::nullopt);
}

TEST(Oracle, TheEventModelTickByTickGivesTheSameValues) {
  long compared = 0;
  long with_value = 0;
  long sensors_by_events = 0;
  for (unsigned seed = 0; seed < 2000; ++seed) {
    Generator g(seed);
    const World w = g.world();
    Oracle oracle(w.network, w.events);
    Animation a(w.network);
    for (const Event& e : w.events) deliver(a, e);
    for (long tick = 0; tick < kTicks; ++tick) {
      oracle.tick(tick);
      ASSERT_FALSE(testing::Test::HasFatalFailure()) << "seed " << seed;
      for (const auto& [slot, type] : w.fields) {
        const auto id = a.field(slot.first, slot.second);
        const Numbers* truth = oracle.value(slot);
        if (!id) {
          ASSERT_EQ(truth, nullptr);
          continue;
        }
        Value v;
        const bool has = a.value(*id, seconds(tick), v);
        ++compared;
        ASSERT_EQ(has, truth != nullptr) << "seed " << seed << " tick " << tick << ' ' << slot.first << slot.second;
        if (!has) continue;
        ++with_value;
        sensors_by_events += slot.second == "startTime";
        const double scale = type == FieldType::kTime ? 1.0 / kTicksPerSecond : 1.0;
        const Vec3 expected = Vec3(truth->x, truth->y, truth->z) * scale;
        if ((v.vec3() - expected).norm() > 1e-6) dump(w);
        ASSERT_LT((v.vec3() - expected).norm(), 1e-6)
            << "seed " << seed << " tick " << tick << ' ' << slot.first << '.' << slot.second << ' '
            << v.vec3().transpose() << " not " << expected.transpose();
      }
    }
  }
  EXPECT_GT(with_value, compared / 20);
  std::printf("oracle: %ld values compared, %ld of them driven, %ld startTimes by events\n", compared, with_value,
              sensors_by_events);
}

// Bits: the same whatever is asked first and however late deliveries come.
TEST(Oracle, AnswersAreAFunctionOfTimeAlone) {
  for (unsigned seed = 0; seed < 600; ++seed) {
    Generator g(seed);
    const World w = g.world();
    Animation forwards(w.network), shuffled(w.network, {0.0, std::size_t{1} << 26, 1});
    for (const Event& e : w.events) deliver(forwards, e);
    std::vector<double> times(200);
    for (double& t : times) t = g.below(3) ? 8.0 * g.real() : seconds(g.below(kTicks));
    std::vector<double> sorted = times;
    std::ranges::sort(sorted);
    Value v;
    std::vector<FieldId> moving;
    const auto all = [&](Animation& a, double t) {  // beginning at any field
      std::vector<double> out(6 * w.fields.size());
      const std::size_t shift = static_cast<std::size_t>(g.below(static_cast<int>(w.fields.size())));
      for (std::size_t i = 0; i < w.fields.size(); ++i) {
        const std::size_t at = (i + shift) % w.fields.size();
        double* o = out.data() + 6 * at;
        const auto id = a.field(w.fields[at].first.first, w.fields[at].first.second);
        const bool has = id && a.value(*id, t, v);
        for (int k = 0; k < 3; ++k) o[k] = has ? v.number[k] : -1e9;
        const auto s = id ? a.segment(*id, t) : std::nullopt;
        o[3] = s ? s->begin_s : -1e9;
        o[4] = s ? s->end_s : -1e9;
        o[5] = s && !s->initial ? s->velocity.sum() + s->position.sum() : -1e9;
      }
      return out;
    };
    std::map<double, std::vector<double>> truth;
    for (const double t : sorted) truth[t] = all(forwards, t);
    std::size_t next = 0;
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (i % 10 == 0 && next < w.events.size()) deliver(shuffled, w.events[next++]);
      if (i % 7 == 0) shuffled.changing(times[i], times[i] + 0.1, moving);
      (void)all(shuffled, times[i]);
    }
    for (const double t : times) {
      if (all(shuffled, t) == truth[t]) continue;
      dump(w);
      std::size_t i = 0;
      const std::vector<double> ours = all(shuffled, t);
      while (ours[i] == truth[t][i]) ++i;
      FAIL() << "seed " << seed << " t " << t << ": " << w.fields[i / 6].first.first << '.'
             << w.fields[i / 6].first.second << " [" << i % 6 << "] " << ours[i] << " not " << truth[t][i];
    }
  }
}

// Segments follow each other without a gap, and say what value() says within them, whatever starts and stops whom.
TEST(Oracle, SegmentsSayWhatValuesSay) {
  long moving = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    Generator g(seed);
    const World w = g.world();
    Animation a(w.network);
    for (const Event& e : w.events) deliver(a, e);
    for (const auto& [slot, type] : w.fields) {
      const auto id = a.field(slot.first, slot.second);
      if (!id) continue;
      double t = -0.5;
      Value v;
      for (int i = 0; i < 2000 && t < 8.0; ++i) {
        const auto s = a.segment(*id, t);
        ASSERT_TRUE(s);
        ASSERT_LE(s->begin_s, t) << "seed " << seed << ' ' << slot.first << '.' << slot.second;
        ASSERT_GT(s->end_s, t) << "seed " << seed << ' ' << slot.first << '.' << slot.second;
        if (i > 0 && s->end_s - t > 1e-12) {  // else the last one's end was rounded down
          ASSERT_NEAR(s->begin_s, t, 1e-9) << "seed " << seed << ' ' << slot.first << '.' << slot.second;
        }
        const double end = std::min(s->end_s, t + 3.0);
        for (const double part : {0.1, 0.5, 0.9}) {
          const double at = t + part * (end - t);
          if (!(at > t && at < end)) continue;
          ASSERT_EQ(a.value(*id, at, v), !s->initial) << "seed " << seed << " t " << at << ' ' << slot.second;
          const auto same = a.segment(*id, at);
          ASSERT_NEAR(std::max(same->begin_s, -1.0), std::max(s->begin_s, -1.0), 1e-9)
              << "seed " << seed << " t " << at;
          ASSERT_NEAR(std::min(same->end_s, 99.0), std::min(s->end_s, 99.0), 1e-9) << "seed " << seed << " t " << at;
          if (s->initial) continue;
          moving += !s->is_constant;
          ASSERT_LT((v.vec3() - s->position_at(at)).norm(), 1e-9)
              << "seed " << seed << " t " << at << ' ' << slot.first << '.' << slot.second;
        }
        t = s->end_s;
      }
    }
  }
  EXPECT_GT(moving, 10000);
}

// A field that changing() leaves out does not change.
TEST(Oracle, WhatIsNotChangingStays) {
  for (unsigned seed = 0; seed < 600; ++seed) {
    Generator g(seed);
    const World w = g.world();
    Animation a(w.network);
    for (const Event& e : w.events) deliver(a, e);
    std::vector<FieldId> moving;
    double t = -0.5;
    while (t < 8.0) {
      const double to = t + (g.below(2) ? seconds(1 + g.below(30)) : 0.3 * g.real());
      a.changing(t, to, moving);
      for (const auto& [slot, type] : w.fields) {
        const auto id = a.field(slot.first, slot.second);
        if (!id || slot.second == "value_changed" || std::ranges::binary_search(moving, *id)) continue;
        Value before, after;
        const bool had = a.value(*id, t, before);
        ASSERT_EQ(a.value(*id, to, after), had) << "seed " << seed << " t " << t << ' ' << slot.first << slot.second;
        if (had) {
          ASSERT_EQ(after.number, before.number) << "seed " << seed << " t " << t << ' ' << slot.first << slot.second;
        }
      }
      t = g.below(10) ? to : std::max(-0.5, t - 1.0);
    }
  }
}

}  // namespace peerd::animation::oracle_test
