#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/math.hpp"

namespace peerd::animation {

// A time that never comes [s]; -kInfinity is before all times.
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The VRML97 types that events of this folder carry (clause 5). Others (SFString, SFNode, SFImage, ...) have no
// predefined movement, and ROUTEs of theirs are not for this folder.
enum class FieldType : std::uint8_t {
  kBool,      // SFBool
  kInt32,     // SFInt32
  kFloat,     // SFFloat
  kTime,      // SFTime [s]
  kColor,     // SFColor, RGB in [0, 1]
  kVec2,      // SFVec2f
  kVec3,      // SFVec3f
  kRotation,  // SFRotation
  kFloats,    // MFFloat
  kColors,    // MFColor
  kVec2s,     // MFVec2f
  kVec3s,     // MFVec3f: a CoordinateInterpolator's and a NormalInterpolator's
  kRotations  // MFRotation
};

[[nodiscard]] constexpr bool is_multiple(FieldType type) { return type >= FieldType::kFloats; }

// The value of one field. Single values are binary64, although SFFloat and SFVec3f ask for binary32 only: rounding a
// fraction to binary32 would make movement a staircase of 6e-8 of a cycle. Rotations are unit quaternions.
struct Value {
  FieldType type = FieldType::kFloat;
  std::array<double, 4> number{};  // bool: 0 or 1; colours: r g b; vectors: x y (z); rotations: quaternion x y z w
  std::vector<float> numbers;      // multiple types only, flat, as VRML97 writes them (MFRotation: axis and angle)

  [[nodiscard]] bool boolean() const { return number[0] != 0.0; }
  [[nodiscard]] double scalar() const { return number[0]; }  // SFFloat, SFTime, SFInt32
  [[nodiscard]] Vec3 vec3() const { return {number[0], number[1], number[2]}; }
  [[nodiscard]] Quat quat() const { return {number[3], number[0], number[1], number[2]}; }

  void set(FieldType t, double x) { type = t, number = {x, 0, 0, 0}; }
  void set(FieldType t, const Vec3& v) { type = t, number = {v.x(), v.y(), v.z(), 0}; }
  void set(const Quat& q) { type = FieldType::kRotation, number = {q.x(), q.y(), q.z(), q.w()}; }

  [[nodiscard]] static Value of_bool(bool b) { return of(FieldType::kBool, b ? 1.0 : 0.0); }
  [[nodiscard]] static Value of_time(double s) { return of(FieldType::kTime, s); }
  [[nodiscard]] static Value of_float(double x) { return of(FieldType::kFloat, x); }
  [[nodiscard]] static Value of_vec3(const Vec3& v) {
    Value out;
    out.set(FieldType::kVec3, v);
    return out;
  }

 private:
  [[nodiscard]] static Value of(FieldType type, double x) {
    Value out;
    out.set(type, x);
    return out;
  }
};

}  // namespace peerd::animation
