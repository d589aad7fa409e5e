#pragma once
#include <gmpxx.h>

#include <array>

namespace peerd::oracle {

using IntegerPoint = std::array<mpz_class, 3>;
using IntegerTriangle = std::array<IntegerPoint, 3>;

// touch() of triangle_oracle.hpp for integer coordinates of any size.
[[nodiscard]] bool touch(const IntegerTriangle& a, const IntegerTriangle& b);

}  // namespace peerd::oracle
