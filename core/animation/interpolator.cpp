#include "core/animation/interpolator.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/animation/spherical_interpolation.hpp"

namespace peerd::animation {
namespace {

// A key interval is the two neighbouring keys that a fraction lies between.
struct KeyInterval {
  std::size_t a = 0;  // the last key <= fraction
  std::size_t b = 0;  // the one after; == a at and outside the ends
  double weight = 0;  // weight of b, in [0, 1)
};

// Finds the key interval of f(t) = v_0 for t <= t_0, v_{n-1} for t >= t_{n-1}, else linterp(t, v_i, v_{i+1}) for t_i <=
// t <= t_{i+1} (4.6.8). At a key that is given more than once, where 4.6.8 leaves it open, the last of its values
// counts (the limit from the right); but v_0 at a first key, as the first line has it. A NaN gives v_0. O(log n); n >=
// 1.
KeyInterval find_key_interval(std::span<const float> key, double fraction) {
  assert(!key.empty());
  const std::size_t last = key.size() - 1;
  if (!(fraction > key[0])) return {0, 0, 0.0};
  if (fraction >= key[last]) return {last, last, 0.0};
  std::size_t a = 0;     // key[a] <= fraction
  std::size_t b = last;  // key[b] > fraction. Unlike std::upper_bound, this ends on any keys, sorted or not
  while (b - a > 1) {
    const std::size_t middle = a + (b - a) / 2;
    (key[middle] <= fraction ? a : b) = middle;
  }
  const double from = key[a];
  const double weight = (fraction - from) / (key[b] - from);
  if (!(weight > 0.0)) return {a, a, 0.0};
  return {a, b, std::min(weight, 1.0)};
}

// The result is exact at weight 0, and constant where the ends are equal.
double lerp(double a, double b, double weight) { return a + weight * (b - a); }
Vec3 lerp(const Vec3& a, const Vec3& b, double weight) { return a + weight * (b - a); }

struct Hsv {
  double hue = 0.0;  // in sixths of a turn from red, [0, 6)
  double saturation = 0.0;
  double value = 0.0;
};

// The conversion follows Foley, van Dam, Feiner and Hughes, Computer Graphics: Principles and Practice, 2nd edition,
// 13.3.4.
Hsv hsv_from_rgb(const Vec3& rgb) {
  const double r = rgb[0];
  const double g = rgb[1];
  const double b = rgb[2];
  const double most = std::max({r, g, b});
  const double propagate = most - std::min({r, g, b});
  if (!(propagate > 0.0) || !(most > 0.0)) return {0.0, 0.0, most};
  double hue = 0.0;
  if (r == most) {
    hue = (g - b) / propagate;
  } else if (g == most) {
    hue = 2.0 + (b - r) / propagate;
  } else {
    hue = 4.0 + (r - g) / propagate;
  }
  return {hue < 0.0 ? hue + 6.0 : hue, propagate / most, most};
}

Vec3 rgb_from_hsv(const Hsv& c) {
  const double sector = std::min(std::floor(c.hue), 5.0);
  const double f = c.hue - sector;
  const double p = c.value * (1.0 - c.saturation);
  const double q = c.value * (1.0 - c.saturation * f);
  const double t = c.value * (1.0 - c.saturation * (1.0 - f));
  switch (static_cast<int>(sector)) {
    case 0:
      return {c.value, t, p};
    case 1:
      return {q, c.value, p};
    case 2:
      return {p, c.value, t};
    case 3:
      return {p, q, c.value};
    case 4:
      return {t, p, c.value};
    default:
      return {c.value, p, q};
  }
}

Vec3 lerp_hsv(const Vec3& rgb_a, const Vec3& rgb_b, double weight) {
  if (weight == 0.0) return rgb_a;  // not through HSV and back, which rounds
  Hsv a = hsv_from_rgb(rgb_a);
  Hsv b = hsv_from_rgb(rgb_b);
  if (a.saturation == 0.0) a.hue = b.hue;
  if (b.saturation == 0.0) b.hue = a.hue;
  double way = b.hue - a.hue;
  if (way > 3.0) way -= 6.0;
  if (way <= -3.0) way += 6.0;
  double hue = a.hue + weight * way;
  if (hue < 0.0) hue += 6.0;
  if (hue >= 6.0) hue -= 6.0;
  return rgb_from_hsv({hue, lerp(a.saturation, b.saturation, weight), lerp(a.value, b.value, weight)});
}

Vec3 triple(std::span<const float> floats, std::size_t at) { return {floats[at], floats[at + 1], floats[at + 2]}; }

void evaluate_many(InterpolatorType type, const Keys& keys, const KeyInterval& between, Value& out) {
  const std::size_t count = keys.key_value.size() / keys.key.size();
  out.numbers.resize(count);
  for (std::size_t i = 0; i < count; i += 3) {
    const Vec3 a = triple(keys.key_value, between.a * count + i);
    const Vec3 b = triple(keys.key_value, between.b * count + i);
    const Vec3 v = between.a == between.b              ? a
                   : type == InterpolatorType::kNormal ? slerp(a, b, between.weight)
                                                       : lerp(a, b, between.weight);
    for (int k = 0; k < 3; ++k) out.numbers[i + k] = static_cast<float>(v[k]);
  }
}

}  // namespace

FieldType value_type(InterpolatorType type) {
  switch (type) {
    case InterpolatorType::kColor:
      return FieldType::kColor;
    case InterpolatorType::kCoordinate:
    case InterpolatorType::kNormal:
      return FieldType::kVec3s;
    case InterpolatorType::kOrientation:
      return FieldType::kRotation;
    case InterpolatorType::kPosition:
      return FieldType::kVec3;
    case InterpolatorType::kScalar:
      break;
  }
  return FieldType::kFloat;
}

FieldType key_value_type(InterpolatorType type) {
  switch (type) {
    case InterpolatorType::kColor:
      return FieldType::kColors;
    case InterpolatorType::kOrientation:
      return FieldType::kRotations;
    case InterpolatorType::kScalar:
      return FieldType::kFloats;
    default:
      return FieldType::kVec3s;
  }
}

Keys usable(InterpolatorType type, const Keys& keys) {
  const std::size_t floats = keys.key_value.size();
  std::size_t n = keys.key.size();
  std::size_t width = 3;  // floats of keyValue a key
  switch (type) {
    case InterpolatorType::kCoordinate:
    case InterpolatorType::kNormal:
      if (n > 0) width = floats / n / 3 * 3;
      if (width == 0) n = 0;
      break;
    case InterpolatorType::kOrientation:
      width = 4;
      break;
    case InterpolatorType::kScalar:
      width = 1;
      break;
    default:
      break;
  }
  if (n > 0) n = std::min(n, floats / width);
  return {keys.key.first(n), keys.key_value.first(n * width)};
}

bool is_sorted(std::span<const float> key) {
  if (!key.empty() && !(key[0] == key[0])) return false;
  for (std::size_t i = 1; i < key.size(); ++i) {
    if (!(key[i - 1] <= key[i])) return false;
  }
  return true;
}

void sort_keys(std::span<float> key) {
  float greatest = -std::numeric_limits<float>::max();
  for (float& k : key) {
    if (k > greatest) greatest = k;
    k = greatest;
  }
}

Quat orientation_at(const Keys& keys, std::size_t i) {
  return quat_from_axis_angle(triple(keys.key_value, 4 * i), keys.key_value[4 * i + 3]);
}

Vec3 position_at(const Keys& keys, std::size_t i) { return triple(keys.key_value, 3 * i); }

void evaluate(InterpolatorType type, const Keys& all, double fraction, Value& out) {
  const Keys keys = usable(type, all);
  assert(!keys.key.empty());
  const KeyInterval at = find_key_interval(keys.key, fraction);
  out.type = value_type(type);
  switch (type) {
    case InterpolatorType::kColor:
      return out.set(out.type, lerp_hsv(position_at(keys, at.a), position_at(keys, at.b), at.weight));
    case InterpolatorType::kPosition:
      return out.set(out.type, lerp(position_at(keys, at.a), position_at(keys, at.b), at.weight));
    case InterpolatorType::kScalar:
      return out.set(out.type, lerp(keys.key_value[at.a], keys.key_value[at.b], at.weight));
    case InterpolatorType::kOrientation: {
      const Quat a = orientation_at(keys, at.a);
      if (at.a == at.b) return out.set(a);
      return out.set(rotated_in_body_frame(a, at.weight * rotation_between(a, orientation_at(keys, at.b))));
    }
    case InterpolatorType::kCoordinate:
    case InterpolatorType::kNormal:
      return evaluate_many(type, keys, at, out);
  }
}

}  // namespace peerd::animation
