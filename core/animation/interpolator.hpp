#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/animation/value.hpp"
#include "core/shared_array.hpp"

namespace peerd::animation {

enum class InterpolatorType : std::uint8_t { kColor, kCoordinate, kNormal, kOrientation, kPosition, kScalar };

// An Interpolator is an interpolator node of VRML97 (4.6.8), with its fields as in the file and keyValue flat (an
// SFRotation is four numbers).
struct Interpolator {
  InterpolatorType type = InterpolatorType::kScalar;
  SharedArray<float> key;
  SharedArray<float> key_value;
};

// A view of the keys that a set_fraction is answered from.
struct Keys {
  std::span<const float> key;
  std::span<const float> key_value;
};
[[nodiscard]] inline Keys keys_of(const Interpolator& i) { return {i.key.span(), i.key_value.span()}; }

[[nodiscard]] FieldType value_type(InterpolatorType type);      // type of value_changed
[[nodiscard]] FieldType key_value_type(InterpolatorType type);  // type of keyValue

// Returns the part of the fields that is used: as many keys as have their whole keyValue, and as many keyValues as have
// a key. Coordinate and NormalInterpolators hold as many vectors a key as their keyValue allows (6.13, 6.31: "an
// integer multiple"), and nothing where that is none. `key` is empty where there is nothing: then a set_fraction makes
// no value_changed (X3D says so; VRML97 is silent).
[[nodiscard]] Keys usable(InterpolatorType type, const Keys& keys);
[[nodiscard]] inline bool sends(InterpolatorType type, const Keys& keys) { return !usable(type, keys).key.empty(); }

// Returns whether keys[0] <= keys[1] <= ... and none is NaN, which 4.6.8 asks for. evaluate() takes other keys without
// harm and gives, for each fraction, some value between those of two neighbouring keys that is the same everywhere.
[[nodiscard]] bool is_sorted(std::span<const float> key);
void sort_keys(std::span<float> key);  // makes each key the greatest up to it

// Computes value_changed for that set_fraction. Requires sends(). Allocates only where `out.numbers` must grow.
// - Color: linear in HSV, the shorter way around the hues (6.10); of two complementary hues, whose result 6.10 leaves
// undefined, upwards from the first (red, yellow, green, ...). Grey takes the hue of the other end.
// - Coordinate, Position, Scalar: linear.
// - Normal: along the arc on the unit sphere (6.31).
// - Orientation: along the shorter arc, linear in its length (6.32).
void evaluate(InterpolatorType type, const Keys& keys, double fraction, Value& out);

// Both return keyValue[i]: of an OrientationInterpolator as a unit quaternion, and of a PositionInterpolator.
[[nodiscard]] Quat orientation_at(const Keys& keys, std::size_t i);
[[nodiscard]] Vec3 position_at(const Keys& keys, std::size_t i);

}  // namespace peerd::animation
