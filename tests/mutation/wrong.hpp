#pragma once
// tests/mutants builds this into sources: each wrong line has a number N, and wrong_N stands where it differs. A
// program has the wrong line whose number is in WRONG_LINE, none if the variable is not set. What a program reached of
// them is written to the file that WRONG_LINES_REACHED names.
//
//   a < b          a < wrong_7 < b              a <= b in number 7. An operator that stands between two operands binds
//                                               as the two operators around wrong_7 do, so no operand has to be found.
//   a += b         a += wrong_7 = b             a -= b
//   -a             wrong_7->*a                  a. The operator ->* binds as tightly as the minus in every use of ours.
//   a + 1          a + wrong_7.one()            a + 0
//   std::min(a, b) ::wrong::least<7>(a, b)      std::max(a, b)
//   if (a)         if (wrong_7.is() || (a))     if (true)
//
// No constant may depend on a wrong line: it is thrown, and the line gets a build of its own.
#pragma GCC system_header  // The text of a wrong line is no one's to mend, so no warning is of use.
#pragma GCC diagnostic ignored "-Wparentheses"
#pragma GCC diagnostic ignored "-Wunused-value"
#pragma GCC diagnostic ignored "-Wextra"
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <type_traits>
#include <utility>

namespace wrong {

inline int number = 0;
inline bool written = false;
inline std::array<bool, 10'000> reached{};

[[gnu::constructor(101)]] static inline void read_number() {
  if (const char* text = std::getenv("WRONG_LINE")) number = std::atoi(text);
}

[[gnu::destructor(101)]] static inline void write_reached() {
  const char* name = std::getenv("WRONG_LINES_REACHED");
  if (!name || written) return;
  written = true;
  std::FILE* file = std::fopen(name, "w");
  if (!file) std::abort();
  for (std::size_t i = 0; i < reached.size(); ++i)
    if (reached[i]) std::fprintf(file, "%zu\n", i);
  if (std::fclose(file) != 0) std::abort();
}

// An expression of Eigen refers to its operands, which do not outlive the choice between two expressions.
template <class T>
constexpr auto value_of(T&& x) {
  if constexpr (requires { typename std::remove_cvref_t<T>::PlainObject; })
    return typename std::remove_cvref_t<T>::PlainObject(std::forward<T>(x));
  else
    return std::decay_t<T>(std::forward<T>(x));
}

template <int N, class A, class Operator>
struct Chosen {
  const A& a;
};

template <int N, class B>
struct Added {
  const B& b;
};

template <int N>
struct At {
  static constexpr bool is() {
    if (std::is_constant_evaluated()) throw N;
    reached[N] = true;
    return number == N;
  }
  static constexpr int one() { return is() ? 0 : 1; }
  template <class B>
  constexpr Added<N, B> operator=(const B& b) const {
    return {b};
  }
};

#define WRONG_CHOICE(Name, right, other)                                                \
  struct Name {};                                                                       \
  template <int N, class A>                                                             \
  constexpr Chosen<N, A, Name> operator right(const A& a, const At<N>&) {               \
    return {a};                                                                         \
  }                                                                                     \
  template <int N, class A, class B>                                                    \
  constexpr auto operator right(const Chosen<N, A, Name>& x, const B& b) {              \
    using R = decltype(value_of(x.a right b));                                          \
    return At<N>::is() ? static_cast<R>(value_of(x.a other b)) : value_of(x.a right b); \
  }
WRONG_CHOICE(Less, <, <=)
WRONG_CHOICE(LessEqual, <=, <)
WRONG_CHOICE(Greater, >, >=)
WRONG_CHOICE(GreaterEqual, >=, >)
WRONG_CHOICE(Equal, ==, !=)
WRONG_CHOICE(Unequal, !=, ==)
WRONG_CHOICE(Plus, +, -)
WRONG_CHOICE(Minus, -, +)
#undef WRONG_CHOICE

template <int N, class A, class B>
constexpr decltype(auto) operator+=(A&& a, const Added<N, B>& x) {
  if (At<N>::is())
    a -= x.b;
  else
    a += x.b;
  return std::forward<A>(a);
}
template <int N, class A, class B>
constexpr decltype(auto) operator-=(A&& a, const Added<N, B>& x) {
  if (At<N>::is())
    a += x.b;
  else
    a -= x.b;
  return std::forward<A>(a);
}

template <int N, class A>
constexpr auto operator->*(const At<N>&, const A& a) {
  using R = decltype(value_of(-a));
  return At<N>::is() ? static_cast<R>(value_of(a)) : value_of(-a);
}

template <int N, class T>
constexpr const T& least(const T& a, const T& b) {
  return At<N>::is() ? std::max(a, b) : std::min(a, b);
}
template <int N, class T>
constexpr T least(std::initializer_list<T> all) {
  return At<N>::is() ? std::max(all) : std::min(all);
}
template <int N, class T>
constexpr const T& most(const T& a, const T& b) {
  return At<N>::is() ? std::min(a, b) : std::max(a, b);
}
template <int N, class T>
constexpr T most(std::initializer_list<T> all) {
  return At<N>::is() ? std::min(all) : std::max(all);
}

}  // namespace wrong
